"""The block's way between two kicks, for engines whose own way is along the tangent: they move bodies straight on.

Their contacts hold velocities where the kick is, at the step's beginning; leapfrog has them in its middle.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from .pace import FLAT, least_pull
from .placement import placement

if TYPE_CHECKING:
    from analytic import Scene
    from analytic.rocking import RockingModel

# Depth of a pivoting or standing corner, in shares of gamma^2 R: round-off does not part it from the ground, and the
# other one lands at a tilt of DEPTH/2 gamma, well below what counts as flat contact.
DEPTH = 1e-7
# Speed at which the lower corner may leave the ground and still counts as in contact, over that gained in free fall.
LIFTING = 1e-3
# Tilt rate below which a block on both corners is put level, over the rate of a swing that does not matter. Iterations
# and landings leave it tilted by up to 1e-6 of gamma, or let it creep until a corner loses contact.
CALM = 1e-2


def depth(scene: Scene) -> float:
    """Depth of a corner on the ground [m]."""
    return DEPTH * scene.block.slenderness**2 * scene.block.radius


class Block:
    """Where the block is: x and height of its centre in the ground's frame [m], tilt [rad]."""

    __slots__ = ("R", "gamma", "m", "height", "sink", "lifting", "calm", "x", "up", "tilt", "side", "n", "c", "turned")

    def __init__(self, scene: Scene, model: RockingModel) -> None:
        self.R, self.gamma, self.m, self.height = model.R, model.gamma, model.m, scene.block.half_height
        self.sink, self.lifting = depth(scene), LIFTING * model.g
        self.calm = CALM * math.sqrt(2 * least_pull(model) * FLAT * model.gamma)
        across, up, _, _ = placement(scene)
        self.x, self.up, self.tilt, self.turned = across, up + self.height - self.sink, scene.start.tilt, 0.0
        self.side = math.copysign(1.0, scene.start.tilt or scene.start.tilt_rate)
        self._lever()

    def _lever(self) -> None:
        angle = self.side * self.gamma - self.tilt
        self.n, self.c = self.R * math.sin(angle), self.R * math.cos(angle)

    def move(self, rate: float, vx: float, vz: float, step: float, interval: float, resting: bool) -> bool:
        """Move by a step [s] at velocities that a kick of `interval` [s] left; True where the block is put level.

        On a corner the centre moves on an arc: along its tangent the corner would lift out of contact in every step. A
        corner that landed too deep is raised to where it started, but not at rest, where the other would be lifted.
        """
        n, c, turned = self.n, self.c, rate * step
        free, flat = self.up > c or vz - n * rate > self.lifting * interval, resting and self._higher() <= 0.0
        self.turned = 0.0
        if flat and not free and abs(rate) < self.calm:
            self.x += vx * step
            self.tilt, self.up = 0.0, self.height - self.sink
            self._lever()
            return True
        self.tilt += turned
        self._lever()
        if free or flat:
            self.x += vx * step
            self.up += vz * step
        else:
            self.x += n - self.n + (vx - c * rate) * step
            self.up = self.up + self.c - c if resting else self.c - self.sink
            self.turned = turned
        if self.tilt * self.side < 0.0:
            self.side = -self.side
            self._lever()
        return False

    def _higher(self) -> float:
        """Height of the higher corner [m]."""
        return self.up - self.R * math.cos(-self.side * self.gamma - self.tilt)

    def lost_spin(self, rate: float) -> float:
        """Angular momentum [N m s] that a kick takes from a block which the step before turned about its corner.

        It arrives with the momentum of the angle before, which the engine holds against the lever of the angle now.
        """
        return self.m * self.R * self.R * (1.0 - math.cos(self.turned)) * rate

    def lag(self, rate: float, step: float) -> float:
        """Horizontal momentum [N s] that the block has at the beginning of a step, less that in its middle.

        Leapfrog's velocities belong to the middle, the engine's contacts hold at the beginning.
        """
        middle = self.side * self.gamma - self.tilt - 0.5 * rate * step
        return self.m * rate * (self.c - self.R * math.cos(middle))
