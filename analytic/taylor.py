"""Taylor series of the motion over one step (compiled): the equations of rocking.py, coefficient by coefficient.

Arrays hold coefficients in the time since the start of the step, lowest first; entry 0 (the state) is given, the
rest is filled up to `order`. S and C are sin and cos of s gamma - phi, so n = R S and c = R C.
"""

import math

from . import layout as L
from .compiled import chosen, inlined, inner
from .laws import NUMBERS, law_function
from .polynomial import INVERSE
from .pulses import SERIES

# Order of the series between the samples of a record, where steps end anyway (`rocking study speed-error`).
SHORT_ORDER = 8

# A decayed motion below this size [rad, m, ...] does not limit the step.
NEGLIGIBLE = 1e-200

# Largest reduction of a step at once, as powers of a long step overflow.
MOST_SHRINK = 1e-3

_bearing_term = law_function("term")
USUAL_LAW = NUMBERS["algebraic"]  # its series is unrolled

# Kinds of ground motion within a segment: none, linear, and from PULSE on the series of `pulses.SERIES`.
QUIET, LINEAR_GROUND, PULSE = range(3)
_pulse_series = chosen(SERIES)


@inner
def allowed_step(f, order, tolerance, h):
    """Largest step up to h whose last Taylor terms stay below tolerance times the size of f in that very step.

    NaN where the series is not finite.
    """
    if not math.isfinite(abs(f[order]) + abs(f[order - 1])):
        return math.nan
    while True:
        limit = tolerance * max(abs(f[0]) + abs(f[1]) * h + abs(f[2]) * h * h, NEGLIGIBLE)
        last, before = abs(f[order]) * h**order, abs(f[order - 1]) * h ** (order - 1)
        if last <= limit and before <= 4 * limit:  # one of the two may vanish by symmetry
            return h
        shrink = 1.0
        if last > limit:
            shrink = 0.9 * (limit / last) ** (1.0 / order)
        if before > 4 * limit:
            shrink = min(shrink, 0.9 * (4 * limit / before) ** (1.0 / (order - 1)))
        h *= max(shrink, MOST_SHRINK)


@inner
def hop_order(length, order, tolerance):
    """Order for a swing of `length` [1/omega_r], at most `order`; the terms decrease about as (length)^k."""
    if length >= 0.25:
        return order
    return min(order, max(5, int(math.log(0.01 * tolerance) / math.log(2 * length)) + 3))


@inner
def ground_series(order, kind, a0, a1, frequency, u, A):
    """Coefficients of the ground acceleration; returns the highest one that is not zero, or -1.

    LINEAR_GROUND: a0 + a1 t; else a0 f(u + frequency t) of a pulse.
    """
    if kind == QUIET:
        return -1
    if kind == LINEAR_GROUND:
        A[0], A[1] = a0, a1
        return 1
    _pulse_series(kind - PULSE, order, a0, frequency, u, A)
    return order


@inlined
def _rigid_series(order, p2, g, highest, P, G):
    A, phi, w, S, C = P[L.GROUND], P[L.PHI], P[L.W], P[L.S], P[L.C]
    for k in range(order):
        if k > 0:
            sine, cosine = 0.0, 0.0
            for j in range(k):
                sine += w[j] * C[k - 1 - j]
                cosine += w[j] * S[k - 1 - j]
            S[k] = -sine * INVERSE[k]
            C[k] = cosine * INVERSE[k]
        push = 0.0
        for j in range(min(k, highest) + 1):
            push += A[j] * C[k - j]
        if G is None:
            w[k + 1] = -p2 * (S[k] + push / g) * INVERSE[k + 1]
        else:
            for j in range(min(k, max(highest, 0)) + 1):
                push += G[j] * S[k - j]
            w[k + 1] = -p2 / g * push * INVERSE[k + 1]
        phi[k + 1] = w[k] * INVERSE[k + 1]


