"""Random scenes within the range of a statue: how often is an engine right, and is every wrong run reported?"""

from ...running.plan import Study
from .study import plan

STUDY = Study(
    "random-scenes",
    "Random scenes in the range of a statue: how often is an engine right, and is every wrong run reported?",
    plan,
    f"{__name__}.page",
)
