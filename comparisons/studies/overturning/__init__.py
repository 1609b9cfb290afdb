"""Overturning: where do the solvers' boundaries lie, over pulse frequency and amplitude?"""

from ...running.plan import Study
from .study import plan

STUDY = Study(
    "overturning",
    "Overturning boundaries under pulses, on rigid ground and isolated, solver by solver.",
    plan,
    f"{__name__}.page",
    indexed={"points": 2},
)
