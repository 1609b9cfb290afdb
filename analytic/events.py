"""Event location for block and base inside one Taylor step, and the rules of rest (compiled).

Each finder returns the first time in the step, or -1. It first evaluates a cheap bound on the polynomial, as most steps
have no event.
"""

import math

from . import layout as L
from .compiled import inner
from .polynomial import bound, first_root

# An impact slower than rest_rate omega_r ends in rest if the next swing is short, too [1/omega_r]: while the ground
# acceleration is close to uplift, a slow impact can still begin a long swing.
LONGEST_LAST_HOP = 1e-3
# Above this restitution the series of impacts is so long that rest begins at the impact itself.
NEARLY_ELASTIC = 0.999
# Tilt rate after an impact [omega_r] that no longer counts as motion while the acceleration is on the threshold.
NO_RATE = 1e-15
# Relative distance to the threshold below which an onset counts as the graze that was just refused.
TOUCH = 1e-9


@inner
def find_uplift(shape, vertical, refused, step, P, work):
    """|absolute acceleration| exceeds the threshold g tan(gamma), or that of g + a_v."""
    row, order, highest, h, event = (
        P[L.ABSOLUTE if shape.on_base else L.GROUND],
        step.order,
        step.highest,
        step.h,
        P[L.EVENT],
    )
    threshold, slope, G = step.gravity * shape.slope, shape.slope, P[L.GRAVITY]
    if abs(row[0]) > threshold and not refused:
        return 0.0
    size, found, least = bound(row, order, h), -1.0, threshold
    if vertical is not None:
        least, power = slope * G[0], slope
        for k in range(1, highest + 1):
            power *= h
            least -= abs(G[k]) * power
    if size >= least:
        for side in (-1.0, 1.0):
            for k in range(order + 1):
                event[k] = side * row[k]
            if vertical is None:
                event[0] += threshold
            else:
                for k in range(max(highest, 0) + 1):
                    event[k] += slope * G[k]
            if refused and abs(event[0]) <= TOUCH * threshold:
                event[0] = 0.0  # the graze just refused; a later crossing counts
                if event[1] < 0:
                    continue
            root = first_root(event, order, h, work)
            if root >= 0:
                found, h = root, root
    return found


@inner
def find_fall(f, side, limit, order, h, event, work):
    """First time at which limit + side f falls below 0; a root at the start of the step is the previous event."""
    lowest, power = limit + side * f[0], 1.0
    for k in range(1, order + 1):
        power *= h
        lowest -= abs(f[k]) * power
    if lowest > 0:
        return -1.0
    for k in range(order + 1):
        event[k] = side * f[k]
    event[0] += limit
    return first_root(event, order, h, work)


@inner
def upper_bound(phi, s, order, h):
    """A bound on |tilt| over the step."""
    top, power = s * phi[0], 1.0
    for k in range(1, order + 1):
        power *= h
        top += max(s * phi[k], 0.0) * power
    return top


@inner
def find_passage(gamma, s, tilt, sooner, order, P, work):
    """(kind, time) of the first passage of the slenderness or of pi/2; sooner : (kind, time) of another event, else
    returned."""
    (found, h), phi, event = sooner, P[L.PHI], P[L.EVENT]
    top = upper_bound(phi, s, order, h)
    if top > gamma > s * tilt:
        root = find_fall(phi, -s, gamma, order, h, event, work)
        if root >= 0:
            found, h = L.PASSAGE, root
    if top > 0.5 * math.pi:
        root = find_fall(phi, -s, 0.5 * math.pi, order, h, event, work)
        if root >= 0:
            found, h = L.OVERTURNING, root
    return found, h


@inner
def find_turn(direction, corner, sooner, order, P, work):
    """(kind, time) of the first reversal or corner of the bearings; direction : of the base velocity; sooner : as in
    `find_passage`."""
    found, h = sooner
    if direction != 0:
        root = find_fall(P[L.V], direction, 0.0, order, h, P[L.EVENT], work)
        if root > 0:
            found, h = L.REVERSAL, root
        if corner < math.inf:
            root = find_fall(P[L.Q], -direction, corner, order, h, P[L.EVENT], work)
            if root >= 0:
                found, h = L.CORNER, root
    return found, h


@inner
def direction_from_rest(par, body, gravity, highest, A, force):
    """Sign of the motion that a base at rest begins: that of its first derivative that is not zero.

    gravity : g + a_v [m/s2]; A : series of a_g; force : of all bearings [N].
    """
    ground = A[0] if highest >= 0 else 0.0
    if body.s != 0:
        c = par.m * par.R * math.cos(body.s * par.gamma - body.tilt)
        n = par.m * par.R * math.sin(body.s * par.gamma - body.tilt)
        # (3)-(6) solved
        absolute = (par.J * (-force - n * body.rate * body.rate) + c * gravity * n) / (par.M * par.J - c * c)
    else:
        absolute = -force / par.M  # (2)
    start = absolute - ground
    if start == 0 and highest >= 1:
        start = -A[1]
    return 0.0 if start == 0 else math.copysign(1.0, start)


