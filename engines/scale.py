"""Times that go with the size of the block."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from analytic import Scene

UNIT_RADIUS = 1.0884  # m, of the Caryatid, for which the variants' times are given


def size_scale(scene: Scene) -> float:
    """What times set for a block of `UNIT_RADIUS` are multiplied with: rocking goes with sqrt(R/g)."""
    return math.sqrt(scene.block.radius / UNIT_RADIUS)
