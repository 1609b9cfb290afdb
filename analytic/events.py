"""Events of the block and the base inside one Taylor step, and the rules of rest (compiled).

Each finder returns the first time in the step, or -1. A cheap bound on the polynomial comes first: most steps hold
no event.
"""

import math

from numba import njit

from .layout import GROUND, IMPACT_LOSS, IMPACTS, RESTS
from .polynomial import first_root

# An impact slower than rest_rate omega_r ends in rest if the next hop is short too [1/omega_r]: while the ground
# acceleration is close to uplift a slow impact can still start a long hop.
LONGEST_LAST_HOP = 1e-3
# Above this restitution the series of hops is so long that it is ended at the impact itself.
NEARLY_ELASTIC = 0.999
# Tilt rate after an impact [omega_r] that no longer counts as motion while the acceleration is on the threshold.
NO_RATE = 1e-15
# Relative distance to the threshold below which an onset counts as the touch just refused.
TOUCH = 1e-9


@njit(cache=True)
def find_uplift(P, row, order, threshold, refused, h, event, work, slope=0.0, highest=-1, G=None):
    """|absolute acceleration| (row of P) exceeds the threshold g tan(gamma).

    With the series G of g + a_v, up to `highest`, that is `slope` G, slope = tan(gamma).
    """
    size, power = abs(P[row, 0]), 1.0
    for k in range(1, order + 1):
        power *= h
        size += abs(P[row, k]) * power
    found, least = -1.0, threshold
    if G is not None:
        least, power = slope * G[0], slope
        for k in range(1, highest + 1):
            power *= h
            least -= abs(G[k]) * power
    if size >= least:
        for side in (-1.0, 1.0):
            for k in range(order + 1):
                event[k] = side * P[row, k]
            if G is None:
                event[0] += threshold
            else:
                for k in range(max(highest, 0) + 1):
                    event[k] += slope * G[k]
            if refused and abs(event[0]) <= TOUCH * threshold:
                event[0] = 0.0  # the touch just refused; a later crossing still counts
                if event[1] < 0:
                    continue
            root = first_root(event, order, h, work)
            if root >= 0:
                found, h = root, root
    return found


@njit(cache=True)
def find_impact(phi, s, order, h, event, work):
    """The tilt comes back to 0; a root at the start of the step is the event just left."""
    for k in range(order + 1):
        event[k] = s * phi[k]
    return first_root(event, order, h, work)


@njit(cache=True)
def upper_bound(phi, s, order, h):
    """A bound on |tilt| over the step."""
    top, power = s * phi[0], 1.0
    for k in range(1, order + 1):
        power *= h
        top += max(s * phi[k], 0.0) * power
    return top


@njit(cache=True)
def find_exceedance(phi, s, limit, order, h, event, work):
    """|tilt| grows beyond `limit`."""
    for k in range(order + 1):
        event[k] = -s * phi[k]
    event[0] += limit
    return first_root(event, order, h, work)


@njit(cache=True)
def find_reversal(v, direction, order, h, event, work):
    """The base velocity changes sign against `direction`."""
    lowest, power = direction * v[0], 1.0
    for k in range(1, order + 1):
        power *= h
        lowest -= abs(v[k]) * power
    if lowest > 0:
        return -1.0
    for k in range(order + 1):
        event[k] = direction * v[k]
    return first_root(event, order, h, work)


@njit(cache=True)
def find_corner(z, direction, corner, order, h, event, work):
    """The hysteretic force reaches `corner` in `direction`, where the bearing's stiffness jumps."""
    lowest, power = corner - direction * z[0], 1.0
    for k in range(1, order + 1):
        power *= h
        lowest -= abs(z[k]) * power
    if lowest > 0:
        return -1.0
    for k in range(order + 1):
        event[k] = -direction * z[k]
    event[0] += corner
    return first_root(event, order, h, work)


@njit(cache=True)
def direction_from_rest(par, gravity, rocking, s, tilt, rate, highest, P, force):
    """Sign of the motion a base at standstill starts into: that of its first derivative that is not zero.

    gravity : g + a_v [m/s2].
    """
    ground = P[GROUND, 0] if highest >= 0 else 0.0
    if rocking:
        c = par.m * par.R * math.cos(s * par.gamma - tilt)
        n = par.m * par.R * math.sin(s * par.gamma - tilt)
        absolute = (par.J * (-force - n * rate * rate) + c * gravity * n) / (par.M * par.J - c * c)  # (3)-(6) solved
    else:
        absolute = -force / par.M  # (2)
    start = absolute - ground
    if start == 0 and highest >= 1:
        start = -P[GROUND, 1]
    return 0.0 if start == 0 else math.copysign(1.0, start)


