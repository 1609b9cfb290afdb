"""The equations of rocking.py as a system of ordinary differential equations, with its state."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from ..response import State
from ..rocking import RockingModel

if TYPE_CHECKING:
    from ..scene import Scene
    from ..types import GroundFunction


class Equations:
    """The state y and its derivative. y = [tilt, rate], on a base also x, v and z if integrated, then energy terms.

    t [s]; side of the pivot, 0 in full contact; scale of each component of y; max_step: longest step [s] for the
    bearings.
    """

    vertical: Callable[[float], float]  # a_v(t) [m/s2] of the segment

    def __init__(self, scene: Scene, energy: bool) -> None:
        self.scene, self.energy = scene, energy
        self.model = model = RockingModel.of(scene)
        self.law, self.omega_r = model.bearing, scene.rocking_frequency
        start, length = scene.start, model.R * model.gamma
        y, scale = [start.tilt, start.tilt_rate], [model.gamma, model.gamma * self.omega_r]
        self.x_c, self.z_c = start.base_displacement, self.law.start(start.base_displacement)
        self.max_step = math.inf
        if model.on_base:
            y += [start.base_displacement, start.base_velocity]
            scale += [length, length * self.omega_r]
            stiffness = self.law.count * (self.law.kb + self.law.dk)
            if stiffness > 0:
                self.max_step = 0.5 * math.sqrt(model.M / stiffness)
            if self.law.unit.branch:
                y.append(self.z_c)
                scale.append(self.law.f0)
        if energy:
            extra = 3 if model.on_base else 1
            y += [0.0] * extra
            scale += [model.m * model.g * length * model.gamma] * extra
        self.y, self.scale, self.t = np.array(y), np.array(scale), 0.0
        self.side = math.copysign(1.0, start.tilt or start.tilt_rate) if start.tilt or start.tilt_rate else 0.0

    def contact_acceleration(self, y: np.ndarray, ground: float) -> float:
        """Absolute acceleration of the base in full contact [m/s2], eq. (2)."""
        if not self.model.on_base:
            return ground
        return self.model.contact_acceleration(self.bearing_force(y))

    def derivative(self, ground: GroundFunction, direction: float) -> Callable[[float, np.ndarray], np.ndarray]:
        model, law, side, energy, vertical = self.model, self.law, self.side, self.energy, self.vertical
        branch = law.unit.branch and law.unit.branch(self.hysteretic_force(self.y), direction, law.constants)
        if not model.on_base:

            def block_alone(t, y):
                a, up, rate = ground(t), vertical(t), y[1]
                slope = (rate, model.accelerations(side, y[0], rate, a, 0.0, up)[0])
                if not energy:
                    return slope
                c, n = model.lever(side, y[0])
                return (*slope, -model.m * (a * c + up * n) * rate)

            return block_alone

        def block_on_base(t, y):
            a, up, (tilt, rate, x, v) = ground(t), vertical(t), y[:4].tolist()
            z = self.hysteretic_force(y)
            force = law.force(x, z, v)
            if side:
                spin, push = model.accelerations(side, tilt, rate, a, force, up)
            else:
                spin, push = 0.0, model.contact_acceleration(force) - a
            slope = [rate, spin, v, push]
            if branch:
                slope.append(branch(z, v))
            if energy:
                c, n = model.lever(side, tilt) if side else (0.0, 0.0)
                work = -a * (model.M * v + model.m * c * rate) - up * model.m * n * rate
                slope += [work, law.count * z * v, law.count * law.damping * v * v]
            return slope

        return block_on_base

    def hysteretic_force(self, y: np.ndarray) -> float:
        """z of one bearing [N]: from the state, or in closed form from the last reversal."""
        return float(y[4]) if self.law.unit.branch else self.law.hysteretic(self.z_c, float(y[2]) - self.x_c)

    def bearing_force(self, y: np.ndarray) -> float:
        return self.law.force(float(y[2]), self.hysteretic_force(y), float(y[3])) if self.model.on_base else 0.0

    def fix_history(self) -> None:
        """Store the point of reversal, the memory of the bearing."""
        if self.model.on_base:
            self.z_c, self.x_c = self.hysteretic_force(self.y), float(self.y[2])

    def energies(self) -> tuple[float, float]:
        """(kinetic, potential) [J], see `RockingModel`."""
        model, (tilt, rate, *base) = self.model, self.y[:4].tolist()
        x, v = base if model.on_base else (0.0, 0.0)
        return model.kinetic_energy(self.side, tilt, rate, v), model.potential_energy(self.side, tilt, x)

    def state(self) -> State:
        x, v = (float(self.y[2]), float(self.y[3])) if self.model.on_base else (0.0, 0.0)
        return State(self.t, float(self.y[0]), float(self.y[1]), x, v, self.bearing_force(self.y))
