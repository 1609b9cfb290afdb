"""The fragility surface: how likely is overturning at an intensity and a slenderness, from a million runs."""

from ...running.study import Study
from .cases import plan
from .page import draw, section

STUDY = Study(
    "surface",
    "Probability of overturning over intensity and slenderness, from a million runs of the analytic model.",
    plan,
    lambda result: {"": draw(result)},
    section,
    all_engines=False,
)
