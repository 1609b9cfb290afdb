"""The study as a whole: its plan."""

import re
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from analytic import SampledMotion
from analytic.design import properties
from analytic.linear_oscillator import displacement_spectrum
from analytic.types import Motion
from engines import available_engines

from ...running.solving import ground_motion
from ...running.study import Ask, Found, Plan, say
from . import paper
from .cost import cost_rows
from .formulas import formulas
from .paper import NOT_REPRODUCIBLE, OTHER_MOTION, REPRODUCED, Value, judged
from .runs import FREE, ISOLATED, caryatid, equivalent_oscillators, simulations, spectra
from .slenderness import claims, uplift_slenderness
from .variations import contact, impact_friction, maps

PART_PAPER, PART_MOTION, PART_HISTORIES = "paper", "motion", "histories"

Record = Annotated[
    str | None,
    typer.Option(metavar="FILE", help="The Duzce record, or another. Default: the shipped synthetic motion."),
]
Units = Annotated[str | None, typer.Option(help="Of a record that does not say: m/s2, cm/s2 or g.")]


def plan(ask: Ask, motion: SampledMotion | None = None, *, record: Record = None, units: Units = None) -> Plan:
    """The plan of the study, an answer for each part.

    Parameters
    ----------
    ask : Ask
    motion : SampledMotion or None
        None: the one in the file `record`.
    record, units : str or None
        A ground motion's file and its units; None: the shipped synthetic motion.
    """
    motion = motion or ground_motion(record, units)
    say(f"ground motion: {motion.label}")
    described = {
        "motion": {"label": motion.label, "peak_time": motion.peak_time, "dt": motion.dt, "end": motion.end},
        "quick": ask.quick,
    }
    say("bearing law, Table 1, misprints")
    rows, arrays = formulas()
    yield Found({"part": PART_PAPER}, rows, arrays, name="caryatid-paper")
    rows, histories = yield from simulations(motion, ask.engines, ask.quick)
    found, arrays, least, slenderness = _analytic(rows, motion, ask.quick)
    rows += found
    stem = f"caryatid-under-{_slug(motion)}"
    yield Found(
        {
            "part": PART_MOTION,
            **described,
            "missing": available_engines()[1],
            "uplift_slenderness": least,
            "slenderness": slenderness,
        },
        rows,
        arrays,
        name=stem,
    )
    histories |= {
        "motion/time": np.arange(len(motion.samples)) * np.float32(motion.dt),
        "motion/acceleration": motion.samples.astype(np.float32),
    }
    return Found(
        {"part": PART_HISTORIES, **described, "slenderness": slenderness, "x_max": paper.X_MAX},
        [row for row in rows if row["part"] == "run"],
        histories,
        name=f"{stem}-histories",
    )


def _analytic(rows, motion, quick):
    """(rows, arrays, least slenderness that lifts, the Caryatid's) of what the analytic model alone answers."""
    say("spectra")
    arrays = spectra(motion, quick)
    isolated = caryatid(ISOLATED, motion).with_(duration=motion.end)
    analytic = {row["scene"]: row for row in rows if row["part"] == "run" and row["solver"] == "analytic"}
    found = equivalent_oscillators(
        motion,
        properties(isolated.bearings, isolated.total_mass, paper.X_MAX),
        analytic[ISOLATED]["peak_base_displacement"],
    )
    for words, part in (
        ("slenderness: which values fit the claims", lambda: claims(motion, quick)),
        ("friction and normal force", lambda: contact(motion, quick)),
        ("other slendernesses, intensities and motions", lambda: maps(motion, quick, say)),
    ):
        say(words)
        here, more = part()
        found, arrays = found + here, arrays | more
    arrays |= _impact_friction(motion)
    say("algebraic against Bouc-Wen")
    found += cost_rows(motion, quick)
    arrays = {
        name: values.astype(np.float32) if values.dtype == np.float64 else values for name, values in arrays.items()
    }
    least = uplift_slenderness(motion)
    return (
        found + [value.row() for value in _values(rows + found, motion, least)],
        arrays,
        least,
        isolated.block.slenderness,
    )


def is_papers_motion(motion: Motion) -> bool:
    """Whether it is a Duzce record, by its name: only then are the paper's numbers the ones to meet."""
    return "DUZCE" in motion.label.upper() and not motion.label.startswith("synthetic")


def _slug(motion):
    """A file's name for the motion: of a record its own, without the ending."""
    name = "synthetic" if motion.label.startswith("synthetic") else Path(motion.label).stem
    return re.sub(r"[^a-z0-9]+", "-", name.lower()).strip("-")


def _impact_friction(motion):
    """Friction an impact itself asks for, over slenderness."""
    slendernesses = np.linspace(0.05, 0.6, 56)
    return {
        "impact friction/slenderness": slendernesses,
        **{
            f"impact friction/{name}": np.array(
                [
                    impact_friction(caryatid(name, motion).with_(block={"slenderness": float(gamma)}))
                    for gamma in slendernesses
                ]
            )
            for name in (FREE, ISOLATED)
        },
    }


