"""The second implementation: the equations of `rocking`, solved by scipy's `solve_ivp` with events.

It is slow and simple, and what a careful user would write. It is independent of the compiled kernel, which it verifies.
One call of `solve_ivp` covers one interval of smooth motion. It ends at the next corner of the ground motion, at an
impact, an uplift, a reversal of the base (where the bearing's history is committed), a corner of the bearing law, or at
overturning.
"""

from __future__ import annotations

import functools
import math
import platform
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from ..errors import SettingError, require
from ..kernel.decision import model_warnings
from ..motion import PulseMotion, SampledMotion, shared_segments
from ..response import Energy, Failure, History, Impact, Response, State, limit_warnings
from ..rocking import RockingModel
from ..scene import refuse_free
from ..solver import is_decided, most_steps, too_long, until_decided

if TYPE_CHECKING:
    from ..errors import GroundFunction
    from ..scene import Scene

METHODS = ("DOP853", "RK45", "LSODA", "Radau")
IMPACT_LIMIT = 50_000  # impacts of a run; more of them never accumulate (restitution of 1)
STALL_LIMIT = 50  # guard against an endless loop of events at one time
STAND_POINTS = 33  # points of a segment at which uplift is checked under two motions
REST_HORIZON = 0.1  # a block rests only if its impacts end within this share of 1/omega_r
ROUNDING = 1e-12  # of a passage of the slenderness that was found as a root


def simulate_twin(
    scene: Scene,
    *,
    method: str = "DOP853",
    rtol: float = 1e-10,
    atol: float | None = None,
    history: bool = True,
    energy: bool = True,
    max_step: float | None = None,
    rest_rate: float = 1e-8,
) -> Response:
    """Simulate a scene with scipy.

    Parameters
    ----------
    scene : Scene
    method : str
        One of `METHODS`.
    rtol : float
        Relative tolerance of `solve_ivp`.
    atol : float, optional
        Absolute tolerance as a share of each state's scale (slenderness, R times slenderness, omega_r times
        these, f0); default rtol.
    history, energy : bool
        Whether to keep the states at every step, and to integrate the energy ledger with them.
    max_step : float, optional
        Longest step [s]; default the least of half a sampling interval and, on bearings, half of 1/omega at ka.
    rest_rate : float
        Impacts have accumulated if |phi'+| < rest_rate omega_r under a compressive force; the block then rests.

    Returns
    -------
    Response
        engine "twin". Extremes of forces and accelerations are taken at the steps; peaks of tilt and displacement are
        located as events.

    Raises
    ------
    SettingError
        The method is unknown, a tolerance is not positive, or `max_step` too short for the run.
    SceneError
        Stiff bearings or a long run need more steps than `most_steps` allows; the message names the part.
    """
    settings: dict[str, Any] = {
        "method": method,
        "rtol": rtol,
        "atol": atol,
        "max_step": max_step,
        "rest_rate": rest_rate,
    }
    _check(settings)
    refuse_free(scene, "the second implementation")
    if scene.duration is None:
        return until_decided(functools.partial(simulate_twin, history=history, energy=energy, **settings), scene)
    run = Run(scene, {**settings, "atol": rtol if atol is None else atol}, history, energy)
    _check_cost(run, max_step)
    run.model.bearing.hysteretic(0.0, 1e-6)  # compiled before the time is taken
    started = time.process_time()
    failure = run.go()
    response = run.response(time.process_time() - started, failure)
    return replace(response, decided=is_decided(scene, response))


def _check_cost(run: Run, max_step: float | None) -> None:
    """Refuse a run that needs more steps of the largest length than the model itself may take."""
    end, most = run.scene.end, most_steps(run.scene)
    if end <= most * run.max_step:
        return
    if max_step is not None:
        raise SettingError(f"max_step = {max_step!r}: {end / max_step:.3g} steps; give at least {end / most:.3g} s")
    raise too_long(run.scene, f"{end / run.max_step:.3g} steps of the second implementation")


def _check(settings: Mapping[str, Any]) -> None:
    """Refuse a method that is unknown, or a number that is not positive."""
    require(
        settings["method"] in METHODS, f"method {settings['method']!r} is unknown: choose one of {', '.join(METHODS)}"
    )
    for name, value in settings.items():
        positive = name == "method" or value is None or (value > 0 and math.isfinite(value))
        require(positive, f"{name} = {value!r} is not positive: give a finite value above 0")


