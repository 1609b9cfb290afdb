"""What matters more than the engine: how often does each uncertainty flip the verdict, the solver's among them?"""

from ...running.study import Study
from .cases import plan
from .figures import draw, draw_vertical
from .finding import finding
from .page import section

STUDY = Study(
    "matters",
    "What flips the verdict more often than the choice of the engine: the vertical motion, a per cent of slenderness?",
    plan,
    lambda result: {"": draw(result), "vertical": draw_vertical(result)},
    section,
    finding=finding,
)
