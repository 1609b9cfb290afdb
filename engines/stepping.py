"""The stepping loop of a leapfrog engine: step lengths, loads, stored rows, and the end of a run.

Leapfrog: displacements are known at the steps' ends t_n, velocities half a step earlier. The time between the
velocities at t_n - h/2 and t_n + h'/2 is (h + h')/2, but an engine multiplies the loads of a step by its own h'. Loads
scaled by (h + h')/(2 h') make the scheme second order for any sequence of steps, the start included (h = 0).

Only the engine moves a body or sets a velocity. The adapter gives it the loads and the length of the step.
"""

from __future__ import annotations

import math
import time
from array import array
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Protocol

import numpy as np

from analytic.bearing import BearingLaw
from analytic.motion import vertical_acceleration
from analytic.response import Failure
from analytic.rocking import RockingModel

from .contract import Mismatch, Run
from .couple import Couple
from .ground_velocity import ground_velocity
from .leapfrog import MOST_ROWS, failure_of, row_limit, trace_of
from .placement import placement
from .scale import size_scale
from .step_size import ROUNDING, SLOW, Rule, fixed_rule, gap_rule, limits
from .vibration import added_mass, driven_mass, leapfrog_stiffness, longest_step

if TYPE_CHECKING:
    from analytic import Scene

    from .swings import Trace

# s, at `scale.UNIT_RADIUS` and the default level. On a light base the error of e is proportional to it.
SMALLEST_STEP = 1e-6
# s, likewise: time before a landing in which the couple of a given restitution acts, a hundred of these. With 2e-4 and
# 4e-4 e is up to 2 and 4 times as far off on a base.
ACTS = 1e-4
SMEARED = 3  # steps before and after an impact over which a contact solver may spread it; see `leapfrog.trace_of`
LANDING = 1.0  # largest landing speed of a corner, over the slenderness, the width 2 b and sqrt(g/R)
# Numbers that were chosen in impact-aware steps, for `engines.contract.Variant.constants`.
CONSTANTS = {
    "largest_step": "longest step in flight and at rest [s], the accuracy parameter",
    "engines.stepping:SMALLEST_STEP": "step while a corner lands [s]",
    "engines.step_size:SHARE": "step over the time to a landing",
    "engines.step_size:GROWTH": "largest growth of a step over the one before",
    "engines.step_size:HOLD": "steps after a landing for which the step does not grow",
    "engines.step_size:SLOW": "closing speed above which a corner counts as landing at any gap, over g h",
    "engines.step_size:NEAR": "least gap of a closing corner that counts as landing, over g h^2",
    "engines.step_size:LEAST_AHEAD": "least time to a jump of the ground motion that gets its own step, over the step",
    "engines.step_size:ROUNDING": "tolerated difference of the steps' sum from the duration, over the step",
    "engines.stepping:LANDING": "largest speed of a landing corner at which contact counts as flat",
    "engines.stepping:SMEARED": "steps before and after an impact over which it may be spread in the trace",
    "engines.stepping:ACTS": "time before a landing in which the couple of a given restitution acts [s]",
    "engines.vibration:VIBRATION": "step over the time in which the bearings' vibration advances by 1 rad",
    "engines.vibration:STIFF": "the same ratio, above which the leapfrog's period error is corrected",
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

    def step(self, step: float, before: float, across: float, up: float, impulse: float) -> State:
        """Advance the engine by one step and return the state of its bodies.

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

    Parameters
    ----------
    bodies : Bodies
        At the scene's start.
    scene : Scene
    duration : float
        Duration of the run [s], in place of the scene's.
    rule : function
        A rule of `engines.step_size`; its contact points are the bottom corners.
    loads : function
        (time, step, step before, base velocity, bearing force without viscous part) -> the arguments of `Bodies.step`.
    largest : float
        Longest step [s].
    jumps : iterable of float
        Times [s] of jumps of the ground acceleration, with which the steps are aligned.

    Returns
    -------
    rows, ended
        Rows as in `engines.leapfrog`, the start first; and "done", "overturned", "not finite", "too many steps", or the
        message of a `NoSolution`.
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
    gained = risen = across = held = added = 0.0

    def loads(t, step, h, v, force):
        nonlocal gained, risen, across, held, added
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
        if interval != held:
            held, added = interval, added_mass(damping, interval, mass) + heavier * interval * interval
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
    clock = time.process_time()
    if isinstance(settings, ImpactAware):
        rule, jumps = gap_rule(largest, smallest, scene.gravity), scene.motion.jumps if scene.motion else ()
    else:
        rule, jumps = fixed_rule(largest), ()
    if isinstance(settings, FirstScript):  # all steps are the same
        duration = largest * max(round(duration / largest), 1)
    loads = sampled_loads(scene) if isinstance(settings, FirstScript) else mean_loads(scene, bodies, largest)
    rows, ended = march(bodies, scene, duration, rule, loads, largest, jumps)
    cpu = time.process_time() - clock
    if isinstance(settings, FirstScript):
        trace = raw(rows)
    else:
        trace = trace_of(rows, scene, contact_tilt(scene, largest, smallest, depth), smeared=SMEARED)
        if couple := couple_of(scene):
            trace = replace(trace, early=couple.lasts)
    failure = failure_of(scene, rows, ended)
    if ended not in ENDS:
        reason, _, why = ended.partition(": ")
        failure = Failure(reason, f"at step {len(rows) - 1}, t = {rows[-1][0]:.9g} s: {why}")
    return Run(trace, len(rows) - 1, cpu, failure, "overturned" if ended == "overturned" else None)


def step_limits(scene: Scene, settings: Settings) -> tuple[float, float]:
    """(largest, smallest) step [s] of a scene; stiff bearings may need shorter steps than the settings ask for."""
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
    """Tilt [rad] below which the block counts as in flat contact: twice the largest penetration of a corner, over 2 b.

    A corner whose landing the rule anticipates sinks by its speed times the smallest step, any other by `depth` g h^2
    at most.
    """
    block, g = scene.block, scene.gravity
    landing = LANDING * block.slenderness * math.sqrt(g / block.radius) * smallest
    return landing + depth * g * largest * largest / block.half_width
