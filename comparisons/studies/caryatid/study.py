"""The study as a whole: its plan."""

import re
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from analytic import SampledMotion
from analytic.design import properties
from engines import available_engines

from ...running.record_options import Channel, Column, Step, Units
from ...running.solving import ground_motion
from ...running.study import Ask, Found, Plan, say
from . import paper
from .cost import cost_rows
from .formulas import formulas
from .runs import FREE, ISOLATED, caryatid, equivalent_oscillators, simulations, spectra
from .slenderness import claims, uplift_slenderness
from .values import motion_values
from .variations import contact, impact_friction, maps

PART_PAPER, PART_MOTION, PART_HISTORIES = "paper", "motion", "histories"

Record = Annotated[
    str | None,
    typer.Option(metavar="FILE", help="The Duzce record, or another. Default: the shipped synthetic motion."),
]


def plan(
    ask: Ask,
    motion: SampledMotion | None = None,
    *,
    record: Record = None,
    units: Units = None,
    dt: Step = None,
    column: Column = None,
    channel: Channel = None,
) -> Plan:
    """The plan of the study, an answer for each part.

    Parameters
    ----------
    ask : Ask
    motion : SampledMotion or None
        None: the one in the file `record`.
    record : str or None
        A ground motion's file; None: the shipped synthetic motion.
    units, dt, column, channel
        What that file does not say itself.
    """
    motion = motion or ground_motion(record, units=units, dt=dt, column=column, channel=channel)
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
    answers = equivalent_oscillators(
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
        answers, arrays = answers + here, arrays | more
    arrays |= _impact_friction(motion)
    say("algebraic against Bouc-Wen")
    answers += cost_rows(motion, quick)
    arrays = {
        name: values.astype(np.float32) if values.dtype == np.float64 else values for name, values in arrays.items()
    }
    least = uplift_slenderness(motion)
    return (
        answers + [value.row() for value in motion_values(rows + answers, motion, least)],
        arrays,
        least,
        isolated.block.slenderness,
    )


def _slug(motion):
    """A file's name for the motion: of a record its own, without the ending, and the channel or column."""
    file, more = re.match(r"([^,(]*)(.*)", motion.label).groups()
    name = "synthetic" if motion.label.startswith("synthetic") else Path(file.strip()).stem + more
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
