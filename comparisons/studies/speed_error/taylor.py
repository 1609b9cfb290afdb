"""The equations of rocking.py solved by heyoka (extra `peers`), a compiled Taylor integrator, set up by someone who wants
it fast: constants are compiled, it restarts at events and samples only, and Python does no more than an event asks.

One system is compiled for rocking, one for full contact on the base, each for the ground at rest, a pulse or the line
between two samples. A change of the system returns to Python. Impacts and reversals do not: they are a callback in
heyoka's own loop, or stop it, Python applies them, and the loop goes on.
"""

import functools
import math
import platform
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from importlib.metadata import version
from typing import Any

import numpy as np
from scipy.optimize import brentq

from analytic import Impact, Response, Scene, SceneError, State
from analytic.laws import algebraic
from analytic.motion import PulseMotion
from analytic.response import Failure
from analytic.rocking import RockingModel
from analytic.segments import segments
from analytic.solver import REST_RATE
from analytic.termination import is_decided
from analytic.twin.run import IMPACT_LIMIT, REST_HORIZON

from .integrators import COOLDOWN

VARIANTS = {True: "Taylor, callback", False: "Taylor, stopped at events"}
SIDE, LINE, PATH = ("side",), ("value", "slope", "begin"), ("direction", "travel", "origin")  # parameters of a system
travel_of, force_of = algebraic.virtual_travel.py_func, algebraic.on_branch.py_func


def simulate_heyoka(
    scene: Scene, *, tolerance: float, callback: bool, history: bool = False, version: str | None = None
) -> Response:
    """Simulate a scene with heyoka.

    Parameters
    ----------
    scene : Scene
        With a duration; its bearings, if any, follow the algebraic law.
    tolerance : float
        Of heyoka's steps.
    callback : bool
        Whether impacts and reversals are a callback; else heyoka stops at them.
    history : bool
        There is none.
    version : str, optional
        heyoka's: part of what a stored run is known by.

    Returns
    -------
    Response
        Outcome, impacts, uplifts, rests, end, peaks of tilt and base displacement (not of one that overturns on a
        base); other numbers are NaN.
    """
    _check(scene, history)
    run = Run(scene, tolerance, callback)
    began = time.process_time()
    failure = run.go()
    cpu = time.process_time() - began
    overturns, on_base = run.overturning is not None, run.model.on_base
    response = Response.unmeasured(
        engine="heyoka",
        variant=VARIANTS[callback],
        scene=scene.name,
        outcome="failed" if failure else "overturns" if overturns else "rocks" if run.rocked else "stands",
        overturning_time=run.overturning,
        peak_tilt=run.peak_tilt,
        peak_tilt_ratio=run.peak_tilt / run.model.gamma,
        peak_base_displacement=math.nan if overturns and on_base else run.peak_x,
        impacts=tuple(Impact(*impact) for impact in run.impacts),
        uplifts=tuple(run.uplifts),
        rests=tuple(run.rests),
        end=run.state(),
        cpu_seconds=cpu,
        steps=run.steps,
        settings={"tolerance": tolerance, "callback": callback, "cooldown": COOLDOWN, "rest_rate": REST_RATE},
        versions={"python": platform.python_version(), "numpy": np.__version__, "heyoka": _version()},
        failure=failure,
    )
    return replace(response, decided=is_decided(scene, response))


@functools.cache
def _version() -> str:
    return version("heyoka")


def _check(scene: Scene, history: bool) -> None:
    """Refuse what is not set up here."""
    if scene.bearings and scene.bearings.law != "algebraic":
        raise SceneError("bearings.law", scene.bearings.law, "not set up in heyoka", "give the algebraic law")
    for key, value in (("motion.vertical", getattr(scene.motion, "vertical", None)), ("block.friction", scene.friction)):
        if value is not None:
            raise SceneError(key, value, "not set up in heyoka", "leave it out")
    if scene.duration is None or history:
        raise SceneError("run.duration", scene.duration, "heyoka runs for a duration, without a history", "give one")


