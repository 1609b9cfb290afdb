"""Speed against error: what each solver costs at what error, on five scenes; and how the cost grows."""

from ...running.study import Study
from .study import plan


def _page(result):
    from .page import page  # where it is shown only: the processes that run it need no charts

    return page(result)


STUDY = Study(
    "speed-error",
    "Error and CPU time of the same runs: kernel, scipy, time stepping, Bouc-Wen, engines and variants.",
    plan,
    page=_page,
)
