"""The Caryatid paper: every equation, figure and table of it reproduced or corrected, and what it leaves out.

There are three result files, all of kind "caryatid": ``caryatid-paper`` (what needs no motion: bearing law, Table 1,
misprints), ``caryatid-under-<motion>`` (what does, without a single value of the motion itself) and
``caryatid-under-<motion>-histories`` (Figs 4 and 6 over time: not to be passed on where the record may not be).
"""

from ...running.plan import Study
from .study import plan

STUDY = Study(
    "caryatid",
    "The Caryatid paper: every equation, figure and table reproduced or corrected, and what it leaves out.",
    plan,
    f"{__name__}.page",
    whole="its answer is several files, under a motion that they do not hold, with CPU times measured together",
)
