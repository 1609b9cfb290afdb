"""Length of the next step of a simulation with contacts, from gaps and closing speeds alone.

    h = clamp(min((1 + growth) h, share * gap/closing over contact points on their way to a landing), h_min, h_max)

held for 4 steps where a contact point's speed jumped by more than 10 g h, or where one is landing just now. On its way
is a point that closes and is higher than g h^2/4, or closes faster than 2 g h. The rule serves any scene in which
gravity g sets the pace of free motion: it knows no shape, and nothing of how bodies rock.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence

# Insensitive: share .1 to .45, growth .2 to 1 and hold 1 to 10 leave the error of e between .9 and 1.5 times itself in
# four engines. From a share of .7 on points land in steps that are too long.
SHARE, GROWTH, HOLD = 0.3, 0.5, 4
# A body that pivots at the rate w about a held point hops along the tangent, by w^2 R h^2/2, which is at most .1 g h^2
# for a block that does not overturn, and falls back at g h or less: that is no landing. Insensitive: NEAR .02 to 1,
# SLOW 1 to 4.
NEAR, SLOW = 0.25, 2.0
# What a moving ground and forces of a few weights give in a step is less, what an impact gives is more. Insensitive: 5
# to 20.
JUMP = 10.0

LEAST_AHEAD = 1e-3  # of a step: a jump that is nearer is not worth a step of its own
ROUNDING = 1e-9  # of a step, by which the steps' sum may miss the duration

Rule = Callable[[Sequence[tuple[float, float]]], float]  # from (gap, closing speed) of each contact point to a step


def gap_rule(largest: float, smallest: float, gravity: float) -> Rule:
    """The rule above; it starts with the smallest step.

    Parameters
    ----------
    largest, smallest : float
        Limits of a step [s].
    gravity : float
        g [m/s2].

    Returns
    -------
    function
        From the (gap [m], closing speed [m/s]) of each contact point, always the same ones in the same order, to the
        length of the next step [s].
    """
    step, held, before = smallest, 0, ()

    def length(points):
        nonlocal step, held, before
        gained = gravity * step
        wanted, slow, jump, near = largest, SLOW * gained, JUMP * gained, NEAR * gained * step
        for (gap, closing), (_, was) in zip(points, before or points, strict=True):
            if closing > slow or (closing > 0 and gap > near):
                if gap <= 0:
                    held = HOLD
                elif SHARE * gap < wanted * closing:
                    wanted = SHARE * gap / closing
            if not -jump < closing - was < jump:
                held = HOLD
        before = points
        longest = step if held else (1 + GROWTH) * step
        if held:
            held -= 1
        step = wanted if wanted < longest else longest
        if step < smallest:
            step = smallest
        return step

    return length


def fixed_rule(step: float) -> Rule:
    """The same step [s] always."""
    return lambda points: step


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