@inner
def hop_deceleration(par, s, gravity, ground, force):
    """-s phi'' at phi = 0 on side s [rad/s2], positive toward contact, from eqs (3)-(6).

    gravity, ground : g + a_v and a_g [m/s2].
    """
    h, b = par.R * math.cos(par.gamma), s * par.R * math.sin(par.gamma)
    if not par.on_base:
        return s * par.m * (h * ground + gravity * b) / par.J
    determinant = par.M * par.J - (par.m * h) ** 2
    return s * (par.M * par.m * gravity * b - par.m * h * force) / determinant


@inner
def remaining_hops(par, rate, gravity, ground, force):
    """Time [s] from an impact with tilt rate `rate` after it to the limit of all further ones; -1 without rest.

    A swing lasts 2 w/q on its side, and w is multiplied by e at each impact: a geometric series, exact for small
    swings.
    """
    s = 1.0 if rate > 0 else -1.0
    here, there = hop_deceleration(par, s, gravity, ground, force), hop_deceleration(par, -s, gravity, ground, force)
    w = abs(rate)
    if here <= 0 or there <= 0:
        # exactly on the threshold rounding determines the sign, and swings decrease for ever
        touching = min(here, there) >= -TOUCH * par.p2
        return 0.0 if touching and w < NO_RATE * math.sqrt(par.p2) else -1.0
    if 2 * w > LONGEST_LAST_HOP / math.sqrt(par.p2) * min(here, there):
        return -1.0
    if par.e > NEARLY_ELASTIC:
        return 0.0
    return 2 * w * (1 / here + par.e / there) / (1 - par.e * par.e)


@inner
def impact_loss(par, v, before, after, jump):
    """Kinetic energy lost [J]: the tilt rate falls from `before` to `after`, the base velocity v rises by `jump`."""
    coupling = par.m * par.R * math.cos(par.gamma)
    return (
        0.5 * par.J * (before * before - after * after)
        + coupling * (v * (before - after) - jump * after)
        - 0.5 * par.M * jump * (2 * v + jump)
    )


@inner
def land(par, rate, base, gravity, ground, rest_rate, t, arrays):
    """State after an impact, eqs (7), (8): (rate, base velocity, whether the block rests). Stores the impact.

    base : before it; gravity, ground : g + a_v and a_g [m/s2]; rest_rate [rad/s].
    """
    impacts, rests, totals, v = arrays.impacts, arrays.rests, arrays.totals, base.v
    before = rate
    rate = par.e * before  # (7)
    jump = par.arm * (before - rate)  # (8)
    totals[L.IMPACT_LOSS] += impact_loss(par, v, before, rate, jump)
    v += jump
    number = int(totals[L.IMPACTS])
    if number < impacts.shape[0]:
        impacts[number, 0], impacts[number, 1], impacts[number, 2], impacts[number, 3] = t, before, rate, jump
    totals[L.IMPACTS] += 1
    force = par.count * (par.kb * base.x + base.z + par.damping * v)
    landed, remaining = rate == 0, -1.0
    if landed or abs(rate) < rest_rate:
        remaining = remaining_hops(par, rate, gravity, ground, force)
    if not (landed or remaining >= 0):
        return rate, v, False
    left = par.arm * rate  # the momentum of the swings left out goes to the base
    totals[L.IMPACT_LOSS] += impact_loss(par, v, rate, 0.0, left)
    if remaining >= 0:  # otherwise it lands flat and lifts again at once
        number = int(totals[L.RESTS])
        if number < rests.shape[0]:
            rests[number] = t + remaining
        totals[L.RESTS] += 1
    return 0.0, v + left, True


@inner
def settle(par, body):
    """(certain, overturns, peak tilt, impacts) of free rocking on rigid ground, from its energy integral.

    phi'^2/2 + p^2 cos(s gamma - phi) is constant between impacts and has its barrier p^2 at |phi| = gamma; an impact
    multiplies phi'^2 by e^2. Uncertain only for a block beyond the barrier that is coming back.
    """
    s, tilt, rate = body.s, body.tilt, body.rate
    here = math.cos(s * par.gamma - tilt)
    excess = 0.5 * rate * rate / par.p2 + here - 1.0  # over the barrier, in units of p^2
    if s * tilt >= par.gamma:
        certain = s * rate >= 0 or excess < 0
        return certain, certain, 0.5 * math.pi, 0
    impacts = 0
    if s * rate < 0:  # first back to an impact
        flat = math.cos(par.gamma)
        excess = par.e * par.e * (0.5 * rate * rate / par.p2 + here - flat) + flat - 1.0
        impacts = 1
    if excess > 0:
        return True, True, 0.5 * math.pi, impacts
    return True, False, par.gamma - math.acos(1.0 + excess), impacts
