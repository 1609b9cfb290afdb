"""Problems A and B: a block alone, that every integrator solves, with references of 30 digits."""

import math
from dataclasses import dataclass
from typing import Any

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


def _problem(scene: Scene, rest: float, **known: Any) -> Problem:
    """rest: rest_rate over omega_r; known: what the scene does not say."""
    model, omega, pulse = RockingModel.of(scene), scene.rocking_frequency, scene.motion
    if pulse is None:
        a, frequency, pulse_end, begin, side = 0.0, 0.0, 0.0, 0.0, math.copysign(1.0, scene.start.tilt)
    else:  # it lifts where the pulse first reaches g tan(gamma), to the left
        a, frequency, pulse_end, side = pulse.amplitude / scene.gravity, pulse.frequency, pulse.end, -1.0
        begin = math.asin(1 / (pulse.amplitude / (scene.gravity * math.tan(scene.block.slenderness)))) / frequency
    return Problem(
        scene=scene, rest_rate=rest * omega, p2=omega**2, gamma=model.gamma, restitution=model.restitution, a=a,
        frequency=frequency, begin=begin, tilt=scene.start.tilt, side=side, pulse_end=pulse_end, **known,
    )  # fmt: skip


A = dict(horizon=7.0, impacts=10, reference=0.01588089793859602683756374)
B = dict(horizon=6.0, impacts=81, reference=0.01186179747282689895957273)
SOLVED = _problem(problem_a(duration=7.0), REST_RATE, **A), _problem(problem_b(duration=9.2), 1e-4, **B)
PROBLEMS = {problem.scene.name: problem for problem in SOLVED}
