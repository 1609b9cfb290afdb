"""How far off are restitution and the base velocity jump, where, why, at what cost?"""

from ...running.study import Study
from .study import plan


def _page(result):
    from .page import page  # where it is shown only: the processes that run it need no charts

    return page(result)


STUDY = Study(
    "restitution",
    "Error of restitution and base velocity jump over slenderness, base mass and accuracy setting, with its cost.",
    plan,
    page=_page,
)
