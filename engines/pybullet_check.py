"""Whether the block is where a rocking block can be: neither slid, nor sunk, nor thrown."""

import numpy as np

from analytic.response import Failure

# Sliding and height of the lower corner [share of R] that end a run as failed.
SLIDING_TOLERANCE, HEIGHT_TOLERANCE = 0.03, 2e-3


def check_place(scene, x, z, tilt, base):
    """A `Failure` where the block slid on its base, sank into it or left it, else None.

    x, z : centre of the block [m] from the ground's origin, z from its standing height; base : base displacement [m].
    """
    block, R, gamma = scene.block, scene.block.radius, scene.block.slenderness
    s = -1.0 if tilt < 0 else 1.0
    slid = x - base - (s * block.half_width - R * np.sin(s * gamma - tilt))
    height = z - (R * np.cos(s * gamma - tilt) - block.half_height)
    if abs(slid) > SLIDING_TOLERANCE * R:
        return Failure("the block slid on its base", f"by {slid:.6g} m; tolerated: {SLIDING_TOLERANCE * R:.3g} m")
    if abs(height) > HEIGHT_TOLERANCE * R:
        word = "sank into" if height < 0 else "left"
        return Failure(f"the block {word} its base", f"lower corner at {height:.6g} m; "
                       f"tolerated: {HEIGHT_TOLERANCE * R:.3g} m")
    return None
