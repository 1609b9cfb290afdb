"""One impact in every engine, taken apart: whose impulse was wrong, and what for?"""

from ...running.plan import Study
from .study import plan

STUDY = Study(
    "autopsy",
    "One impact in every engine and variant, taken apart: the parts of its error and their cause.",
    plan,
    f"{__name__}.page",
)
