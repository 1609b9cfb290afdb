"""The systems that heyoka (extra `peers`), a Taylor integrator, compiles: the equations of rocking.py and their events.

Constants are compiled; side, ground and bearing memory are parameters.
"""

import functools
import math
from typing import Any

from analytic.motion import PulseMotion
from analytic.rocking import RockingModel

from .integrators import COOLDOWN

SIDE, LINE, PATH = ("side",), ("value", "slope", "begin"), ("direction", "travel", "origin")  # parameters


class System:
    """A compiled system, used by one `taylor.Run` after the other, `run`; handlers: its methods for terminal events.

    state, pars: heyoka's own arrays. line, path: the parameters of ground and bearings. shown: of [phi, w, x, v], its
    state.
    """

    run: Any

    def __init__(self, adaptive: Any, rocking: bool, lines: int, handlers: tuple[str, ...], end_reached: Any) -> None:
        self.adaptive, self.rocking, self.handlers = adaptive, rocking, handlers
        self.state, self.pars = adaptive.state, adaptive.pars
        self.line, self.path = self.pars[rocking : rocking + lines], self.pars[rocking + lines :]
        self.shown = slice(0, len(self.state)) if rocking else slice(2, 4)
        self.propagate, self.end_reached = adaptive.propagate_until, end_reached

    @property
    def time(self) -> float:
        return float(self.adaptive.time)


@functools.cache
def compiled(
    model: RockingModel, pulse: PulseMotion | None, line: bool, rocking: bool, tolerance: float, callback: bool
) -> System:
    """The system of a model, in rocking or in full contact.

    pulse: of amplitude 1, under which it is; line: whether it is under a line between samples.
    """
    import heyoka

    lines = LINE if line else LINE[:1] if pulse else ()
    names = (SIDE if rocking else ()) + lines + (PATH if model.bearing.count else ())
    par = {name: heyoka.par[place] for place, name in enumerate(names)}
    ground = heyoka.expression(0.0)
    if line:
        ground = par["value"] + par["slope"] * (heyoka.time - par["begin"])
    elif pulse:
        phase = pulse.phase - pulse.frequency * pulse.start
        ground = par["value"] * pulse.form.value(heyoka, pulse.frequency * heyoka.time + phase)
    equations, terminal, peaks = _equations(model, par, ground, rocking)
    holder: list[System] = []

    def handled(name: str) -> Any:
        return lambda *_: getattr(holder[0].run, name)(holder[0])

    def noted(name: str) -> Any:
        def note(adaptive: Any, t: float, _: int) -> None:
            getattr(holder[0].run, name)(adaptive.update_d_output(t))

        return note

    downward = {"direction": heyoka.event_direction.negative}
    adaptive = heyoka.taylor_adaptive(
        equations,
        [0.0] * len(equations),
        pars=[0.0] * len(names),
        tol=tolerance,
        t_events=[
            heyoka.t_event(function, cooldown=COOLDOWN, **downward, **({"callback": handled(name)} if callback else {}))
            for name, function in terminal.items()
        ],
        nt_events=[heyoka.nt_event(function, noted(name)) for name, function in peaks.items()],
    )
    system = System(adaptive, rocking, len(lines), tuple(terminal), heyoka.taylor_outcome.time_limit)
    holder.append(system)
    return system


def _equations(model: RockingModel, par: dict[str, Any], ground: Any, rocking: bool) -> tuple[Any, Any, Any]:
    """(equations, terminal events, events of a peak), events by name; a terminal one is where it falls through 0."""
    import heyoka

    phi, w, x, v = heyoka.make_vars("phi", "w", "x", "v")
    law, force = model.bearing, heyoka.expression(0.0)
    if law.count:
        c, s = law.constants, par["direction"]
        power = (par["travel"] + s * (x - par["origin"])) ** (1 - c.alpha)
        force = law.count * (law.kb * x + s * (c.dk / (1 - c.alpha) * (power - c.d0) + c.f0) + law.damping * v)
    reversal = {"reversal": par["direction"] * v} if law.count else {}
    peaks = {} if law.count else {"turn": v}
    if not rocking:
        limit = model.M * model.uplift_acceleration
        terminal = {"uplift": 1.0 - (force / limit) ** 2} | reversal if law.count else {}
        return [(x, v), (v, -force / model.M - ground)], terminal, peaks
    s = par["side"]
    angle = s * model.gamma - phi
    m, M, J, R, g = model.m, model.M, model.J, model.R, model.g
    terminal = {"impact": s * phi, "overturn": 0.5 * math.pi - s * phi}
    if not model.on_base:
        spin = -(m * R / J) * (g * heyoka.sin(angle) + ground * heyoka.cos(angle))
        return [(phi, w), (w, spin)], terminal, {"apex": w}
    c, n = m * R * heyoka.cos(angle), m * R * heyoka.sin(angle)
    push, moment = -n * w**2 - force, -g * n  # as in `RockingModel.accelerations`
    determinant = M * J - c**2
    spin, push = (M * moment - c * push) / determinant, (J * push - c * moment) / determinant - ground
    equations = [(phi, w), (w, spin), (x, v), (v, push)]
    return equations, terminal | reversal, {"apex": w} | peaks
