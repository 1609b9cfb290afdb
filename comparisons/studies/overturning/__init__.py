"""Overturning: where do the solvers' boundaries lie, over pulse frequency and amplitude?"""

from ...running.study import Study
from .cases import plan
from .figures import draw_knobs, draw_maps, draw_shifts
from .finding import finding, judgement
from .page import section


def _figures(result):
    return {"maps": draw_maps(result), "shifts": draw_shifts(result), "knobs": draw_knobs(result)}


STUDY = Study(
    "overturning",
    "Overturning boundaries under pulses, on rigid ground and isolated, solver by solver.",
    plan,
    _figures,
    section,
    finding=finding,
    judgement=judgement,
)
