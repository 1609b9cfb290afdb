"""Recorded motions: does an engine overturn the blocks that the analytic model overturns?"""

from ...running.plan import Study
from .study import plan

STUDY = Study(
    "recorded",
    "Recorded motions: does an engine overturn the blocks that the analytic model overturns?",
    plan,
    f"{__name__}.page",
    problems=lambda result: [row["reason"] for row in result.rows if row["part"] == "absent"],
)
