"""The stepping loop of a leapfrog engine: step lengths, loads, recorded rows, and the end of a run.

Leapfrog: displacements are known at the steps' ends t_n, velocities half a step earlier. The time between the
velocities at t_n - h/2 and t_n + h'/2 is (h + h')/2, but an engine multiplies the loads of a step by its own h'. Loads
scaled by (h + h')/(2 h') make the scheme second order for any sequence of steps, the start included (h = 0).

Only the engine moves a body or sets a velocity. The adapter gives it the loads and the length of the step, and checks
once that it holds the values it was given (`require`).

The length of a step in a simulation with contacts follows from gaps and closing speeds only:

    h = clamp(min((1 + growth) h, share * gap/closing over contact points on their way to a landing), h_min, h_max)

A point is on its way to a landing if it closes with a gap above near * g h^2, or faster than 2 g h. The step does not
grow for 4 steps after a point that has sunk closes as fast. The rule holds for any scene in which gravity g sets the
time scale of free motion: it uses neither shapes nor the theory of rocking.

A row is (time [s], length of the step that led there [s], tilt [rad], its rate [rad/s], base displacement [m] and
velocity [m/s], hysteretic force of one bearing [N], total force without viscous part [N]) and, where read, the block's
centre x, z [m] and x', z' [m/s] as in `Trace.centre`. Rates are half a step early, except at the start.
"""

from __future__ import annotations

import math
import time
from array import array
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from analytic.motion import vertical_acceleration
from analytic.response import Failure
from analytic.rocking import BearingLaw, RockingModel
from analytic.stack.equations import LOWER, UPPER

from .contract import Mismatch, Run
from .loads import (
    Couple,
    added_mass,
    driven_mass,
    ground_velocity,
    leapfrog_stiffness,
    longest_step,
    placement,
    placements,
    size_scale,
    slabs_of,
)
from .swings import StackTrace, Trace

# Insensitive: a share of .1 to .45, growth of .2 to 1 and hold of 1 to 10 change the error of e by factors of .9 to 1.5
# in four engines. With a share of .7 or more, points land in steps that are too long.
SHARE, GROWTH, HOLD = 0.3, 0.5, 4
# A body that pivots at the rate w about a held point moves along the tangent in a step and rises by w^2 R h^2/2, at
# most .1 g h^2 for a block that does not overturn. It falls back at g h or less, which does not count as a landing.
# Insensitive: NEAR .15 to 1, SLOW 1 to 4; with .1 and less, steps shrink for the hops of DART's standing corners, and
# its peak tilts are off by up to 4e-2.
NEAR, SLOW = 0.25, 2.0

LEAST_AHEAD = 1e-3  # of a step: a jump that is closer does not get its own step
ROUNDING = 1e-9  # of a step: tolerated difference of the steps' sum from the duration

Rule = Callable[[Sequence[tuple[float, float]]], float]  # from (gap, closing speed) of each contact point to a step


def gap_rule(largest: float, smallest: float, gravity: float) -> Rule:
    """The `Rule` in the module's docstring; before the first step, h is the smallest one.

    Parameters
    ----------
    largest, smallest : float
        Limits of a step [s].
    gravity : float
        g [m/s2].

    Returns
    -------
    function
        From the (gap [m], closing speed [m/s]) of each contact point to the length of the next step [s].
    """
    step, hold = smallest, 0

    def length(points):
        nonlocal step, hold
        gained = gravity * step
        wanted, slow, near = largest, SLOW * gained, NEAR * gained * step
        for gap, closing in points:
            if closing > slow or (closing > 0 and gap > near):
                if gap <= 0:
                    hold = HOLD
                elif SHARE * gap < wanted * closing:
                    wanted = SHARE * gap / closing
        longest = step if hold else (1 + GROWTH) * step
        hold = max(hold - 1, 0)
        step = max(min(wanted, longest), smallest)
        return step

    return length


