"""A run of the second implementation: intervals of smooth motion, and the events between them."""

from __future__ import annotations

import math
import platform
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from ..decision import model_warnings
from ..extremes import Extremes
from ..limits import limit_warnings
from ..motion import PulseMotion, SampledMotion
from ..response import Energy, Failure, Impact, Response
from ..segments import shared_segments
from .equations import Equations

if TYPE_CHECKING:
    from ..scene import Scene
    from ..types import GroundFunction

IMPACT_LIMIT = 50_000  # more impacts in one run never accumulate (restitution of 1)
STALL_LIMIT = 50  # guard against an endless loop of events at one time
STAND_POINTS = 33  # points of a segment at which uplift is checked under two motions
REST_HORIZON = 0.1  # a block rests only if its impacts end within this share of 1/omega_r


@dataclass(frozen=True)
class Event:
    """An event of `solve_ivp`, a root of function(t, y). terminal: ends the interval. direction: sign of the slope."""

    function: Callable[..., float]
    terminal: bool = True
    direction: int = -1

    def __call__(self, t: float, y: np.ndarray) -> float:
        return self.function(t, y)


class Run(Equations):
    """One run: its current state, its events so far, and the results that are kept."""

    def __init__(self, scene: Scene, settings: Mapping[str, Any], history: bool, energy: bool) -> None:
        super().__init__(scene, energy)
        self.settings, start = settings, scene.start
        if isinstance(scene.motion, SampledMotion):  # two steps a sample, as one could skip a hop
            self.max_step = min(self.max_step, 0.5 * scene.motion.dt)
        self.max_step = settings["max_step"] or self.max_step
        self.atol = settings["atol"] * self.scale
        self.lifted = 0.0 if start.tilt == 0 else -1.0  # last time of tilt 0
        self.turned, self.corner = -1.0, math.inf  # last reversal of the base; next corner of the bearing law, z [N]
        self.flight: float | None = None  # a guess of the next step [s]
        self.overturning: float | None = None
        self.unstable: float | None = 0.0 if abs(start.tilt) >= self.model.gamma else None
        self.rocked = self.side != 0
        self.impacts: list[Impact] = []
        self.uplifts: list[float] = []
        self.rests: list[float] = []
        self.steps, self.stalled, self.impact_loss = 0, 0, 0.0
        self.extremes = Extremes(start.tilt, start.base_displacement, history)
        self.stored = self.energies()

    # the state machine

    def go(self) -> Failure | None:
        """Run to the end or to overturning; a Failure, or None."""
        for _, end, ground, vertical in shared_segments(self.scene.motion, self.scene.end):
            self.vertical = vertical  # a_v(t) [m/s2] of the segment
            while self.t < end and self.overturning is None:
                before = self.t
                failure = self.advance(end, ground)
                self.stalled = self.stalled + 1 if self.t == before else 0
                if failure:
                    return failure
                if self.stalled > STALL_LIMIT or len(self.impacts) > IMPACT_LIMIT:
                    return Failure(
                        "events pile up without progress", f"{len(self.impacts)} impacts, t = {self.t!r}", self.state()
                    )
        return None

    def advance(self, end: float, ground: GroundFunction) -> Failure | None:
        """One interval of smooth motion from self.t, at most to `end`."""
        if self.side == 0:
            a = self.contact_acceleration(self.y, ground(self.t))
            if abs(a) > self.model.uplift_limit(self.vertical(self.t)):
                self.lift(a)
                return None
            if not self.model.on_base:
                self.stand(end, ground)
                return None
        return self.integrate(end, ground)

    def lift(self, acceleration: float) -> None:
        """Uplift: tilt, rate and phi'' are 0, so that the side follows from the acceleration, which it opposes."""
        self.side, self.lifted, self.rocked = -math.copysign(1.0, acceleration), self.t, True
        self.uplifts.append(self.t)

    def stand(self, end: float, ground: GroundFunction) -> None:
        """Full contact on rigid ground: the block stands until |a_g| exceeds (g + a_v) tan(gamma)."""

        def excess(t):
            return abs(ground(t)) - self.model.uplift_limit(self.vertical(t))

        start, until = self.t, end
        if isinstance(self.scene.motion, PulseMotion):  # the difference of two sines may have a maximum
            times = np.linspace(start, end, STAND_POINTS).tolist()
            until = next((t for t in times if excess(t) > 0), end)
        lifts = excess(until) > 0  # |a_g| has no maximum inside a segment
        self.t = brentq(excess, start, until, xtol=1e-15, rtol=1e-15) if lifts else end
        for t in (start, self.t):
            self.record(t, self.y, ground(t))
        if lifts:
            self.lift(ground(self.t))

    def integrate(self, end: float, ground: GroundFunction) -> Failure | None:
        """Integrate until `end` or the first terminal event, and apply that event."""
        direction = self.direction(end, ground)
        events = self.events(direction)
        longest = min(self.max_step, end - self.t)
        step = {"first_step": min(self.flight or longest, longest)}
        if self.flight is None and math.isinf(self.max_step) and self.scene.motion is None:
            step = {}
        try:
            solution = solve_ivp(
                self.derivative(ground, direction),
                (self.t, end),
                self.y,
                self.settings["method"],
                events=[event for _, event in events],
                rtol=self.settings["rtol"],
                atol=self.atol,
                max_step=self.max_step,
                **step,
            )
        except ValueError as error:  # LSODA's dense output may miss its own sign change
            return Failure("scipy could not find an event", str(error), self.state())
        self.steps += len(solution.t) - 1
        missed = self.stepped_over(events, solution)
        if missed is not None and self.t < missed < solution.t[-1]:
            return self.integrate(missed, ground)  # its end is now beyond the crossing
        self.flight = None
        for t, y in self.states(events, solution):
            self.record(t, y, ground(t))
        self.t, self.y = float(solution.t[-1]), solution.y[:, -1].copy()
        if solution.status < 0:
            return Failure("the integrator gave up", solution.message, self.state())
        terminal = None
        for (name, event), times in zip(events, solution.t_events, strict=True):
            if name == "unstable" and self.unstable is None and len(times):
                self.unstable = float(times[0])
            if event.terminal and len(times):  # scipy reports only the first terminal event
                terminal = name
        if terminal:
            getattr(self, "at_" + terminal)(ground(self.t))
        return None

    @staticmethod
    def states(events: Sequence[tuple[str, Event]], solution: Any) -> list[tuple[float, np.ndarray]]:
        """(t, y) in order of time: the steps, the reversals of block and base, and the passages of the slenderness."""
        found = list(zip(solution.t, solution.y.T, strict=True))
        for (_, event), times, states in zip(events, solution.t_events, solution.y_events, strict=True):
            if not event.terminal:
                found += zip(times, states, strict=True)
        return sorted(found, key=lambda each: each[0])

    def stepped_over(self, events: Sequence[tuple[str, Event]], solution: Any) -> float | None:
        """Time of the first extreme beyond a threshold that was crossed twice within one step, or None.

        tilt below 0 where its rate is 0; |a_abs| above g tan(gamma), or the bearing beyond its corner, where the base
        stands still.
        """
        found = []
        for (name, _), times, states in zip(events, solution.t_events, solution.y_events, strict=True):
            for t, y in zip(times, states, strict=True):
                if name == "apex" and self.side * y[0] < 0:
                    found.append(float(t))
                elif name == "reversal" and self.side == 0:
                    limit = self.model.uplift_limit(self.vertical(t))
                    if abs(self.contact_acceleration(y, 0.0)) > limit * (1 + 1e-13):
                        found.append(float(t))
                if name == "reversal" and abs(self.corner) < math.inf and abs(y[4]) > abs(self.corner):
                    found.append(math.nextafter(t, self.t))
        return min(found, default=None)

    def direction(self, end: float, ground: GroundFunction) -> float:
        """Sign of the base velocity over the coming stretch; where it stands, of its acceleration."""
        if not self.model.on_base:
            return 0.0
        if self.y[3] != 0:
            return math.copysign(1.0, self.y[3])
        for t in (self.t, self.t + 1e-3 * (end - self.t)):  # at the start of a motion a_g may still be 0
            acceleration = self.derivative(ground, 0.0)(t, self.y)[3]
            if acceleration != 0:
                return math.copysign(1.0, acceleration)
        return 0.0

    # events of the integration; "terminal" ones end an interval and have an at_ method

    def events(self, direction: float) -> list[tuple[str, Event]]:
        side, model, lifted, turned = self.side, self.model, self.lifted, self.turned
        found = []
        if side:
            # the root phi = 0 at uplift is divided out
            found.append(("impact", Event(lambda t, y: side * y[0] / (t - lifted) if t > lifted else 1.0)))
            found.append(("overturning", Event(lambda t, y: side * y[0] - math.pi / 2, direction=1)))
            found.append(("apex", Event(lambda t, y: side * y[1], terminal=False, direction=0)))
            found.append(("unstable", Event(lambda t, y: side * y[0] - model.gamma, terminal=False, direction=1)))
        else:
            limit, vertical = model.uplift_limit, self.vertical
            found.append(
                ("uplift", Event(lambda t, y: abs(self.contact_acceleration(y, 0.0)) - limit(vertical(t)), direction=1))
            )
        if direction:
            stops = self.law.unit.memory
            found.append(("reversal", Event(lambda t, y: direction * y[3] if t > turned else 1.0, terminal=stops)))
            ahead = self.law.unit.begin.py_func(direction, self.hysteretic_force(self.y), 1.0, self.law.constants)[2]
            self.corner = corner = direction * ahead
            if ahead < math.inf:
                found.append(("corner", Event(lambda t, y: direction * (y[4] - corner), direction=1)))
        return found

    def at_overturning(self, ground: GroundFunction) -> None:
        self.overturning = self.t

    def at_uplift(self, ground: float) -> None:
        self.lift(self.contact_acceleration(self.y, ground))

    def at_reversal(self, ground: float) -> None:
        self.fix_history()
        self.y[3], self.turned = 0.0, self.t

    def at_corner(self, ground: float) -> None:
        self.y[4] = self.corner

    def at_impact(self, ground: float) -> None:
        """Eqs (7), (8); then the other corner, or rest if impacts accumulate under a compressive contact force."""
        y, model = self.y, self.model
        before, kinetic = y[1], self.energies()[0]
        y[0] = 0.0
        y[1], jump = model.impact(before)
        if model.on_base:
            self.fix_history()
            y[3] += jump
        self.impacts.append(Impact(self.t, float(before), float(y[1]), float(jump)))
        self.side, self.lifted = math.copysign(1.0, y[1]), self.t
        force, e = self.bearing_force(y), model.restitution
        # deceleration toward contact on either corner: sides alternate, and a load makes them unequal
        here, there = (
            -side * model.accelerations(side, 0.0, y[1], ground, force, self.vertical(self.t))[0]
            for side in (self.side, -self.side)
        )
        held, remaining = min(here, there) > 0, math.inf
        if held and e < 1:  # two geometric series
            remaining = 2 * abs(y[1]) / (1 - e * e) * (1 / here + e / there)
        if here > 0:
            self.flight = 2.2 * abs(y[1]) / here or None
        resting = abs(y[1]) < self.settings["rest_rate"] * self.omega_r
        if y[1] == 0 or (resting and remaining * self.omega_r < REST_HORIZON):
            if model.on_base:  # the remaining momentum goes to the base, as at an impact with restitution 0
                y[3] += model.mass_share * model.R * math.cos(model.gamma) * y[1]
            y[1], self.side, self.flight = 0.0, 0.0, None
            if held:
                self.rests.append(float(self.t + remaining))
        self.impact_loss += kinetic - self.energies()[0]

    # what is kept

    def record(self, t: float, y: np.ndarray, ground: float) -> None:
        """Keep one step."""
        model, force, up = self.model, self.bearing_force(y), self.vertical(t)
        tilt, rate = float(y[0]), float(y[1])
        if self.side:
            spin, push = model.accelerations(self.side, tilt, rate, ground, force, up)
            absolute = push + ground
            horizontal, normal = model.contact_forces(self.side, tilt, rate, spin, absolute, up)
        else:
            absolute = self.contact_acceleration(y, ground)
            horizontal, normal = model.m * absolute, model.m * (model.g + up)
        x, v = (float(y[2]), float(y[3])) if model.on_base else (0.0, 0.0)
        weight = model.m * model.g
        self.extremes.step(
            (t, tilt, rate, x, v, force, ground), absolute, horizontal / weight, normal / weight, model.gamma
        )

    def ledger(self) -> Energy:
        kinetic, potential = (now - then for now, then in zip(self.energies(), self.stored, strict=True))
        work = self.y[-3:].tolist() if self.model.on_base else [float(self.y[-1]), 0.0, 0.0]
        return Energy(*[kinetic, potential, *work, float(self.impact_loss)])

    def response(self, cpu_seconds: float, failure: Failure | None) -> Response:
        outcome = "rocks" if self.rocked else "stands"
        outcome = "failed" if failure else "overturns" if self.overturning is not None else outcome
        extremes = self.extremes
        fall_time = extremes.exclude_overturning() if outcome == "overturns" else None
        return Response(
            engine="twin",
            variant=self.settings["method"],
            outcome=outcome,
            overturning_time=self.overturning,
            unstable_time=self.unstable,
            fall_time=fall_time,
            peak_tilt=extremes.tilt,
            peak_tilt_ratio=extremes.tilt / self.model.gamma,
            peak_base_displacement=extremes.x,
            peak_base_acceleration=extremes.acceleration,
            impacts=tuple(self.impacts),
            uplifts=tuple(self.uplifts),
            rests=tuple(self.rests),
            friction_demand=extremes.friction,
            min_normal_ratio=extremes.normal,
            end=self.state(),
            cpu_seconds=cpu_seconds,
            steps=self.steps,
            settings=dict(self.settings),
            scene=self.scene.name,
            failure=failure,
            energy=self.ledger() if self.energy else None,
            history=extremes.history(),
            versions={"python": platform.python_version(), "numpy": np.__version__, "scipy": scipy.__version__},
            warnings=model_warnings(self.scene, extremes.friction, extremes.normal)
            + limit_warnings(self.scene, extremes.x),
        )
