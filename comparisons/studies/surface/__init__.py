"""The fragility surface: how likely is overturning at an intensity and a slenderness, from a million runs."""

from ...running.study import Study
from .study import plan


def _page(result):
    from .page import page  # where it is shown only: the processes that run it need no charts

    return page(result)


STUDY = Study(
    "surface",
    "Probability of overturning over intensity and slenderness, from a million runs of the analytic model.",
    plan,
    page=_page,
    all_engines=False,
)
