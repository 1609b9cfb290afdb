"""Fragility: how likely is a limit state at an intensity, in which measure, and does the engine change the answer?"""

from ...running.plan import Study
from .study import plan

STUDY = Study(
    "fragility",
    "Fragility over intensity: which measure tells most, does a lognormal curve fit, does the engine shift it?",
    plan,
    f"{__name__}.page",
)
