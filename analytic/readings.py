"""What is read off a Taylor step besides its end: history, diagnostics, energy ledger (compiled)."""

import math

from numba import njit

from .layout import (
    ABSOLUTE,
    EVENT,
    FRICTION,
    GRAVITY,
    GROUND,
    HYSTERETIC,
    INPUT,
    NORMAL,
    PEAK_ACCELERATION,
    PHI,
    PRODUCT_A,
    PRODUCT_B,
    VISCOUS,
    C,
    F,
    S,
    V,
    W,
    X,
)
from .polynomial import INVERSE, bound, derivative, largest, value

# Points inside a step at which friction demand and normal force are read.
PROBES = 4


@njit(cache=True)
def write_history(history, written, output_step, t, h, P, order, on_base, rocking):
    """Rows of the history up to t + h; returns how many are written by then. Nothing moves where P is not used."""
    while written < history.shape[0] and written * output_step <= t + h:
        row = history[written]
        d = min(max(written * output_step - t, 0.0), h)
        row[:] = 0.0
        row[0] = written * output_step
        if rocking:
            row[1], row[2] = value(P[PHI], order, d), value(P[W], order, d)
        if on_base:
            row[3], row[4], row[5] = value(P[X], order, d), value(P[V], order, d), value(P[F], order, d)
        written += 1
    return written


@njit(cache=True)
def _integral_of_product(f, highest, g, order, h):
    """Integral over [0, h] of f g, of orders `highest` and `order`, with every term of the product.

    Cut at the order of its factors the product would be worse than they are by up to two to that order.
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


@njit(cache=True, inline="always")
def gravity_at(par, vertical, P, highest, d):
    """g + a_v [m/s2] at d [s] in the step; highest : order of the ground's series."""
    if vertical is None:
        gravity = par.g
    else:
        gravity = value(P[GRAVITY], max(highest, 0), d)
    return gravity


@njit(cache=True)
def _top(a, b, c):
    """Largest value of the parabola through three readings at equal intervals, between them."""
    turn, bend = 0.5 * (a - c), a - 2 * b + c
    if abs(turn) < -bend:  # its vertex is inside
        return b - 0.5 * turn * turn / bend
    return max(a, b, c)


@njit(cache=True)
def read_contact(par, vertical, s, rocking, P, order, highest, h, totals, work):
    """Friction demand |H|/N, least N/(m g) and peak absolute base acceleration within the step."""
    row, last = (ABSOLUTE, order) if par.on_base else (GROUND, highest)
    level = not rocking and vertical is None  # then |H|/N = |acceleration|/g
    known = min(totals[PEAK_ACCELERATION], totals[FRICTION] * par.g) if level else totals[PEAK_ACCELERATION]
    if last >= 0 and bound(P[row], last, h) > known:
        peak = largest(P[row], 1.0, last, h, known, P[EVENT], work)
        peak = largest(P[row], -1.0, last, h, peak, P[EVENT], work)
        totals[PEAK_ACCELERATION] = max(totals[PEAK_ACCELERATION], peak)
        if level:
            totals[FRICTION] = max(totals[FRICTION], peak / par.g)
    if level:
        return
    demand, demand_before, lift, lift_before = 0.0, 0.0, 0.0, 0.0
    for probe in range(PROBES + 1):
        d = h * probe / PROBES
        horizontal = value(P[row], last, d) if last >= 0 else 0.0
        upward = gravity_at(par, vertical, P, highest, d)
        if rocking:
            rate, second = value(P[W], order, d), derivative(P[W], order, d)
            angle = s * par.gamma - value(P[PHI], order, d)
            c, n = par.R * math.cos(angle), par.R * math.sin(angle)
            horizontal += c * second + n * rate * rate
            upward += n * second - c * rate * rate
        here, low = abs(horizontal) / upward if upward > 0 else math.inf, -upward / par.g
        if probe > 1:
            totals[FRICTION] = max(totals[FRICTION], _top(demand_before, demand, here))
            totals[NORMAL] = min(totals[NORMAL], -_top(lift_before, lift, low))
        demand_before, demand, lift_before, lift = demand, here, lift, low


@njit(cache=True)
def read_lifting(par, P, order, highest, h, totals):
    """Work of the vertical ground motion on the rocking block within the step [J]: -int a_v m n phi' dt."""
    lift, rising = P[EVENT], P[PRODUCT_A]
    for k in range(max(highest, 0) + 1):
        lift[k] = P[GRAVITY, k]
    lift[0] -= par.g
    last = 0.0  # the series of sin ends one term before the others on rigid ground
    for j in range(order):
        last -= P[W, j] * P[C, order - 1 - j]
    P[S, order] = last * INVERSE[order]
    for k in range(order + 1):  # of phi' sin
        rising[k] = 0.0
        for j in range(k + 1):
            rising[k] += P[S, j] * P[W, k - j]
    totals[INPUT] -= par.m * par.R * _integral_of_product(lift, max(highest, 0), rising, order, h)


@njit(cache=True)
def read_energy(par, rocking, P, order, highest, h, totals):
    """Work of the ground, of the hysteretic and of the viscous bearing force within the step [J]."""
    momentum, hysteretic = P[PRODUCT_A], P[PRODUCT_B]
    if highest >= 0:  # -int a_g (M x' + m c phi') dt
        for k in range(order + 1):
            turning = 0.0
            if rocking:
                for j in range(k + 1):
                    turning += P[C, j] * P[W, k - j]
            momentum[k] = par.m * par.R * turning + (par.M * P[V, k] if par.on_base else 0.0)
        totals[INPUT] -= _integral_of_product(P[GROUND], min(highest, order), momentum, order, h)
    if par.count > 0:
        for k in range(order + 1):
            hysteretic[k] = P[F, k] - par.count * (par.kb * P[X, k] + par.damping * P[V, k])
        totals[HYSTERETIC] += _integral_of_product(hysteretic, order, P[V], order, h)
        if par.damping > 0:
            totals[VISCOUS] += par.count * par.damping * _integral_of_product(P[V], order, P[V], order, h)
