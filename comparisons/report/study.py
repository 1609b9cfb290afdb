"""The report's own runs as a study, and their results in the report's folder."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from ..running.study import Study, compute
from .runs import SLENDERNESSES, plan
from .sections import caryatid_sections

if TYPE_CHECKING:
    from analytic.types import Motion

# Under a record of more samples one engine runs at a time: each needs some 100 bytes a step several times over.
SHORT_RECORD = 200_000
UNFINISHED = "unfinished"  # folder of what a report that is broken off goes on from

STUDY = Study("report", "The Caryatid and free rocking in every solver.", plan, lambda result: {}, caryatid_sections)


def make_results(
    folder: str | PathLike[str],
    motion: Motion,
    *,
    duration: float | None = None,
    slendernesses: Sequence[float] = SLENDERNESSES,
) -> None:
    """Simulate everything the report shows and write its result files into `folder`.

    Parameters
    ----------
    folder : path
        Made if it does not exist. A report that is broken off goes on from what it finds here.
    motion : SampledMotion
    duration : float or None
        Of the Caryatid's runs [s]; None: until their outcome is decided.
    slendernesses : sequence of float
        Of the free rocking blocks [rad].
    """
    unfinished = Path(folder) / UNFINISHED
    for path in compute(
        STUDY,
        unfinished,
        workers=None if len(motion.samples) <= SHORT_RECORD else 1,
        motion=motion,
        histories=unfinished,
        duration=duration,
        slendernesses=slendernesses,
    ):
        for file in (path.with_suffix(".npz"), path):
            shutil.move(file, Path(folder) / file.name)
    shutil.rmtree(unfinished)  # complete: the next report measures its times afresh
