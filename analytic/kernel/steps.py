"""Parts of a step of the kernel: ground motion, Taylor series, first event, end of step (compiled).

The series are those of the equations of `rocking`, coefficient by coefficient. Arrays hold coefficients in the time
since the start of the step, lowest first; entry 0 (the state) is given, the rest is filled up to `order`. S and C are
sin and cos of s gamma - phi, so that n = R S and c = R C.

`upright` : samples of the vertical motion; any array for a pulse, None without a vertical motion. The kind is
fixed when a function is compiled, so that runs without one lose no time.
"""

import math

from ..laws import NUMBERS, law_function
from ..motion import SERIES
from . import layout as L
from .compiled import chosen, inlined, inner
from .events import (
    direction_from_rest,
    find_fall,
    find_passage,
    find_turn,
    find_uplift,
    hop_deceleration,
    read_contact,
    read_energy,
    read_lifting,
    write_history,
)
from .polynomial import INVERSE, SHORT_ORDER, bound, largest, value

# A decayed motion below this size [rad, m, ...] does not limit the step.
NEGLIGIBLE = 1e-200

# Largest reduction of a step at once, as powers of a long step overflow.
MOST_SHRINK = 1e-3

_bearing_term = law_function("term")
USUAL_LAW = NUMBERS["algebraic"]  # its series is unrolled

# Kinds of ground motion within a segment: none, linear, and from PULSE on the series of `motion.SERIES`.
QUIET, LINEAR_GROUND, PULSE = range(3)
_pulse_series = chosen(SERIES)


@inlined
def _allowed_step(f, order, tolerance, h):
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
def allowed_step(f, order, tolerance, h):
    """Return the largest step up to h whose last Taylor terms stay below tolerance times the size of f in it.

    NaN where the series is not finite.
    """
    if order == SHORT_ORDER:  # powers by a constant are unrolled
        return _allowed_step(f, SHORT_ORDER, tolerance, h)
    return _allowed_step(f, order, tolerance, h)


@inner
def hop_order(length, order, tolerance):
    """Return the order for a swing of `length` [1/omega_r], at most `order`; the terms decrease about as (length)^k."""
    if length >= 0.25:
        return order
    return min(order, max(5, int(math.log(0.01 * tolerance) / math.log(2 * length)) + 3))


@inner
def ground_series(order, kind, a0, a1, frequency, u, A):
    """Fill the coefficients of the ground acceleration; return the order of the highest one that is not zero, or -1.

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
    """Fill the series of rocking on rigid ground, eq. (4) with x = 0: phi'' = -p^2 (S + a_g/g C).

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
    """Fill the series in full contact on the base, eq. (2): (m + m_b)(a_g + x'') + n_d f = 0; F[0], q[0] are given."""
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
    """Fill the series of rocking on the base, eqs (3)-(6), with c phi'' + n phi'^2 written as (c phi')'.

    M X + m (c phi')' = -F;   m c X + J phi'' = -m g n;   X = a_g + x''. With the series G of g + a_v, as many terms as
    a_g has, G replaces g.
    """
    if order == SHORT_ORDER and par.law == USUAL_LAW:
        _base_series(SHORT_ORDER, USUAL_LAW, par, factors, highest, P, G)
    else:
        _base_series(order, par.law, par, factors, highest, P, G)


# First trial length of a step of a rocking block [1/omega_r]: no step is longer at a useful tolerance.
FARTHEST = 4.0

# Events at one time before a run gives up, so that no loop is endless; never seen.
PATIENCE = 1000
# Steps shorter than this fraction of the time are below its rounding.
ROUNDING = 4e-16

# Functions of the bearing law, see `laws.Law`.
mark, power_of, begin_step, reached = map(law_function, ("mark", "power", "begin", "reached"))


