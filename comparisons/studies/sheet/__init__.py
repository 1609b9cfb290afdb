"""The problem sheet solved by every engine and variant: what ``rocking score`` ranks other codes beside."""

from ...running.study import Study
from .study import plan


def _page(result):
    from .page import page  # where it is shown only: the processes that run it need no charts

    return page(result)


STUDY = Study(
    "sheet", "The problem sheet in every engine: what rocking score ranks other codes beside.", plan, page=_page
)
