"""What the Caryatid paper prints, as far as it is known here; its simulations in every solver, Figs 4(b) and 6, points
of Figs 5(a) and 5(b); and each number of the paper beside this study's.
"""

from collections.abc import Generator, Iterator, Mapping, Sequence
from itertools import product
from typing import Any

import numpy as np

from analytic import Base, Bearings, Response, SampledMotion, Scene, load_scene, rocking_spectrum
from analytic.design import BearingProperties
from analytic.linear_oscillator import displacement_spectrum
from analytic.motion import Motion

from ...running.cases import Case
from ...running.plan import Batch
from ...running.sweep import Row

FREE, ISOLATED = "free-standing", "isolated"
SHIPPED = {FREE: "caryatid-rigid", ISOLATED: "caryatid-isolated"}
DAMPING_RATIOS = (0.05, 0.10, 0.15, 0.20, 0.30)  # Fig. 5(b); the paper's own are not at hand
OSCILLATOR_DAMPING = (0.05, 0.30)  # of those run in the engines
# A block this stocky stays down on its oscillator: it lifts at 0.84 g.
STOCKY = 0.7  # rad
TIME_LIMIT = 120.0  # s
HISTORY_STEP = 0.01  # s, at which histories are kept
LEFT_OUT = "impacts", "uplifts", "rests", "energy", "sliding"  # of a response: lists, and what needs a friction


def caryatid(name: str, motion: Motion | None) -> Scene:
    """The free-standing or the isolated Caryatid under `motion`."""
    return load_scene(SHIPPED[name]).with_(motion=motion, duration=None)


def slender_block(motion: Motion, period: float, slenderness: float) -> Scene:
    """A block on rigid ground whose rocking period T_r is `period` [s], as in Fig. 5(a)."""
    scene = caryatid(FREE, motion)
    radius = 3 * scene.gravity * (period / (2 * np.pi)) ** 2 / 4  # (1) with J_O = 4/3 m R^2
    return scene.with_(block={"radius": float(radius), "slenderness": slenderness})


def oscillator(motion: Motion, period: float, damping: float) -> Scene:
    """A linear oscillator as a scene: a block that cannot lift, on one linear bearing with a damper."""
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
    """The whole response, and of Figs 4(b) and 6 tilt and displacement at multiples of `HISTORY_STEP`."""
    found = response.to_json()
    if case.tag["part"] == "run" and (history := response.history):
        time = np.arange(0.0, history.time[-1], HISTORY_STEP)
        columns = {
            name: np.interp(time, history.time, getattr(history, name)) for name in ("tilt", "base_displacement")
        }
        found["history"] = {name: column.tolist() for name, column in {"time": time, **columns}.items()}
    return found


def simulations(
    motion: Motion, engines: Sequence[str], quick: bool = False
) -> Generator[Batch, list[Row], tuple[list[dict[str, Any]], dict[str, np.ndarray]]]:
    """Plan of all runs; returns their rows, and the histories of Figs 4(b) and 6 as arrays."""
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
        if row.case.scene.base is None:  # the ground's own peak: a value of the motion
            values.pop("peak_base_acceleration", None)
        for column, numbers in values.pop("history", {}).items():
            histories[f"{row.case.tag['scene']}/{engine}/{column}"] = np.array(numbers, dtype=np.float32)
        default = {"engine": engine, "variant": row.case.variant}  # of a run that failed
        rows.append({**default, **values, **row.case.tag, "failure": row.failure, **row.cost})
    return rows, histories


def _points(motion, solvers, quick):
    """Single blocks and oscillators of Fig. 5, in every solver."""
    free = caryatid(FREE, motion)
    slenderness, own = free.block.slenderness, 2 * np.pi / free.rocking_frequency
    blocks = (own, 5.0) if quick else (1.5, own, 3.0, 3.5, 4.5, 5.0, 6.0, 7.0)
    oscillators = (2.0,) if quick else (1.0, 2.0, 3.0)
    without = {"history": False}
    for solver, period in product(solvers, blocks):
        tag = {"part": "rocking spectrum", "period": float(period)}
        yield Case(slender_block(motion, period, slenderness), solver, settings=without, tag=tag)
    for solver, period, damping in product(solvers, oscillators, OSCILLATOR_DAMPING):
        tag = {"part": "displacement spectrum", "period": period, "damping": damping}
        yield Case(oscillator(motion, period, damping), solver, settings=without, tag=tag)


def spectra(motion: Motion, quick: bool = False) -> dict[str, np.ndarray]:
    """Arrays of Fig. 5(a), max tilt over slenderness against T_r, and Fig. 5(b), max displacement against T_bi."""
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
    """What a linear oscillator at T_bi predicts, with the damping in either definition, beside the bearings' own."""
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


REPRODUCED, CORRECTED, NOT_REPRODUCIBLE = "reproduced", "corrected", "not reproducible"
GIVEN, DERIVED, OTHER_MOTION = "input", "not printed, derived", "other motion"
NOT_CHECKABLE = "not checkable"

