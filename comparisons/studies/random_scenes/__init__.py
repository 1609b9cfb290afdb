"""Random scenes within the range of a statue: how often is an engine right, and is every wrong run told?"""

from ...running.study import Study
from .page import finding, judgement, section
from .study import plan

STUDY = Study(
    "random-scenes",
    "Random scenes in the range of a statue: how often is an engine right, and is every wrong run told?",
    plan,
    lambda result: {},
    section,
    finding=finding,
    judgement=judgement,
)