@njit(cache=True)
def hop_deceleration(par, s, gravity, ground, force):
    """-s phi'' at phi = 0 on side s [rad/s2]; positive where gravity brings the block back. From eqs (3)-(6).

    gravity, ground : g + a_v and a_g [m/s2].
    """
    h, b = par.R * math.cos(par.gamma), s * par.R * math.sin(par.gamma)
    if not par.on_base:
        return s * par.m * (h * ground + gravity * b) / par.J
    determinant = par.M * par.J - (par.m * h) ** 2
    return s * (par.M * par.m * gravity * b - par.m * h * force) / determinant


@njit(cache=True)
def remaining_hops(par, rate, gravity, ground, force):
    """Time that the impacts after one that leaves tilt rate `rate` still take [s]; -1 if they do not end in rest.

    A hop lasts 2 w/q on its side and w falls by e at each impact: a geometric series, exact for small hops.
    """
    s = 1.0 if rate > 0 else -1.0
    here, there = hop_deceleration(par, s, gravity, ground, force), hop_deceleration(par, -s, gravity, ground, force)
    w = abs(rate)
    if here <= 0 or there <= 0:
        # exactly on the threshold rounding decides the sign: hops shrink for ever
        touching = min(here, there) >= -TOUCH * par.p2
        return 0.0 if touching and w < NO_RATE * math.sqrt(par.p2) else -1.0
    if 2 * w > LONGEST_LAST_HOP / math.sqrt(par.p2) * min(here, there):
        return -1.0
    if par.e > NEARLY_ELASTIC:
        return 0.0
    return 2 * w * (1 / here + par.e / there) / (1 - par.e * par.e)


@njit(cache=True)
def impact_loss(par, v, before, after, jump):
    """Kinetic energy lost [J]: the tilt rate falls from `before` to `after`, the base velocity v rises by `jump`."""
    coupling = par.m * par.R * math.cos(par.gamma)
    return (
        0.5 * par.J * (before * before - after * after)
        + coupling * (v * (before - after) - jump * after)
        - 0.5 * par.M * jump * (2 * v + jump)
    )


@njit(inline="always")
def land(par, rate, base, gravity, ground, rest_rate, t, impacts, rests, totals):
    """Across an impact, eqs (7), (8): (rate, base velocity, whether the block now stays down). Keeps its row.

    base : (x, v, z) before; gravity, ground : g + a_v and a_g [m/s2]; rest_rate [rad/s].
    """
    (x, v, z), before, lever = base, rate, par.mt * par.R * math.cos(par.gamma)
    rate = par.e * before  # (7)
    jump = lever * (before - rate)  # (8), from momentum
    totals[IMPACT_LOSS] += impact_loss(par, v, before, rate, jump)
    v += jump
    number = int(totals[IMPACTS])
    if number < impacts.shape[0]:
        impacts[number, 0], impacts[number, 1], impacts[number, 2], impacts[number, 3] = t, before, rate, jump
    totals[IMPACTS] += 1
    force = par.count * (par.kb * x + z + par.damping * v)
    landed, remaining = rate == 0, -1.0
    if landed or abs(rate) < rest_rate:
        remaining = remaining_hops(par, rate, gravity, ground, force)
    if not (landed or remaining >= 0):
        return rate, v, False
    left = lever * rate  # the hops left out: their momentum stays with the base
    totals[IMPACT_LOSS] += impact_loss(par, v, rate, 0.0, left)
    if remaining >= 0:  # else it lands flat and lifts again at once
        number = int(totals[RESTS])
        if number < rests.shape[0]:
            rests[number] = t + remaining
        totals[RESTS] += 1
    return 0.0, v + left, True


@njit(cache=True)
def settle(par, s, tilt, rate):
    """(certain, overturns, peak tilt, impacts) of free rocking on rigid ground, from its energy integral.

    phi'^2/2 + p^2 cos(s gamma - phi) is constant in flight and has its barrier p^2 at |phi| = gamma; an impact leaves
    e^2 of phi'^2. Never uncertain but for a block beyond the barrier that is coming back.
    """
    here = math.cos(s * par.gamma - tilt)
    excess = 0.5 * rate * rate / par.p2 + here - 1.0  # over the barrier, in units of p^2
    if s * tilt >= par.gamma:
        certain = s * rate >= 0 or excess < 0
        return certain, certain, 0.5 * math.pi, 0
    impacts = 0
    if s * rate < 0:  # first back through an impact
        flat = math.cos(par.gamma)
        excess = par.e * par.e * (0.5 * rate * rate / par.p2 + here - flat) + flat - 1.0
        impacts = 1
    if excess > 0:
        return True, True, 0.5 * math.pi, impacts
    return True, False, par.gamma - math.acos(1.0 + excess), impacts
