"""Overturning: where do the solvers' boundaries lie, over pulse frequency and amplitude?"""

from ...running.study import Study
from .study import plan


def _page(result):
    from .page import page  # where it is shown only: the processes that run it need no charts

    return page(result)


def _judgement(result):
    from .page import judgement

    return judgement(result)


STUDY = Study(
    "overturning",
    "Overturning boundaries under pulses, on rigid ground and isolated, solver by solver.",
    plan,
    page=_page,
    judgement=_judgement,
)