def fixed_rule(step: float) -> Rule:
    """The `Rule` of a constant step [s]."""
    return lambda points: step


def limits(
    duration: float, largest: float, jumps: Iterable[float] = ()
) -> tuple[float, Callable[[float, float], tuple[float, float]]]:
    """Return the first time that the steps must meet, and a function that shortens a step to meet it.

    The times are the `jumps` of the ground acceleration, in ascending order, and the end of the run. The function maps
    (t, step) to the adjusted step and the next such time. `largest` is the longest step. All are in the same unit.
    """
    ahead = iter(jumps)
    jump, gate = next(ahead, math.inf), duration - ROUNDING * largest + 2 * ROUNDING * largest

    def fitted(t, step):
        nonlocal jump
        if t + step >= jump:
            if t >= jump:
                jump = next(ahead, math.inf)
            step = aligned(step, jump - t)
        return (duration - t if t + step > gate else step), min(jump, gate)

    return min(jump, gate), fitted


def aligned(step: float, ahead: float) -> float:
    """The step [s] of a leapfrog, shortened if a jump of the ground acceleration lies `ahead` [s] within it.

    The jump must fall between two impulses, each of which covers half of the steps before and after it. An impulse that
    contains the jump delays the uplift of a block.
    """
    if not LEAST_AHEAD * step < ahead <= step:
        return step
    return 2 * ahead if 2 * ahead <= step else 2 / 3 * ahead


if TYPE_CHECKING:
    from analytic import Scene

# Steps after which a run is given up: this many per largest step of the duration, and a reserve for the impacts.
ROWS_PER_STEP, RESERVE, MOST_ROWS = 50, 100_000, 20_000_000


def row_limit(duration: float, largest: float) -> int:
    """Largest number of steps of a run, from its duration and largest step [same unit of time]."""
    return int(min(MOST_ROWS, ROWS_PER_STEP * duration / largest + RESERVE))


def failure_of(scene: Scene, rows: Sequence[Sequence[float]] | np.ndarray, ended: str | None) -> Failure | None:
    """The `Failure` of a run that ended as "not finite" or "too many steps", else None."""
    count, t = len(rows) - 1, rows[-1][0]
    if ended == "not finite":
        return Failure("the state is no longer finite", f"at step {count}, t = {t:.9g} s")
    if ended == "too many steps":
        return Failure(ended, f"{count} by t = {t:.9g} s of {scene.duration:.9g} s")
    return None


def trace_of(
    rows: Sequence[Sequence[float]] | np.ndarray, scene: Scene, contact_tilt: float, smeared: int | None = None
) -> Trace:
    """The `Trace` of rows, with velocities interpolated to the times of the displacements.

    A velocity at t_n is the mean of its neighbours, weighted by their distance. Contact solvers spread an impact over
    the steps that reach contact and leave it; there the velocity is extrapolated from the neighbours in flight.
    smeared: number of steps on each side of tilt = 0 to which this applies; None: all steps at the contact tilt.
    """
    t, h, tilt, rate, x, v, _, force, *centre = np.array(rows).T
    law = RockingModel.of(scene).bearing
    if len(rows) >= 4:
        side = np.where(np.abs(tilt) > contact_tilt, np.sign(tilt), 0.0)
        changes = side[1:] != side[:-1]
        leaving = np.append(changes, False) & (side != 0)  # the next step is at contact or beyond
        coming = np.append(False, changes) & (side != 0)
        if smeared is not None:
            crossed = np.flatnonzero((tilt[1:] > 0) != (tilt[:-1] > 0))
            close = np.zeros(len(t), dtype=bool)
            for shift in range(1 - smeared, smeared + 1):
                close[np.clip(crossed + shift, 0, len(t) - 1)] = True
            leaving, coming = leaving & close, coming & close
        rate, v, *centre[2:] = (
            _synchronised(value, h, leaving & ~coming, coming & ~leaving) for value in (rate, v, *centre[2:])
        )
    return Trace(
        t,
        tilt,
        rate,
        x,
        v,
        force + law.count * law.damping * v,
        contact_tilt,
        centre=np.column_stack(centre) if centre else None,
    )


