"""A scene solved by heyoka (extra `peers`), set up by someone who wants it fast.

It restarts at events and samples only, and Python does no more than an event asks. Between rocking and full contact it
returns to Python. Impacts and reversals are a callback in heyoka's own loop, or they stop it, Python applies them, and
the loop goes on.
"""

import functools
import math
import platform
import time
from dataclasses import replace
from importlib import metadata

import numpy as np
from scipy.optimize import brentq

from analytic import Impact, Response, Scene, SceneError, SettingError, State
from analytic.laws import algebraic
from analytic.motion import PulseMotion
from analytic.response import Failure
from analytic.rocking import RockingModel
from analytic.segments import segments
from analytic.solver import REST_RATE
from analytic.termination import is_decided
from analytic.twin.run import IMPACT_LIMIT, REST_HORIZON
from analytic.types import GroundFunction

from .integrators import COOLDOWN, TAYLOR
from .systems import System, compiled

# rad, rad/s, m/s: far below rounding of the motion, far above what rounding of an acceleration of 0 makes of 0. Where a
# step begins with an event function of exactly 0, heyoka takes that for the root, and may miss the next.
NUDGE = 1e-20
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
        There is none: has to be False.
    version : str, optional
        heyoka's: part of what a stored run is known by.

    Returns
    -------
    Response
        Outcome, impacts, uplifts, rests, end, peaks of tilt and base displacement (not of one that overturns on a
        base); other numbers are NaN.

    Raises
    ------
    SceneError, SettingError
        What is not set up here: another law, a vertical motion, a friction, no duration; a history.
    """
    _check(scene, history)
    run = Run(scene, tolerance, callback)
    began = time.process_time()
    failure = run.go()
    cpu = time.process_time() - began
    overturns, on_base = run.overturning is not None, run.model.on_base
    response = Response.unmeasured(
        engine="heyoka",
        variant=next(name for name, called in TAYLOR.items() if called == callback),
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
    return metadata.version("heyoka")


def _check(scene: Scene, history: bool) -> None:
    """Refuse what is not set up here."""
    if scene.bearings and scene.bearings.law != "algebraic":
        raise SceneError("bearings.law", scene.bearings.law, "not set up in heyoka", "give the algebraic law")
    for key, value in (("motion.vertical", getattr(scene.motion, "vertical", None)), ("friction", scene.friction)):
        if value is not None:
            raise SceneError(key, value, "not set up in heyoka", "leave it out")
    if scene.duration is None:
        raise SceneError("run.duration", None, "heyoka has to know its end", "give one")
    if history:
        raise SettingError("history = True: heyoka keeps none here")


def _line(begin: float, end: float, ground: GroundFunction) -> tuple[float, float, float]:
    """A line of the ground acceleration: its first value [m/s2], slope [m/s3] and begin [s]."""
    value = ground(begin)
    return value, (ground(end) - value) / (end - begin), begin


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
        self.rocked = self.side != 0
        self.overturning: float | None = None
        self.peak_tilt, self.peak_x = abs(start.tilt), abs(start.base_displacement)
        self.impacts: list[tuple[float, float, float, float]] = []
        self.uplifts: list[float] = []
        self.rests: list[float] = []
        self.steps, self.handled = 0, 0
        self.stretches, self.place = segments(scene.motion, scene.end), 0
        motion = scene.motion
        self.pulse = motion if isinstance(motion, PulseMotion) else None
        self.lines = [] if motion is None or self.pulse else [_line(*stretch) for stretch in self.stretches]
        pulse = self.pulse and replace(self.pulse, amplitude=1.0)  # the amplitude is a parameter
        self.systems = {
            (rocking, shaken): compiled(
                model, pulse if shaken else None, bool(self.lines), rocking, tolerance, callback
            )
            for rocking in ((True, False) if model.on_base else (True,))
            for shaken in ((True, False) if pulse else (False,))
        }
        self.path = (0.0, 0.0, 0.0)
        if model.on_base:
            z = self.law.start(start.base_displacement)
            direction = self.first_direction(z)
            self.path = direction, travel_of(direction, z, self.constants) if self.law.count else 0.0, self.y[2]

    def go(self) -> Failure | None:
        """Run to the end or to overturning; a Failure, or None."""
        while self.t < self.scene.end and self.overturning is None:
            while self.stretches[self.place][1] <= self.t:
                self.place += 1
            if self.handled > IMPACT_LIMIT:
                return Failure("events pile up without progress", f"t = {self.t!r}", self.state())
            if failure := self.advance():
                return failure
        self.peak_tilt, self.peak_x = max(self.peak_tilt, abs(self.y[0])), max(self.peak_x, abs(self.y[2]))
        return None

    def ground(self, t: float) -> float:
        return self.stretches[self.place][2](t)

    def advance(self) -> Failure | None:
        """Go on to what changes the system, or to the end of a standing block's stretch."""
        if self.side == 0:
            if abs(a := self.contact_acceleration()) > self.model.uplift_acceleration:
                self.lift(a)
            elif not self.model.on_base:
                self.stand(self.stretches[self.place][1])
                return None
        return self.integrate()

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

    def integrate(self) -> Failure | None:
        """By one system: from sample to sample, or to the end of the pulse; or to what changes the system."""
        pulse = self.pulse
        shaken = pulse is not None and pulse.start <= self.t < pulse.end
        system = self.systems[self.side != 0, shaken]
        system.run, system.adaptive.time = self, self.t
        if system.handlers:
            system.adaptive.reset_cooldowns()
        system.state[:] = self.nudged()[system.shown]
        if system.rocking:
            system.pars[0] = self.side
        if len(system.path):
            system.path[:] = self.path
        if self.lines:
            for place in range(self.place, len(self.lines)):
                self.place, system.line[:] = place, self.lines[place]
                if not self.reach(system, self.stretches[place][1]):
                    break
        elif shaken:
            system.line[0] = pulse.amplitude
            self.reach(system, min(pulse.end, self.scene.end))
        else:
            self.reach(system, self.stretches[self.place][1])
        self.t = system.time
        self.y[system.shown] = system.state.tolist()
        if not np.isfinite(self.y).all():
            return Failure("the state is not finite", "", self.state())
        return None

    def nudged(self) -> list[float]:
        """y without the zeros that are the root of an event."""
        tilt, rate, x, v = self.y
        return [tilt or self.side * NUDGE, rate or self.side * NUDGE, x, v or self.path[0] * NUDGE]

    def reach(self, system: System, end: float) -> bool:
        """Whether the system reaches `end` [s]; else it is left at what changes it."""
        while True:
            result = system.propagate(end)
            self.steps += result[3]
            if result[0] == system.end_reached:
                return True
            event = -1 - int(result[0])
            if self.callback or not 0 <= event < len(system.handlers):
                return False
            if not getattr(self, system.handlers[event])(system):
                return False

    # what an event does to the system that has reached it; whether that system goes on

    def impact(self, system: System) -> bool:
        """Eqs (7), (8); then the other corner, or rest."""
        self.handled += 1
        _, before, *base = system.state.tolist()
        after, jump = self.restitution * before, 0.0
        if base:
            x, v = base
            jump = self.arm * (before - after)
            v += jump
            base, self.peak_x = [x, v], max(self.peak_x, abs(x))
            if self.law.count:
                self.turn_to(system, x, math.copysign(1.0, v))
        system.state[:] = [0.0, after, *base]
        system.pars[0] = self.side = -self.side
        self.impacts.append((system.time, before, after, jump))
        slow = abs(after) < self.rest_rate
        return not (slow and self.rests_at(system.time, system)) and self.handled <= IMPACT_LIMIT

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
                self.turn_to(system, x, math.copysign(1.0, v))
        state[1], self.side = 0.0, 0.0
        if held:
            self.rests.append(t + remaining)
        return True

    def reversal(self, system: System) -> bool:
        self.handled += 1
        x = float(system.state[-2])
        system.state[-1], self.peak_x = 0.0, max(self.peak_x, abs(x))
        self.turn_to(system, x, -self.path[0])
        return self.handled <= IMPACT_LIMIT

    def uplift(self, system: System) -> bool:
        self.t = system.time
        self.lift(self.model.contact_acceleration(self.force(*system.state.tolist())))
        return False

    def overturn(self, system: System) -> bool:
        self.overturning = system.time
        return False

    # peaks, at a state in a step

    def apex(self, y: np.ndarray) -> None:
        self.peak_tilt = max(self.peak_tilt, abs(float(y[0])))

    def turn(self, y: np.ndarray) -> None:
        self.peak_x = max(self.peak_x, abs(float(y[-2])))

    # the bearings

    def hysteretic(self, x: float) -> float:
        """z of one bearing [N] at a displacement, on the path since the last reversal."""
        direction, travel, origin = self.path
        return force_of(direction, travel + direction * (x - origin), self.constants)

    def turn_to(self, system: System, x: float, direction: float) -> None:
        """A path of one direction begins at x: the memory of the bearing."""
        self.path = direction, travel_of(direction, self.hysteretic(x), self.constants), x
        system.path[:] = self.path

    def force(self, x: float, v: float) -> float:
        """Of all bearings [N]."""
        return self.law.force(x, self.hysteretic(x), v) if self.law.count else 0.0

    def first_direction(self, z: float) -> float:
        """Sign of the base velocity at the start; where it stands, of its first acceleration."""
        tilt, rate, x, v = self.y
        force = self.law.force(x, z, v)
        for begin, end, ground in self.stretches:
            for t in (begin, begin + 1e-3 * (end - begin)):  # at the start of a motion a_g may still be 0
                push = self.model.contact_acceleration(force) - ground(t)
                if self.side:
                    push = self.model.accelerations(self.side, tilt, rate, ground(t), force)[1]
                if v or push:
                    return math.copysign(1.0, v or push)
        return 1.0

    def state(self) -> State:
        tilt, rate, x, v = self.y
        return State(self.t, tilt, rate, x, v, self.force(x, v))
