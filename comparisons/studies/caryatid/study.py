"""The Caryatid paper: each equation, figure and table, reproduced or corrected, and what it omits.

There are three results, all of kind "caryatid". ``caryatid-paper`` needs no motion: the bearing law of Fig. 3, Table 1
and the misprints, each by a number. ``caryatid-under-<motion>`` needs one, but stores no single value of the motion
itself: the paper's simulations in every solver, the slenderness that it can have meant, and other slendernesses,
intensities and motions. ``caryatid-under-<motion>-histories`` has Figs 4 and 6 over time, which may not be passed on
where the record may not be.
"""

import math
import re
from collections.abc import Generator, Sequence
from functools import partial, reduce
from itertools import product
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

from analytic import (
    Base,
    Bearings,
    Response,
    SampledMotion,
    Scene,
    rocking_spectrum,
    simulate,
    simulate_many,
    synthetic_motion,
)
from analytic.advice.bearing_scan import displacement_spectrum
from analytic.motion import Motion
from analytic.rocking import BearingProperties, properties
from engines import available_engines

from ...execution.cases import Case
from ...execution.command_runs import Channel, Column, Step, Units, ground_motion
from ...execution.plan import Batch, Computed, Plan, Request, boundaries, drive
from ...execution.progress import log
from ...execution.sweep import Row
from ...schemas.columns import declared, flag_of, list_of, number_of, table_of, whole_of, word_of
from ..rows import SHARED
from .paper import (
    FREE,
    ISOLATED,
    SHIPPED,
    VULNERABLE_ABOUT,
    VULNERABLE_PERIOD,
    X_MAX,
    caryatid,
    formulas,
    motion_values,
)

