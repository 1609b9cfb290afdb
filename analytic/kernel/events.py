"""Events inside one Taylor step, the rules of rest, and what is read from a step (compiled).

Each finder returns the first time of its event in the step, or -1. It first evaluates a cheap bound on the polynomial,
as most steps have no event. Dense output of the step gives history, contact diagnostics and energy ledger.
"""

import math

from . import layout as L
from .compiled import inlined, inner
from .polynomial import INVERSE, SHORT_ORDER, bound, derivative, first_root, largest, value

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
    """Return the time at which |absolute acceleration| exceeds the threshold g tan(gamma), or that of g + a_v."""
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
    size, first, least = bound(row, order, h), -1.0, threshold
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
                first, h = root, root
    return first


@inner
def find_fall(f, side, limit, order, h, event, work):
    """Return the first time at which limit + side f falls below 0; a root at the start is the previous event."""
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
    """Return a bound on |tilt| over the step."""
    top, power = s * phi[0], 1.0
    for k in range(1, order + 1):
        power *= h
        top += max(s * phi[k], 0.0) * power
    return top


@inner
def find_passage(gamma, s, tilt, sooner, order, P, work):
    """Return (kind, time) of the first passage of the slenderness or of pi/2, or else `sooner`.

    sooner : (kind, time) of another event.
    """
    (kind, h), phi, event = sooner, P[L.PHI], P[L.EVENT]
    top = upper_bound(phi, s, order, h)
    if top > gamma > s * tilt:
        root = find_fall(phi, -s, gamma, order, h, event, work)
        if root >= 0:
            kind, h = L.PASSAGE, root
    if top > 0.5 * math.pi:
        root = find_fall(phi, -s, 0.5 * math.pi, order, h, event, work)
        if root >= 0:
            kind, h = L.OVERTURNING, root
    return kind, h


@inner
def find_turn(direction, corner, sooner, order, P, work):
    """Return (kind, time) of the first reversal or corner of the bearings, or else `sooner`, see `find_passage`.

    direction : of the base velocity.
    """
    kind, h = sooner
    if direction != 0:
        root = find_fall(P[L.V], direction, 0.0, order, h, P[L.EVENT], work)
        if root > 0:
            kind, h = L.REVERSAL, root
        if corner < math.inf:
            root = find_fall(P[L.Q], -direction, corner, order, h, P[L.EVENT], work)
            if root >= 0:
                kind, h = L.CORNER, root
    return kind, h


