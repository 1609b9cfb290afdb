"""A kick in Drake.

An update of Drake's plant kicks all bodies, contacts included; what it would then move them by is left aside, as the
plant's step is not ours (see `scene`). Loads are impulses over that step.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from ..planar import Bodies, NoSolution
from .scene import STICTION, start_of

if TYPE_CHECKING:
    from analytic import Scene

    from .scene import Assembly

SLIP = 1.1  # slip of a corner that slides, over the most of one that sticks


def said(error: RuntimeError) -> str:
    """How a run ends by an error of Drake, without the time, which is not ours."""
    return f"Drake found no solution of a step: {str(error).partition(' at simulation time')[0]}"


class DrakeBodies(Bodies):
    """The bodies of one plant or two."""

    contact = 1e-5  # a block that stands under a motion lifts by up to 7e-6 of gamma: its corners yield

    def __init__(self, assembly: Assembly, scene: Scene, largest: float) -> None:
        super().__init__(scene, largest)
        self.contacts, self.holding = assembly.contacts, assembly.holding
        self.bases = [(one.base, one.context) for one in (self.contacts, self.holding) if one]
        self.state = start_of(scene)
        self.count = len(self.state) // 2
        self.loads = np.zeros(self.count)
        self.slip = SLIP * STICTION * math.sqrt(self.model.R * self.model.g)

    def weigh(self, mass: float) -> None:
        """Give the base a mass [kg]."""
        for body, context in self.bases:
            body.SetMass(context, mass)

    def kick(
        self, impulses: tuple[float, float, float, float], times: tuple[float, float, float], purpose: int
    ) -> tuple[float, float, float, float]:
        """Velocities that a kick leaves: see `Bodies.kick`."""
        self.loads[:] = impulses[: self.count]
        try:
            velocities = self._kicked(times[2])
        except RuntimeError as error:
            raise NoSolution(said(error)) from error
        self.state[self.count :] = velocities
        vz, vx, rate, *v = velocities
        return vz, vx, rate, v[0] if v else 0.0

    def _kicked(self, interval):
        """Velocities after the loads; those of `holding` where the lower corner would slide faster than `slip`."""
        block = self.block
        try:
            velocities = self.contacts.kick(self.state, self.loads)
            vz, vx, rate, *v = velocities
            slides = abs(vx - block.c * rate - sum(v)) > self.slip and vz - block.n * rate <= block.lifting * interval
            if not (self.holding and slides):
                return velocities
        except RuntimeError:
            if not self.holding:
                raise
        return self.holding.kick(self.state, self.loads)

    def place(self, level: bool) -> None:
        """Move the bodies to where they are."""
        block = self.block
        self.state[:3] = block.up, block.x, block.tilt
        if self.count > 3:
            self.state[3] = self.base.x