class Extremes:
    """Largest tilt [rad], base displacement [m], absolute acceleration [m/s2] and friction demand, least N/(m g).

    All except the tilt leave out the last fall. `held`: their values, and the time [s], when |tilt| last was at most
    the slenderness.
    """

    def __init__(self, tilt: float, x: float, history: bool) -> None:
        self.tilt, self.x, self.acceleration, self.friction, self.normal = abs(tilt), abs(x), 0.0, 0.0, 1.0
        self.held = self.x, self.acceleration, self.friction, self.normal, 0.0
        self.rows: list[Sequence[float]] | None = [] if history else None

    def step(self, row: Sequence[float], absolute: float, horizontal: float, normal: float, slenderness: float) -> None:
        """Include one state: a row of the history, the base's acceleration [m/s2], contact forces over m g."""
        t, tilt, _, x, *_ = row
        self.tilt, self.x = max(self.tilt, abs(tilt)), max(self.x, abs(x))
        self.acceleration = max(self.acceleration, abs(absolute))
        self.friction = max(self.friction, abs(horizontal) / normal if normal > 0 else math.inf)
        self.normal = min(self.normal, normal)
        if abs(tilt) <= slenderness * (1 + ROUNDING):
            self.held = self.x, self.acceleration, self.friction, self.normal, t
        if self.rows is not None:
            self.rows.append(row)

    def exclude_overturning(self) -> float:
        """Remove the last fall of a block that has overturned; return the time [s] at which it began."""
        self.x, self.acceleration, self.friction, self.normal, began = self.held
        return began

    def history(self) -> History | None:
        """Return the `History`, or None."""
        if self.rows is None:
            return None
        return History(*np.array(self.rows).reshape(-1, len(History.COLUMNS)).T)


@dataclass(frozen=True)
class Event:
    """An event of `solve_ivp`: a root of function(t, y).

    terminal: whether it ends the interval. direction: sign of the slope.
    """

    function: Callable[..., float]
    terminal: bool = True
    direction: int = -1

    def __call__(self, t: float, y: np.ndarray) -> float:
        return self.function(t, y)