@dataclass(eq=False)
class System:
    """A compiled system. state, pars: heyoka's own arrays; at: place of each parameter by name; base: of x in the state.

    handlers: names of the methods of `Run` that handle its terminal events. run: the one that it is used by.
    """

    adaptive: Any
    state: np.ndarray
    pars: np.ndarray
    at: dict[str, int]
    base: int
    handlers: tuple[str, ...]
    run: "Run | None" = None

    def set(self, names: tuple[str, ...], values: tuple[float, ...]) -> None:
        """Set parameters, as far as the system has them."""
        for name, value in zip(names, values, strict=True):
            if name in self.at:
                self.pars[self.at[name]] = value


@functools.cache
def compiled(
    model: RockingModel, pulse: PulseMotion | None, line: bool, rocking: bool, tolerance: float, callback: bool
) -> System:
    """The system of a model, in rocking or in full contact.

    pulse: of amplitude 1, under which it is; line: whether it is under a line between samples.
    """
    import heyoka

    names = (SIDE if rocking else ()) + (LINE if line else LINE[:1] if pulse else ())
    names += PATH if model.bearing.count else ()
    at = {name: place for place, name in enumerate(names)}
    par = {name: heyoka.par[place] for name, place in at.items()}
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
            heyoka.t_event(
                function, cooldown=COOLDOWN, **downward, **({"callback": handled(name)} if callback else {})
            )
            for name, function in terminal.items()
        ],
        nt_events=[heyoka.nt_event(function, noted(name)) for name, function in peaks.items()],
    )
    system = System(adaptive, adaptive.state, adaptive.pars, at, 2 if rocking else 0, tuple(terminal))
    holder.append(system)
    return system


def _equations(model: RockingModel, par: dict[str, Any], ground: Any, rocking: bool) -> tuple[Any, Any, Any]:
    """(equations, terminal events, events of a peak), the events by name; a terminal one ends above 0."""
    import heyoka

    phi, w, x, v = heyoka.make_vars("phi", "w", "x", "v")
    law, force = model.bearing, heyoka.expression(0.0)
    if law.count:
        c, s = law.constants, par["direction"]
        power = (par["travel"] + s * (x - par["origin"])) ** (1 - c.alpha)
        force = law.count * (law.kb * x + s * (c.dk / (1 - c.alpha) * (power - c.d0) + c.f0) + law.damping * v)
    reversal = {"reversal": par["direction"] * v} if law.count else {}
    if not rocking:
        limit = model.M * model.uplift_acceleration
        terminal = {"uplift": 1.0 - (force / limit) ** 2} | reversal if law.count else {}
        return [(x, v), (v, -force / model.M - ground)], terminal, {}
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
    return equations, terminal | reversal, {"apex": w} | ({} if law.count else {"turn": v})


