"""Fragility: how likely is overturning at an intensity, and does the answer depend on the solver?"""

from ...running.study import Study
from .cases import plan
from .page import draw, section

STUDY = Study(
    "fragility",
    "Probability of overturning over the intensity of synthetic motions, solver by solver.",
    plan,
    lambda result: {"": draw(result)},
    section,
)
