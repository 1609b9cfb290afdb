"""One impact in every engine, taken apart: whose impulse was wrong, and what for?"""

from ...running.study import Study
from .cases import plan
from .page import draw, finding, section

STUDY = Study(
    "autopsy",
    "One impact in every engine and variant, as the contact's own story: the parts of its error and their cause.",
    plan,
    lambda result: {"": draw(result)},
    section,
    finding=finding,
)
