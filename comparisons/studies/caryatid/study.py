"""The Caryatid paper: every equation, figure and table of it reproduced or corrected, and what it leaves out.

There are three results, all of kind "caryatid": ``caryatid-paper`` (what needs no motion: bearing law, Table 1,
misprints), ``caryatid-under-<motion>`` (what does, without a single value of the motion itself) and
``caryatid-under-<motion>-histories`` (Figs 4 and 6 over time: not to be passed on where the record may not be).
"""

import re
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from analytic import SampledMotion
from analytic.design import properties
from engines import available_engines

from ...running.options import Channel, Column, Step, Units
from ...running.plan import Computed, Plan, Request
from ...running.progress import log
from ...running.solving import ground_motion
from .formulas import formulas
from .runs import ISOLATED, X_MAX, caryatid, equivalent_oscillators, motion_values, simulations, spectra
from .variations import claims, maps, uplift_slenderness

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
    """The plan of the study, an answer for each part.

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
    """(rows, arrays) of what the analytic model alone answers."""
    log("spectra")
    arrays = spectra(motion, quick)
    isolated = caryatid(ISOLATED, motion)
    (own,) = (row for row in runs if row["scene"] == ISOLATED and row["engine"] == "analytic")
    bearings = properties(isolated.bearings, isolated.total_mass, X_MAX)
    rows = equivalent_oscillators(motion, bearings, own["peak_base_displacement"])
    log("slenderness: which values fit the claims")
    fitting, periods = claims(motion, quick)
    log("other slendernesses, intensities and motions")
    shares, benefit = maps(motion, quick)
    rows += [*fitting, *shares]
    arrays |= periods | benefit
    singles = {name: one.astype(np.float32) for name, one in arrays.items() if one.dtype == np.float64}
    return rows, arrays | singles


def _slug(motion):
    """A file's name for the motion: of a record its own, without the ending, and the channel or column."""
    file, more = re.match(r"([^,(]*)(.*)", motion.label).groups()
    name = "synthetic" if motion.label.startswith("synthetic") else Path(file.strip()).stem + more
    return re.sub(r"[^a-z0-9]+", "-", name.lower()).strip("-")