# Table 1(a): targets; Table 1(b): the bearings designed for them
PERIOD, X_MAX, DAMPING = 2.0, 0.30, 0.30  # s, m, share of critical
KA, KB, ALPHA, DELTA_K = 6.22e4, 6.22e3, 44.69, 1e-20  # N/m, N/m, -, N/m
COUNT, MASS, BASE_MASS, OMEGA_R = 4, 3172.05, 212.0, 2.60  # -, kg, kg, rad/s
# Of Figs 4 to 6 (Duzce 12 November 1999, East-West) the text prints outcomes and two times, and no other value.
OVERTURNING = "after approximately 35 s"  # of the paper's own file
VULNERABLE_PERIOD, VULNERABLE_ABOUT = 4.0, 0.5  # s, "four seconds" and how it is read here
OWN_FILE = "the paper's file of the same event and component starts earlier and is processed otherwise"

# Known to exist, but neither text nor numbers of it are at hand.
UNKNOWN = (
    "Figs 1 and 2; the damping ratios of Fig. 5(b); the values on the axes of Figs 3 to 6; the dimensions of "
    "the Caryatid and of its bearings beyond Table 1; the slenderness."
)


def value(
    where: str,
    quantity: str,
    printed: float | str,
    study: float | str,
    status: str,
    note: str = "",
    engine: str | None = None,
) -> dict[str, Any]:
    """A row: one number of the paper beside this study's, with their difference where both are numbers.

    Parameters
    ----------
    where : str
        Table, figure or equation.
    quantity : str
        What, with its unit.
    printed, study : float or str
        The paper's and this study's.
    status : str
        One of those above.
    note : str
        Why.
    engine : str or None
        Whose run gave it, "analytic" among them; None: no run.
    """
    numbers = isinstance(printed, float) and isinstance(study, float) and status != GIVEN
    return {
        "part": "value",
        "where": where,
        "quantity": quantity,
        "engine": engine,
        "paper": printed,
        "study": study,
        "difference": study - printed if numbers else None,  # type: ignore[operator]  # both are numbers
        "status": status,
        "note": note,
    }


def judged(
    where: str, quantity: str, printed: float, study: float, within: float, note: str = "", own: bool = True
) -> dict[str, Any]:
    """A row as `value` makes it, reproduced if it lies within half a printed digit, or what "about" allows.

    own: whether the paper's motion is behind it; else it is not judged.
    """
    met = abs(study - printed) <= within
    return value(where, quantity, printed, study, _status(own, met), note)


def _status(own, met):
    return OTHER_MOTION if not own else REPRODUCED if met else NOT_REPRODUCIBLE


def is_papers_motion(motion: Motion) -> bool:
    """Whether it is a Duzce record, by its name: only then are the paper's numbers the ones to meet."""
    return "DUZCE" in motion.label.upper() and not motion.label.startswith("synthetic")


def motion_values(rows: Sequence[Mapping[str, Any]], motion: SampledMotion, least: float) -> Iterator[dict[str, Any]]:
    """Rows of the paper's numbers in Figs 4 to 6, each beside what every solver's rows give.

    least: slenderness [rad] that does not rock on the bearings.
    """
    own = is_papers_motion(motion)
    for row in rows:
        if row["part"] == "run":
            yield from _run_values(row, motion, own)
    status, note = (GIVEN, OWN_FILE) if own else (OTHER_MOTION, "")
    yield value("Fig. 4(a)", "ground motion", "Duzce 12 Nov 1999, East-West", motion.label, status, note)
    note = "the paper's damping ratios and values are not at hand"
    yield value("Fig. 5(b)", "peak displacements of oscillators", "not at hand", "drawn", NOT_REPRODUCIBLE, note)
    for row in rows:
        if row["part"] == "vulnerable":
            note = f"largest T_r that overturns, in steps of {row['step']:g} s, γ = {row['slenderness']:g} rad"
            about = VULNERABLE_PERIOD, row["period"], VULNERABLE_ABOUT
            yield judged("Fig. 5(a)", "vulnerable below T_r of [s]", *about, note, own=own)
    what = "least slenderness that does not rock on the bearings [rad]"
    yield value("text", what, "not printed", least, DERIVED, "atan(max|a|/g)")


def _run_values(row, motion, own):
    """Figs 4(b) and 6 as one solver's run has them."""
    what, engine = f"{row['scene']} Caryatid", row["engine"]

    def found(place, quantity, printed, study, status=None, note=""):
        study, note = "does not happen" if study is None else study, note if own else ""
        status = status if own and status else _status(own, study == printed)
        return value(place, quantity, printed, study, status, note, engine)

    if row["outcome"] == "failed":
        why = row["failure"]["reason"]
        yield value("Figs 4(b), 6", what, "runs", "failed", NOT_REPRODUCIBLE, why, engine)
    elif row["scene"] == FREE:
        time, after = row["overturning_time"], "overturning after the peak of the motion [s]"
        yield found("Fig. 4(b)", what, "overturns", row["outcome"])
        time = None if time is None else time - motion.peak_time
        yield found("Fig. 4(b)", after, OVERTURNING, time, NOT_CHECKABLE, OWN_FILE)
    else:
        peak = row["peak_base_displacement"]
        acceleration = row["peak_base_acceleration"] / caryatid(ISOLATED, motion).gravity
        yield found("Fig. 6", what, "stands", row["outcome"])
        yield found("Fig. 6", "peak displacement of the base [m]", "not printed", peak, DERIVED)
        yield found("Fig. 6", "peak absolute acceleration [g]", "not printed", acceleration, DERIVED)
        yield found("Fig. 6", "peak displacement below x_max = 0.30 m", "yes", "yes" if peak < X_MAX else "no")