class Equations:
    """The state y and its derivative: y = [tilt, rate], on a base also x, v and z if integrated, then energy terms.

    t [s]; side of the pivot, 0 in full contact; scale of each component of y; max_step: longest step [s] for the
    bearings.
    """

    vertical: Callable[[float], float]  # a_v(t) [m/s2] of the segment

    def __init__(self, scene: Scene, energy: bool) -> None:
        self.scene, self.energy = scene, energy
        self.model = model = RockingModel.of(scene)
        self.law, self.omega_r = model.bearing, scene.rocking_frequency
        start, length = scene.start, model.R * model.gamma
        y, scale = [start.tilt, start.tilt_rate], [model.gamma, model.gamma * self.omega_r]
        self.x_c, self.z_c = start.base_displacement, self.law.start(start.base_displacement)
        self.max_step = math.inf
        if model.on_base:
            y += [start.base_displacement, start.base_velocity]
            scale += [length, length * self.omega_r]
            stiffness = self.law.count * (self.law.kb + self.law.dk)
            if stiffness > 0:
                self.max_step = 0.5 * math.sqrt(model.M / stiffness)
            if self.law.unit.branch:
                y.append(self.z_c)
                scale.append(self.law.f0)
        if energy:
            extra = 3 if model.on_base else 1
            y += [0.0] * extra
            scale += [model.m * model.g * length * model.gamma] * extra
        self.y, self.scale, self.t = np.array(y), np.array(scale), 0.0
        self.side = math.copysign(1.0, start.tilt or start.tilt_rate) if start.tilt or start.tilt_rate else 0.0

    def contact_acceleration(self, y: np.ndarray, ground: float) -> float:
        """Return the absolute acceleration of the base in full contact [m/s2], eq. (2)."""
        if not self.model.on_base:
            return ground
        return self.model.contact_acceleration(self.bearing_force(y))

    def derivative(self, ground: GroundFunction, direction: float) -> Callable[[float, np.ndarray], np.ndarray]:
        """Return y'(t, y) over an interval. direction: sign of the base velocity."""
        model, law, side, energy, vertical = self.model, self.law, self.side, self.energy, self.vertical
        branch = law.unit.branch and law.unit.branch(self.hysteretic_force(self.y), direction, law.constants)
        if not model.on_base:

            def block_alone(t, y):
                a, up, rate = ground(t), vertical(t), y[1]
                slope = (rate, model.accelerations(side, y[0], rate, a, 0.0, up)[0])
                if not energy:
                    return slope
                c, n = model.lever(side, y[0])
                return (*slope, -model.m * (a * c + up * n) * rate)

            return block_alone

        def block_on_base(t, y):
            a, up, (tilt, rate, x, v) = ground(t), vertical(t), y[:4].tolist()
            z = self.hysteretic_force(y)
            force = law.force(x, z, v)
            if side:
                spin, push = model.accelerations(side, tilt, rate, a, force, up)
            else:
                spin, push = 0.0, model.contact_acceleration(force) - a
            slope = [rate, spin, v, push]
            if branch:
                slope.append(branch(z, v))
            if energy:
                c, n = model.lever(side, tilt) if side else (0.0, 0.0)
                work = -a * (model.M * v + model.m * c * rate) - up * model.m * n * rate
                slope += [work, law.count * z * v, law.count * law.damping * v * v]
            return slope

        return block_on_base

    def hysteretic_force(self, y: np.ndarray) -> float:
        """Return z of one bearing [N]: from the state, or in closed form from the last reversal."""
        return float(y[4]) if self.law.unit.branch else self.law.hysteretic(self.z_c, float(y[2]) - self.x_c)

    def bearing_force(self, y: np.ndarray) -> float:
        """Return the force of all bearings [N], 0 on rigid ground."""
        return self.law.force(float(y[2]), self.hysteretic_force(y), float(y[3])) if self.model.on_base else 0.0

    def fix_history(self) -> None:
        """Store the point of reversal, the memory of the bearing."""
        if self.model.on_base:
            self.z_c, self.x_c = self.hysteretic_force(self.y), float(self.y[2])

    def energies(self) -> tuple[float, float]:
        """Return (kinetic, potential) [J], see `RockingModel`."""
        model, (tilt, rate, *base) = self.model, self.y[:4].tolist()
        x, v = base if model.on_base else (0.0, 0.0)
        return model.kinetic_energy(self.side, tilt, rate, v), model.potential_energy(self.side, tilt, x)

    def state(self) -> State:
        """Return the current `State`."""
        x, v = (float(self.y[2]), float(self.y[3])) if self.model.on_base else (0.0, 0.0)
        return State(self.t, float(self.y[0]), float(self.y[1]), x, v, self.bearing_force(self.y))


