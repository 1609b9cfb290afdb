"""What changes the outcome more often than the engine does: each uncertainty in turn, the engine's error among them."""

from ...running.study import Study
from .study import plan


def _page(result):
    from .page import page  # where it is shown only: the processes that run it need no charts

    return page(result)


STUDY = Study(
    "matters",
    "What changes the outcome more often than the choice of the engine: vertical motion, a per cent of slenderness?",
    plan,
    page=_page,
)