@inlined
def stretch_of_ground(ground, upright, segment, begin, order, duration):
    """Return the next `Stretch` of ground motion, from `begin` [s]. order : of the series of a pulse."""
    kind, a0, slope, lift, rise, end, shaking = QUIET, 0.0, 0.0, 0.0, 0.0, duration, ground.shaking
    if ground.kind == LINEAR_GROUND:
        if segment < ground.samples.shape[0] - 1:
            a0 = shaking.scale * ground.samples[segment]
            slope = (shaking.scale * ground.samples[segment + 1] - a0) / ground.dt
            end = min((segment + 1) * ground.dt, duration)
            order = SHORT_ORDER
            if upright is not None:
                lift = shaking.upright_scale * upright[segment]
                rise = (shaking.upright_scale * upright[segment + 1] - lift) / ground.dt
            if a0 != 0 or slope != 0 or lift != 0 or rise != 0:
                kind = LINEAR_GROUND
    elif ground.kind != QUIET:
        if segment == 0:
            end = min(shaking.start, duration)
        elif segment == 1:
            kind, a0, lift, end = ground.kind, shaking.scale, shaking.upright_scale, min(shaking.end, duration)
    return L.Stretch(kind, a0, slope, lift, rise, end, order)


@inlined
def ground_of_step(shaking, stretch, tau, h, A):
    """Fill the series of the ground acceleration `tau` into the stretch; return (its highest order, step)."""
    kind = stretch.kind
    if shaking.frequency == 0 and kind != QUIET:  # a constant pulse, too
        kind = LINEAR_GROUND
    phase = shaking.phase + shaking.frequency * tau  # not from t, which would lose accuracy for late pulses
    if kind >= PULSE:
        h = min(h, 1.0 / shaking.frequency)
    level = stretch.a0 + stretch.slope * tau
    return ground_series(stretch.order, kind, level, stretch.slope, shaking.frequency, phase, A), h


@inner
def gravity_of_step(shaking, g, stretch, tau, G):
    """Fill the series of g + a_v, as `ground_of_step`."""
    G[0], G[1], kind = 0.0, 0.0, stretch.kind
    if shaking.frequency == 0 and kind != QUIET:  # a constant pulse, too
        kind = LINEAR_GROUND
    phase = shaking.upright_phase + shaking.frequency * tau
    ground_series(stretch.order, kind, stretch.lift + stretch.rise * tau, stretch.rise, shaking.frequency, phase, G)
    G[0] += g


@inlined
def bearing_of_step(par, body, base, branch, gravity, highest, P):
    """Prepare base and bearing at the start of a step: fill x, v, q and F of order 0.

    gravity : g + a_v [m/s2]. Returns the same as `branch_of`.
    """
    x, v, z = base
    P[L.X, 0], P[L.V, 0] = x, v
    P[L.F, 0] = par.count * (par.kb * x + z + par.damping * v)
    moving = math.copysign(1.0, v)
    if v == 0:
        moving = direction_from_rest(par, body, gravity, highest, P[L.GROUND], P[L.F, 0])
    return branch_of(par, moving, base, branch, P)


@inlined
def branch_of(par, moving, base, branch, P):
    """Return (branch, factors of the bearing's series, the bearing's next corner); fill q of order 0.

    moving : the side to which the base moves.
    """
    (x, _, z), (direction, x_c, mark_c, power) = base, branch
    if moving != direction and moving != 0:
        direction, x_c = moving, x
        mark_c = mark(par.law, direction, z, par.constants)
        power = power_of(par.law, mark_c, par.constants)
    travel = mark_c + direction * (x - x_c)
    P[L.Q, 0], factors, corner = begin_step(par.law, direction, z, travel, power, par.constants)
    return L.Branch(direction, x_c, mark_c, power), factors, corner


@inlined
def contact_of_step(par, step, tolerance, P):
    """Fill the series in full contact; return the step that they allow [s]."""
    order, highest = step.order, step.highest
    if not par.on_base:
        for k in range(highest + 1, order + 1):
            P[L.GROUND, k] = 0.0
        return step.h
    contact_series(order, par, step.factors, highest, P)
    # the force, too: with ka close to kb it varies faster than the velocity
    return allowed_step(P[L.F], order, tolerance, allowed_step(P[L.V], order, tolerance, step.h))