class Run(Equations):
    """One run: its current state, its events so far, and the results that are kept."""

    def __init__(self, scene: Scene, settings: Mapping[str, Any], history: bool, energy: bool) -> None:
        super().__init__(scene, energy)
        self.settings, start = settings, scene.start
        if isinstance(scene.motion, SampledMotion):  # two steps a sample, as a single step could skip a hop
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
        """Run to the end or to overturning; return a Failure, or None."""
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
        """Advance over one interval of smooth motion from self.t, at most to `end`."""
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
        """Lift the block: tilt, rate and phi'' are 0, so that the side is opposite to the acceleration."""
        self.side, self.lifted, self.rocked = -math.copysign(1.0, acceleration), self.t, True
        self.uplifts.append(self.t)

    def stand(self, end: float, ground: GroundFunction) -> None:
        """Keep the block in full contact on rigid ground until |a_g| exceeds (g + a_v) tan(gamma)."""

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
        """Return (t, y) in order of time, at steps, reversals of block and base, and passages of the slenderness."""
        points = list(zip(solution.t, solution.y.T, strict=True))
        for (_, event), times, states in zip(events, solution.t_events, solution.y_events, strict=True):
            if not event.terminal:
                points += zip(times, states, strict=True)
        return sorted(points, key=lambda each: each[0])

    def stepped_over(self, events: Sequence[tuple[str, Event]], solution: Any) -> float | None:
        """Return the time of the first extreme beyond a threshold that was crossed twice within one step, or None.

        These are a tilt below 0 where its rate is 0 and, where the base stands still, |a_abs| above g tan(gamma) or the
        bearing beyond its corner.
        """
        crossings = []
        for (name, _), times, states in zip(events, solution.t_events, solution.y_events, strict=True):
            for t, y in zip(times, states, strict=True):
                if name == "apex" and self.side * y[0] < 0:
                    crossings.append(float(t))
                elif name == "reversal" and self.side == 0:
                    limit = self.model.uplift_limit(self.vertical(t))
                    if abs(self.contact_acceleration(y, 0.0)) > limit * (1 + 1e-13):
                        crossings.append(float(t))
                if name == "reversal" and abs(self.corner) < math.inf and abs(y[4]) > abs(self.corner):
                    crossings.append(math.nextafter(t, self.t))
        return min(crossings, default=None)

    def direction(self, end: float, ground: GroundFunction) -> float:
        """Return the sign of the base velocity over the coming stretch; where the base stands, of its acceleration."""
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
        """Return (name, `Event`) of all events of an integration.

        A terminal event ends the interval, and the method at_NAME applies it.
        """
        side, model, lifted, turned = self.side, self.model, self.lifted, self.turned
        events = []
        if side:
            # the root phi = 0 at uplift is divided out
            events.append(("impact", Event(lambda t, y: side * y[0] / (t - lifted) if t > lifted else 1.0)))
            events.append(("overturning", Event(lambda t, y: side * y[0] - math.pi / 2, direction=1)))
            events.append(("apex", Event(lambda t, y: side * y[1], terminal=False, direction=0)))
            events.append(("unstable", Event(lambda t, y: side * y[0] - model.gamma, terminal=False, direction=1)))
        else:
            limit, vertical = model.uplift_limit, self.vertical
            events.append(
                ("uplift", Event(lambda t, y: abs(self.contact_acceleration(y, 0.0)) - limit(vertical(t)), direction=1))
            )
        if direction:
            stops = self.law.unit.memory  # else there may be several, each a peak
            reversal = Event(lambda t, y: direction * y[3] if t > turned else 1.0, stops, -1 if stops else 0)
            events.append(("reversal", reversal))
            ahead = self.law.unit.begin.py_func(direction, self.hysteretic_force(self.y), 1.0, 0.0, self.law.constants)[
                2
            ]
            self.corner = corner = direction * ahead
            if ahead < math.inf:
                events.append(("corner", Event(lambda t, y: direction * (y[4] - corner), direction=1)))
        return events

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
        """Apply eqs (7), (8); then the other corner, or rest if impacts accumulate under a compressive force."""
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
        this_side, other_side = (
            -side * model.accelerations(side, 0.0, y[1], ground, force, self.vertical(self.t))[0]
            for side in (self.side, -self.side)
        )
        held, remaining = min(this_side, other_side) > 0, math.inf
        if held and e < 1:  # two geometric series
            remaining = 2 * abs(y[1]) / (1 - e * e) * (1 / this_side + e / other_side)
        if this_side > 0:
            self.flight = 2.2 * abs(y[1]) / this_side or None
        resting = abs(y[1]) < self.settings["rest_rate"] * self.omega_r
        if y[1] == 0 or (resting and remaining * self.omega_r < REST_HORIZON):
            if model.on_base:  # the remaining momentum goes to the base, as at an impact with restitution 0
                y[3] += model.mass_share * model.R * math.cos(model.gamma) * y[1]
            y[1], self.side, self.flight = 0.0, 0.0, None
            if held:
                self.rests.append(float(self.t + remaining))
        self.impact_loss += kinetic - self.energies()[0]

    # results

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
        """Return the energy balance from the start to now."""
        kinetic, potential = (after - before for after, before in zip(self.energies(), self.stored, strict=True))
        work = self.y[-3:].tolist() if self.model.on_base else [float(self.y[-1]), 0.0, 0.0]
        return Energy(*[kinetic, potential, *work, float(self.impact_loss)])

    def response(self, cpu_seconds: float, failure: Failure | None) -> Response:
        """Return the `Response` of the run."""
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
