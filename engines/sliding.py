"""The base on its bearings between two kicks of a leapfrog engine: its loads and its way."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from analytic.bearing import BearingLaw

from .vibration import added_mass, driven_mass, leapfrog_stiffness

if TYPE_CHECKING:
    from analytic import Scene
    from analytic.rocking import RockingModel


class SlidingBase:
    """x [m], v [m/s], hysteretic force z of one bearing [N] and the force of all [N]. All zeros on rigid ground.

    weigh: gives the engine's body a mass [kg].
    """

    def __init__(self, scene: Scene, model: RockingModel, largest: float, weigh: Callable[[float], None]) -> None:
        self.weigh = weigh
        self.law, self.mass, self.driven = BearingLaw.of(scene.bearings), model.M - model.m, driven_mass(model)
        self.damping = self.law.count * self.law.damping
        self.heavier = leapfrog_stiffness(self.law, largest, self.driven)
        self.held = self.lagged = 0.0
        self.x, self.v = scene.start.base_displacement, scene.start.base_velocity
        self.z = self.law.start(self.x)
        self.force = self.law.force(self.x, self.z)

    def impulse(self, interval: float, pushed: float, lag: float) -> float:
        """Impulse [N s] on the base in a kick of `interval` [s].

        pushed: gain of velocity from the ground's motion [m/s]; lag: of `pivoting.Block.lag`.
        """
        if interval != self.held and (self.damping or self.heavier):
            self.held = interval
            added = added_mass(self.damping, interval, self.driven) + self.heavier * interval * interval
            self.weigh(self.mass + added)
        impulse = self.mass * pushed + lag - self.lagged - (self.force + self.damping * self.v) * interval
        self.lagged = lag
        return impulse

    def follow(self, v: float, step: float) -> None:
        """Move for a step [s] at the velocity [m/s] that a kick left; the bearings follow."""
        self.v = v
        self.x += v * step
        if self.law.count:
            self.z = self.law.hysteretic(self.z, v * step)
            self.force = self.law.force(self.x, self.z)