@inner
def rigid_series(order, p2, g, highest, P, G):
    """Rocking on rigid ground, eq. (4) with x = 0: phi'' = -p^2 (S + a_g/g C).

    With the series G of g + a_v, as many terms as a_g has, phi'' = -p^2/g (G S + a_g C).
    """
    if order == SHORT_ORDER:  # a constant order is unrolled: twice as fast
        _rigid_series(SHORT_ORDER, p2, g, highest, P, G)
    else:
        _rigid_series(order, p2, g, highest, P, G)


@inlined
def _contact_series(order, law, par, factors, highest, P):
    A, x, v, q, F, absolute = P[L.GROUND], P[L.X], P[L.V], P[L.Q], P[L.F], P[L.ABSOLUTE]
    count, kb, damping, inverse_mass = par.count, par.kb, par.damping, -1.0 / par.M
    for k in range(order + 1):
        if k > 0:
            z = _bearing_term(law, k, factors, x, v, q)
            F[k] = count * (kb * x[k] + z + damping * v[k])
        absolute[k] = F[k] * inverse_mass
        if k < order:
            relative = absolute[k] - A[k] if k <= highest else absolute[k]
            v[k + 1] = relative * INVERSE[k + 1]
            x[k + 1] = v[k] * INVERSE[k + 1]


@inner
def contact_series(order, par, factors, highest, P):
    """Full contact on the base, eq. (2): (m + m_b)(a_g + x'') + n_d f = 0. F[0] and q[0] are given."""
    if order == SHORT_ORDER and par.law == USUAL_LAW:  # constants are unrolled: twice as fast
        _contact_series(SHORT_ORDER, USUAL_LAW, par, factors, highest, P)
    else:
        _contact_series(order, par.law, par, factors, highest, P)


@inlined
def _base_series(order, law, par, factors, highest, P, G):
    A, phi, w, S, C, x, v = P[L.GROUND], P[L.PHI], P[L.W], P[L.S], P[L.C], P[L.X], P[L.V]
    q, F, absolute = P[L.Q], P[L.F], P[L.ABSOLUTE]
    count, kb, damping, M, J, g = par.count, par.kb, par.damping, par.M, par.J, par.g
    mR = par.m * par.R
    c0 = mR * C[0]
    scale = 1.0 / (M * J - c0 * c0)
    for k in range(order + 1):
        if k > 0:
            sine = 0.0
            for j in range(k):
                sine += w[j] * C[k - 1 - j]
            S[k] = -sine * INVERSE[k]
            z = _bearing_term(law, k, factors, x, v, q)
            F[k] = count * (kb * x[k] + z + damping * v[k])
        cosine = 0.0
        for j in range(k + 1):
            cosine += w[j] * S[k - j]
        C[k + 1] = cosine * INVERSE[k + 1]
        momentum, lever = 0.0, 0.0
        for j in range(1, k + 1):
            momentum += C[j] * w[k + 1 - j]
            lever += C[j] * absolute[k - j]
        momentum += C[k + 1] * w[0]
        push = -F[k] - mR * (k + 1) * momentum
        if G is None:
            weight = g * S[k]
        else:
            weight = 0.0
            for j in range(min(k, max(highest, 0)) + 1):
                weight += G[j] * S[k - j]
        moment = -mR * (weight + lever)
        absolute[k] = (J * push - c0 * moment) * scale
        if k < order:
            w[k + 1] = (M * moment - c0 * push) * scale * INVERSE[k + 1]
            phi[k + 1] = w[k] * INVERSE[k + 1]
            relative = absolute[k] - A[k] if k <= highest else absolute[k]
            v[k + 1] = relative * INVERSE[k + 1]
            x[k + 1] = v[k] * INVERSE[k + 1]


@inner
def base_series(order, par, factors, highest, P, G):
    """Rocking on the base, eqs (3)-(6), with c phi'' + n phi'^2 written as (c phi')'.

    M X + m (c phi')' = -F;   m c X + J phi'' = -m g n;   X = a_g + x''. With the series G of g + a_v, as many terms as
    a_g has, G replaces g.
    """
    if order == SHORT_ORDER and par.law == USUAL_LAW:
        _base_series(SHORT_ORDER, USUAL_LAW, par, factors, highest, P, G)
    else:
        _base_series(order, par.law, par, factors, highest, P, G)