# The columns of its rows, and by part which of them a row has; see `comparisons.studies.rows`.
COLUMNS = SHARED | declared(
    word_of("where", "where", "place in the paper"),
    word_of("quantity", "quantity", "name of the quantity, with its unit"),
    number_of("paper", "paper", "what the paper prints", "of the quantity", type="number or word", digits=6),
    number_of("study", "this study", "what is found here", "of the quantity", type="number or word", digits=6),
    number_of("difference", "difference", "found minus printed", "of the quantity"),
    word_of("status", "status", "reproduced, corrected, derived, input, not printed or not checkable"),
    word_of("note", "note", "a note on the status"),
    word_of("printed", "printed", "the equation as printed"),
    word_of("corrected", "should be", "the equation corrected"),
    word_of("measure", "measure", "what shows the misprint, with its unit"),
    number_of(
        "value_corrected",
        "value corrected",
        "value of that measure with the corrected equation",
        "of the measure",
        digits=5,
    ),
    number_of(
        "value_printed", "value printed", "value of that measure with the printed equation", "of the measure", digits=5
    ),
    word_of("number", "number", "number of the equation"),
    word_of("what", "what", "what is computed"),
    word_of("check", "how it was checked", "what is computed to check the equation, with its unit"),
    number_of("value", "value", "value of the check", "of the check", digits=6),
    flag_of("decided", "decided", "whether nothing can change it any more"),
    number_of("overturning_time", "overturning time", "when the block has overturned", "s", digits=5),
    number_of("unstable_time", "unstable time", "when its overturning was certain", "s"),
    number_of("fall_time", "fall time", "last passage of the slenderness by a block that overturns", "s"),
    number_of("peak_tilt", "peak tilt", "largest |tilt|", "rad"),
    number_of("peak_tilt_ratio", "peak |φ|/γ", "largest |tilt| over the slenderness", digits=4),
    number_of("peak_base_displacement", "peak displacement", "largest displacement of the base", "m", digits=5),
    number_of("peak_base_acceleration", "peak base acceleration", "largest absolute acceleration of the base", "m/s2"),
    whole_of("impact_count", "impact count", "impacts of the run"),
    number_of("friction_demand", "friction demand", "largest horizontal over normal force under the block", digits=3),
    number_of("min_normal_ratio", "least N/(m g)", "least normal force over the weight", digits=3),
    table_of("end", "end", "time, tilt, displacement and rates at the end", "SI"),
    table_of("versions", "versions", "versions of the packages that computed the run"),
    list_of("warnings", "warnings", "warnings of the run"),
    number_of("period", "period", "period of the oscillator, or of the isolated structure", "s", digits=3),
    number_of("damping", "its value", "equivalent viscous damping over the critical one", digits=3, percent=True),
    word_of("definition", "damping", "how that damping is defined"),
    number_of(
        "displacement", "peak displacement of the oscillator", "peak of the equivalent linear oscillator", "m", digits=3
    ),
    number_of("nonlinear", "of the bearings", "peak under the bearings' own law", "m", digits=3),
    word_of("claim", "claim", "a claim of the paper on an outcome"),
    list_of("intervals", "intervals", "intervals [low, high] of slenderness within which the claim holds", "rad"),
    whole_of("evaluations", "evaluations", "runs that the search took"),
    number_of("step", "step", "step of the scan over slenderness", "rad"),
    word_of("motion", "motion", "motion under which the cells are computed"),
    whole_of("cells", "cells", "number of cells of the map of slenderness and intensity"),
    number_of("both stay upright", "both stay upright", "share of cells where both blocks stay upright"),
    number_of(
        "only the isolated one does",
        "only the isolated one does",
        "share of cells where the isolated block alone stays upright",
    ),
    number_of(
        "only the free-standing one does",
        "only the free-standing one does",
        "share of cells where the free-standing block alone does",
    ),
    number_of("both overturn", "both overturn", "share of cells where both blocks overturn"),
    number_of(
        "only the isolated one does, within 0.30 m",
        "only the isolated one does, within 0.30 m",
        "share of cells where moreover the base stays within 0.30 m",
    ),
    number_of("isolated lifts", "isolated lifts", "share of cells where the isolated block lifts"),
    number_of("beyond x_max", "beyond x_max", "share of cells where the base goes beyond its limit"),
    number_of("cpu_seconds", "CPU time", "CPU time of the run", "s"),
)
RUN = """engine variant? outcome failure? | scene overturning_time? unstable_time? peak_tilt? peak_tilt_ratio?
    peak_base_displacement? friction_demand? min_normal_ratio? end steps settings versions decided warnings differences
    comparable impact_count"""
PARTS = {
    "value": "where quantity engine? paper study difference? status note",
    "misprint": "where printed corrected measure value_corrected value_printed",
    "equation": "number what status check value",
    "run": f"scene {RUN}",
    "rocking spectrum": f"period {RUN}",
    "displacement spectrum": f"period damping {RUN}",
    "equivalent": "definition damping period displacement nonlinear",
    "claim": "claim intervals evaluations?",
    "vulnerable": "slenderness step period",
    "benefit": """motion cells 'both stay upright' 'only the isolated one does' 'only the free-standing one does'
            'both overturn' 'only the isolated one does, within 0.30 m' 'isolated lifts' 'beyond x_max'""",
}

DAMPING_RATIOS = (0.05, 0.10, 0.15, 0.20, 0.30)  # Fig. 5(b); the paper's own are not at hand
OSCILLATOR_DAMPING = (0.05, 0.30)  # dampings that are run in the engines
# A block this stocky stays down on its oscillator: it lifts at 0.84 g.
STOCKY = 0.7  # rad
TIME_LIMIT = 120.0  # s
HISTORY_STEP = 0.01  # s, at which histories are kept
LEFT_OUT = (
    "impacts",
    "uplifts",
    "rests",
    "energy",
    "sliding",
    "stack",
)  # of a response: lists, and what no scene here has


def slender_block(motion: Motion, period: float, slenderness: float) -> Scene:
    """Return a block on rigid ground whose rocking period T_r is `period` [s], as in Fig. 5(a)."""
    scene = caryatid(FREE, motion)
    radius = 3 * scene.gravity * (period / (2 * np.pi)) ** 2 / 4  # (1) with J_O = 4/3 m R^2
    return scene.with_(block={"radius": float(radius), "slenderness": slenderness})


