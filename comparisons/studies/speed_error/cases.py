"""The scenes of the speed-error study with their references, and what runs on each: solvers and their levels; and an
overturning boundary, and the search for the one that a solver has in the reference's place.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import zip_longest
from typing import Any, Self

from scipy.optimize import brentq

from analytic import PulseMotion, Response, Scene, Start, State, simulate, synthetic_motion
from analytic.caryatid import BASE, BEARINGS, caryatid_block
from engines import ENGINES, get_engine
from engines.contract import Variant

from ...measuring import models, scripts
from ...measuring.horizon import sensitivity_horizon
from ...running.cases import Case
from . import integrators

RUNS = 6  # of a search: the first at the reference's boundary, then at the corrected ones
STRIDE = 0.05  # longest move of a search, relative; it ends within its runs or finds no boundary
SMALL = 1e-3  # margin below which the reference's slope alone is as good as a chord


@dataclass(frozen=True)
class Boundary:
    """Pulse amplitude [m/s2] at which the block just overturns, and slope: d margin / d (amplitude / boundary)."""

    amplitude: float
    slope: float


def margin(scene: Scene, end: State) -> float:
    """Energy beyond what tipping over needs, over m g R (1 - cos gamma), after the motion's end; conserved in flight.

    Negative: the block falls back; positive: it overturns. With u = gamma - |phi|: (w^2/2 - p^2 (1 - cos u))/(p^2 (1 -
    cos gamma)).
    """
    gamma, p2 = scene.block.slenderness, scene.rocking_frequency**2
    u = gamma - abs(end.tilt)
    return (0.5 * end.tilt_rate**2 - 2 * p2 * math.sin(0.5 * u) ** 2) / (2 * p2 * math.sin(0.5 * gamma) ** 2)


def at_amplitude(scene: Scene, amplitude: float) -> Scene:
    """The scene with its pulse at another amplitude [m/s2]."""
    assert isinstance(scene.motion, PulseMotion)
    return scene.with_(motion=replace(scene.motion, amplitude=float(amplitude)))


def searched(
    run: Callable[[Scene], Response], scene: Scene, boundary: Boundary | None
) -> tuple[Response, list[float] | None, float]:
    """A single run, or a search for the solver's own boundary.

    The margin is smooth in the amplitude, so moving by the reference's slope converges at once for a solver near the
    reference; one far from it is bracketed.

    Returns
    -------
    response : Response
        The first.
    shifts : list of float or None
        Relative position of the boundary against the reference's after each run; None without one, or if a run failed.
    cpu_seconds : float
        Of all runs.
    """
    first = run(scene)
    if boundary is None:
        return first, None, first.cpu_seconds
    shift, shifts, cpu, known = 0.0, list[float](), 0.0, dict[float, float]()
    for _ in range(RUNS):
        moved = at_amplitude(scene, boundary.amplitude * (1 + shift))
        response = run(moved) if known else first
        cpu += response.cpu_seconds
        if response.outcome == "failed":
            return response, None, cpu
        known[shift] = margin(moved, response.end) / boundary.slope
        shift = _next(known, shift)
        shifts.append(shift)
    return first, shifts, cpu


def _next(known, last):
    """Where to look next: by the chord of the two nearest points on either side, else by the reference's slope."""
    below = max((at for at, value in known.items() if value <= 0), default=None)
    above = min((at for at, value in known.items() if value > 0), default=None)
    if below is None or above is None or abs(known[last]) < SMALL:
        return last - min(max(known[last], -STRIDE), STRIDE)
    if below > above:  # not monotone here: stay
        return last
    return below + (above - below) * min(max(-known[below] / (known[above] - known[below]), 0.1), 0.9)


TIGHTEST = 1e-17  # tolerance of the kernel as a reference
LONGEST = 10.0  # s, of a run under the synthetic motion: the strong shaking and what follows
FREQUENCY_RATIO = 3.0  # pulse frequency over omega_r, near-overturning scenes
# shape of a pulse: amplitude / g tan(slenderness) on either side of its boundary; the second starts with a jump
BRACKETS = {"one-sine": (1.35, 1.45), "one-cosine": (1.8, 1.95)}

TRANSPARENT = ("free-rigid", "near-overturning")  # scenes without base or record
SAMPLED = ("isolated-standing", "isolated-rocking")
PLAIN = "isolated-rocking"  # the scene in which engines are compared at their defaults

NEEDED = "as needed"
HEAVY_BASE, SPRINGS, FREE_3D = "rigid ground as a heavy base", "rigid ground as stiff springs", "free block in 3-D"


