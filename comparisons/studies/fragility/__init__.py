"""Fragility: how likely is a limit state at an intensity, in which measure, and does the engine change the answer?"""

from ...running.study import Study
from .study import plan


def _page(result):
    from .page import page  # where it is shown only: the processes that run it need no charts

    return page(result)


def _judgement(result):
    from .page import judgement

    return judgement(result)


STUDY = Study(
    "fragility",
    "Fragility over intensity: which measure tells most, does a lognormal curve fit, does the engine shift it?",
    plan,
    page=_page,
    judgement=_judgement,
)
