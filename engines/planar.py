"""Engines whose own way is along the tangent, at their best: the loop that paces them, kicks and moves their bodies.

Such an engine is a `Bodies`: it solves a kick, contacts included, and says the velocities that it leaves. Steps, loads,
ways and rows are the same code for all; it is leapfrog, as Bullet is (see `engines.pybullet.stepping`).
"""

from __future__ import annotations

import math
import time
from abc import ABC, abstractmethod
from array import array
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from analytic.response import Failure
from analytic.rocking import RockingModel

from .contract import Run
from .kicks import pushes
from .leapfrog import failure_of, row_limit, trace_of
from .pace import FLAT, REST, ROUNDING, THROWN, StepRule, impact_aware, least_pull, limits
from .pivoting import Block
from .placement import placement
from .scale import size_scale
from .sliding import SlidingBase
from .vibration import VISCOUS, base_decay, longest_step

if TYPE_CHECKING:
    from analytic import Scene

    from .swings import Trace

APPROACH = 0.3  # share of the remaining time to the impact that a step may take
SMALLEST_STEP = 1e-7  # s, at `scale.UNIT_RADIUS`
ENDS = ("done", "overturned", "not finite", "too many steps")  # all others are an engine's words, "what: why"


@dataclass(frozen=True)
class ImpactAware:
    """Large steps in flight and at rest, small ones on the way to an impact.

    accuracy is the one knob: the share of its speed at the impact that the block may gain in one step there; the error
    of e is about as large. largest_step [s] is that of flight and rest for the Caryatid's R, and goes with sqrt(R/g).
    """

    accuracy: float
    largest_step: float


@dataclass(frozen=True)
class EqualSteps:
    """A free block with the settings of a script: `step` [s] is the one knob."""

    step: float


class NoSolution(RuntimeError):
    """The engine finds no velocities after a kick; "what: why", in its own words."""


class Bodies(ABC):
    """The block and the base of a scene as an engine holds them, and where they are."""

    least_viscous = 0.0  # the least accuracy for which viscous bearings set the step at an impact
    # Tilt below which the block counts as in flat contact, as a share of gamma. Impacts of swings below FLAT are
    # stepped over, and may come out as swings of up to 3 FLAT.
    contact = 3 * FLAT

    def __init__(self, scene: Scene, largest: float) -> None:
        self.model = RockingModel.of(scene)
        self.block = Block(scene, self.model)
        self.base = SlidingBase(scene, self.model, largest, self.weigh)

    @abstractmethod
    def weigh(self, mass: float) -> None:
        """Give the base a mass [kg]."""

    @abstractmethod
    def kick(
        self, impulses: tuple[float, float, float, float], times: tuple[float, float, float], purpose: int
    ) -> tuple[float, float, float, float]:
        """Velocities that a kick leaves: z', x' [m/s], tilt rate [rad/s], x' of the base [m/s].

        Parameters
        ----------
        impulses : tuple of float
            On the block upward and across [N s], on its tilt [N m s], on the base [N s].
        times : tuple of float
            Of the step after the kick, the step before it (0: none), and the kick between their middles [s].
        purpose : int
            Of the step after it, as `engines.pace` has it.

        Raises
        ------
        NoSolution
        """

    @abstractmethod
    def place(self, level: bool) -> None:
        """Move the engine's bodies to where `block` and `base` are; level: the block was put on both corners."""

    def fit(self, step: float, purpose: int, h: float) -> tuple[float, int]:
        """(length [s], purpose) of a step, as asked or as the engine needs them after one of h [s]."""
        return step, purpose


def pace_of(
    model: RockingModel, scene: Scene, largest: float, accuracy: float, least_viscous: float = 0.0
) -> Callable[[float, float, bool, float], tuple[float, int]]:
    """Length and purpose of a step as `engines.pace` has them, at most `largest` [s].

    least_viscous: the least accuracy for which viscous bearings set the step at an impact.
    """
    # Both corners count as loaded where the higher one is within what a step of free fall covers.
    standing = 2 * least_pull(model) * model.g * largest * largest / (2 * scene.block.half_width)
    damping, smallest = model.bearing.count * model.bearing.damping, SMALLEST_STEP * size_scale(scene)
    sharpest = VISCOUS * max(accuracy, least_viscous) * model.M / damping if damping else math.inf
    thrown, decay = THROWN if scene.motion else 1.0, base_decay(scene)
    rule = StepRule(largest, smallest, accuracy, APPROACH, sharpest, standing, True, True, decay, thrown)
    return impact_aware(model, scene.start.tilt_rate, rule)


