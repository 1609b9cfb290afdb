"""Integrators of the optional extra `peers`, where installed: heyoka, of what a user would pick the nearest in cost."""

from collections.abc import Callable
from importlib.metadata import version
from importlib.util import find_spec

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


PEERS = {("heyoka", "Taylor"): heyoka_run}  # an engine's name is that of its package


def installed() -> dict[tuple[str, str], str]:
    """{(engine, variant): version} of the peers that can be imported here."""
    return {name: version(name[0]) for name in PEERS if find_spec(name[0])}
