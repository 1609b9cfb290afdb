"""One impact in every engine, taken apart: whose impulse was wrong, and what for?"""

from ...running.study import Study
from .study import plan


def _page(result):
    from .page import page  # where it is shown only: the processes that run it need no charts

    return page(result)


STUDY = Study(
    "autopsy",
    "One impact in every engine and variant, taken apart: the parts of its error and their cause.",
    plan,
    page=_page,
)
