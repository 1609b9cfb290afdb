"""How far off are restitution and the base velocity jump, where, why, at what cost?"""

from ...running.study import Study
from .figures import figures
from .finding import finding
from .page import section_of
from .summary import plan

STUDY = Study(
    "restitution",
    "Error of restitution and base velocity jump over slenderness, base mass and accuracy setting, with its cost.",
    plan,
    figures,
    section_of,
    finding=finding,
)