def oscillator(motion: Motion, period: float, damping: float) -> Scene:
    """Return a linear oscillator as a scene: a block that cannot lift, on one linear bearing with a damper."""
    scene = caryatid(ISOLATED, motion)
    omega = 2 * np.pi / period
    bearing = Bearings(
        law="linear",
        count=1,
        ka=float(scene.total_mass * omega**2),
        damping=float(2 * damping * omega * scene.total_mass),
    )
    return Scene(
        block=scene.block.model_copy(update={"slenderness": STOCKY}),
        base=Base(mass=scene.base.mass),
        bearings=bearing,
        motion=motion,
        gravity=scene.gravity,
    )


def measure(case: Case, response: Response) -> dict[str, Any]:
    """Return the whole response, and for Figs 4(b) and 6 tilt and displacement at multiples of `HISTORY_STEP`."""
    measures = response.to_json()
    if case.tag["part"] == "run" and (history := response.history):
        time = np.arange(0.0, history.time[-1], HISTORY_STEP)
        columns = {
            name: np.interp(time, history.time, getattr(history, name)) for name in ("tilt", "base_displacement")
        }
        measures["history"] = {name: column.tolist() for name, column in {"time": time, **columns}.items()}
    return measures


def simulations(
    motion: Motion, engines: Sequence[str], quick: bool = False
) -> Generator[Batch, list[Row], tuple[list[dict[str, Any]], dict[str, np.ndarray]]]:
    """Plan all runs; return their rows, and the histories of Figs 4(b) and 6 as arrays."""
    solvers = ("analytic", *engines)
    figures = [
        Case(caryatid(name, motion), solver, tag={"part": "run", "scene": name})
        for name in SHIPPED
        for solver in solvers
    ]
    rows, histories = [], {}
    for row in (yield Batch([*figures, *_points(motion, solvers, quick)], measure, "Figs 4 to 6", TIME_LIMIT)):
        values = {name: value for name, value in row.values.items() if name not in LEFT_OUT}
        engine = row.case.solver
        if row.case.scene.base is None:  # it would be the ground's own peak, a value of the motion
            values.pop("peak_base_acceleration", None)
        for column, numbers in values.pop("history", {}).items():
            histories[f"{row.case.tag['scene']}/{engine}/{column}"] = np.array(numbers, dtype=np.float32)
        default = {"engine": engine, "variant": row.case.variant}  # row of a failed run
        rows.append({**default, **values, **row.case.tag, "failure": row.failure, **row.cost})
    return rows, histories


def _points(motion, solvers, quick):
    """Cases of the single blocks and oscillators of Fig. 5, in every solver."""
    free = caryatid(FREE, motion)
    slenderness, rocking_period = free.block.slenderness, 2 * np.pi / free.rocking_frequency
    blocks = (rocking_period, 5.0) if quick else (1.5, rocking_period, 3.0, 3.5, 4.5, 5.0, 6.0, 7.0)
    oscillators = (2.0,) if quick else (1.0, 2.0, 3.0)
    without = {"history": False}
    for solver, period in product(solvers, blocks):
        tag = {"part": "rocking spectrum", "period": float(period)}
        yield Case(slender_block(motion, period, slenderness), solver, settings=without, tag=tag)
    for solver, period, damping in product(solvers, oscillators, OSCILLATOR_DAMPING):
        tag = {"part": "displacement spectrum", "period": period, "damping": damping}
        yield Case(oscillator(motion, period, damping), solver, settings=without, tag=tag)