def _synchronised(value: np.ndarray, h: np.ndarray, from_before: np.ndarray, from_after: np.ndarray) -> np.ndarray:
    """`value`, known half a step early, interpolated to the steps' ends."""
    gain = np.diff(value) / (0.5 * (h[1:] + h[:-1]))  # per second, at t_0 .. t_(n-2)
    result = value.copy()  # the start is not half a step early
    result[1:-1] = (value[1:-1] * h[2:] + value[2:] * h[1:-1]) / (h[1:-1] + h[2:])
    result[-1] = value[-1] + 0.5 * h[-1] * gain[-1]
    i = np.flatnonzero(from_before[2:]) + 2
    result[i] = value[i] + 0.5 * h[i] * gain[i - 1]
    i = np.flatnonzero(from_after[1:-2]) + 1
    result[i] = value[i + 1] - 0.5 * h[i + 1] * gain[i + 1]
    return result


def raw_trace_of(rows: Sequence[Sequence[float]] | np.ndarray, scene: Scene, contact_tilt: float) -> Trace:
    """The `Trace` of uncorrected rows, as in a first script.

    The block's position is read only in a stack, and where it may slide.
    """
    t, _, tilt, rate, x, v, _, force, *centre = np.array(rows).T
    law = RockingModel.of(scene).bearing
    place = np.column_stack(centre) if centre and (scene.is_stack or scene.friction is not None) else None
    total = force + law.count * law.damping * v
    return Trace(t, tilt, rate, x, v, total, contact_tilt, centre=place, first_script=True)


# s, at `loads.UNIT_RADIUS` and the default level. On a light base the error of e is proportional to it.
SMALLEST_STEP = 1e-6
# s, likewise: time before a landing in which the couple of a given restitution acts, a hundred of these. With 2e-4 and
# 4e-4 e is up to 2 and 4 times as far off on a base.
ACTS = 1e-4
SMEARED = 3  # steps before and after an impact over which a contact solver may spread it; see `trace_of`
LANDING = 1.0  # largest landing speed of a corner, over the slenderness, the width 2 b and sqrt(g/R)
# Numbers that were chosen in impact-aware steps, for `engines.contract.Variant.constants`.
CONSTANTS = {
    "largest_step": "longest step in flight and at rest [s], the accuracy parameter",
    "engines.loop:SMALLEST_STEP": "step while a corner lands [s]",
    "engines.loop:SHARE": "step over the time to a landing",
    "engines.loop:GROWTH": "largest growth of a step over the one before",
    "engines.loop:HOLD": "steps after a landing for which the step does not grow",
    "engines.loop:SLOW": "closing speed above which a corner counts as landing at any gap, over g h",
    "engines.loop:NEAR": "least gap of a closing corner that counts as landing, over g h^2",
    "engines.loop:LEAST_AHEAD": "least time to a jump of the ground motion that gets its own step, over the step",
    "engines.loop:ROUNDING": "tolerated difference of the steps' sum from the duration, over the step",
    "engines.loop:LANDING": "largest speed of a landing corner at which contact counts as flat",
    "engines.loop:SMEARED": "steps before and after an impact over which it may be spread in the trace",
    "engines.loop:ACTS": "time before a landing in which the couple of a given restitution acts [s]",
    "engines.loads:VIBRATION": "step over the time in which the bearings' vibration advances by 1 rad",
    "engines.loads:STIFF": "the same ratio, above which the leapfrog's period error is corrected",
}
# What the adapters of leapfrog engines impose, for `engines.contract.Variant.imposes`.
MEAN_LOADS = (
    "loads times (step + step before)/(2 step), the ground's as its mean; dampers and stiff bearings as mass added to "
    "the base; velocities read half a step early"
)
RULED = f"steps by gaps and closing speeds, which meet jumps of the ground's acceleration; {MEAN_LOADS}"
GIVEN = "restitution given: a couple before each landing"
SAMPLED = "loads as where a step begins"
ENDS = ("done", "overturned", "not finite", "too many steps")  # any other end is the engine's message, "what: why"

