"""Initial position and velocity of the block, the same for every engine."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from analytic import Scene


def placement(scene: Scene) -> tuple[float, float, float, float]:
    """Centre of the block and its velocity at the start: (x, z [m], x', z' [m/s]), z from its standing height.

    The block pivots about its lower corner on a base with the start's displacement and velocity.
    """
    start, block = scene.start, scene.block
    s = math.copysign(1.0, start.tilt or start.tilt_rate)
    angle = s * block.slenderness - start.tilt
    c, n = block.radius * math.cos(angle), block.radius * math.sin(angle)
    return (
        start.base_displacement + s * block.half_width - n,
        c - block.half_height,
        start.base_velocity + c * start.tilt_rate,
        n * start.tilt_rate,
    )
