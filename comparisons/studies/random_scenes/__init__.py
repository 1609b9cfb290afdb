"""Random scenes within the range of a statue: how often is an engine right, and is every wrong run reported?"""

from ...running.study import Study
from .study import plan


def _page(result):
    from .page import page  # where it is shown only

    return page(result)


def _judgement(result):
    from .page import judgement

    return judgement(result)


STUDY = Study(
    "random-scenes",
    "Random scenes in the range of a statue: how often is an engine right, and is every wrong run reported?",
    plan,
    page=_page,
    judgement=_judgement,
)