# Tilt [rad] and its rate; x, z [m] and x', z' of the block's centre, measured from its position when standing at the
# origin; x, x' of the base.
State = tuple[float, float, float, float, float, float, float, float]
Loads = Callable[[float, float, float, float, float], tuple[float, float, float]]


class NoSolution(RuntimeError):
    """The engine finds no velocities for a step; the message is the engine's, "what: why"."""


class Bodies(Protocol):
    """The block and the base of a scene as an engine holds them.

    Those of a variant that takes a restitution have a method ``twist(moment)``, too: it applies a couple [N m] to the
    block in the next step, and is called before every one.
    """

    def step(self, step: float, before: float, across: float, up: float, impulse: float) -> Sequence[float]:
        """Advance the engine by one step and return the `State` of its bodies.

        That of a stack begins with the tilt, rate, x, z, x', z' of the pedestal.

        Parameters
        ----------
        step, before : float
            Length of the step and of the one before it (0 at the start) [s].
        across, up : float
            Velocity that gravity and ground motion add to every body in the step [m/s].
        impulse : float
            Impulse of the bearings on the base [N s].

        Raises
        ------
        NoSolution
        """

    def weigh(self, added: float) -> None:
        """Set the mass of the base to its own plus `added` [kg]."""


def march(
    bodies: Bodies, scene: Scene, duration: float, rule: Rule, loads: Loads, largest: float, jumps: Iterable[float] = ()
) -> tuple[np.ndarray, str]:
    """Step until the duration is over, the block has overturned, a state is not finite or there is no solution.

    Return (rows, ended): rows as in the module's docstring, the start first; one of `ENDS`, or the message of a
    `NoSolution`.

    Parameters
    ----------
    bodies, scene
        The bodies of the scene at its start.
    duration, largest : float
        Duration of the run, in place of the scene's, and longest step [s].
    rule, loads : function
        A `Rule`, whose contact points are the bottom corners; and (time, step, step before, base velocity, bearing
        force without viscous part) -> the arguments of `Bodies.step`.
    jumps : iterable of float
        Times [s] of jumps of the ground acceleration, with which the steps are aligned.
    """
    law, start, loaded = BearingLaw.of(scene.bearings), scene.start, scene.bearings is not None
    half, high, fallen = scene.block.half_width, scene.block.half_height, 0.5 * math.pi
    limit, fitted = limits(duration, largest, jumps)
    cos, sin, isfinite, advance, hysteretic = math.cos, math.sin, math.isfinite, bodies.step, law.hysteretic
    t, h, tilt, rate, base, v = 0.0, 0.0, start.tilt, start.tilt_rate, start.base_displacement, start.base_velocity
    x, z, vx, vz = placement(scene)
    history = law.start(base)
    force, couple = law.force(base, history), couple_of(scene)
    rows = array("d", (t, h, tilt, rate, base, v, history, force, x, z, vx, vz))
    keep, width, end, ended = rows.extend, len(rows), duration - ROUNDING * largest, "too many steps"
    for _ in range(row_limit(duration, largest)):
        c, s = cos(tilt), sin(tilt)
        mean, lower, sinking, turning = z + high * (1 - c), half * s, -vz - high * s * rate, half * c * rate
        step = rule(((mean - lower, sinking + turning), (mean + lower, sinking - turning)))
        if t + step >= limit:
            step, limit = fitted(t, step)
        across, up, impulse = loads(t, step, h, v, force)
        if not isfinite(across + up + impulse):  # an engine may ignore such a load
            ended = "not finite"
            break
        if couple:
            bodies.twist(couple.moment(step, tilt, rate))  # type: ignore[attr-defined]  # see `Bodies`
        before = base
        try:
            tilt, rate, x, z, vx, vz, base, v = advance(step, h, across, up, impulse)
        except NoSolution as error:
            ended = str(error)
            break
        if loaded:
            history = hysteretic(history, base - before)
            force = law.force(base, history)
        t, h = t + step, step
        keep((t, h, tilt, rate, base, v, history, force, x, z, vx, vz))
        if not -fallen < tilt < fallen or not isfinite(rate + vx + vz):
            ended = "overturned" if isfinite(tilt + rate + vx + vz) else "not finite"
            break
        if t >= end:
            ended = "done"
            break
    return np.frombuffer(rows).reshape(-1, width), ended


