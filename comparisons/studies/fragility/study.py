"""The fragility study: a cloud of runs of the analytic model, the first of it in every engine, and curves of both.

Blocks and motions of the cloud are random. No two runs share a motion, a block or an intensity, so that runs are
independent. Accelerations are evenly spread over the logarithm, far below and far above what matters.
"""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from analytic import Response, SampledMotion, Scene, load_scene, synthetic_motion
from analytic.caryatid import BASE, BEARINGS, MASS
from analytic.design import properties
from analytic.linear_oscillator import displacement_spectrum
from analytic.rocking import RockingModel
from engines import get_engine
from engines.comparison import END, Reference, compare

from ...ensembles.motions import peak_velocity
from ...measuring.statistics import class_of
from ...running.cases import Case
from ...running.plan import Batch, Computed, Plan, Request
from ...running.sweep import Row
from .fits import State, effects, fits

X_MAX = 0.30  # m, what the bearings are built for: Table 1(a) of the paper
PERIOD = properties(BEARINGS, MASS + BASE.mass, X_MAX).period  # s, of isolation, secant at X_MAX
DAMPING = 0.05  # of the spectrum, as catalogues have it
STRETCH = (0.5, 2.0)  # of a motion's time: all synthetic ones have nearly one spectrum
RADII = (0.6, 2.0)  # m
PEAKS = (0.08, 3.0)  # g
# name: (shipped scene, least and greatest slenderness [rad])
SCENES = {"free-standing": ("caryatid-rigid", (0.12, 0.32)), "isolated": ("caryatid-isolated", (0.1, 0.25))}
DRAWN = ("stretch", "radius", "slenderness", "peak")

# intensity measures; g tan(slenderness) is the uplift acceleration, omega_r the rocking frequency
UPLIFT, ROCKING, ISOLATED, STROKE = "PGA/(g tan γ)", "ω_r PGV/(g tan γ)", "Sa/(g tan γ)", "PGV"


@dataclass(frozen=True, eq=False)
class Cloud:
    """scenes: of n runs. drawn: {what was drawn: (n,)}. measures: {name: (n,)}, see `measures`."""

    scenes: tuple[Scene, ...]
    drawn: dict[str, np.ndarray]
    measures: dict[str, np.ndarray]

    def near(self, least: float, most: float) -> np.ndarray:
        """Indices of the runs whose PGA/(g tan γ) lies between the two, in their order."""
        ratio = self.measures[UPLIFT]
        return np.flatnonzero((ratio >= least) & (ratio <= most))


def cloud(shipped: str, slendernesses: tuple[float, float], count: int) -> Cloud:
    """`count` runs of a shipped scene; run k is under the synthetic motion of seed k. Equal counts begin alike."""
    usual = load_scene(shipped).with_(motion=None, duration=None)
    if usual.bearings is not None:
        usual = usual.with_(bearings={"x_max": X_MAX})
    ranges = dict(zip(DRAWN, (STRETCH, RADII, slendernesses, PEAKS), strict=True))
    uniform = np.random.Generator(np.random.PCG64(1)).random((count, len(DRAWN))).T
    drawn = {name: low * (high / low) ** u for (name, (low, high)), u in zip(ranges.items(), uniform, strict=True)}
    scenes = []
    for seed in range(count):
        stretch, radius, slenderness, peak = (float(drawn[name][seed]) for name in DRAWN)
        motion = synthetic_motion(seed=seed)
        samples = motion.samples * (peak * usual.gravity / motion.peak)
        shaking = SampledMotion(motion.dt * stretch, samples, f"{motion.label}, {stretch:.3g} times as slow")
        scenes.append(usual.with_(block={"radius": radius, "slenderness": slenderness}, motion=shaking))
    return Cloud(tuple(scenes), drawn, measures(scenes))


def measures(scenes: list[Scene]) -> dict[str, np.ndarray]:
    """{name: (n,)} of scenes with sampled motions: those of their limit states; PGV [m/s]; on bearings Sa [g]."""
    gravity = np.array([scene.gravity for scene in scenes])
    steepness = np.tan([scene.block.slenderness for scene in scenes])
    peak = np.array([scene.motion.peak for scene in scenes]) / gravity
    speed = np.array([peak_velocity(scene.motion) for scene in scenes])
    rocking = np.array([scene.rocking_frequency for scene in scenes])
    found = {UPLIFT: peak / steepness, STROKE: speed, ROCKING: rocking * speed / (gravity * steepness)}
    if scenes[0].bearings is None:
        return found
    displacement = np.array([displacement_spectrum(scene.motion, [PERIOD], [DAMPING])[0, 0] for scene in scenes])
    spectral = displacement * (2 * math.pi / PERIOD) ** 2 / gravity
    return {**found, "Sa": spectral, ISOLATED: spectral / steepness}


