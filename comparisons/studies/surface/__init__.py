"""The fragility surface: how likely is overturning at an intensity and a slenderness, from a million runs."""

from ...running.plan import Study
from .study import plan

STUDY = Study(
    "surface",
    "Probability of overturning over intensity and slenderness, from a million runs of the analytic model.",
    plan,
    f"{__name__}.page",
    all_engines=False,
    whole="its settings count the failed and undecided runs of all solvers together",
)
