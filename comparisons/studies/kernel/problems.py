"""Problems A and B: a block alone, that every integrator solves, with references of 30 digits."""

from __future__ import annotations

import math
from dataclasses import dataclass

from analytic import Scene
from analytic.problems import problem_a, problem_b
from analytic.rocking import RockingModel
from analytic.solver import REST_RATE


@dataclass(frozen=True)
class Problem:
    """phi'' = -p2 (sin(s gamma - phi) + a sin(frequency t) cos(s gamma - phi)); s is the side, + or -1.

    It moves from `begin` [s] on, with `tilt` [rad] and no velocity; at an impact the velocity is multiplied by
    `restitution`, and the block rests when less than `rest_rate` [rad/s] is left. a = 0 without a pulse, or after
    `pulse_end` [s].

    reference: |tilt| [rad] at `horizon` [s]. impacts: how many there are to the scene's duration.
    """

    scene: Scene
    horizon: float
    rest_rate: float
    impacts: int
    reference: float
    p2: float
    gamma: float
    restitution: float
    a: float
    frequency: float
    begin: float
    tilt: float
    side: float
    pulse_end: float

    @property
    def stops(self) -> list[float]:
        """Times [s] where an integrator has to stop: the pulse's end, the horizon, the end."""
        return sorted({self.pulse_end, self.horizon, self.scene.duration} - {0.0})

    def error(self, tilt: float) -> float:
        """Of a tilt [rad] at the horizon, over the slenderness [-]."""
        return abs(abs(tilt) - self.reference) / self.gamma


def _problem(
    scene: Scene, horizon: float, rest: float, impacts: int, reference: float, begin: float, side: float
) -> Problem:
    """rest: rest_rate over omega_r."""
    model, omega, pulse = RockingModel.of(scene), scene.rocking_frequency, scene.motion
    forced = (pulse.amplitude / scene.gravity, pulse.frequency, pulse.end) if pulse else (0.0, 0.0, 0.0)
    a, frequency, pulse_end = forced
    return Problem(
        scene,
        horizon,
        rest * omega,
        impacts,
        reference,
        omega**2,
        model.gamma,
        model.restitution,
        a,
        frequency,
        begin,
        scene.start.tilt,
        side,
        pulse_end,
    )


def _problems():
    a, b = problem_a(duration=7.0), problem_b(duration=9.2)
    ratio = b.motion.amplitude / (b.gravity * math.tan(b.block.slenderness))
    lifts = math.asin(1 / ratio) / b.motion.frequency  # s, to the left
    return (
        _problem(a, 7.0, REST_RATE, 10, 0.01588089793859602683756374, 0.0, math.copysign(1.0, a.start.tilt)),
        _problem(b, 6.0, 1e-4, 81, 0.01186179747282689895957273, lifts, -1.0),
    )


PROBLEMS = {problem.scene.name: problem for problem in _problems()}
