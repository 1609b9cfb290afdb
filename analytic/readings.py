"""Dense output of a Taylor step: history, contact diagnostics and energy ledger (compiled)."""

import math

from . import layout as L
from .compiled import inner
from .polynomial import INVERSE, bound, derivative, largest, value

# Points inside a step at which friction demand and normal force are evaluated.
PROBES = 4


@inner
def write_history(par, body, step, output_step, arrays, written):
    """Write the rows of the history up to the end of the step; returns the number of rows written so far."""
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


@inner
def integral_of_product(f, highest, g, order, h):
    """Integral over [0, h] of f g, of orders `highest` and `order`, with all terms of the product.

    Truncated at the order of its factors, the product would be less accurate than they are, by up to two to that order.
    """
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
def gravity_at(par, vertical, P, highest, d):
    """g + a_v [m/s2] at d [s] in the step; highest : order of the series of the ground motion."""
    if vertical is None:
        gravity = par.g
    else:
        gravity = value(P[L.GRAVITY], max(highest, 0), d)
    return gravity


@inner
def top(a, b, c):
    """Maximum, between its points, of the parabola through three values at equal intervals."""
    turn, bend = 0.5 * (a - c), a - 2 * b + c
    if abs(turn) < -bend:  # its vertex is inside
        return b - 0.5 * turn * turn / bend
    return max(a, b, c)


@inner
def read_contact(par, vertical, body, step, arrays):
    """Friction demand |H|/N, least N/(m g) and peak absolute base acceleration within the step."""
    P, totals, work, h, order, highest = arrays.P, arrays.totals, arrays.work, step.h, step.order, step.highest
    rocking = body.s != 0
    row, last = (L.ABSOLUTE, order) if par.on_base else (L.GROUND, highest)
    level = not rocking and vertical is None  # then |H|/N = |acceleration|/g
    known = min(totals[L.PEAK_ACCELERATION], totals[L.FRICTION] * par.g) if level else totals[L.PEAK_ACCELERATION]
    if last >= 0 and bound(P[row], last, h) > known:
        peak = largest(P[row], 1.0, last, h, known, P[L.EVENT], work)
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
        here, low = abs(horizontal) / upward if upward > 0 else math.inf, -upward / par.g
        if probe > 1:
            totals[L.FRICTION] = max(totals[L.FRICTION], top(demand_before, demand, here))
            totals[L.NORMAL] = min(totals[L.NORMAL], -top(lift_before, lift, low))
        demand_before, demand, lift_before, lift = demand, here, lift, low


@inner
def read_lifting(par, step, P, totals):
    """Work of the vertical ground motion on the rocking block within the step [J]: -int a_v m n phi' dt."""
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
    """Work of the ground, of the hysteretic and of the viscous bearing force within the step [J]."""
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
    """Work of the hysteretic and of the viscous bearing force within the step [J]."""
    h, order, hysteretic = step.h, step.order, P[L.PRODUCT_B]
    if par.count > 0:
        for k in range(order + 1):
            hysteretic[k] = P[L.F, k] - par.count * (par.kb * P[L.X, k] + par.damping * P[L.V, k])
        totals[L.HYSTERETIC] += integral_of_product(hysteretic, order, P[L.V], order, h)
        if par.damping > 0:
            totals[L.VISCOUS] += par.count * par.damping * integral_of_product(P[L.V], order, P[L.V], order, h)
