"""How far off are restitution and the base velocity jump, where, why, at what cost?"""

from ...running.plan import Study
from .study import plan

STUDY = Study(
    "restitution",
    "Error of restitution and base velocity jump over slenderness, base mass and level, with its cost.",
    plan,
    f"{__name__}.page",
)