def spectra(motion: Motion, quick: bool = False) -> dict[str, np.ndarray]:
    """Return the arrays of Figs 5(a) and 5(b).

    They are max tilt over slenderness against T_r, and max displacement against T_bi.
    """
    slenderness = caryatid(FREE, motion).block.slenderness
    periods = np.linspace(0.5, 8.0, 151 if quick else 751)
    tilts = rocking_spectrum(motion, periods, slenderness)
    isolation = np.linspace(0.1, 5.0, 99 if quick else 246)
    return {
        "rocking/period": periods,
        "rocking/tilt": np.where(tilts.overturns, np.nan, tilts.peak_tilt / slenderness),
        "rocking/overturns": tilts.overturns,
        "displacement/period": isolation,
        "displacement/damping": np.array(DAMPING_RATIOS),
        "displacement/peak": displacement_spectrum(motion, isolation, DAMPING_RATIOS),
    }


def equivalent_oscillators(motion: Motion, properties: BearingProperties, nonlinear: float) -> list[dict[str, Any]]:
    """Return rows of what a linear oscillator at T_bi predicts, beside the bearings' own displacement.

    There is a row for either definition of the damping.
    """
    return [
        {
            "part": "equivalent",
            "definition": name,
            "damping": damping,
            "period": properties.period,
            "displacement": float(displacement_spectrum(motion, [properties.period], [damping])[0, 0]),
            "nonlinear": nonlinear,
        }
        for name, damping in (
            ("W_D/(2π E_s)", properties.damping_paper),
            ("W_D/(4π E_s)", properties.damping_equivalent),
        )
    ]


LOW, HIGH = 0.10, 0.45  # rad
TOLERANCE = 1e-5  # rad
LONGEST = 8.0  # s, longest rocking period that is tried
# which block stays upright
BOTH, ONLY_ISOLATED, ONLY_FREE, NEITHER = range(4)
CATEGORIES = ("both stay upright", "only the isolated one does", "only the free-standing one does", "both overturn")
WITHIN = "only the isolated one does, within 0.30 m"
SEEDS = 12


def vulnerable_period(motion: Motion, slenderness: float, step: float = 0.02) -> float:
    """Return the longest rocking period T_r [s] up to `LONGEST` at which a block overturns; 0 if none.

    Periods lie on a grid of `step` [s].
    """
    periods = np.arange(LONGEST, 0.4, -step)
    overturns = rocking_spectrum(motion, periods, slenderness).overturns
    return round(float(periods[overturns].max(initial=0.0)), 6)


def claims(motion: Motion, quick: bool = False) -> tuple[list[dict[str, Any]], dict[str, np.ndarray]]:
    """Return rows on the intervals of slenderness in which each of the paper's three claims holds, and all of them.

    Also the arrays of vulnerable period over slenderness.
    """
    free, isolated = caryatid(FREE, motion), caryatid(ISOLATED, motion)
    scan, step, near = (29, 0.1, 1e-2) if quick else (71, 0.02, 1e-3)

    def run(scene, points):
        return simulate_many([scene.with_(block={"slenderness": point}) for point in points])

    def vulnerable(points):
        periods = np.array([vulnerable_period(motion, point, step) for point in points])
        return abs(periods - VULNERABLE_PERIOD) <= VULNERABLE_ABOUT

    tests = {
        "free-standing overturns": (lambda points: run(free, points).overturns, 141, TOLERANCE),
        f"vulnerable below T_r = {VULNERABLE_PERIOD:g} ± {VULNERABLE_ABOUT:g} s": (vulnerable, scan, near),
        "isolated does not rock": (lambda points: ~run(isolated, points).lifted, 141, TOLERANCE),
    }
    rows = []
    for claim, (holds, points, tolerance) in tests.items():
        search = boundaries(LOW, HIGH, points, tolerance)
        (column,) = drive([search], partial(_outcomes, holds))
        intervals = _intervals(column.transitions, bool(holds([LOW])[0]))
        rows.append({"part": "claim", "claim": claim, "intervals": intervals, "evaluations": column.evaluations})
    together = reduce(_overlap, [row["intervals"] for row in rows])
    slenderness, grid = free.block.slenderness, np.linspace(LOW, HIGH, scan)
    rows += [
        {"part": "claim", "claim": "all three", "intervals": together, "evaluations": None},
        {
            "part": "vulnerable",
            "slenderness": slenderness,
            "step": step,
            "period": vulnerable_period(motion, slenderness, step),
        },
    ]
    periods = np.array([vulnerable_period(motion, float(gamma), step) for gamma in grid])
    return rows, {"claims/slenderness": grid, "claims/vulnerable period": periods}


