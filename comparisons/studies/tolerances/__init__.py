"""The table of agreement tolerances, every row measured anew: how far is each engine, and what is it held to?"""

from ...running.plan import Study
from .study import plan, problems

STUDY = Study(
    "tolerances",
    "How far each engine is from the analytic model, beside what it is held to. Status 1: a row does not hold.",
    plan,
    f"{__name__}.page",
    problems,
)
