"""The kernel of the analytic model against other integrators, and what it costs at its work."""

from ...running.study import Study
from .study import plan


def _page(result):
    from .page import page  # where it is shown only

    return page(result)


STUDY = Study(
    "kernel",
    "The analytic model's kernel against other integrators: error and CPU time of the same runs, and throughput.",
    plan,
    page=_page,
    all_engines=False,
)