def _outcomes(holds, batch):
    return list(map(bool, holds([point for _, point in batch])))


def uplift_slenderness(motion: Motion) -> float:
    """Return the least slenderness [rad] that stays down on the bearings, from the acceleration: atan(max|a|/g).

    A block that stays down does not change the acceleration of its base, so any such block gives the acceleration.
    """
    scene = caryatid(ISOLATED, motion).with_(block={"slenderness": 1.2})
    return math.atan(simulate(scene, history=False).peak_base_acceleration / scene.gravity)


def _intervals(transitions, holds_at_low):
    edges = [LOW] if holds_at_low else []
    edges += [transition.high if transition.after else transition.low for transition in transitions]
    edges += [HIGH] if len(edges) % 2 else []
    return [edges[k : k + 2] for k in range(0, len(edges), 2)]


def _overlap(ones, others):
    """Intersections of two lists of intervals."""
    pairs = [(max(a[0], b[0]), min(a[1], b[1])) for a in ones for b in others]
    return [[low, high] for low, high in sorted(pairs) if low < high]


def grid(quick: bool, fine: bool = True) -> tuple[np.ndarray, np.ndarray]:
    """Return the slendernesses [rad] and the intensities [-] of the map."""
    slendernesses, intensities = (15, 12) if quick else (71, 56) if fine else (36, 34)
    return np.linspace(LOW, HIGH, slendernesses), np.linspace(0.25, 3.0, intensities)