def couple_of(scene: Scene) -> Couple | None:
    """The couple of a scene that gives the restitution, else None."""
    return Couple.of(scene, ACTS * size_scale(scene))


def mean_loads(scene: Scene, bodies: Bodies, largest: float) -> Loads:
    """The `loads` of `march` for the mean of two steps; the impulse of the ground motion is exact."""
    law, model = BearingLaw.of(scene.bearings), RockingModel.of(scene)
    damping, mass, g = law.count * law.damping, driven_mass(model), model.g
    heavier = leapfrog_stiffness(law, largest, mass)
    ground, upright = ground_velocity(scene.motion), ground_velocity(scene.motion and scene.motion.vertical)
    gained = risen = across = weighed = added = 0.0

    def loads(t, step, h, v, force):
        nonlocal gained, risen, across, weighed, added
        interval = 0.5 * (step + h)
        up = -g * interval
        if ground:
            before, gained = gained, ground(t + 0.5 * step)
            across = before - gained
        if upright:
            before, risen = risen, upright(t + 0.5 * step)
            up += before - risen
        if not (damping or heavier):
            return across, up, -force * interval
        if interval != weighed:
            weighed, added = interval, added_mass(damping, interval, mass) + heavier * interval * interval
            bodies.weigh(added)
        return across, up, -(force + damping * v) * interval - added * across

    return loads


def sampled_loads(scene: Scene) -> Loads:
    """The `loads` of `march` sampled at the start of the step, as in a first script."""
    law, g, motion = BearingLaw.of(scene.bearings), scene.gravity, scene.motion
    damping = law.count * law.damping

    def loads(t, step, h, v, force):
        across = -float(motion.acceleration(t)) if motion else 0.0
        up = -g - float(vertical_acceleration(motion, t))
        return across * step, up * step, -(force + damping * v) * step

    return loads


