"""Solvers of the optional extra `peers`: heyoka, SUNDIALS CVODE (scikit-sundae), CyRK. Each only where installed."""

from __future__ import annotations

import importlib.util
import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from .solvers_scipy import block_constants, block_start

if TYPE_CHECKING:
    from .problems import Problem

PEERS = {"heyoka": "heyoka", "CVODE Adams": "sksundae", "CyRK DOP853": "CyRK"}
COOLDOWN = 1e-12  # s; heyoka's own choice drops the shortest hops silently


def installed() -> list[str]:
    """Names of the peers that can be imported here."""
    return [name for name, module in PEERS.items() if importlib.util.find_spec(module)]


def heyoka_run(problem: Problem, tolerance: float) -> Callable[[], tuple[Any, int]]:
    """Problem A or B by heyoka: one compiled system in flight under the pulse, one for free flight.

    Impacts are a callback in heyoka's own loop; the restart between them costs no return to Python.
    """
    import heyoka

    p2, gamma, e, omega, a, frequency = block_constants(problem)
    start, tilt0, rate0, side0, corners = block_start(problem)
    phi, w = heyoka.make_vars("phi", "w")
    angle = heyoka.par[0] * gamma - phi
    counted = [0]
    least = problem.rest_rate * omega

    def impact(system, _):
        state = system.state
        counted[0] += 1
        rate = e * state[1]
        state[0], state[1] = 0.0, rate
        system.pars[0] = -system.pars[0]
        return abs(rate) >= least

    def system(push):
        event = heyoka.t_event(
            heyoka.par[0] * phi, callback=impact, direction=heyoka.event_direction.negative, cooldown=COOLDOWN
        )
        return heyoka.taylor_adaptive(
            [(phi, w), (w, -p2 * (heyoka.sin(angle) + push))],
            [tilt0, rate0],
            pars=[side0],
            tol=tolerance,
            t_events=[event],
        )

    free = system(0.0)
    stages = []
    if corners:
        stages.append((system(a * heyoka.sin(frequency * heyoka.time) * heyoka.cos(angle)), corners[0]))
    stages += [(free, problem.horizon)]
    duration = problem.scene.duration

    def run():
        counted[0] = 0
        t, y, s = start, (tilt0, rate0), side0
        for stage, until in stages:
            stage.time = t
            stage.state[:] = y
            stage.pars[0] = s
            stage.reset_cooldowns()
            stage.propagate_until(until)
            t, y, s = until, stage.state, stage.pars[0]
        state = free.state.copy()
        if problem.horizon < duration:
            free.propagate_until(duration)
        return state, counted[0]

    return run


def cvode_run(problem: Problem, rtol: float) -> Callable[[], tuple[Any, int]]:
    """Problem A or B by SUNDIALS CVODE (Adams) with its root function; restarted at every impact."""
    from sksundae.cvode import CVODE

    p2, gamma, e, omega, a, frequency = block_constants(problem)
    start, tilt0, rate0, side0, corners = block_start(problem)
    stops = sorted({*corners, problem.horizon, problem.scene.duration})
    now = {"s": side0, "push": 0.0, "begin": start}

    def derivative(t, y, yp):
        tilt, rate = y.tolist()
        angle = now["s"] * gamma - tilt
        push = now["push"] * math.sin(frequency * t) * math.cos(angle) if now["push"] else 0.0
        yp[0], yp[1] = rate, -p2 * (math.sin(angle) + push)

    def impact(t, y, events):
        events[0] = now["s"] * y[0] / (t - now["begin"]) if t > now["begin"] else 1.0

    impact.terminal, impact.direction = [True], [-1]  # type: ignore[attr-defined]  # CVODE reads them there

    def run():
        t, y, impacts, state = start, np.array([tilt0, rate0]), 0, None
        now["s"] = side0
        solver = CVODE(
            derivative,
            method="Adams",
            rtol=rtol,
            atol=rtol * np.array([gamma, gamma * omega]),
            eventsfn=impact,
            num_events=1,
            max_num_steps=100000,
        )
        for stop in stops:
            now["push"] = a if corners and t < corners[0] else 0.0
            now["begin"] = t
            solver.init_step(t, y)
            while t < stop:
                step = solver.step(stop, tstop=stop)
                t, y = float(step.t), np.array(step.y)
                if step.status < 0:
                    return np.array([math.nan]), impacts
                if t < stop:
                    impacts += 1
                    y[0], y[1] = 0.0, e * y[1]
                    if abs(y[1]) < problem.rest_rate * omega:
                        return state, impacts
                    now["s"], now["begin"] = -now["s"], t
                    solver.init_step(t, y)
            if stop == problem.horizon:
                state = y.copy()
        return state, impacts

    return run


def cyrk_run(problem: Problem, rtol: float) -> Callable[[], tuple[Any, int]]:
    """Problem A or B by CyRK's compiled DOP853 with an event; restarted at every impact."""
    from CyRK import pysolve_ivp

    p2, gamma, e, omega, a, frequency = block_constants(problem)
    start, tilt0, rate0, side0, corners = block_start(problem)
    stops = sorted({*corners, problem.horizon, problem.scene.duration})
    atol = rtol * np.array([gamma, gamma * omega])
    now = {"s": side0, "begin": start}
    sin, cos = math.sin, math.cos

    def free(dy, t, y):
        dy[0] = y[1]
        dy[1] = -p2 * sin(now["s"] * gamma - y[0])

    def forced(dy, t, y):
        angle = now["s"] * gamma - y[0]
        dy[0] = y[1]
        dy[1] = -p2 * (sin(angle) + a * sin(frequency * t) * cos(angle))

    def impact(t, y):
        return now["s"] * y[0] / (t - now["begin"]) if t > now["begin"] else 1.0

    impact.terminal, impact.direction = 1, -1  # type: ignore[attr-defined]  # CyRK reads them there

    def run():
        t, y, impacts, state = start, np.array([tilt0, rate0]), 0, None
        now["s"] = side0
        for stop in stops:
            now["begin"] = t
            derivative = forced if corners and t < corners[0] else free
            while t < stop:
                result = pysolve_ivp(
                    derivative,
                    (t, stop),
                    y,
                    method="DOP853",
                    rtol=rtol,
                    atol=atol,
                    events=(impact,),
                    pass_dy_as_arg=True,
                )
                if not result.success:
                    return np.array([math.nan]), impacts
                t, y = float(result.t[-1]), result.y[:, -1].copy()
                if result.event_terminated:
                    impacts += 1
                    y[0], y[1] = 0.0, e * y[1]
                    if abs(y[1]) < problem.rest_rate * omega:
                        return state, impacts
                    now["s"], now["begin"] = -now["s"], t
            if stop == problem.horizon:
                state = y.copy()
        return state, impacts

    return run


RUNS = {"heyoka": heyoka_run, "CVODE Adams": cvode_run, "CyRK DOP853": cyrk_run}
