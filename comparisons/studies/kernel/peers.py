"""Integrators of the optional extra `peers`: heyoka, SUNDIALS CVODE (scikit-sundae), CyRK; each where installed."""

from __future__ import annotations

import math
from collections.abc import Callable
from importlib.metadata import version
from importlib.util import find_spec
from typing import TYPE_CHECKING

import numpy as np

from .integrators import restarted

if TYPE_CHECKING:
    from .problems import Problem

COOLDOWN = 1e-12  # s; heyoka's own choice drops the shortest hops silently


def heyoka_run(problem: Problem, tolerance: float) -> Callable[[], tuple[float, int]]:
    """One compiled system in flight under the pulse, one for free flight.

    Impacts are a callback in heyoka's own loop; the restart between them costs no return to Python.
    """
    import heyoka

    p2, gamma, e, a, frequency = problem.p2, problem.gamma, problem.restitution, problem.a, problem.frequency
    phi, w = heyoka.make_vars("phi", "w")
    angle = heyoka.par[0] * gamma - phi
    counted = [0]

    def impact(system, _):
        counted[0] += 1
        system.state[:] = 0.0, e * system.state[1]
        system.pars[0] = -system.pars[0]
        return abs(system.state[1]) >= problem.rest_rate

    def system(push):
        event = heyoka.t_event(
            heyoka.par[0] * phi, callback=impact, direction=heyoka.event_direction.negative, cooldown=COOLDOWN
        )
        equations = [(phi, w), (w, -p2 * (heyoka.sin(angle) + push))]
        return heyoka.taylor_adaptive(equations, [0.0, 0.0], pars=[1.0], tol=tolerance, t_events=[event])

    free = system(0.0)
    stages = [(free, problem.horizon)]
    if a:
        forced = system(a * heyoka.sin(frequency * heyoka.time) * heyoka.cos(angle))
        stages.insert(0, (forced, problem.pulse_end))
    duration = problem.scene.duration

    def run():
        counted[0] = 0
        t, y, side = problem.begin, (problem.tilt, 0.0), problem.side
        for stage, until in stages:
            stage.time = t
            stage.state[:] = y
            stage.pars[0] = side
            stage.reset_cooldowns()
            stage.propagate_until(until)
            t, y, side = until, stage.state, stage.pars[0]
        tilt = float(free.state[0])
        if problem.horizon < duration:
            free.propagate_until(duration)
        return tilt, counted[0]

    return run


def cvode_run(problem: Problem, rtol: float) -> Callable[[], tuple[float, int]]:
    """SUNDIALS CVODE (Adams) with its root function; restarted at every impact."""
    from sksundae.cvode import CVODE

    p2, gamma, a, frequency = problem.p2, problem.gamma, problem.a, problem.frequency
    now = {"side": 1.0, "push": 0.0, "begin": 0.0}

    def derivative(t, y, yp):
        tilt, rate = y.tolist()
        angle = now["side"] * gamma - tilt
        push = now["push"] * math.sin(frequency * t) * math.cos(angle) if now["push"] else 0.0
        yp[0], yp[1] = rate, -p2 * (math.sin(angle) + push)

    def impact(t, y, events):
        events[0] = now["side"] * y[0] / (t - now["begin"]) if t > now["begin"] else 1.0

    impact.terminal, impact.direction = [True], [-1]  # type: ignore[attr-defined]  # CVODE reads them there
    atol = rtol * np.array([gamma, gamma * math.sqrt(p2)])
    solver = CVODE(
        derivative, method="Adams", rtol=rtol, atol=atol, eventsfn=impact, num_events=1, max_num_steps=100000
    )

    def fly(begin, stop, tilt, rate, side, pushed):
        now.update(side=side, push=a if pushed else 0.0, begin=begin)
        solver.init_step(begin, np.array([tilt, rate]))
        step = solver.step(stop, tstop=stop)
        if step.status < 0:
            raise RuntimeError(step.message)
        return float(step.t), *step.y.tolist(), step.t < stop

    return restarted(problem, fly)


def cyrk_run(problem: Problem, rtol: float) -> Callable[[], tuple[float, int]]:
    """CyRK's compiled DOP853 with an event; restarted at every impact."""
    from CyRK import pysolve_ivp

    p2, gamma, a, frequency = problem.p2, problem.gamma, problem.a, problem.frequency
    atol = rtol * np.array([gamma, gamma * math.sqrt(p2)])
    now = {"side": 1.0, "begin": 0.0}
    sin, cos = math.sin, math.cos

    def free(dy, t, y):
        dy[0] = y[1]
        dy[1] = -p2 * sin(now["side"] * gamma - y[0])

    def forced(dy, t, y):
        angle = now["side"] * gamma - y[0]
        dy[0] = y[1]
        dy[1] = -p2 * (sin(angle) + a * sin(frequency * t) * cos(angle))

    def impact(t, y):
        return now["side"] * y[0] / (t - now["begin"]) if t > now["begin"] else 1.0

    impact.terminal, impact.direction = 1, -1  # type: ignore[attr-defined]  # CyRK reads them there
    settings = dict(method="DOP853", rtol=rtol, atol=atol, events=(impact,), pass_dy_as_arg=True)

    def fly(begin, stop, tilt, rate, side, pushed):
        now.update(side=side, begin=begin)
        result = pysolve_ivp(forced if pushed else free, (begin, stop), np.array([tilt, rate]), **settings)
        if not result.success:
            raise RuntimeError(result.message)
        return float(result.t[-1]), *result.y[:, -1].tolist(), bool(result.event_terminated)

    return restarted(problem, fly)


# (engine, variant): (module, distribution, function)
PEERS = {
    ("heyoka", "Taylor"): ("heyoka", "heyoka", heyoka_run),
    ("CVODE", "Adams"): ("sksundae", "scikit-sundae", cvode_run),
    ("CyRK", "DOP853"): ("CyRK", "CyRK", cyrk_run),
}


def installed() -> dict[tuple[str, str], str]:
    """{(engine, variant): version} of the peers that can be imported here."""
    return {name: version(package) for name, (module, package, _) in PEERS.items() if find_spec(module)}
