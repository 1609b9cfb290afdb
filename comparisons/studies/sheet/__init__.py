"""The problem sheet solved by every engine and variant: what ``rocking score`` ranks other codes beside."""

from ...running.plan import Study
from .study import plan

STUDY = Study(
    "sheet", "The problem sheet in every engine: what rocking score ranks other codes beside.", plan, f"{__name__}.page"
)
