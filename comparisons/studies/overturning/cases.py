"""The runs behind the overturning study: analytic maps, a scan of all solvers, their boundaries, their knobs."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from analytic import load_scene, overturning_map
from engines import get_engine

from ...running.cases import Case
from ...running.refine import together
from ...running.study import Batch, Found, say
from ...showing.wording import solver_name
from .edges import HIGHEST, LOWEST, edges, least_normal, locate, pulse
from .outcomes import BAND, judge, label_of

if TYPE_CHECKING:
    from analytic import Response, Scene

    from ...running.study import Ask, Plan

SHAPES = ("one-sine", "one-cosine", "ricker")
# The isolated Caryatid itself overturns at base displacements far beyond its bearings' 0.30 m only; a more slender
# block on the same bearings does at amplitudes of a strong earthquake.
GROUNDS = {"rigid ground": ("caryatid-rigid", {}), "isolated base": ("caryatid-isolated", {"slenderness": 0.15})}
FREQUENCIES = (2.0, 4.0, 6.0, 8.0)
SCAN = np.geomspace(1.05, 19.5, 11)
LADDER = ((2e-4, 1.2e-2), (3e-2,), (0.1,), (0.3,))
KNOB_LADDER = ((2e-3, 2e-2), (0.1,), (0.3,))
TOLERANCE, KNOB_TOLERANCE = 2e-5, 2e-4

KNOB_FREQUENCY = 4.0
TIME_STEPPING = ("time-stepping", None, "step", (1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 1e-5))


def defaults_of(engines: Sequence[str]) -> list[tuple[str, str]]:
    """(engine, variant) of the engines at default settings."""
    return [(name, get_engine(name).default_variant) for name in engines]


def ladders_of(engines: Sequence[str]) -> list[tuple[str, str, str, tuple[float, ...]]]:
    """(engine, variant, knob, values) of all variants but default settings: step, accuracy or stiffness."""
    return [
        (name, variant, kind.knob, kind.ladder)
        for name in engines
        for variant, kind in get_engine(name).variants.items()
        if kind.tier != "defaults" and not kind.takes_restitution
    ]


def first_scripts_of(engines: Sequence[str]) -> list[tuple[str, str, str, tuple[float, ...]]]:
    """The same of default settings."""
    return [
        (name, variant, kind.knob, (kind.default,))
        for name in engines
        for variant, kind in get_engine(name).variants.items()
        if kind.tier == "defaults"
    ]


def held_of(engines: Sequence[str]) -> list[tuple[str, str, dict[str, float]]]:
    """(engine, variant, settings) of the variants that hold the corner down, as the analytic model does."""
    return [
        (name, variant, kind.finer[0] if kind.finer else {})
        for name in engines
        for variant, kind in get_engine(name).variants.items()
        if kind.takes_restitution
    ]


def measure(case: Case, response: Response) -> dict[str, Any]:
    """What is kept of a run."""
    return {"outcome": response.outcome, "decided": response.decided, "end_tilt": response.end.tilt}


def plan(ask: Ask) -> Plan:
    """The plan of the study: an answer first without other settings than the defaults, then growing.

    Rows by "part": "edge" (a boundary of the analytic model), "shift" (a solver's beside it, at default settings),
    "held" (the same with the corner held, where the normal force is negative), "knob" (the same at other settings),
    "confusion", "surprise" (a disagreement outside the band) and "failure".

    Arrays: frequency, amplitude; ``<ground>/<shape>``: int16, shape (amplitudes, frequencies), impacts before
    overturning in the analytic model, -1 where it does not overturn. ``points``: shape (n, 8): ground, shape, solver
    (indices into the settings), frequency, amplitude, analytic outcome, solver's outcome (1 overturns, 0 not, -1
    failed or undecided), whether of the scan.
    """
    quick, engines = ask.quick, defaults_of(ask.engines)
    grounds = {
        name: load_scene(shipped).with_(block=block, motion=None, duration=None)
        for name, (shipped, block) in GROUNDS.items()
    }
    shapes = SHAPES[:1] if quick else SHAPES
    frequencies = (2.0, 4.0) if quick else FREQUENCIES
    arrays = _maps(grounds, shapes, quick)
    boundaries = {}
    for ground, scene in grounds.items():
        for shape in shapes:
            say(f"analytic boundaries: {ground}, {shape}")
            boundaries[ground, shape] = dict(zip(frequencies, edges(scene, shape, frequencies), strict=True))
    rows = [
        {"part": "edge", "ground": ground, **vars(edge)}
        for (ground, _), columns in boundaries.items()
        for column in columns.values()
        for edge in column
    ]
    log = _Log(engines, grounds)
    for engine in engines:
        yield from log.scan(engine, boundaries, SCAN[::4] if quick else SCAN)
    rows += yield from _search(log, boundaries, engines, "shift", LADDER, TOLERANCE)
    pulled = {
        key: {frequency: [edge for edge in column if edge.min_normal < 0] for frequency, column in columns.items()}
        for key, columns in boundaries.items()
    }
    rows += yield from _search(log, pulled, held_of(ask.engines), "held", LADDER, TOLERANCE)
    arrays["points"], judged = judge(log.points, log.engines, grounds, shapes, boundaries)
    rows += judged
    settings = _settings(ask, grounds, shapes, frequencies)
    yield Found(settings, rows + log.failures, arrays)
    chosen = {
        (ground, "one-sine"): {f: column for f, column in boundaries[ground, "one-sine"].items() if f == KNOB_FREQUENCY}
        for ground in grounds
    }
    for solver, variant, knob, values in (*first_scripts_of(ask.engines), TIME_STEPPING, *ladders_of(ask.engines)):
        for value in values[1:2] if quick and len(values) > 1 else values:
            rows += yield from _search(
                log, chosen, [(solver, variant, {knob: value})], "knob", KNOB_LADDER, KNOB_TOLERANCE
            )
        yield Found(settings, rows + log.failures, arrays)
    return Found(settings, rows + log.failures, arrays)


def _settings(ask, grounds, shapes, frequencies):
    """What the study was asked, for its result file."""
    return {
        "quick": ask.quick,
        "grounds": {
            name: {
                "scene": GROUNDS[name][0],
                "block": scene.block.model_dump(),
                "omega_r": scene.rocking_frequency,
                "unit": scene.gravity * math.tan(scene.block.slenderness),
                "tan_slenderness": math.tan(scene.block.slenderness),
                "base": scene.base.model_dump() if scene.base else None,
                "bearings": scene.bearings.model_dump() if scene.bearings else None,
            }
            for name, scene in grounds.items()
        },
        "shapes": list(shapes),
        "frequencies": list(frequencies),
        "scan": list(SCAN[::4] if ask.quick else SCAN),
        "amplitudes": [LOWEST, HIGHEST],
        "band": BAND,
        "tolerance": TOLERANCE,
        "knob_tolerance": KNOB_TOLERANCE,
        "solvers": [solver_name(*asked) for asked in defaults_of(ask.engines)],
        "held": {solver_name(*asked[:2]): label_of(asked) for asked in held_of(ask.engines)},
        "knobs": [
            [solver, variant, knob]
            for solver, variant, knob, _ in (TIME_STEPPING, *ladders_of(ask.engines), *first_scripts_of(ask.engines))
        ],
        "default_knobs": {
            solver_name(*asked): get_engine(asked[0]).variants[asked[1]].default for asked in defaults_of(ask.engines)
        },
        "first_scripts": [solver_name(*asked[:2]) for asked in first_scripts_of(ask.engines)],
        "friction": {
            solver_name(solver, variant): friction
            for solver, variant, *_ in first_scripts_of(ask.engines)
            if (friction := get_engine(solver).variants[variant].friction) is not None
        },
    }


def _maps(grounds, shapes, quick):
    frequency = np.linspace(1.5, 8.5, 36 if quick else 141)
    amplitude = np.geomspace(LOWEST, HIGHEST, 60 if quick else 240)
    arrays = {"frequency": frequency, "amplitude": amplitude}
    for ground, scene in grounds.items():
        for shape in shapes:
            say(f"analytic map: {ground}, {shape}")
            outcomes = overturning_map(scene, shape, frequency, amplitude)
            impacts = np.minimum(outcomes.impacts, 32767)
            arrays[f"{ground}/{shape}"] = np.where(outcomes.overturns, impacts, -1).astype(np.int16)
    return arrays


class _Log:
    """Runs points of the map through the solvers and remembers all outcomes and failures."""

    def __init__(self, engines: Sequence[Any], grounds: Mapping[str, Scene]) -> None:
        self.engines, self._grounds = engines, grounds
        self.points, self.failures = {}, []

    def run(self, points, label, scan=False):
        """Outcomes (True, False, None) of (engine, ground, shape, frequency, amplitude, least N) tuples."""
        cases = []
        for (solver, variant, *settings), ground, shape, frequency, amplitude, _ in points:
            scene = self._grounds[ground]
            motion = pulse(scene, shape, frequency, amplitude)
            cases.append(
                Case(
                    scene.with_(motion=motion), solver, variant, {"history": False, **(settings[0] if settings else {})}
                )
            )
        answers = []
        rows = yield Batch(cases, measure, label)
        for point, row in zip(points, rows, strict=True):
            engine, ground, shape, frequency, amplitude, normal = point
            answer = None
            if not row.failed and row.values["decided"]:
                answer = row.values["outcome"] == "overturns"
            if answer is None:
                failure = row.failure or {
                    "kind": "undecided",
                    "reason": "the longest run ends without a certain outcome",
                    "message": f"tilt {row.values['end_tilt']:.6g} rad",
                }
                self.failures.append(
                    {
                        "part": "failure",
                        "solver": label_of(engine),
                        "ground": ground,
                        "shape": shape,
                        "frequency": frequency,
                        "amplitude": amplitude,
                        "min_normal": normal,
                        **failure,
                    }
                )
            if engine in self.engines:
                self.points[engine, ground, shape, frequency, amplitude] = answer, scan
            answers.append(answer)
        return answers

    def scan(self, engine, found, amplitudes):
        """A coarse map of one engine, wherever the boundaries of the analytic model are."""
        points = []
        for (ground, shape), columns in found.items():
            scene = self._grounds[ground]
            for frequency in columns:
                for amplitude in map(float, amplitudes):
                    normal = least_normal(scene, pulse(scene, shape, frequency, amplitude))
                    points.append((engine, ground, shape, frequency, amplitude, normal))
        yield from self.run(points, f"scan: {label_of(engine)}", scan=True)


def _search(log, found, engines, part, ladder, tolerance):
    """Rows of the solvers' boundaries beside the analytic ones in `found`."""
    jobs = [
        (engine, ground, edge)
        for engine in engines
        for (ground, _), columns in found.items()
        for column in columns.values()
        for edge in column
    ]

    label = f"{part}: {', '.join(dict.fromkeys(label_of(engine) for engine in engines))}"
    searches, answers = together([locate(edge, ladder, tolerance) for _, _, edge in jobs]), None
    while True:
        try:
            batch = searches.send(answers)
        except StopIteration as stop:
            located = stop.value
            break
        points = []
        for index, amplitude in batch:
            engine, ground, edge = jobs[index]
            points.append((engine, ground, edge.shape, edge.frequency, float(amplitude), edge.min_normal))
        answers = yield from log.run(points, label)
    return [
        {
            "part": part,
            "solver": solver_name(*engine[:2]),
            "settings": engine[2] if engine[2:] else {},
            "ground": ground,
            "shape": edge.shape,
            "frequency": edge.frequency,
            "amplitude": edge.amplitude,
            "rises": edge.rises,
            "mode": edge.mode,
            "room": min(1 - edge.low / edge.amplitude, edge.high / edge.amplitude - 1),
            **vars(one),
        }
        for (engine, ground, edge), one in zip(jobs, located, strict=True)
    ]
