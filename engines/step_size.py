"""Length of the next step of a simulation with contacts, from gaps and closing speeds only.

    h = clamp(min((1 + growth) h, share * gap/closing over contact points on their way to a landing), h_min, h_max)

A point is on its way to a landing if it closes with a gap above near * g h^2, or faster than 2 g h. The step does not
grow for 4 steps after a point that has sunk closes as fast. The rule holds for any scene in which gravity g sets the
time scale of free motion: it uses neither shapes nor the theory of rocking.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence

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
    """The rule in the module's docstring; before the first step, h is the smallest one.

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
    step, held = smallest, 0

    def length(points):
        nonlocal step, held
        gained = gravity * step
        wanted, slow, near = largest, SLOW * gained, NEAR * gained * step
        for gap, closing in points:
            if closing > slow or (closing > 0 and gap > near):
                if gap <= 0:
                    held = HOLD
                elif SHARE * gap < wanted * closing:
                    wanted = SHARE * gap / closing
        longest = step if held else (1 + GROWTH) * step
        held = max(held - 1, 0)
        step = max(min(wanted, longest), smallest)
        return step

    return length


def fixed_rule(step: float) -> Rule:
    """A constant step [s]."""
    return lambda points: step


def limits(
    duration: float, largest: float, jumps: Iterable[float] = ()
) -> tuple[float, Callable[[float, float], tuple[float, float]]]:
    """(first time that the steps must meet, a function (t, step) -> adjusted step and the next such time).

    These times are the `jumps` of the ground acceleration, in ascending order, and the end of the run. `largest` is the
    longest step. All are in the same unit.
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
    """The step [s] of a leapfrog, shortened if needed so that a jump of the ground acceleration `ahead` [s] from now
    falls between two impulses, each of which covers half of the steps before and after it. An impulse that contains the
    jump delays the uplift of a block.
    """
    if not LEAST_AHEAD * step < ahead <= step:
        return step
    return 2 * ahead if 2 * ahead <= step else 2 / 3 * ahead
