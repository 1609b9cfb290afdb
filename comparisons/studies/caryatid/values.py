"""The paper's numbers that need the motion, Figs 4 to 6, each beside what every solver says."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from analytic.linear_oscillator import displacement_spectrum

from . import paper
from .paper import NOT_REPRODUCIBLE, OTHER_MOTION, REPRODUCED, Value, judged
from .runs import FREE, ISOLATED, caryatid

if TYPE_CHECKING:
    from analytic import SampledMotion
    from analytic.types import Motion


def is_papers_motion(motion: Motion) -> bool:
    """Whether it is a Duzce record, by its name: only then are the paper's numbers the ones to meet."""
    return "DUZCE" in motion.label.upper() and not motion.label.startswith("synthetic")


def motion_values(rows: Sequence[Mapping[str, Any]], motion: SampledMotion, least: float) -> list[Value]:
    """The `Value`s that the rows of the study give; least: slenderness [rad] that does not rock on the bearings."""
    own = is_papers_motion(motion)
    return [
        *(value for row in rows if row["part"] == "run" for value in _run_values(row, motion, own)),
        Value(
            "Fig. 4(a)",
            "ground motion",
            "Duzce 12 Nov 1999, East-West",
            motion.label,
            REPRODUCED if own else OTHER_MOTION,
            "the paper's trace starts about 28 s earlier",
        ),
        *_spectrum_values(rows),
        *_oscillator_values(rows, motion),
        *(_limit_value(row, own) for row in rows if row["part"] == "vulnerable"),
        Value(
            "text",
            "least slenderness that does not rock on the bearings [rad]",
            "not printed",
            least,
            paper.DERIVED,
            "atan(max|a|/g)",
        ),
    ]


def _number_value(own, where, quantity, printed, study, within, note=""):
    """The `Value` of a number, None where there is none; it is judged only under the paper's own motion."""
    if study is None:
        return Value(where, quantity, printed, "does not happen", NOT_REPRODUCIBLE if own else OTHER_MOTION, note)
    if own:
        return judged(where, quantity, printed, study, within, note)
    return Value(where, quantity, printed, study, OTHER_MOTION, note)


def _word_value(own, where, quantity, printed, study):
    """The `Value` of a word."""
    status = REPRODUCED if study == printed else NOT_REPRODUCIBLE
    return Value(where, quantity, printed, study, status if own else OTHER_MOTION)


def _run_values(row, motion, own):
    """Figs 4(b) and 6 as one solver's run has them."""
    solver = row["solver"]
    if row["outcome"] == "failed":
        what, why = f"{row['scene']} Caryatid, {solver}", row["failure"]["reason"]
        return [Value("Figs 4(b), 6", what, "runs", "failed", NOT_REPRODUCIBLE, why)]
    if row["scene"] == FREE:
        time = row["overturning_time"]
        return [
            _word_value(own, "Fig. 4(b)", f"free-standing Caryatid, {solver}", "overturns", row["outcome"]),
            _number_value(
                own,
                "Fig. 4(b)",
                f"overturning after the peak of the motion [s], {solver}",
                paper.OVERTURNING_AFTER_PEAK,
                None if time is None else time - motion.peak_time,
                paper.OVERTURNING_ABOUT,
                "about 35 s in a trace that starts about 28 s earlier",
            ),
        ]
    peak, gravity = row["peak_base_displacement"], caryatid(ISOLATED, motion).gravity
    below = "yes" if peak < paper.X_MAX else "no"
    numbers = (
        ("peak displacement of the base [m]", paper.PEAK_DISPLACEMENT, peak),
        ("peak absolute acceleration [g]", paper.PEAK_ACCELERATION_G, row["peak_base_acceleration"] / gravity),
    )
    return [
        _word_value(own, "Fig. 6", f"isolated Caryatid, {solver}", "stands", row["outcome"]),
        *(
            _number_value(own, "Fig. 6", f"{quantity}, {solver}", printed, study, 0.0005)
            for quantity, printed, study in numbers
        ),
        _word_value(own, "Fig. 6", f"peak displacement below x_max = 0.30 m, {solver}", "yes", below),
    ]


def _spectrum_values(rows):
    """Fig. 5(a): whether each engine overturns where the analytic model does."""
    points = [row for row in rows if row["part"] == "rocking spectrum"]
    expected = {row["period"]: row["outcome"] == "overturns" for row in points if row["solver"] == "analytic"}
    periods = ", ".join(f"{period:.3g}" for period in dict.fromkeys(row["period"] for row in points))
    for solver in dict.fromkeys(row["solver"] for row in points if row["solver"] != "analytic"):
        wrong = [
            row["period"]
            for row in points
            if row["solver"] == solver and (row["outcome"] == "overturns") != expected.get(row["period"], False)
        ]
        where = f"not at T_r = {', '.join(f'{period:.3g}' for period in wrong)} s" if wrong else "at all points"
        quantity = f"overturning as in the analytic model, {solver}"
        yield Value("Fig. 5(a)", quantity, "no engine used", where, paper.ADDED, f"T_r = {periods} s")


def _limit_value(row, own):
    """Fig. 5(a): up to which rocking period blocks overturn."""
    return _number_value(
        own,
        "Fig. 5(a)",
        "vulnerable below T_r of [s]",
        paper.VULNERABLE_PERIOD,
        row["period"],
        paper.VULNERABLE_ABOUT,
        f"largest T_r that overturns, in steps of {row['step']:g} s, γ = {row['slenderness']:g} rad",
    )


def _oscillator_values(rows, motion):
    """Fig. 5(b): no number of the paper is at hand; every solver against the exact solution."""
    points = [row for row in rows if row["part"] == "displacement spectrum" and row["outcome"] == "stands"]
    for solver in dict.fromkeys(row["solver"] for row in points):
        apart = [
            abs(
                row["peak_base_displacement"]
                / float(displacement_spectrum(motion, [row["period"]], [row["damping"]])[0, 0])
                - 1
            )
            for row in points
            if row["solver"] == solver
        ]
        yield Value(
            "Fig. 5(b)",
            f"oscillators, worst relative difference from the exact one [-], {solver}",
            "not at hand",
            max(apart),
            NOT_REPRODUCIBLE,
            "drawn; the paper's damping ratios and values are not at hand",
        )