CHANGE = 1e-4  # relative change of the restitution: the model's own sensitivity
MODEL, PERTURBED = ("analytic", ""), ("analytic", "perturbed")
NEAR = (1.3, 6.0)  # PGA/(g tan γ) of the runs that engines get: there outcomes are mixed
TIME_LIMIT = 60.0  # s, of an engine's run; a stiff corner that hardly lifts may take more, and fails
# runs: of the analytic model, of the engines' main variants (with 73 motions or more, no difference shows equality),
# of the kind "defaults" (a few runs show large errors)
FULL, QUICK = (2000, 80, 20), (200, 6, 2)
# {limit state of |tilt|/slenderness: measure}; on bearings `ISOLATED` throughout. Of PGA, PGV and Sa, as they are and
# over g tan γ, these had the curves of least dispersion: a small tilt is an uplift, which PGA alone decides.
TILTS = {0.1: UPLIFT, 0.5: ROCKING, 1.0: ROCKING}
KEPT = ("overturns", "tilt", "displacement")


def variants_of(engines: Sequence[str]) -> list[tuple[str, str]]:
    """(engine, variant) compared: the main variant of every engine, then those of the kind "defaults"."""
    defaults = {name: get_engine(name).default_variant for name in engines}
    return [
        *defaults.items(),
        *(
            (name, variant)
            for name, default in defaults.items()
            for variant, spec in get_engine(name).variants.items()
            if spec.kind == "defaults" and variant != default
        ),
    ]


def measure(case: Case, response: Response) -> dict[str, Any]:
    return {
        "overturns": response.outcome == "overturns",
        "tilt": response.peak_tilt_ratio,
        "displacement": response.peak_base_displacement,
        "decided": response.decided,
    }


def beside_model(case: Case, response: Response) -> dict[str, Any]:
    """What is kept of an engine's run: in what it differs from the model, too."""
    differences = compare(case.scene, response).differences
    return {**measure(case, response), "quantities": [one.quantity for one in differences]}


def plan(request: Request, scenes: dict[str, Any] | None = None, runs: tuple[int, int, int] | None = None) -> Plan:
    """The plan of the study; an answer with one scene more each time.

    Rows by "part": "fit" and "effect" (see `comparisons.studies.fragility.fits`), "run" (an engine's, its class by how
    the block ends), "cost" (CPU seconds per run), "check" and "failure". The model with its restitution changed by
    `CHANGE` is the variant "perturbed" of "analytic". Arrays, float32: ``<scene>/<drawn>``, of all runs, with PGV and,
    on bearings, Sa; ``<scene>/<engine>, <variant>/tilt`` and ``/displacement`` of the first in ``<scene>/near``
    (``<scene>/analytic/``: of all): NaN where a run failed, the tilt infinite where it overturned.

    Parameters
    ----------
    request : Request
    scenes, runs : dict and (int, int, int), optional
        In place of `SCENES`, and of `FULL` or `QUICK`.
    """
    scenes = scenes or (dict(list(SCENES.items())[:1]) if request.quick else SCENES)
    counts, variants = runs or (QUICK if request.quick else FULL), variants_of(request.engines)
    rows, arrays = [], {}
    for name, (shipped, slendernesses) in scenes.items():
        drawn = cloud(shipped, slendernesses, counts[0])
        near, states = drawn.near(*NEAR)[: counts[1]], states_of(drawn)
        whole = yield Batch(_cases(enumerate(drawn.scenes), *MODEL), measure, f"{name}: analytic model")
        model = values_of(whole)
        undecided = sum(not row.values["decided"] for row in whole if not row.failed)
        failed = sum(row.failed for row in whole)
        ends = {int(seed): Reference.of(drawn.scenes[seed]).end_comparable for seed in near}
        check = {"runs": len(whole), "undecided": undecided, "failed": failed}
        found = [
            *fits(drawn.measures, states, model),
            {"part": "check", "engine": "analytic", "variant": "", **check},
            *_runs(MODEL, whole),
        ]
        made = {
            **drawn.drawn,
            **{key: drawn.measures[key] for key in ("PGV", "Sa") if key in drawn.measures},
            **_kept("analytic", model),
        }
        for pair, cases in _compared(drawn, near, counts[2], variants):
            label = ", ".join(filter(None, pair))
            run = yield Batch(cases, measure if pair == PERTURBED else beside_model, f"{name}: {label}", TIME_LIMIT)
            few, theirs = near[: len(cases)], values_of(run)
            ours = {key: array[few] for key, array in model.items()}
            found += effects(drawn.measures, few, states, (ours, theirs), pair)
            found += _runs(pair, run)
            if pair != PERTURBED:
                found += [_run_row(pair, row, ends, falls) for row, falls in zip(run, ours["overturns"], strict=True)]
            made |= _kept(label, theirs)
        rows += [{"scene": name, **row} for row in found]
        arrays |= {f"{name}/{key}": array.astype(np.float32) for key, array in made.items()} | {f"{name}/near": near}
        answer = Computed(
            _settings(request, scenes, counts, variants), list(rows), dict(arrays), seed=[0, counts[0] - 1]
        )
        yield answer
    return answer