@inner
def direction_from_rest(par, body, gravity, highest, A, force):
    """Return the sign of the motion that a base at rest begins: that of its first derivative that is not zero.

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
    """Return -s phi'' at phi = 0 on side s [rad/s2], positive toward contact, from eqs (3)-(6).

    gravity, ground : g + a_v and a_g [m/s2].
    """
    h, b = par.R * math.cos(par.gamma), s * par.R * math.sin(par.gamma)
    if not par.on_base:
        return s * par.m * (h * ground + gravity * b) / par.J
    determinant = par.M * par.J - (par.m * h) ** 2
    return s * (par.M * par.m * gravity * b - par.m * h * force) / determinant


@inner
def remaining_hops(par, rate, gravity, ground, force):
    """Return the time [s] from an impact to the limit of all further ones, or -1 if the block does not come to rest.

    rate : the tilt rate after the impact. A swing lasts 2 w/q on its side, and w is multiplied by e at each impact: a
    geometric series, exact for small swings.
    """
    s = 1.0 if rate > 0 else -1.0
    # decelerations toward contact on the side of the next swing, and on the other
    near, far = hop_deceleration(par, s, gravity, ground, force), hop_deceleration(par, -s, gravity, ground, force)
    w = abs(rate)
    if near <= 0 or far <= 0:
        # exactly on the threshold rounding determines the sign, and swings decrease for ever
        touching = min(near, far) >= -TOUCH * par.p2
        return 0.0 if touching and w < NO_RATE * math.sqrt(par.p2) else -1.0
    if 2 * w > LONGEST_LAST_HOP / math.sqrt(par.p2) * min(near, far):
        return -1.0
    if par.e > NEARLY_ELASTIC:
        return 0.0
    return 2 * w * (1 / near + par.e / far) / (1 - par.e * par.e)


@inner
def impact_loss(par, v, before, after, jump):
    """Return the kinetic energy lost [J] while the tilt rate falls from `before` to `after`.

    v : velocity of the base, which rises by `jump`.
    """
    coupling = par.m * par.R * math.cos(par.gamma)
    return (
        0.5 * par.J * (before * before - after * after)
        + coupling * (v * (before - after) - jump * after)
        - 0.5 * par.M * jump * (2 * v + jump)
    )


@inner
def land(par, rate, base, gravity, ground, rest_rate, t, arrays):
    """Return the state after an impact, eqs (7), (8): (rate, base velocity, whether the block rests). Store the impact.

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
    """Return (certain, overturns, peak tilt, impacts) of free rocking on rigid ground, from its energy integral.

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


# Points inside a step at which friction demand and normal force are evaluated.
PROBES = 4


@inner
def write_history(par, body, step, output_step, arrays, written):
    """Write the rows of the history up to the end of the step; return the number of rows written so far."""
    history, P, order = arrays.history, arrays.P, step.order
    while written < history.shape[0] and written * output_step <= step.t + step.h:
        row = history[written]
        d = min(max(written * output_step - step.t, 0.0), step.h)
        row[:] = 0.0
        row[0] = written * output_step
        if body.s != 0:
            row[1], row[2] = value(P[L.PHI], order, d), value(P[L.W], order, d)
        if par.on_base:
            row[3], row[4], row[5] = value(P[L.X], order, d), value(P[L.V], order, d), value(P[L.F], order, d)
        written += 1
    return written


@inlined
def _integral_of_product(f, highest, g, order, h):
    total, power = 0.0, h
    for j in range(highest + 1):
        term, term_power = 0.0, f[j] * power
        for k in range(order + 1):
            term += g[k] * term_power * INVERSE[j + k + 1]
            term_power *= h
        total += term
        power *= h
    return total


@inner
def integral_of_product(f, highest, g, order, h):
    """Return the integral over [0, h] of f g, of orders `highest` and `order`, with all terms of the product.

    Truncated at the order of its factors, the product would be less accurate than they are, by up to two to that order.
    """
    if order == SHORT_ORDER:
        return _integral_of_product(f, highest, g, SHORT_ORDER, h)
    return _integral_of_product(f, highest, g, order, h)


@inner
def gravity_at(par, vertical, P, highest, d):
    """Return g + a_v [m/s2] at d [s] in the step; highest : order of the series of the ground motion."""
    if vertical is None:
        gravity = par.g
    else:
        gravity = value(P[L.GRAVITY], max(highest, 0), d)
    return gravity


@inner
def top(a, b, c):
    """Return the maximum, between its points, of the parabola through three values at equal intervals."""
    turn, bend = 0.5 * (a - c), a - 2 * b + c
    if abs(turn) < -bend:  # its vertex is inside
        return b - 0.5 * turn * turn / bend
    return max(a, b, c)


@inner
def read_contact(par, vertical, body, step, arrays):
    """Read friction demand |H|/N, least N/(m g) and peak absolute base acceleration within the step."""
    P, totals, work, h, order, highest = arrays.P, arrays.totals, arrays.work, step.h, step.order, step.highest
    rocking = body.s != 0
    row, last = (L.ABSOLUTE, order) if par.on_base else (L.GROUND, highest)
    level = not rocking and vertical is None  # then |H|/N = |acceleration|/g
    known_peak = min(totals[L.PEAK_ACCELERATION], totals[L.FRICTION] * par.g) if level else totals[L.PEAK_ACCELERATION]
    if last >= 0 and bound(P[row], last, h) > known_peak:
        peak = largest(P[row], 1.0, last, h, known_peak, P[L.EVENT], work)
        peak = largest(P[row], -1.0, last, h, peak, P[L.EVENT], work)
        totals[L.PEAK_ACCELERATION] = max(totals[L.PEAK_ACCELERATION], peak)
        if level:
            totals[L.FRICTION] = max(totals[L.FRICTION], peak / par.g)
    if level:
        return
    demand, demand_before, lift, lift_before = 0.0, 0.0, 0.0, 0.0
    for probe in range(PROBES + 1):
        d = h * probe / PROBES
        horizontal = value(P[row], last, d) if last >= 0 else 0.0
        upward = gravity_at(par, vertical, P, highest, d)
        if rocking:
            rate, second = value(P[L.W], order, d), derivative(P[L.W], order, d)
            angle = body.s * par.gamma - value(P[L.PHI], order, d)
            c, n = par.R * math.cos(angle), par.R * math.sin(angle)
            horizontal += c * second + n * rate * rate
            upward += n * second - c * rate * rate
        ratio, low = abs(horizontal) / upward if upward > 0 else math.inf, -upward / par.g
        if probe > 1:
            totals[L.FRICTION] = max(totals[L.FRICTION], top(demand_before, demand, ratio))
            totals[L.NORMAL] = min(totals[L.NORMAL], -top(lift_before, lift, low))
        demand_before, demand, lift_before, lift = demand, ratio, lift, low


@inner
def read_lifting(par, step, P, totals):
    """Read the work of the vertical ground motion on the rocking block within the step [J]: -int a_v m n phi' dt."""
    h, order, highest = step.h, step.order, step.highest
    lift, rising = P[L.EVENT], P[L.PRODUCT_A]
    for k in range(max(highest, 0) + 1):
        lift[k] = P[L.GRAVITY, k]
    lift[0] -= par.g
    last = 0.0  # on rigid ground the series of sin is one term shorter
    for j in range(order):
        last -= P[L.W, j] * P[L.C, order - 1 - j]
    P[L.S, order] = last * INVERSE[order]
    for k in range(order + 1):  # of phi' sin
        rising[k] = 0.0
        for j in range(k + 1):
            rising[k] += P[L.S, j] * P[L.W, k - j]
    totals[L.INPUT] -= par.m * par.R * integral_of_product(lift, max(highest, 0), rising, order, h)


