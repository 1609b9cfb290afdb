"""Numerical stability: which solver gets which hard case right, where it does not, and which finer settings do."""

from ...running.study import Study
from .study import plan


def _page(result):
    from .page import page  # where it is shown only: the processes that run it need no charts

    return page(result)


def _judgement(result):
    from .page import judgement

    return judgement(result)


STUDY = Study(
    "stability",
    "Named hard cases in every solver and variant: right, differs or failed, with measures, evidence, finer settings.",
    plan,
    page=_page,
    judgement=_judgement,
)