class Pair:
    """An engine's two bodies as the `Bodies` of `march`, which sees the one that is tilted more; keeps their states."""

    def __init__(self, bodies: Bodies, scene: Scene, pedestal_tilt: float) -> None:
        self.bodies, self.slabs, self.weigh = bodies, slabs_of(scene), bodies.weigh
        self.now: list[float] = []
        for (x, vx), (z, vz), (tilt, rate) in placements(scene, pedestal_tilt):
            self.now += [tilt, rate, x, z, vx, vz]
        self.states = array("d", self.now)

    def step(self, *loads: float) -> Sequence[float]:
        """A step: see `engines.loop.Bodies`."""
        *self.now, base, v = self.bodies.step(*loads)
        self.states.extend(self.now)
        first, w1, _, _, vx1, vz1, second, w2, x, z, vx2, vz2 = self.now
        tilt = second - first if abs(second - first) > abs(first) else first  # a NaN in any is one here
        return tilt, w1 + w2, x, z, vx1 + vx2, vz1 + vz2, base, v

    def ruled(self, rule: Rule) -> Rule:
        """The `Rule` of the four corners: two of the pedestal, two of the block over the pedestal's top."""
        return lambda _: rule(self.corners())

    def corners(self) -> tuple[tuple[float, float], ...]:
        """(Gap [m], closing speed [m/s]) of each corner."""
        first, w1, x1, z1, vx1, vz1, second, w2, x2, z2, vx2, vz2 = self.now
        (one, two), c, s = self.slabs, math.cos(first), math.sin(first)
        # of the block's centre from the pedestal's, along the pedestal's axes
        x, z, vx, vz = x2 - x1, z2 - z1 + one.h + two.h, vx2 - vx1, vz2 - vz1
        high, rising = x * s + z * c - one.h, vx * s + vz * c + w1 * (x * c - z * s)
        return (
            *_corners(z1 + one.h, vz1, first, w1, one.b, one.h),
            *_corners(high, rising, second - first, w2 - w1, two.b, two.h),
        )

    def trace(self, rows: np.ndarray, traced: Callable[[np.ndarray], Trace]) -> StackTrace:
        """The `StackTrace` of the rows of `march`; traced: from such rows of one block to its `Trace`.

        What the block's traces take as contact holds of the pedestal, too: it is at least as wide, so that a
        penetration tilts it by less.
        """
        states = np.hsplit(np.frombuffer(self.states).reshape(-1, 12), 2)
        states[UPPER] = states[UPPER] - states[LOWER] * [1, 1, 0, 0, 0, 0]
        lower, upper = (
            traced(np.column_stack([rows[:, :2], state[:, :2], rows[:, 4:8], state[:, 2:]])) for state in states
        )
        return StackTrace(**vars(upper), pedestal=lower, hysteretic=rows[:, 6])


def _corners(
    high: float, rising: float, tilt: float, rate: float, b: float, h: float
) -> tuple[tuple[float, float], tuple[float, float]]:
    """(Gap, closing speed) of both corners of a block whose centre is `high` over its support; all relative to that."""
    c, s = math.cos(tilt), math.sin(tilt)
    mean, lower, sinking, turning = high - h * c, b * s, -rising - h * s * rate, b * c * rate
    return (mean - lower, sinking + turning), (mean + lower, sinking - turning)


@dataclass(frozen=True)
class ImpactAware:
    """Steps by gaps and closing speeds: small where a corner lands, at most `largest_step` [s] elsewhere.

    `largest_step` is the accuracy parameter. The error from flight is proportional to its square, the error from
    landings to the smallest step. The smallest step is therefore `SMALLEST_STEP` at a largest step of `balanced_step`
    [s], and proportional to the square of the largest. Steps are given for the Caryatid's R; times scale with
    sqrt(R/g).
    """

    largest_step: float = 2e-4
    balanced_step: float = 2e-4


@dataclass(frozen=True)
class FixedStep:
    """Steps of equal length: `step` [s], given for the Caryatid's R, is the accuracy parameter."""

    step: float


@dataclass(frozen=True)
class FirstScript:
    """The engine's defaults, with loads and states not corrected: `step` [s] is the accuracy parameter."""

    step: float


Settings = ImpactAware | FixedStep | FirstScript


