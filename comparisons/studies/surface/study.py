"""The fragility surface: slendernesses x synthetic motions x intensities, and where half of the motions overturn.

A case is a block under a motion; its measure runs all intensities and keeps a digit for each, so that a million runs
are some ten thousand rows.
"""

from typing import Annotated, Any

import numpy as np
import typer

from analytic import Response, load_scene, simulate_many, synthetic_motion
from analytic.synthetic import PEAK, G
from engines import ENGINES, get_engine

from ...measuring.statistics import wilson
from ...running.cases import Case
from ...running.plan import Batch, Computed, Plan, Request

# Why one engine's rows cannot be computed anew by themselves, see `Study.whole`.
WHOLE = "its settings count the failed and undecided runs of all solvers together"

ANALYTIC = "analytic"
# slendernesses [rad], peak ground accelerations [g], synthetic motions
FULL = np.linspace(0.08, 0.45, 50), np.geomspace(0.1, 3.0, 40), 500
QUICK = np.linspace(0.1, 0.4, 4), np.geomspace(0.1, 3.0, 8), 10
STANDS, OVERTURNS, FAILED = "0", "1", "x"

SCENE = "Scene whose block takes the slendernesses; shipped, or a file."
Name = Annotated[str, typer.Option("--scene", metavar="SCENE", help=SCENE)]


def measure(case: Case, response: Response) -> dict[str, Any]:
    """A digit for each of the case's intensities; of an engine the run at the first one is `response`."""
    scales = np.array(case.tag["intensities"]) / case.tag["intensities"][0]
    if case.solver == ANALYTIC:
        outcomes = simulate_many([case.scene] * len(scales), scales=scales, workers=1)
        digits = np.where(outcomes.failed, FAILED, np.where(outcomes.overturns, OVERTURNS, STANDS)).tolist()
        return {"outcomes": "".join(digits), "undecided": int((~outcomes.decided).sum())}
    scenes = [case.scene.with_(motion=case.scene.motion.scaled(float(scale))) for scale in scales[1:]]
    responses = [response, *(Case(scene, case.solver, case.variant, case.settings).run() for scene in scenes)]
    digits = [{"failed": FAILED, "overturns": OVERTURNS}.get(each.outcome, STANDS) for each in responses]
    return {"outcomes": "".join(digits), "undecided": sum(not each.decided for each in responses)}


def plan(request: Request, grid: Any = None, *, scene: Name = "caryatid-rigid") -> Plan:
    """The plan of the study.

    Rows, part "half": for each engine and slenderness the intensity that overturns half, see `_half`. Arrays
    ``<engine>/overturned`` and ``<engine>/sound``: runs that overturned, and runs that did not fail, shape
    (slendernesses, intensities).

    Parameters
    ----------
    request : Request
    grid : (slendernesses, intensities, motions), optional
        In place of `FULL` or `QUICK`.
    scene : str
    """
    slendernesses, intensities, count = grid or (QUICK if request.quick else FULL)
    start = load_scene(scene).with_(motion=None, duration=None)
    first = [synthetic_motion(seed=seed).scaled(float(intensities[0]) * G / PEAK) for seed in range(count)]
    rows, arrays, checks = [], {}, {"runs": 0, "undecided": 0, "failed": 0}
    for engine in (ANALYTIC, *request.engines):
        variant = get_engine(engine).default_variant if engine in ENGINES else ""
        cases = [
            Case(
                start.with_(block={"slenderness": float(slenderness)}, motion=motion),
                engine,
                settings={"history": False},
                tag={"intensities": [float(x) for x in intensities]},
            )
            for slenderness in slendernesses
            for motion in first
        ]
        results = yield Batch(cases, measure, f"{engine}: {len(cases) * len(intensities)} runs")
        digits = np.array([list(row.values.get("outcomes", FAILED * len(intensities))) for row in results])
        digits = digits.reshape(len(slendernesses), count, len(intensities))
        overturned, sound = (digits == OVERTURNS).sum(axis=1), (digits != FAILED).sum(axis=1)
        arrays |= {f"{engine}/overturned": overturned, f"{engine}/sound": sound}
        rows += [
            {
                "part": "half",
                "engine": engine,
                "variant": variant,
                "slenderness": float(slenderness),
                **_half(intensities, fallen, size),
            }
            for slenderness, fallen, size in zip(slendernesses, overturned, sound, strict=True)
        ]
        checks["runs"] += digits.size
        checks["failed"] += int((digits == FAILED).sum())
        checks["undecided"] += sum(row.values.get("undecided", 0) for row in results)
    settings = {
        "quick": request.quick,
        "scene": scene,
        "slendernesses": [float(x) for x in slendernesses],
        "intensities": [float(x) for x in intensities],
        "motions": count,
        "motion": "synthetic duzce-like, scaled",
        "engines": request.engines,
        **checks,
    }
    return Computed(settings, rows, arrays, seed=[0, count - 1])


def _half(intensities, fallen, size):
    """Where half of the motions overturn the block, and how far the share falls again above.

    The interval is where the upper and the lower Wilson limits cross one half. No curve is fitted: scaling a motion up
    can save a block, and no lognormal one does that.
    """
    share = fallen / np.where(size > 0, size, 1)
    low, high = np.transpose([wilson(int(k), int(n)) if n else (0.0, 1.0) for k, n in zip(fallen, size, strict=True)])
    return {
        "half": crossing(intensities, share),
        "interval": [crossing(intensities, high), crossing(intensities, low)],
        "falls_by": float((np.maximum.accumulate(share) - share).max()),
        "widest": float((high - low).max()),
    }


def crossing(intensities: np.ndarray, share: np.ndarray, level: float = 0.5) -> float | None:
    """The intensity at which `share` first reaches `level`, between two intensities by their logarithm; None: nowhere,
    or below the first one.
    """
    above = np.flatnonzero(share >= level)
    if not len(above) or above[0] == 0:
        return None
    k = slice(above[0] - 1, above[0] + 1)
    return float(np.exp(np.interp(level, share[k], np.log(intensities[k]))))
