"""Length of the next step, for engines whose contact needs small steps at an impact and none elsewhere.

The speed at which the block will reach contact follows from its tilt, its rate and what it gains toward contact. Steps
grow in flight, and are a share of what is left of it on the way to an impact.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from analytic.rocking import RockingModel

# No accuracy knobs: over the ranges given e moves by at most 2e-5 and the number of steps by at most 8 % (slenderness
# .1 and .45, rigid ground and a base of 212 kg).
GROWTH = 1.5  # most growth from step to step; 1.25 to 2
# A base that an impact kicks, and a damper stops within less than a largest step, goes as far as the growing steps let
# it: 9.4e3 omega_r, overdamped: off by 2.4 % (PyBullet, pymunk) and 6 % (MuJoCo) at 1.5, by .2 to 1.2 % at 1.15.
DAMPED_GROWTH, DAMPED = 1.15, 0.1
SETTLING = 4  # steps that stay as small after an impact as at it: engines spread it over two; 1 to 8
FLAT = 1e-6  # swings below this share of gamma do not matter, their impacts are stepped over; 1e-7 to 1e-5
# A moving ground throws the block from a swing that would not matter at rest; stepped over, the throw comes up to a
# step late. So under a motion less energy matters, by `StepRule.thrown`. Peak of .01 slendernesses, base at 59 omega_r,
# at 1, .3 and .1: off by 2.4, 1.5 and .004 % (PyBullet), 2.4, .2 and .7 % (Drake), 2.1, .4 and .5 % (pymunk), .3, .5
# and .4 % (DART). Steps: up to 14 % more there, 1 to 17 % under the synthetic record.
THROWN = 0.3
STANDING = 100  # energy below which the block counts as standing, over that of a swing which does not matter
LEAST_AHEAD = 1e-3  # of a step: a jump that is nearer is not worth a step of its own
ROUNDING = 1e-9  # of a step, by which the steps' sum may miss the duration
FAR = 1.2  # longer than this times the largest step over the approach is far from an impact

FLIGHT, IMPACT, REST = range(3)  # what a step is for: one corner carries, both may, both do


@dataclass(frozen=True)
class StepRule:
    """What an engine asks of its steps.

    Parameters
    ----------
    largest, smallest : float
        Limits of a step [s].
    accuracy : float
        Share of its speed at the impact that the block may gain in one step there.
    approach : float
        Share of the remaining time to the impact that a step may take.
    sharpest : float
        Longest step at an impact [s].
    standing : float
        Energy of a swing, as the square of its speed at the impact [rad2/s2], below which it counts as rest, if that is
        more than `STANDING` times that of one that does not matter.
    overlong : bool
        A coarse accuracy may ask for steps above the largest at an impact; else they stay below it.
    cruise : bool
        Far from an impact keep the largest step without a closer look.
    decay : float
        Rate at which its dampers stop the base [1/s].
    thrown : float
        Energy of a swing that matters, over that with the ground at rest.
    """

    largest: float
    smallest: float
    accuracy: float
    approach: float
    sharpest: float = math.inf
    standing: float = 0.0
    overlong: bool = False
    cruise: bool = False
    decay: float = 0.0
    thrown: float = 1.0


def impact_aware(
    model: RockingModel, start_rate: float, rule: StepRule
) -> Callable[[float, float, bool, float], tuple[float, int]]:
    """A function (tilt, rate, jumped, interval) -> (length [s], FLIGHT, IMPACT or REST) of the step from a state.

    It is called before each step of a `RockingModel` that starts at the tilt rate `start_rate` [rad/s]. rule: a
    `StepRule`. jumped: the tilt lies on the other side than at the call before; interval: between the rates of the two
    calls [s].
    """
    largest, smallest, accuracy, approach = rule.largest, rule.smallest, rule.accuracy, rule.approach
    sharpest, overlong, cruise = rule.sharpest, rule.overlong, rule.cruise
    growth = DAMPED_GROWTH if rule.decay * largest > DAMPED else GROWTH
    least, calm = least_pull(model), _weak(model)
    twice, weak = 2 * least, calm * rule.thrown
    almost = max(STANDING * calm, rule.standing)
    level, reach = almost / twice, largest / approach * FAR
    # A first swing may be short: start small and let the step grow.
    step = min(largest, max(smallest, accuracy * abs(start_rate) / least, 1e-2 * largest))
    before, settling, cruising, first, sqrt, far = 0.0, 0, False, True, math.sqrt, (largest, FLIGHT)

    def pace(tilt, rate, jumped, interval):
        nonlocal step, before, settling, cruising, first
        toward, size, gain = (-rate, tilt, before - rate) if tilt > 0 else (rate, -tilt, rate - before)
        before = rate
        pull = gain / interval  # what the last step gained toward contact, where that is more: the ground may push
        if pull < least:
            pull = least
        if cruising and not jumped and size > level and size > reach * (toward + 0.5 * reach * pull):
            return far
        energy = toward * toward + twice * size  # of the swing, as the square of its speed at the impact
        purpose, wanted = REST if energy < almost else FLIGHT, step
        if jumped:
            settling = SETTLING if energy > weak else 0
        if settling:
            settling -= 1
            purpose = purpose or IMPACT
        elif not first:
            wanted = step * growth
            if wanted > largest:
                wanted = largest
            if energy > weak:
                speed = sqrt(toward * toward + 2 * pull * size)
                finest = max(smallest, accuracy * speed / pull)
                if finest > sharpest:
                    finest = sharpest
                near = approach * ((speed - toward) / pull - 3 * finest)
                if near < wanted:
                    if near <= finest:
                        purpose = purpose or IMPACT
                        near = finest
                    if overlong or near < wanted:
                        wanted = near
        cruising = cruise and wanted == step == largest and purpose != REST and not settling
        step, first = wanted, False
        return step, purpose

    return pace


def limits(
    duration: float, largest: float, jumps: Iterable[float] = ()
) -> tuple[float, Callable[[float, float], tuple[float, float]]]:
    """(first time that a step may not pass unseen, a function (t, step) -> step and the next such time).

    Such times are the `jumps` of the ground's acceleration, in their order, and the end of the run; `largest`: the
    longest step; all in the same unit.
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
    """The step [s], or a shorter one, of a leapfrog so that a jump of the ground's acceleration `ahead` [s] away falls
    between two kicks, which act over half of the steps before and after. A kick that holds the jump lifts a block late.
    """
    if not LEAST_AHEAD * step < ahead <= step:
        return step
    return 2 * ahead if 2 * ahead <= step else 2 / 3 * ahead


def fixed(
    model: RockingModel, step: float, standing: float = 0.0
) -> Callable[[float, float, bool, float], tuple[float, int]]:
    """As `impact_aware`, the length always `step` [s]."""
    almost = max(STANDING * _weak(model), standing)
    level, ahead = almost / (2 * least_pull(model)), 2 * step
    flight, impact, rest = (step, FLIGHT), (step, IMPACT), (step, REST)

    def pace(tilt, rate, jumped, interval):
        if -level < tilt < level and rate * rate < almost:
            return rest
        return impact if jumped or (tilt + ahead * rate > 0) != (tilt > 0) else flight

    return pace


def least_pull(model: RockingModel) -> float:
    """|tilt''| toward contact of an unforced block at tilt 0 [rad/s2]."""
    return abs(model.accelerations(1.0, 0.0, 0.0, 0.0, 0.0)[0])


def _weak(model: RockingModel) -> float:
    """Energy of a swing that does not matter, as the square of its speed at the impact [rad2/s2]."""
    return 2 * least_pull(model) * FLAT * model.gamma
