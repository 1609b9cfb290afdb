"""Scaling of times with the size of the block."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from analytic import Scene

UNIT_RADIUS = 1.0884  # m, of the Caryatid, for which the variants' times are given


def size_scale(scene: Scene) -> float:
    """Factor on times that are set for a block of `UNIT_RADIUS`: rocking scales with sqrt(R/g)."""
    return math.sqrt(scene.block.radius / UNIT_RADIUS)
