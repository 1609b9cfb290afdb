"""A kick in Chipmunk.

A call of Chipmunk first moves all bodies at their velocities, then finds contacts, then kicks: a kick stands between
the step before and the step after. Its loads are scaled by (h + h')/(2 h), as Chipmunk multiplies them by h, the step
before; h', the step after, is chosen first, from tilt and rate that the kick will find. The first call begins a step
before the start, on the way that leads to it, and kicks by half a step.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..pace import IMPACT, REST
from ..pivoting import DEPTH
from ..placement import placement
from ..planar import Bodies

if TYPE_CHECKING:
    from analytic import Scene

    from .scene import Assembly


class ChipmunkBodies(Bodies):
    """The block, and the wheel whose rim is the base."""

    least_viscous = 1e-5  # below it Chipmunk's corners pull

    def __init__(self, assembly: Assembly, scene: Scene, largest: float) -> None:
        super().__init__(scene, largest)
        self.space, self.body, self.wheel, self.radius = assembly.space, assembly.block, assembly.wheel, assembly.radius
        self.sweeps, self.used, self.close = assembly.sweeps, 0, DEPTH * self.model.gamma
        _, _, vx, vz = placement(scene)
        self.before = vz, vx, scene.start.tilt_rate

    def weigh(self, mass: float) -> None:
        """Give the base a mass [kg]."""
        self.wheel.moment = mass * self.radius**2

    def fit(self, step: float, purpose: int, h: float) -> tuple[float, int]:
        """With both corners in contact the step before again.

        Chipmunk begins with the impulses before, in proportion to the steps: where these change, what is too much of
        them pulls.
        """
        if -self.close < self.block.tilt < self.close and purpose != REST:
            return h or step, IMPACT
        return step, purpose

    def kick(
        self, impulses: tuple[float, float, float, float], times: tuple[float, float, float], purpose: int
    ) -> tuple[float, float, float, float]:
        """Velocities that a kick leaves: see `Bodies.kick`."""
        (up, across, spin, load), (step, h, _) = impulses, times
        body, block, call, (vz, vx, rate) = self.body, self.block, h or step, self.before
        if self.sweeps[purpose] != self.used:
            self.space.iterations = self.used = self.sweeps[purpose]
        body.force = across / call, up / call
        body.torque = -spin / call
        body.position = block.x - vx * call, block.up - vz * call
        if self.wheel is not None:
            self.wheel.torque = -load / call * self.radius
            self.wheel.angle = self.base.v / self.radius * call  # and 0 after the call's way
        if not h:
            body.angle = rate * call - block.tilt
        self.space.step(call)
        (vx, vz), rate = body.velocity, -body.angular_velocity
        self.before = vz, vx, rate
        return vz, vx, rate, -self.radius * self.wheel.angular_velocity if self.wheel is not None else 0.0

    def place(self, level: bool) -> None:
        """Level the block where it was put on both corners; else it is placed before each kick."""
        if level:
            self.body.angle = 0.0