@inlined
def rocking_of_step(par, upright, kind, body, fresh, step, tolerance, P):
    """Fill the series while rocking; return (order used, step [s]).

    kind : of the ground motion; fresh : whether the block has just lifted.
    """
    (s, tilt, rate), order, highest, w = body, step.order, step.highest, P[L.W]
    h = min(step.h, FARTHEST / math.sqrt(par.p2))
    angle, used, reach = s * par.gamma - tilt, order, h
    P[L.PHI, 0], w[0], P[L.S, 0], P[L.C, 0] = tilt, rate, math.sin(angle), math.cos(angle)
    if tilt == 0 and rate != 0 and kind != LINEAR_GROUND:  # after an impact: the swing's length determines the order
        back = hop_deceleration(par, s, step.gravity, P[L.GROUND, 0] if highest >= 0 else 0.0, P[L.F, 0])
        if back > 0:
            hop = 2 * abs(rate) / back
            used = hop_order(math.sqrt(par.p2) * hop, order, tolerance)
            if used < order:
                reach = min(h, 1.2 * hop)
    while True:
        good = reach
        if par.on_base:
            if upright is None:
                base_series(used, par, step.factors, highest, P, None)
            else:
                base_series(used, par, step.factors, highest, P, P[L.GRAVITY])
            good = allowed_step(P[L.F], used, tolerance, allowed_step(P[L.V], used, tolerance, good))
        elif upright is None:
            rigid_series(used, par.p2, par.g, highest, P, None)
        else:
            rigid_series(used, par.p2, par.g, highest, P, P[L.GRAVITY])
        if fresh:
            P[L.PHI, 2], w[1] = 0.0, 0.0
        good = allowed_step(w, used, tolerance, good)
        if used == order or good == reach:
            return used, good
        used, reach = order, h  # the swing is longer than estimated


@inner
def first_event(shape, upright, body, refused, direction, step, P, work):
    """Return (kind of the first event in the step, its time since the start); without one NONE and the step's length.

    refused : the last onset of uplift was a graze; direction : of the base velocity.
    """
    s, tilt, _ = body
    kind, h, order = L.NONE, step.h, step.order
    if s == 0:
        root = find_uplift(shape, upright, refused, step, P, work)
        if root >= 0:
            kind, h = L.UPLIFT, root
    else:
        root = find_fall(P[L.PHI], s, 0.0, order, h, P[L.EVENT], work)
        if root >= 0:
            kind, h = L.IMPACT, root
        kind, h = find_passage(shape.gamma, s, tilt, (kind, h), order, P, work)
    return find_turn(direction, step.corner, (kind, h), order, P, work)


@inlined
def read_step(par, upright, body, step, options, arrays, written):
    """Write history, diagnostics and energy ledger of the step; return the rows of the history written."""
    rocking, moved = body.s != 0, step.h > 0
    if arrays.history.shape[0] > 0 and (moved or step.t == 0):
        written = write_history(par, body, step, options.output_step, arrays, written)
    if options.record and moved:
        read_contact(par, upright, body, step, arrays)
        if rocking or par.on_base:
            read_energy(par, body, step, arrays.P, arrays.totals)
        if upright is not None and rocking:
            read_lifting(par, step, arrays.P, arrays.totals)
    return written


@inlined
def end_of_block(body, step, peak_tilt, P, work):
    """Return (tilt, rate, peak tilt) at the end of the step; of several peaks inside it the largest counts."""
    h, order, phi = step.h, step.order, P[L.PHI]
    tilt_end, rate_end = value(phi, order, h), value(P[L.W], order, h)
    if bound(phi, order, h) > peak_tilt:
        peak_tilt = largest(phi, body.s, order, h, peak_tilt, P[L.EVENT], work)
    return tilt_end, rate_end, max(peak_tilt, abs(tilt_end))


@inlined
def end_of_base(par, event, base, branch, step, P):
    """Return base and branch at the end of the step, which is at the `event`."""
    z, (direction, x_c, mark_c, _), h, order = base.z, branch, step.h, step.order
    x, v = value(P[L.X], order, h), value(P[L.V], order, h)
    if event == L.REVERSAL:
        v = 0.0
    power = power_of(par.law, mark_c + direction * (x - x_c), par.constants)
    z = reached(par.law, direction, z, P[L.Q], order, h, power, par.constants)
    if event == L.CORNER:
        z = direction * step.corner
    return L.Base(x, v, z), L.Branch(direction, x_c, mark_c, power)