@inner
def read_energy(par, body, step, P, totals):
    """Read the work of the ground, of the hysteretic and of the viscous bearing force within the step [J]."""
    h, order, highest = step.h, step.order, step.highest
    momentum = P[L.PRODUCT_A]
    if highest >= 0:  # -int a_g (M x' + m c phi') dt
        for k in range(order + 1):
            turning = 0.0
            if body.s != 0:
                for j in range(k + 1):
                    turning += P[L.C, j] * P[L.W, k - j]
            momentum[k] = par.m * par.R * turning + (par.M * P[L.V, k] if par.on_base else 0.0)
        totals[L.INPUT] -= integral_of_product(P[L.GROUND], min(highest, order), momentum, order, h)
    read_bearings(par, step, P, totals)


@inner
def read_bearings(par, step, P, totals):
    """Read the work of the hysteretic and of the viscous bearing force within the step [J]."""
    h, order, hysteretic = step.h, step.order, P[L.PRODUCT_B]
    if par.count > 0:
        for k in range(order + 1):
            hysteretic[k] = P[L.F, k] - par.count * (par.kb * P[L.X, k] + par.damping * P[L.V, k])
        totals[L.HYSTERETIC] += integral_of_product(hysteretic, order, P[L.V], order, h)
        if par.damping > 0:
            totals[L.VISCOUS] += par.count * par.damping * integral_of_product(P[L.V], order, P[L.V], order, h)