class Run:
    """One run: state, memory of the bearings, events. side: of the pivot, 0 in full contact; y: [phi, w, x, v]."""

    def __init__(self, scene: Scene, tolerance: float, callback: bool) -> None:
        self.scene, self.callback, start = scene, callback, scene.start
        self.model = model = RockingModel.of(scene)
        self.law, self.constants = model.bearing, model.bearing.constants
        self.restitution, self.arm = model.restitution, model.jump_arm
        self.rest_rate = REST_RATE * scene.rocking_frequency
        self.t, self.y = 0.0, [start.tilt, start.tilt_rate, start.base_displacement, start.base_velocity]
        self.side = math.copysign(1.0, start.tilt or start.tilt_rate) if start.tilt or start.tilt_rate else 0.0
        self.rocked, self.overturning = self.side != 0, None
        self.peak_tilt, self.peak_x = abs(start.tilt), abs(start.base_displacement)
        self.impacts: list[tuple[float, float, float, float]] = []
        self.uplifts: list[float] = []
        self.rests: list[float] = []
        self.steps, self.handled = 0, 0
        self.stretches = segments(scene.motion, scene.end)
        motion = scene.motion
        self.pulse = motion if isinstance(motion, PulseMotion) else None
        pulse = self.pulse and replace(self.pulse, amplitude=1.0)  # the amplitude is a parameter
        line = motion is not None and pulse is None
        self.systems = {
            (rocking, shaken): compiled(model, pulse if shaken else None, line, rocking, tolerance, callback)
            for rocking in ((True, False) if model.on_base else (True,))
            for shaken in ((True, False) if pulse else (False,))
        }
        self.path = (0.0, 0.0, 0.0)
        if self.law.count:
            z = self.law.start(start.base_displacement)
            self.remember(start.base_displacement, z, self.first_direction(z))

    def go(self) -> Failure | None:
        """Run to the end or to overturning; a Failure, or None."""
        for begin, end, ground in self.stretches:
            self.ground = ground
            while self.t < end and self.overturning is None:
                if self.handled > IMPACT_LIMIT:
                    return Failure("events pile up without progress", f"t = {self.t!r}", self.state())
                if failure := self.advance(begin, end):
                    return failure
        self.peak_tilt, self.peak_x = max(self.peak_tilt, abs(self.y[0])), max(self.peak_x, abs(self.y[2]))
        return None

    def advance(self, begin: float, end: float) -> Failure | None:
        """Go on to the end of the stretch, at most, or to what changes the system."""
        if self.side == 0:
            if abs(a := self.contact_acceleration()) > self.model.uplift_acceleration:
                self.lift(a)
            elif not self.model.on_base:
                self.stand(end)
                return None
        return self.integrate(begin, end)

    def contact_acceleration(self) -> float:
        """Absolute acceleration of the base in full contact [m/s2], eq. (2)."""
        return self.model.contact_acceleration(self.force(*self.y[2:])) if self.model.on_base else self.ground(self.t)

    def lift(self, acceleration: float) -> None:
        self.side, self.rocked = -math.copysign(1.0, acceleration), True
        self.uplifts.append(self.t)

    def stand(self, end: float) -> None:
        """Full contact on rigid ground: |a_g| is monotone in a stretch."""
        limit = self.model.uplift_acceleration
        if abs(self.ground(end)) > limit:
            self.t = brentq(lambda t: abs(self.ground(t)) - limit, self.t, end, xtol=1e-15, rtol=1e-15)
            self.lift(self.ground(self.t))
        else:
            self.t = end

    def integrate(self, begin: float, end: float) -> Failure | None:
        """By one system: under a pulse to its end, else to the end of the stretch, or to what changes the system."""
        pulse, value, slope = self.pulse, 0.0, 0.0
        shaken = pulse is not None and pulse.start <= self.t < pulse.end
        system = self.systems[self.side != 0, shaken]
        if shaken:
            end, value = min(pulse.end, self.scene.end), pulse.amplitude
        elif pulse is None:
            value = self.ground(begin)
            slope = (self.ground(end) - value) / (end - begin)
        system.run, adaptive = self, system.adaptive
        adaptive.time = self.t
        if system.handlers:
            adaptive.reset_cooldowns()
        shown = slice(2 - system.base, 2 - system.base + len(system.state))  # of y, in its state
        system.state[:] = self.y[shown]
        system.set(SIDE + LINE + PATH, (self.side, value, slope, begin, *self.path))
        goes_on = True
        while goes_on:
            outcome, _, _, steps, *_ = adaptive.propagate_until(end)
            event, self.steps = -1 - int(outcome), self.steps + steps
            stopped = 0 <= event < len(system.handlers)
            goes_on = stopped and not self.callback and getattr(self, system.handlers[event])(system)
        self.t = float(adaptive.time)
        self.y[shown] = system.state.tolist()
        if outcome.name == "err_nf_state":
            return Failure("the state is not finite", str(outcome), self.state())
        return None

    # what an event does to the system that has reached it; whether that system goes on

    def impact(self, system: System) -> bool:
        """Eqs (7), (8); then the other corner, or rest."""
        self.handled += 1
        state, t = system.state, float(system.adaptive.time)
        before = float(state[1])
        after, jump = self.restitution * before, 0.0
        state[0], state[1], self.side = 0.0, after, -self.side
        system.pars[0] = self.side
        if self.model.on_base:
            x, jump = float(state[2]), self.arm * (before - after)
            v = float(state[3]) + jump
            state[3], self.peak_x = v, max(self.peak_x, abs(x))
            if self.law.count:
                self.remember(x, self.hysteretic(x), math.copysign(1.0, v))
                system.set(PATH, self.path)
        self.impacts.append((t, before, after, jump))
        slow = abs(after) < self.rest_rate
        return not (slow and self.rests_at(t, system)) and self.handled <= IMPACT_LIMIT

    def rests_at(self, t: float, system: System) -> bool:
        """Whether impacts accumulate under a compressive contact force, as in `twin.run`; then the block rests."""
        model, state = self.model, system.state
        x, v = (float(state[2]), float(state[3])) if model.on_base else (0.0, 0.0)
        after, e, force, ground = float(state[1]), self.restitution, self.force(x, v), self.ground(t)
        here, there = (
            -side * model.accelerations(side, 0.0, after, ground, force)[0] for side in (self.side, -self.side)
        )
        held, remaining = min(here, there) > 0, math.inf
        if held and e < 1:
            remaining = 2 * abs(after) / (1 - e * e) * (1 / here + e / there)
        if after and not remaining * self.scene.rocking_frequency < REST_HORIZON:
            return False
        if model.on_base:  # as at an impact with restitution 0
            v = state[3] = v + self.arm * after
            if self.law.count and v:
                self.remember(x, self.hysteretic(x), math.copysign(1.0, v))
        state[1], self.side = 0.0, 0.0
        if held:
            self.rests.append(t + remaining)
        return True

    def reversal(self, system: System) -> bool:
        self.handled += 1
        x, direction = float(system.state[system.base]), self.path[0]
        system.state[system.base + 1], self.peak_x = 0.0, max(self.peak_x, abs(x))
        self.remember(x, self.hysteretic(x), -direction)
        system.set(PATH, self.path)
        return self.handled <= IMPACT_LIMIT

    def uplift(self, system: System) -> bool:
        self.t = float(system.adaptive.time)
        self.lift(self.model.contact_acceleration(self.force(*system.state.tolist())))
        return False

    def overturn(self, system: System) -> bool:
        self.overturning = float(system.adaptive.time)
        return False

    # peaks, at a state in a step

    def apex(self, y: np.ndarray) -> None:
        self.peak_tilt = max(self.peak_tilt, abs(float(y[0])))

    def turn(self, y: np.ndarray) -> None:
        self.peak_x = max(self.peak_x, abs(float(y[2])))

    # the bearings

    def hysteretic(self, x: float) -> float:
        """z of one bearing [N] at a displacement, on the path since the last reversal."""
        direction, travel, origin = self.path
        return force_of(direction, travel + direction * (x - origin), self.constants)

    def remember(self, x: float, z: float, direction: float) -> None:
        """The point where a path of one direction begins, the memory of the bearing."""
        self.path = direction, travel_of(direction, z, self.constants), x

    def force(self, x: float, v: float) -> float:
        """Of all bearings [N]."""
        return self.law.force(x, self.hysteretic(x), v) if self.law.count else 0.0

    def first_direction(self, z: float) -> float:
        """Sign of the base velocity at the start; where it stands, of its acceleration then or soon after."""
        _, _, x, v = self.y
        if v:
            return math.copysign(1.0, v)
        _, end, ground = self.stretches[0]
        force = self.law.force(x, z, v)
        for t in (0.0, 1e-3 * end):
            push = self.model.contact_acceleration(force) - ground(t)
            if self.side:
                push = self.model.accelerations(self.side, *self.y[:2], ground(t), force)[1]
            if push:
                return math.copysign(1.0, push)
        return 1.0

    def state(self) -> State:
        x, v = self.y[2:]
        return State(self.t, *self.y, self.force(x, v))
