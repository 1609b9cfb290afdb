"""A kick in DART: all bodies, contacts included; where it then moves them is overwritten.

Loads are forces over the step: those of a kick are scaled by (h + h')/(2 h'), see `engines.pybullet.stepping`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..planar import Bodies

if TYPE_CHECKING:
    from analytic import Scene

    from .scene import Assembly


class DartBodies(Bodies):
    """The skeletons of block and ground."""

    def __init__(self, assembly: Assembly, scene: Scene, largest: float) -> None:
        super().__init__(scene, largest)
        self.world, self.skeleton, self.ground = assembly.world, assembly.block, assembly.ground
        self.body, self.used = assembly.base, 0.0

    def weigh(self, mass: float) -> None:
        """Give the base a mass [kg]."""
        self.body.setMass(mass)

    def kick(
        self, impulses: tuple[float, float, float, float], times: tuple[float, float, float], purpose: int
    ) -> tuple[float, float, float, float]:
        """Velocities that a kick leaves: see `Bodies.kick`."""
        (up, across, spin, load), step = impulses, times[0]
        if step != self.used:
            self.world.setTimeStep(step)
            self.used = step
        self.skeleton.setForces((up / step, across / step, spin / step))
        if self.body is not None:
            self.ground.setForces((load / step,))
        self.world.step()
        vz, vx, rate = self.skeleton.getVelocities().tolist()
        return vz, vx, rate, self.ground.getVelocity(0) if self.body is not None else 0.0

    def place(self, level: bool) -> None:
        """Move the block to where it is; the base's place does not matter."""
        block = self.block
        self.skeleton.setPositions((block.up, block.x, block.tilt))