def states_of(drawn: Cloud) -> dict[str, State]:
    """Limit states by name."""
    bearings = drawn.scenes[0].bearings
    tilts = TILTS if bearings is None else dict.fromkeys(TILTS, ISOLATED)
    states = {f"|φ|/γ > {limit:g}": State("tilt", limit, measure) for limit, measure in tilts.items()}
    states["overturning"] = State("overturns", 0.5, tilts[1.0])
    if bearings is not None:
        states[f"displacement > {bearings.x_max:g} m"] = State("displacement", bearings.x_max, STROKE)
    return states


def values_of(results: Sequence[Row]) -> dict[str, np.ndarray]:
    """{each of `KEPT`: (n,)} of rows; NaN where a run failed, the tilt infinite in overturning."""
    found = {key: np.array([np.nan if row.failed else row.values[key] for row in results], dtype=float) for key in KEPT}
    found["tilt"][found["overturns"] == 1] = np.inf
    return found


def _cases(scenes: Iterable[tuple[int, Scene]], engine: str, variant: str) -> list[Case]:
    return [Case(scene, engine, variant or None, {"history": False}, {"seed": seed}) for seed, scene in scenes]


def _compared(drawn: Cloud, near: np.ndarray, few: int, variants: Iterable[tuple[str, str]]) -> Iterator[tuple]:
    """((engine, variant), cases): the model with another restitution, then engines; of the kind "defaults" `few`."""
    chosen = [(int(seed), drawn.scenes[seed]) for seed in near]
    yield PERTURBED, _cases([(seed, _more_elastic(scene)) for seed, scene in chosen], *MODEL)
    for engine, variant in variants:
        default = variant == get_engine(engine).default_variant
        yield (engine, variant), _cases(chosen if default else chosen[:few], engine, variant)


def _more_elastic(scene):
    return scene.with_(block={"restitution": min(RockingModel.of(scene).restitution * (1 + CHANGE), 1.0)})


def _kept(label, values):
    return {f"{label}/{key}": values[key] for key in KEPT[1:]}


def _run_row(pair, row, ends, falls):
    """The row of an engine's run; ends: whether runs of a seed's scene can be judged by how the block ends; falls:
    whether the model's overturns."""
    seed = row.case.tag["seed"]
    quantities = row.values.get("quantities")
    known = {"comparable": ends[seed], "class": class_of(ends[seed], quantities, END), "quantities": quantities}
    known |= {"model_overturns": bool(falls), "overturns": row.values.get("overturns")}
    return {"part": "run", "engine": pair[0], "variant": pair[1], "seed": seed, **known}


def _runs(pair, results):
    """What runs cost, and those that failed."""
    key = {"engine": pair[0], "variant": pair[1]}
    seconds = [row.cost["cpu_seconds"] for row in results if row.cost]
    mean = float(np.mean(seconds)) if seconds else None
    return [
        {"part": "cost", **key, "runs": len(results), "cpu_per_run": mean},
        *({"part": "failure", **key, "seed": row.case.tag["seed"], **row.failure} for row in results if row.failed),
    ]


def _settings(request, scenes, counts, variants):
    kinds = [(engine, variant, get_engine(engine).variants[variant]) for engine, variant in variants]
    return {
        "quick": request.quick,
        "scenes": {name: {"scene": shipped, "slendernesses": list(s)} for name, (shipped, s) in scenes.items()},
        "runs": counts[0],
        "runs_of_engines": counts[1],
        "runs_of_defaults": counts[2],
        "drawn": dict(zip(DRAWN, (list(STRETCH), list(RADII), None, list(PEAKS)), strict=True)),
        "near": list(NEAR),
        "period": PERIOD,
        "damping": DAMPING,
        "x_max": X_MAX,
        "change": CHANGE,
        "variants": [
            {"engine": engine, "variant": variant, "tier": spec.kind, "friction": spec.friction}
            for engine, variant, spec in kinds
        ],
    }
