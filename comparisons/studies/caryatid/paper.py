"""What the Caryatid paper prints, as far as it is known here, and each number of it beside this study's."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from typing import Any

from analytic import SampledMotion
from analytic.linear_oscillator import displacement_spectrum
from analytic.types import Motion

from .runs import FREE, ISOLATED, caryatid

REPRODUCED, CORRECTED, NOT_REPRODUCIBLE = "reproduced", "corrected", "not reproducible"
GIVEN, DERIVED, ADDED, OTHER_MOTION = "input", "not printed, derived", "added here", "other motion"
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
    where: str,
    quantity: str,
    printed: float | str,
    study: float | str | None,
    within: float = 0.0,
    note: str = "",
    engine: str | None = None,
    own: bool = True,
) -> dict[str, Any]:
    """A row as `value` makes it, reproduced if it is the same word or lies within half a printed digit, or what "about"
    allows; study: None if it does not happen. own: whether the paper's motion is behind it; else it is not judged.
    """
    study = "does not happen" if study is None else study
    words = isinstance(study, str) or isinstance(printed, str)
    met = study == printed if words else abs(study - printed) <= within  # type: ignore[operator]  # both are numbers
    status = OTHER_MOTION if not own else REPRODUCED if met else NOT_REPRODUCIBLE
    return value(where, quantity, printed, study, status, note, engine)


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
    yield from _spectrum_values(rows)
    yield from _oscillator_values(rows, motion)
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
    meets = partial(judged, engine=engine, own=own)

    def found(place, quantity, printed, study, status, note=""):
        study = "does not happen" if study is None else study
        status, note = (status, note) if own else (OTHER_MOTION, "")
        return value(place, quantity, printed, study, status, note, engine)

    if row["outcome"] == "failed":
        why = row["failure"]["reason"]
        yield value("Figs 4(b), 6", what, "runs", "failed", NOT_REPRODUCIBLE, why, engine)
    elif row["scene"] == FREE:
        time, after = row["overturning_time"], "overturning after the peak of the motion [s]"
        yield meets("Fig. 4(b)", what, "overturns", row["outcome"])
        time = None if time is None else time - motion.peak_time
        yield found("Fig. 4(b)", after, OVERTURNING, time, NOT_CHECKABLE, OWN_FILE)
    else:
        peak = row["peak_base_displacement"]
        acceleration = row["peak_base_acceleration"] / caryatid(ISOLATED, motion).gravity
        yield meets("Fig. 6", what, "stands", row["outcome"])
        yield found("Fig. 6", "peak displacement of the base [m]", "not printed", peak, DERIVED)
        yield found("Fig. 6", "peak absolute acceleration [g]", "not printed", acceleration, DERIVED)
        yield meets("Fig. 6", "peak displacement below x_max = 0.30 m", "yes", "yes" if peak < X_MAX else "no")


def _by_engine(rows):
    found: dict[str, list] = {}
    for row in rows:
        found.setdefault(row["engine"], []).append(row)
    return found


def _periods(periods):
    return ", ".join(f"{period:.3g}" for period in periods)


def _spectrum_values(rows):
    """Fig. 5(a): whether each engine overturns where the analytic model does."""
    by_engine = _by_engine(row for row in rows if row["part"] == "rocking spectrum")
    expected = {row["period"]: row["outcome"] == "overturns" for row in by_engine.pop("analytic", ())}
    for engine, points in by_engine.items():
        wrong = [
            row["period"] for row in points if (row["outcome"] == "overturns") != expected.get(row["period"], False)
        ]
        agrees = f"not at T_r = {_periods(wrong)} s" if wrong else "at all points"
        note = f"T_r = {_periods(row['period'] for row in points)} s"
        what = "overturning as in the analytic model"
        yield value("Fig. 5(a)", what, "no engine used", agrees, ADDED, note, engine)


def _oscillator_values(rows, motion):
    """Fig. 5(b): no number of the paper is at hand; every solver against the exact solution."""
    standing = (row for row in rows if row["part"] == "displacement spectrum" and row["outcome"] == "stands")
    for engine, points in _by_engine(standing).items():
        exact = [float(displacement_spectrum(motion, [row["period"]], [row["damping"]])[0, 0]) for row in points]
        apart = [abs(row["peak_base_displacement"] / one - 1) for row, one in zip(points, exact, strict=True)]
        what = "oscillators, worst relative difference from the exact one [-]"
        note = "drawn; the paper's damping ratios and values are not at hand"
        yield value("Fig. 5(b)", what, "not at hand", max(apart), NOT_REPRODUCIBLE, note, engine)
