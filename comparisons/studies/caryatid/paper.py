"""What the Caryatid paper prints, as far as it is known here, and each number of it beside this study's."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from analytic import SampledMotion
from analytic.motion import Motion

from .runs import FREE, ISOLATED, caryatid

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
