"""The numbers that were chosen in an engine's variant, each halved and doubled: what moves?"""

from ...running.plan import Study
from .study import plan

STUDY = Study(
    "constants",
    "Each number that was chosen in an engine's variant, halved and doubled: what moves?",
    plan,
    f"{__name__}.page",
)