def march(bodies: Bodies, scene: Scene, largest: float, accuracy: float) -> tuple[np.ndarray, str]:
    """Step until the duration is over, the block has overturned, a state is not finite or there is no solution.

    Parameters
    ----------
    bodies : Bodies
        At the scene's start.
    scene : Scene
    largest : float
        Longest step [s].
    accuracy : float
        Share of its speed at the impact that the block may gain in one step there.

    Returns
    -------
    rows, ended
        Rows as `engines.leapfrog` has them, the start first; "done", "overturned", "not finite", "too many steps", or
        the words of a `NoSolution`.
    """
    model, block, base, on_base = bodies.model, bodies.block, bodies.base, scene.base is not None
    pace, push = pace_of(model, scene, largest, accuracy, bodies.least_viscous), pushes(scene.motion, model.g)
    duration: float = scene.duration  # type: ignore[assignment]  # a run has one
    limit, fitted = limits(duration, largest, scene.motion.jumps if scene.motion else ())
    m, height, fallen, fit, kick = model.m, block.height, 0.5 * math.pi, bodies.fit, bodies.kick
    across, up, vx, vz = placement(scene)
    t, h, rate, tilt, interval, side, load = 0.0, 0.0, scene.start.tilt_rate, block.tilt, 1.0, block.tilt > 0, 0.0
    rows = array("d", (t, h, tilt, rate, base.x, base.v, base.z, base.force, across, up, vx, vz))
    keep, width, end, ended = rows.extend, len(rows), duration - ROUNDING * largest, "too many steps"
    for _ in range(row_limit(duration, largest)):
        jumped, side = (tilt > 0) != side, tilt > 0
        step, purpose = fit(*pace(tilt, rate, jumped, interval), h)
        if t + step >= limit:
            step, limit = fitted(t, step)
        interval = 0.5 * (h + step)
        across, up = push(t + 0.5 * step, interval)
        spin = block.lost_spin(rate) if block.turned else 0.0
        if not math.isfinite(across + up + spin + base.force):  # an engine may go on without an acceleration
            ended = "not finite"
            break
        if on_base:
            load = base.impulse(interval, across, block.lag(rate, step))
        try:
            vz, vx, rate, v = kick((m * up, m * across, spin, load), (step, h, interval), purpose)
        except NoSolution as error:
            ended = str(error)
            break
        if on_base:
            base.follow(v, step)
        bodies.place(block.move(rate, vx, vz, step, interval, purpose == REST))
        t, h, tilt = t + step, step, block.tilt
        keep((t, h, tilt, rate, base.x, base.v, base.z, base.force, block.x, block.up - height, vx, vz))
        if not -fallen < tilt < fallen:
            ended = "overturned" if math.isfinite(tilt) else "not finite"
            break
        if t >= end:
            ended = "done"
            break
    return np.frombuffer(rows).reshape(-1, width), ended


def impact_aware_run(
    scene: Scene, settings: ImpactAware, bodies_of: Callable[[float], Bodies], warnings: tuple[str, ...] = ()
) -> Run:
    """The `Run` of a scene; bodies_of: from the longest step [s]."""
    largest = longest_step(scene, settings.largest_step * size_scale(scene))
    clock = time.process_time()
    bodies = bodies_of(largest)
    rows, ended = march(bodies, scene, largest, settings.accuracy)
    cpu = time.process_time() - clock
    trace = trace_of(rows, scene, bodies.contact * scene.block.slenderness, smeared=3)
    return _run_of(scene, rows, ended, cpu, trace, warnings)


def equal_steps_run(
    scene: Scene, step: float, script: Callable[[], tuple[np.ndarray, str]], read: Callable[[np.ndarray], Trace]
) -> Run:
    """The `Run` of a scene in equal steps [s]; script: (rows, ended) as of `march`; read: the trace of its rows."""
    clock = time.process_time()
    rows, ended = script()
    cpu = time.process_time() - clock
    return _run_of(scene, rows, ended, cpu, read(rows))


def _run_of(scene, rows, ended, cpu, trace, warnings=()):
    """The `Run` of rows as `engines.leapfrog` has them, and of how they ended."""
    failure = failure_of(scene, rows, ended)
    if ended not in ENDS:
        reason, _, why = ended.partition(": ")
        failure = Failure(reason, f"at step {len(rows) - 1}, t = {rows[-1][0]:.9g} s: {why}")
    overturned = "overturned" if ended == "overturned" else None
    return Run(trace, len(rows) - 1, cpu, failure, overturned, warnings=warnings)