def _values(rows, motion, least):
    """The paper's numbers that need the motion: Figs 4 to 6, in every solver."""
    own = is_papers_motion(motion)
    values = []

    def compare(where, quantity, printed, study, within, note=""):
        if own and study is not None:
            values.append(judged(where, quantity, printed, study, within, note))
        elif study is None:
            values.append(
                Value(where, quantity, printed, "does not happen", NOT_REPRODUCIBLE if own else OTHER_MOTION, note)
            )
        else:
            values.append(Value(where, quantity, printed, study, OTHER_MOTION, note))

    def words(where, quantity, printed, study):
        status = REPRODUCED if study == printed else NOT_REPRODUCIBLE
        values.append(Value(where, quantity, printed, study, status if own else OTHER_MOTION))

    for row in (row for row in rows if row["part"] == "run"):
        solver, outcome = row["solver"], row["outcome"]
        if outcome == "failed":
            values.append(
                Value(
                    "Figs 4(b), 6",
                    f"{row['scene']} Caryatid, {solver}",
                    "runs",
                    "failed",
                    NOT_REPRODUCIBLE,
                    row["failure"]["reason"],
                )
            )
        elif row["scene"] == FREE:
            words("Fig. 4(b)", f"free-standing Caryatid, {solver}", "overturns", outcome)
            time = row["overturning_time"]
            compare(
                "Fig. 4(b)",
                f"overturning after the peak of the motion [s], {solver}",
                paper.OVERTURNING_AFTER_PEAK,
                None if time is None else time - motion.peak_time,
                paper.OVERTURNING_ABOUT,
                "about 35 s in a trace that starts about 28 s earlier",
            )
        else:
            words("Fig. 6", f"isolated Caryatid, {solver}", "stands", outcome)
            compare(
                "Fig. 6",
                f"peak displacement of the base [m], {solver}",
                paper.PEAK_DISPLACEMENT,
                row["peak_base_displacement"],
                0.0005,
            )
            compare(
                "Fig. 6",
                f"peak absolute acceleration [g], {solver}",
                paper.PEAK_ACCELERATION_G,
                row["peak_base_acceleration"] / caryatid(ISOLATED, motion).gravity,
                0.0005,
            )
            words(
                "Fig. 6",
                f"peak displacement below x_max = 0.30 m, {solver}",
                "yes",
                "yes" if row["peak_base_displacement"] < paper.X_MAX else "no",
            )
    values.append(
        Value(
            "Fig. 4(a)",
            "ground motion",
            "Duzce 12 Nov 1999, East-West",
            motion.label,
            REPRODUCED if own else OTHER_MOTION,
            "the paper's trace starts about 28 s earlier",
        )
    )
    periods = [row["period"] for row in rows if row["part"] == "rocking spectrum"]
    for solver in dict.fromkeys(row["solver"] for row in rows if row["part"] == "rocking spectrum"):
        wrong = [
            row["period"]
            for row in rows
            if row["part"] == "rocking spectrum"
            and row["solver"] == solver
            and (row["outcome"] == "overturns") != _overturns(rows, row["period"])
        ]
        if solver != "analytic":
            found = "at all points" if not wrong else f"not at T_r = {', '.join(f'{t:.3g}' for t in wrong)} s"
            values.append(
                Value(
                    "Fig. 5(a)",
                    f"overturning as in the analytic model, {solver}",
                    "no engine used",
                    found,
                    paper.ADDED,
                    f"T_r = {', '.join(f'{t:.3g}' for t in dict.fromkeys(periods))} s",
                )
            )
    values += _oscillator_values(rows, motion)
    limit = [row for row in rows if row["part"] == "vulnerable"]
    for row in limit:
        compare(
            "Fig. 5(a)",
            "vulnerable below T_r of [s]",
            paper.VULNERABLE_PERIOD,
            row["period"],
            paper.VULNERABLE_ABOUT,
            f"largest T_r that overturns, in steps of {row['step']:g} s, γ = {row['slenderness']:g} rad",
        )
    values.append(
        Value(
            "text",
            "least slenderness that does not rock on the bearings [rad]",
            "not printed",
            least,
            paper.DERIVED,
            "atan(max|a|/g)",
        )
    )
    return values


def _oscillator_values(rows, motion):
    """Fig. 5(b): no number of the paper is at hand; every solver against the exact solution."""
    points = [row for row in rows if row["part"] == "displacement spectrum" and row["outcome"] == "stands"]
    values = []
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
        values.append(
            Value(
                "Fig. 5(b)",
                f"oscillators, worst relative difference from the exact one [-], {solver}",
                "not at hand",
                max(apart),
                NOT_REPRODUCIBLE,
                "drawn; the paper's damping ratios and values are not at hand",
            )
        )
    return values


def _overturns(rows, period):
    return any(
        row["outcome"] == "overturns"
        for row in rows
        if row["part"] == "rocking spectrum" and row["solver"] == "analytic" and row["period"] == period
    )