@dataclass(frozen=True, eq=False)
class Trial:
    """One scene of the study.

    measures: names of the errors that mean something here, the principal one first. boundary: None but where the runs
    search for one. reference: the kernel at its tightest.
    """

    name: str
    scene: Scene
    measures: tuple[str, ...]
    boundary: Boundary | None = None

    @cached_property
    def reference(self) -> Response:
        return tight(self.scene)

    def with_law(self, law: str) -> Self:
        """The same trial with another bearing law, and that law's own reference."""
        return replace(self, scene=self.scene.with_(bearings={"law": law}))


def tight(scene: Scene) -> Response:
    """The reference response of a scene."""
    return simulate(scene, history=False, tolerance=TIGHTEST)


def trials() -> list[Trial]:
    """The six trials, in order of what they ask of a solver."""
    free = caryatid_block(0.2)
    isolated: dict[str, Any] = {"base": BASE, "bearings": BEARINGS, "motion": synthetic_motion()}
    rigid = Scene(name="free rocking on rigid ground", block=free, start=Start(tilt=0.12), duration=5.0)
    sliding = rigid.with_(name="free rocking on a sliding base", base=BASE, duration=4.0)
    stands = Scene(name="isolated, standing", block=caryatid_block(0.28), duration=LONGEST, **isolated)
    rocks = Scene(name="isolated, rocking", block=caryatid_block(0.15), duration=LONGEST, **isolated)
    rocks = rocks.with_(duration=math.floor(100 * sensitivity_horizon(rocks).horizon) / 100)
    events = ("restitution", "impact_time")
    return [
        Trial("free-rigid", rigid, (*events, "end_tilt")),
        Trial("free-sliding", sliding, (*events, "peak_displacement")),
        Trial("isolated-standing", stands, ("peak_displacement",)),
        Trial("isolated-rocking", rocks, ("restitution", "peak_tilt", "impact_time", "peak_displacement")),
        near_overturning("one-sine"),
        near_overturning("one-cosine", name="near-overturning-jump"),
    ]


def problem_trials() -> list[Trial]:
    """Problems A and B as trials: of integrators, to fine errors; their references are not the kernel's."""
    return [Trial(name, problem.scene, ("horizon_tilt",)) for name, problem in integrators.PROBLEMS.items()]


def near_overturning(shape: str, name: str = "near-overturning") -> Trial:
    """A pulse at the amplitude where the block just overturns after one impact; its boundary is the question."""
    block = caryatid_block(0.25)
    unit = 9.81 * math.tan(block.slenderness)
    pulse = PulseMotion(shape, unit, FREQUENCY_RATIO * Scene(block=block, duration=1.0).rocking_frequency)
    words = f"{shape.replace('-', ' ')} at the overturning boundary"
    scene = Scene(name=words, block=block, motion=pulse, duration=2.5)

    def at(amplitude):
        return margin(scene, tight(at_amplitude(scene, amplitude)).end)

    low, high = BRACKETS[shape]
    amplitude = brentq(at, low * unit, high * unit, xtol=1e-15, rtol=1e-15)
    change = 1e-4
    slope = (at(amplitude * (1 + change)) - at(amplitude * (1 - change))) / (2 * change)
    measures = ("boundary_shift", "restitution", "peak_tilt", "impact_time")
    return Trial(name, at_amplitude(scene, amplitude), measures, Boundary(amplitude, slope))


@dataclass(frozen=True, eq=False)
class Entry:
    """One solver at one level of its accuracy parameter on one trial.

    engine, variant: what rows call it. parameter, level: None where there is but one. solver: what is run, if not the
    engine. model: `NEEDED`, or what is modelled beyond what the scene needs; scene_of: the scene so modelled, of the
    trial's.
    """

    trial: Trial
    engine: str
    variant: str
    parameter: str | None
    level: float | None
    solver: str = ""
    settings: dict = field(default_factory=dict)
    model: str = NEEDED
    scene_of: Callable[[Scene], Scene] = lambda scene: scene

    def case(self, turn: int) -> Case:
        """The measurement of one round as a `Case`."""
        solver, boundary = self.solver or self.engine, self.trial.boundary
        level = {self.parameter: self.level} if self.parameter else {}
        return Case(
            self.scene_of(self.trial.scene),
            solver,
            self.variant if solver in ENGINES else None,
            {**self.settings, **level, "history": False},
            {"boundary": boundary and [boundary.amplitude, boundary.slope], "round": turn},
        )


def powers(*exponents: float) -> tuple[float, ...]:
    return tuple(10.0**exponent for exponent in exponents)


