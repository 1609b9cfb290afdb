"""scipy's `solve_ivp` with events, set up by someone who wants it fast.

No classes, floats instead of arrays in the right-hand side, the smallest set of events, a first step taken from the
length of the coming hop. The readable set-up, the one to learn from, is `analytic.twin`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.integrate import solve_ivp

from analytic.bearing import BearingLaw
from analytic.motion import SampledMotion
from analytic.rocking import RockingModel
from analytic.twin import simulate_twin
from analytic.twin.run import Event

if TYPE_CHECKING:
    from .problems import Problem

METHODS = ("RK45", "DOP853", "LSODA", "Radau")
SHORT_HOP = 0.3  # in units of 1/omega_r: below it, the first step is the whole hop


def block_start(problem: Problem) -> tuple[float, float, float, float, list[float]]:
    """(time, tilt, tilt rate, side, corners of the motion) from which the block of A or B moves; exact."""
    scene = problem.scene
    if scene.motion is None:
        return 0.0, scene.start.tilt, 0.0, math.copysign(1.0, scene.start.tilt), []
    ratio = scene.motion.amplitude / (scene.gravity * math.tan(scene.block.slenderness))
    return math.asin(1 / ratio) / scene.motion.frequency, 0.0, 0.0, -1.0, [scene.motion.end]


def block_constants(problem: Problem) -> tuple[float, float, float, float, float, float]:
    """omega_r^2, slenderness, restitution, omega_r of the block of A or B; its pulse's amplitude over g and frequency.

    Floats; amplitude and frequency are 0 without a pulse.
    """
    scene, model = problem.scene, RockingModel.of(problem.scene)
    omega, pulse = scene.rocking_frequency, scene.motion
    a, frequency = (pulse.amplitude / scene.gravity, pulse.frequency) if pulse else (0.0, 0.0)
    return omega**2, model.gamma, model.restitution, omega, a, frequency


def block_run(problem: Problem, method: str, rtol: float) -> Callable[[], tuple[Any, int]]:
    """A function that runs problem A or B and returns (state at the horizon, impacts)."""
    p2, gamma, e, omega, a, frequency = block_constants(problem)
    start, tilt0, rate0, side0, corners = block_start(problem)
    stops = sorted({*corners, problem.horizon, problem.scene.duration})
    atol = rtol * np.array([gamma, gamma * omega])
    sin, cos = math.sin, math.cos

    def free(s):
        def derivative(t, y):
            phi, w = y.tolist()
            return w, -p2 * sin(s * gamma - phi)

        return derivative

    def forced(s):
        def derivative(t, y):
            phi, w = y.tolist()
            angle = s * gamma - phi
            return w, -p2 * (sin(angle) + a * sin(frequency * t) * cos(angle))

        return derivative

    def run():
        t, y, s, impacts, state, first = start, (tilt0, rate0), side0, 0, None, None
        for stop in stops:
            pushed = corners and t < corners[0]
            while t < stop:
                begin, side = t, s

                def impact(now, z):  # the root at take-off is divided out
                    return side * z[0] / (now - begin) if now > begin else 1.0  # noqa: B023

                step = {"first_step": min(first, stop - t)} if first else {}
                solution = solve_ivp(
                    (forced if pushed else free)(s),
                    (t, stop),
                    y,
                    method,
                    events=Event(impact),
                    rtol=rtol,
                    atol=atol,
                    **step,
                )
                if solution.status < 0:
                    return np.array([math.nan]), impacts
                t, (phi, w) = float(solution.t[-1]), solution.y[:, -1].tolist()
                y, first = (phi, w), None
                if solution.status == 1:
                    impacts, w, s = impacts + 1, e * w, -s
                    y = (0.0, w)
                    if abs(w) < problem.rest_rate * omega:
                        return state, impacts
                    push = a * sin(frequency * t) * cos(gamma) if pushed else 0.0
                    hop = 2 * abs(w) / (p2 * (sin(gamma) + s * push))
                    first = 1.1 * hop if 0 < hop * omega < SHORT_HOP else None
            if stop == problem.horizon:
                state = np.array(y)
        return state, impacts

    return run


def twin_run(problem: Problem, method: str, rtol: float) -> Callable[[], tuple[Any, int]]:
    """A function that runs a problem under a record with the readable twin: a restart, at best a step, per sample."""
    longest = problem.scene.motion.dt  # half the twin's own cost; whether a hop is missed the count of impacts tells

    def run():
        response = simulate_twin(
            problem.scene,
            method=method,
            rtol=rtol,
            history=False,
            energy=False,
            max_step=longest,
            rest_rate=problem.rest_rate,
        )
        end = response.end
        return (np.array([end.tilt, end.tilt_rate, end.base_displacement, end.base_velocity]), len(response.impacts))

    return run


def contact_run(problem: Problem, method: str, rtol: float) -> Callable[[], tuple[Any, int]]:
    """A function that runs a block which never lifts, under a record: a stop at reversals of the base only.

    The record's corners are left to the error control, which is cheaper than a restart at each of them.
    """
    scene, model, law = problem.scene, RockingModel.of(problem.scene), BearingLaw.of(problem.scene.bearings)
    if not isinstance(scene.motion, SampledMotion):
        raise ValueError(f"{scene.name}: needs a sampled motion")
    samples, dt, duration = scene.motion.samples.tolist(), scene.motion.dt, scene.duration
    ground = _ground(scene.motion)
    count, kb, dk, alpha, d0, f0, M = law.count, law.kb, law.dk, law.alpha, law.d0, law.f0, model.M
    threshold, length, power = model.uplift_acceleration, model.R * model.gamma, 1 - law.alpha
    atol = rtol * np.array([length, length * scene.rocking_frequency])

    def run():
        t, y, z_c, direction = 0.0, (0.0, 0.0), 0.0, 0.0
        first = next(i for i, sample in enumerate(samples) if sample)
        t = max(0, first - 1) * dt
        direction = -math.copysign(1.0, samples[first])
        while t < duration:
            x_c, s, begin = y[0], direction, t
            travel = max(d0, d0 + (1 - alpha) * (s * z_c - f0) / dk) ** (1 / (1 - alpha))

            def force(x):
                bracket = max(travel + s * (x - x_c), 1e-9)  # noqa: B023  trial points may lie behind the reversal
                return count * (kb * x + s * (dk * (bracket**power - d0) / power + f0))  # noqa: B023

            def derivative(now, state):
                x, v = state.tolist()
                return v, -force(x) / M - ground(now)  # noqa: B023

            def reversal(now, state):
                return s * state[1] if now > begin else 1.0  # noqa: B023

            def uplift(now, state):
                return threshold - abs(force(state[0])) / M  # noqa: B023

            solution = solve_ivp(
                derivative,
                (t, duration),
                y,
                method,
                events=(Event(reversal), Event(uplift, direction=0)),
                rtol=rtol,
                atol=atol,
                first_step=min(dt, duration - t),
            )
            if solution.status < 0 or len(solution.t_events[1]):
                return np.full(4, math.nan), -1
            t, (x, v) = float(solution.t[-1]), solution.y[:, -1].tolist()
            z_c = force(x) / count - kb * x
            y, direction = (x, 0.0 if solution.status == 1 else v), -direction
        return np.array([0.0, 0.0, *y]), 0

    return run


def _ground(motion):
    """The ground's acceleration [m/s2] as a function of one time [s], without arrays."""
    samples, dt, over = motion.samples.tolist(), motion.dt, motion.end
    last = len(samples) - 2

    def ground(t):
        if t > over:
            return 0.0
        i = min(int(t / dt), last)
        return samples[i] + (samples[i + 1] - samples[i]) * (t / dt - i)

    return ground