def run_of(
    scene: Scene,
    settings: Settings,
    bodies_of: Callable[[float], Bodies],
    raw: Callable[[np.ndarray], Trace],
    depth: float = SLOW,
    pedestal_tilt: float = 0.0,
) -> Run:
    """The `Run` of a scene.

    Parameters
    ----------
    scene : Scene
    settings : ImpactAware or FixedStep or FirstScript
    bodies_of : function
        From the longest step [s] to the engine's bodies; it may raise `Mismatch`.
    raw : function
        From rows to the trace of a first script.
    depth : float
        Largest penetration of a corner that closes too slowly for the rule, over g h^2.
    pedestal_tilt : float
        Tilt of a free pedestal at the start [rad].
    """
    largest, smallest = step_limits(scene, settings)
    duration = scene.duration or 0.0  # never None in a run
    if duration / largest > MOST_ROWS:
        count = f"{duration / largest:.3g} for {duration:.6g} s; at most {MOST_ROWS}"
        return Run(None, 0, math.nan, Failure("too many steps", f"steps of {largest:.3g} s: {count}"))
    try:
        bodies = bodies_of(largest)
    except Mismatch as error:
        return Run(None, 0, math.nan, Failure("the engine does not hold the scene", str(error)))
    if scene.is_stack:
        bodies = pair = Pair(bodies, scene, pedestal_tilt)
    clock = time.process_time()
    if isinstance(settings, ImpactAware):
        rule, jumps = gap_rule(largest, smallest, scene.gravity), scene.motion.jumps if scene.motion else ()
        if scene.is_stack:
            rule = pair.ruled(rule)
    else:
        rule, jumps = fixed_rule(largest), ()
    if isinstance(settings, FirstScript):  # all steps are the same
        duration = largest * max(round(duration / largest), 1)
    loads = sampled_loads(scene) if isinstance(settings, FirstScript) else mean_loads(scene, bodies, largest)
    rows, ended = march(bodies, scene, duration, rule, loads, largest, jumps)
    cpu = time.process_time() - clock
    traced = raw
    if not isinstance(settings, FirstScript):
        contact = contact_tilt(scene, largest, smallest, depth)
        traced = partial(trace_of, scene=scene, contact_tilt=contact, smeared=SMEARED)
    trace = pair.trace(rows, traced) if scene.is_stack else traced(rows)
    if couple := couple_of(scene):
        trace = replace(trace, early=couple.lasts)
    failure = failure_of(scene, rows, ended)
    if ended not in ENDS:
        reason, _, why = ended.partition(": ")
        failure = Failure(reason, f"at step {len(rows) - 1}, t = {rows[-1][0]:.9g} s: {why}")
    return Run(trace, len(rows) - 1, cpu, failure, "overturned" if ended == "overturned" else None)


def step_limits(scene: Scene, settings: Settings) -> tuple[float, float]:
    """Limits of a scene's steps: (largest, smallest) [s]. Stiff bearings may shorten those of the settings."""
    if isinstance(settings, FirstScript):
        return settings.step, settings.step
    scale = size_scale(scene)
    if isinstance(settings, FixedStep):
        step = longest_step(scene, settings.step * scale)
        return step, step
    largest = longest_step(scene, settings.largest_step * scale)
    finer = (settings.largest_step / settings.balanced_step) ** 2
    return largest, min(largest, SMALLEST_STEP * finer * scale)


def contact_tilt(scene: Scene, largest: float, smallest: float, depth: float) -> float:
    """Tilt [rad] below which the block counts as in flat contact.

    It is twice the largest penetration of a corner, over 2 b.
    A corner whose landing the rule anticipates sinks by its speed times the smallest step, any other by `depth` g h^2
    at most.
    """
    block, g = scene.block, scene.gravity
    landing = LANDING * block.slenderness * math.sqrt(g / block.radius) * smallest
    return landing + depth * g * largest * largest / block.half_width


RELATIVE, ABSOLUTE = 1e-12, 1e-14  # round-off


def require(values: Iterable[tuple[str, Any, Any]]) -> None:
    """Raise `Mismatch` naming what an engine holds that differs from what it was given.

    Parameters
    ----------
    values : iterable of (name, used, wanted)
        Numbers or arrays; one number may be wanted for all entries of an array.
    """
    wrong = [
        f"{name} is {np.asarray(used).tolist()}, not {np.asarray(wanted).tolist()}"
        for name, used, wanted in values
        if not _same(used, wanted)
    ]
    if wrong:
        raise Mismatch("; ".join(wrong))


def _same(used: Any, wanted: Any) -> bool:
    if isinstance(used, int | float) and isinstance(wanted, int | float):
        return abs(used - wanted) <= ABSOLUTE + RELATIVE * abs(wanted)  # not for NaN
    return np.size(wanted) in (1, np.size(used)) and np.allclose(used, wanted, RELATIVE, ABSOLUTE)