# levels of a full and of a quick run
FREE_3D_STEPS = ((1 / 240, 1e-3, 3e-4, 1e-4), (1 / 240, 1e-3))  # s
KERNEL = (powers(-3, -4, -6, -8, -10, -12, -14, -16), powers(-4, -8, -12))
STEPPING = (powers(-2, -2.5, -3, -3.5, -4, -4.5, -5, -6), powers(-2, -3, -4))
SCIPY = {
    "DOP853": (powers(-3, -5, -7, -9, -11, -12), powers(-5, -9)),
    "RK45": (powers(-3, -5, -7, -9, -11), powers(-5, -9)),
    "LSODA": (powers(-3, -5, -7, -9, -11), powers(-7)),
    "Radau": (powers(-3, -5, -7), powers(-5)),
}
# a restart at every sample makes a scipy run under a record cost seconds
SCIPY_SAMPLED = {
    "DOP853": (powers(-3, -6, -9), ()),
    "RK45": (powers(-3, -6, -9), ()),
    "LSODA": (powers(-6), ()),
    "Radau": (powers(-3), ()),
}


def refined(levels: Sequence[float]) -> list[float]:
    """Levels with the geometric means of their neighbours."""
    means = (math.sqrt(a * b) for a, b in zip(levels, levels[1:], strict=False))
    return sorted({*levels, *means}, reverse=levels[0] > levels[-1])


def levels_of(spec: Variant, quick: bool) -> list[float]:
    """Levels of a variant that are run; few of the kind "defaults", whose error hardly changes."""
    few = (spec.levels[0], spec.default) if quick else spec.levels
    return list(dict.fromkeys(few)) if quick or spec.kind == "defaults" else refined(spec.levels)


def entries(scenes: Sequence[Trial], engines: Sequence[str], quick: bool) -> list[Entry]:
    """All entries, so that solvers alternate: the first level of each, then the second of each."""
    turns = (turn for trial in scenes for turn in zip_longest(*_ladders(trial, engines, quick)))
    return [entry for turn in turns for entry in turn if entry]


def _ladders(trial: Trial, engines: Sequence[str], quick: bool) -> Iterator[list[Entry]]:
    """Each solver's entries on a trial, level after level."""
    if trial.name in integrators.PROBLEMS:
        yield from _integrators(trial, quick)
        return
    yield from _models(trial, SCIPY_SAMPLED if trial.name in SAMPLED else SCIPY, quick)
    for name in engines:
        engine = get_engine(name)
        if engine.script and not quick:
            version = {**engine.versions(), "script": scripts.version_of(engine, trial.scene)}
            as_written = {"engine": name, "version": version}
            yield [Entry(trial, name, scripts.NAME, None, None, f"{scripts.__name__}:simulate_script", as_written)]
        for variant, kind in engine.variants.items():
            yield [Entry(trial, name, variant, kind.accuracy_parameter, level) for level in levels_of(kind, quick)]
            if kind.free_block and trial.scene.bearings is None:
                steps = FREE_3D_STEPS[quick]
                yield [Entry(trial, name, variant, "step", step, kind.free_block, model=FREE_3D) for step in steps]
    if trial.name in SAMPLED:
        yield from _models(trial.with_law("bouc-wen"), {"DOP853": SCIPY_SAMPLED["DOP853"]}, quick)
    if trial.name in TRANSPARENT:
        ways = [(SPRINGS, models.on_stiff_springs)]
        if trial.scene.motion is None:  # a free base does not feel the ground's motion
            ways.append((HEAVY_BASE, models.on_heavy_base))
        for model, change in ways:
            yield [_kernel(trial, level, model=model, scene_of=change) for level in powers(-8, -12)[quick:]]


def _models(trial, methods, quick):
    """The kernel, time stepping, and the equations in scipy by these methods."""
    yield [_kernel(trial, level) for level in KERNEL[quick]]
    yield [Entry(trial, "time-stepping", "", "step", step) for step in STEPPING[quick]]
    for method, levels in methods.items():
        settings = {"energy": False, "method": method}
        yield [Entry(trial, "scipy", method, "rtol", level, "twin", settings) for level in levels[quick]]


def _integrators(trial, quick):
    for (engine, variant), levels in integrators.TOLERANCES.items():
        settings = {"engine": engine, "variant": variant}
        yield [
            Entry(trial, engine, variant, "tolerance", level, integrators.SOLVER, settings) for level in levels[quick]
        ]


def _kernel(trial, level, **modelled):
    return Entry(trial, "analytic", "kernel", "tolerance", level, **modelled)
