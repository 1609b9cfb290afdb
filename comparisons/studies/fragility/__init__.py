"""Fragility: how likely is a limit state at an intensity, in which measure, and does the answer hang on the solver?"""

from ...running.study import Study
from .cases import plan
from .figures import draw_curves, draw_dispersions, draw_effects
from .finding import finding, judgement
from .page import section

STUDY = Study(
    "fragility",
    "Fragility over intensity: which measure tells most, does a lognormal curve fit, does the solver shift it?",
    plan,
    lambda result: {"": draw_curves(result), "measures": draw_dispersions(result), "solvers": draw_effects(result)},
    section,
    finding=finding,
    judgement=judgement,
)