def benefit(
    motion: Motion, slendernesses: np.ndarray, intensities: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Compare the free-standing and the isolated block over slenderness and intensity; arrays of shape (n, k).

    They are the category (uint8), whether the isolated block lifts, and its peak base displacement [m].

    The displacement is NaN where the isolated block overturns: runs end when that is certain.
    """
    scaled = [motion.scaled(float(factor)) for factor in intensities]
    changes = [
        {"block": {"slenderness": float(gamma)}, "motion": scaled_motion}
        for gamma, scaled_motion in product(slendernesses, scaled)
    ]
    shape = len(slendernesses), len(intensities)
    free, isolated = (
        simulate_many([scene.with_(**change) for change in changes])
        for scene in (caryatid(FREE, motion), caryatid(ISOLATED, motion))
    )
    if free.failed.any() or isolated.failed.any():
        raise RuntimeError("the analytic model failed on a scene of the map; report it with its slenderness")
    category = np.select(
        [~free.overturns & ~isolated.overturns, ~isolated.overturns, ~free.overturns],
        [BOTH, ONLY_ISOLATED, ONLY_FREE],
        NEITHER,
    )
    displacement = np.where(isolated.overturns, np.nan, isolated.peak_base_displacement)
    return (
        category.astype(np.uint8).reshape(shape),
        isolated.lifted.reshape(shape),
        displacement.astype(np.float32).reshape(shape),
    )


def maps(motion: Motion, quick: bool = False) -> tuple[list[dict[str, Any]], dict[str, np.ndarray]]:
    """Return rows and arrays: shares of the map of `motion` and of synthetic motions' maps, and the map itself."""
    fine, coarse = grid(quick), grid(quick, fine=False)
    outcomes = benefit(motion, *fine)
    rows = [_shares("this motion", *outcomes)]
    names = ("slenderness", "intensity", "category", "isolated lifts", "isolated displacement")
    arrays = {f"benefit/{name}": values for name, values in zip(names, (*fine, *outcomes), strict=True)}
    for seed in range(3 if quick else SEEDS):
        rows.append(_shares(f"synthetic, seed {seed}", *benefit(synthetic_motion(seed=seed), *coarse)))
    return rows, arrays


def _shares(name, category, lifted, displacement):
    shares = {text: float((category == kind).mean()) for kind, text in enumerate(CATEGORIES)}
    within = (category == ONLY_ISOLATED) & (displacement <= X_MAX)
    return {
        "part": "benefit",
        "motion": name,
        "cells": int(category.size),
        **shares,
        WITHIN: float(within.mean()),
        "isolated lifts": float(lifted.mean()),
        "beyond x_max": float((displacement > X_MAX).mean()),
    }


# Why one engine's rows cannot be computed anew by themselves, see `Study.whole`.
WHOLE = "its answer is several files, under a motion that they do not hold"

PART_PAPER, PART_MOTION, PART_HISTORIES = "paper", "motion", "histories"

Record = Annotated[
    str | None,
    typer.Option(metavar="FILE", help="The Duzce record, or another. Default: the shipped synthetic motion."),
]


def plan(
    request: Request,
    motion: SampledMotion | None = None,
    *,
    record: Record = None,
    units: Units = None,
    dt: Step = None,
    column: Column = None,
    channel: Channel = None,
) -> Plan:
    """Plan the study; it gives an answer for each part.

    Parameters
    ----------
    request : Request
    motion : SampledMotion or None
        None: the one in the file `record`.
    record : str or None
        A ground motion's file; None: the shipped synthetic motion.
    units, dt, column, channel
        What that file does not say itself.
    """
    motion = motion or ground_motion(record, units=units, dt=dt, column=column, channel=channel)
    log(f"ground motion: {motion.label}")
    log("bearing law, Table 1, misprints")
    yield Computed({"part": PART_PAPER}, *formulas(), name="caryatid-paper")
    rows, histories = yield from simulations(motion, request.engines, request.quick)
    runs = [row for row in rows if row["part"] == "run"]
    answers, arrays = _analytic(motion, runs, request.quick)
    rows, least = rows + answers, uplift_slenderness(motion)
    stem = f"caryatid-under-{_slug(motion)}"
    settings = {
        "motion": {"label": motion.label, "peak_time": motion.peak_time, "dt": motion.dt, "end": motion.end},
        "quick": request.quick,
        "slenderness": caryatid(ISOLATED, motion).block.slenderness,
    }
    yield Computed(
        {"part": PART_MOTION, **settings, "missing": available_engines()[1], "uplift_slenderness": least},
        [*rows, *motion_values(rows, motion, least)],
        arrays,
        name=stem,
    )
    histories |= {
        "motion/time": np.arange(len(motion.samples)) * np.float32(motion.dt),
        "motion/acceleration": motion.samples.astype(np.float32),
    }
    return Computed({"part": PART_HISTORIES, **settings, "x_max": X_MAX}, runs, histories, name=f"{stem}-histories")


def _analytic(motion, runs, quick):
    """Return the rows and arrays that the analytic model alone gives."""
    log("spectra")
    arrays = spectra(motion, quick)
    isolated = caryatid(ISOLATED, motion)
    (isolated_run,) = (row for row in runs if row["scene"] == ISOLATED and row["engine"] == "analytic")
    bearings = properties(isolated.bearings, isolated.total_mass, X_MAX)
    rows = equivalent_oscillators(motion, bearings, isolated_run["peak_base_displacement"])
    log("slenderness: which values fit the claims")
    fitting, periods = claims(motion, quick)
    log("other slendernesses, intensities and motions")
    shares, benefit = maps(motion, quick)
    rows += [*fitting, *shares]
    arrays |= periods | benefit
    singles = {name: array.astype(np.float32) for name, array in arrays.items() if array.dtype == np.float64}
    return rows, arrays | singles


def _slug(motion):
    """Return the name of the motion in file names.

    For a record it is the file's own, without the ending, with the channel or column.
    """
    file, more = re.match(r"([^,(]*)(.*)", motion.label).groups()
    name = "synthetic" if motion.label.startswith("synthetic") else Path(file.strip()).stem + more
    return re.sub(r"[^a-z0-9]+", "-", name.lower()).strip("-")
