"""Chosen numbers of impact-aware and their meaning, for `engines.contract.Variant.constants`."""

from ..stepping import CONSTANTS as STEPS

HERE = "engines.pybullet.scene"
CONSTANTS = {
    **STEPS,
    f"{HERE}:FRICTION": "coefficient where the scene gives none",
    f"{HERE}:CORNER_RADIUS": "radius of the corners' spheres, over R",
    f"{HERE}:ROCKING_REST": "relative residual of the contact solver's impulses on one corner",
    f"{HERE}:STANDING_REST": "the same on two corners",
    f"{HERE}:MOST_ITERATIONS": "iterations of the contact solver, at most",
}
