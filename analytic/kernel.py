"""The compiled event-driven integrator: full contact, uplift, rocking, impact, rest, re-uplift, overturning.

Taylor steps stop at every corner of the ground motion; inside a step all events are roots of the step's own
polynomials, so their times are as exact as the step. The equations stand in taylor.py, the bearing in bearing.py.
"""

import math
from collections import namedtuple

import numpy as np
from numba import njit

from .bearing import ALGEBRAIC, BOUC_WEN, virtual_travel
from .polynomial import BISECTIONS, MAX_ORDER, bracketed_root, first_root, value
from .taylor import (
    HARMONIC,
    LINEAR_GROUND,
    QUIET,
    SHORT_ORDER,
    base_series,
    contact_series,
    ground_series,
    rigid_series,
)

# Modes of the block.
CONTACT, ROCKING, OVERTURNED = range(3)
# Why a run ended.
COMPLETE, DECIDED, STUCK, NOT_FINITE = range(4)
# Slots of the totals a run returns.
(STATUS, MODE, TIME, PEAK_TILT, PEAK_X, PEAK_ACCELERATION, UNSTABLE_TIME, FRICTION, NORMAL, INPUT, HYSTERETIC,
 VISCOUS, IMPACT_LOSS, STEPS, IMPACTS, UPLIFTS, RESTS, WILL_OVERTURN, LIFTED) = range(19)
TOTALS = 19
# Rows of the workspace that hold the absolute base acceleration and the ground acceleration.
ABSOLUTE, GROUND = 8, 9

# Ground motion: sampled (dt, samples) or a pulse; `kind` is one of QUIET, LINEAR_GROUND (sampled), HARMONIC
# (a0 sin(phase + frequency (t - start))), RICKER. A rectangular pulse is HARMONIC with frequency 0.
Ground = namedtuple("Ground", "kind dt samples scale frequency phase start end")
# What to do: `record` keeps events (up to `capacity` of a kind), ledger and diagnostics; `decide` stops as soon as the
# outcome is certain.
Options = namedtuple("Options", "tolerance order rest_rate record decide output_step capacity")

# An impact slower than rest_rate omega_r ends in rest if the next hop is also short; see `rests`.
LONGEST_LAST_HOP = 1e-3  # in units of 1/omega_r
# Points inside a step at which unsmooth diagnostics (friction demand, accelerations) are read.
PROBES = 4
# Events without progress of time that count as stuck (none is known; a guard, not a rule).
PATIENCE = 1000


@njit(cache=True)
def hop_deceleration(par, s, ground, F):
    """-s phi'' at phi = 0 on side s [rad/s2]; positive where gravity brings the block back. From eqs (3)-(6)."""
    h, b = par.R * math.cos(par.gamma), s * par.R * math.sin(par.gamma)
    if not par.on_base:
        return s * par.m * (h * ground + par.g * b) / par.J
    determinant = par.M * par.J - (par.m * h) ** 2
    return s * (par.M * par.m * par.g * b - par.m * h * F) / determinant


@njit(cache=True)
def remaining_hops(par, rate, ground, F):
    """Time the accumulating impacts after one that leaves tilt rate `rate` still take [s]; -1 if they do not end in rest.

    Hop n lasts 2 w_n/q on its side and w_n+1 = e w_n: a geometric series, exact in the limit of small hops.
    """
    s = 1.0 if rate > 0 else -1.0
    here, there = hop_deceleration(par, s, ground, F), hop_deceleration(par, -s, ground, F)
    if here <= 0 or there <= 0:
        return -1.0
    w = abs(rate)
    if 2 * w > LONGEST_LAST_HOP / math.sqrt(par.p2) * min(here, there):
        return -1.0
    if par.e > 0.999:  # the series is long: end it at the impact
        return 0.0
    return 2 * w * (1 / here + par.e / there) / (1 - par.e * par.e)


@njit(cache=True)
def allowed_step(f, order, tolerance, h):
    """Largest step up to h whose last Taylor term stays below tolerance times the size of f in the step."""
    size = abs(f[0]) + abs(f[1]) * h + abs(f[2]) * h * h
    limit = tolerance * size
    highest = abs(f[order]) * h**order
    if highest > limit:
        h *= 0.9 * (limit / highest) ** (1.0 / order)
    lower = abs(f[order - 1]) * h ** (order - 1)
    if lower > 4 * limit:
        h *= 0.9 * (4 * limit / lower) ** (1.0 / (order - 1))
    return h


@njit(cache=True)
def integral_of_product(f, g, order, h):
    """Integral of f g over [0, h], to the order of the series."""
    total, power = 0.0, h
    for k in range(order + 1):
        term = 0.0
        for j in range(k + 1):
            term += f[j] * g[k - j]
        total += term * power / (k + 1)
        power *= h
    return total


@njit(cache=True)
def run(par, ground, options, totals):
    """Simulate; fills `totals` and returns (end state, impacts, uplifts, rests, history).

    end : (tilt, rate, x, v, z); impacts : (n, 4); uplifts, rests : (n,); history : (n, 6) at multiples of
    output_step: time, tilt, rate, x, v, F (empty if output_step is 0).
    """
    record, tolerance = options.record, options.tolerance
    # unpacked once: reading an array out of a tuple costs two atomic operations each time
    ground_kind, ground_dt, samples, ground_scale, ground_frequency, ground_phase, ground_start, ground_end = ground
    omega = math.sqrt(par.p2)
    overturn, threshold = 0.5 * math.pi, par.g * math.tan(par.gamma)
    P = np.zeros((15, MAX_ORDER + 2))
    phi, w, S, C, x, v, q, F, absolute, A = P[0], P[1], P[2], P[3], P[4], P[5], P[6], P[7], P[ABSOLUTE], P[GROUND]
    event, hysteretic, momentum = P[10], P[11], P[12]
    work = np.empty((BISECTIONS + 2, MAX_ORDER + 1))
    # never rebound in the loop: numba would count references at every merge of the control flow
    capacity = options.capacity if record else 0
    impacts, uplifts, rests = np.empty((capacity, 4)), np.empty(capacity), np.empty(capacity)
    outputs = int(math.floor(par.duration / options.output_step * (1 + 1e-14))) + 1 if options.output_step > 0 else 0
    history = np.empty((outputs, 6))
    written, n_impacts, n_uplifts, n_rests, steps, idle = 0, 0, 0, 0, 0, 0
    status, peak_tilt, peak_x, peak_absolute = COMPLETE, abs(par.tilt), abs(par.x), 0.0
    unstable_time, friction, normal, will_overturn = -1.0, 0.0, 1.0, False
    work_in, work_hysteretic, work_viscous, impact_loss = 0.0, 0.0, 0.0, 0.0

    tilt, rate, bx, bv, z = par.tilt, par.rate, par.x, par.v, par.z
    mode, t = CONTACT, 0.0
    s = 0.0
    if tilt != 0 or rate != 0:
        mode, s = ROCKING, math.copysign(1.0, tilt if tilt != 0 else rate)
    fresh_uplift, blocked = False, False  # onset just found: phi'' = 0 exactly; onset refused within this step
    order = SHORT_ORDER if ground_kind == LINEAR_GROUND else options.order
    # bearing history: direction of travel, D_c and x_c of the last reversal
    direction, anchor_x, anchor_travel = 0.0, bx, 1.0
    segment = 0
    segments = samples.shape[0] - 1 if ground_kind == LINEAR_GROUND else 3
    begin = 0.0
    while begin < par.duration and mode != OVERTURNED and status == COMPLETE:
        # the next stretch of ground motion without a corner
        kind, a0, slope = QUIET, 0.0, 0.0
        finish = par.duration
        if ground_kind == LINEAR_GROUND:
            if segment < segments:
                a0 = ground_scale * samples[segment]
                slope = (ground_scale * samples[segment + 1] - a0) / ground_dt
                finish = min((segment + 1) * ground_dt, par.duration)
                if a0 != 0 or slope != 0:
                    kind = LINEAR_GROUND
        elif ground_kind != QUIET:
            if segment == 0:
                finish = min(ground_start, par.duration)
            elif segment == 1:
                kind, a0 = ground_kind, ground_scale
                finish = min(ground_end, par.duration)
        segment += 1
        if kind == QUIET and ground_kind == LINEAR_GROUND and segment > segments:
            order = options.order
        length = finish - begin
        tau = 0.0
        while tau < length:
            h = length - tau
            t = begin + tau
            if h <= 4e-16 * finish:  # less than the rounding of time: not a step
                break
            if kind == QUIET and mode == CONTACT and not par.on_base:
                tau = length  # nothing moves
                while written < outputs and written * options.output_step <= finish:
                    history[written] = 0.0
                    history[written, 0] = written * options.output_step
                    written += 1
                continue
            if options.decide and kind == QUIET and finish == par.duration and mode == ROCKING and not par.on_base:
                # after the motion the energy integral decides: E = phi'^2/2 + p^2 cos(s gamma - phi), barrier p^2
                barrier = par.p2 * (1 - math.cos(s * par.gamma - tilt))
                excess = 0.5 * rate * rate - barrier
                if s * tilt < par.gamma:
                    if s * rate < 0:  # first back through an impact
                        after = par.e * par.e * (0.5 * rate * rate + par.p2 * (math.cos(s * par.gamma - tilt)
                                                                               - math.cos(par.gamma)))
                        excess_after = after - par.p2 * (1 - math.cos(par.gamma))
                        top = excess_after / par.p2 + 1
                        excess = max(excess_after, excess if excess < 0 else -1.0)
                        n_impacts += 1
                    else:
                        top = excess / par.p2 + 1
                    will_overturn = excess > 0
                    if not will_overturn:
                        peak_tilt = max(peak_tilt, par.gamma - math.acos(min(1.0, top)))
                        status = DECIDED
                        break
                elif s * rate >= 0 or excess < 0:
                    will_overturn = True
                if will_overturn:
                    peak_tilt = overturn
                    status = DECIDED
                    break
            phase = ground_phase + ground_frequency * (t - ground_start)
            if kind == HARMONIC and ground_frequency == 0:
                highest = ground_series(order, LINEAR_GROUND, a0, 0.0, 0.0, 0.0, A)
            else:
                highest = ground_series(order, kind, a0 + slope * tau if kind == LINEAR_GROUND else a0, slope,
                                        ground_frequency, phase, A)
            if kind != QUIET and kind != LINEAR_GROUND and ground_frequency > 0:
                h = min(h, 1.0 / ground_frequency)
            steps += 1
            found, h_event = 0, -1.0  # 1 uplift, 2 impact, 3 reversal, 4 overturning
            used = order

            # ---- series of this step, and its length
            if mode == CONTACT and not par.on_base:
                for k in range(highest + 1, order + 1):
                    A[k] = 0.0
                if abs(A[0]) > threshold and not blocked:
                    found, h_event = 1, 0.0
            else:
                y0 = 1.0
                if par.on_base:
                    x[0], v[0] = bx, bv
                    F[0] = par.count * (par.kb * bx + z + par.damping * bv)
                    if bv != 0:
                        moving = 1.0 if bv > 0 else -1.0
                    else:  # from standstill: the direction the first nonzero derivative gives
                        start = -(par.M * A[0] if highest >= 0 else 0.0) - F[0]
                        if mode == ROCKING:
                            c0 = par.m * par.R * math.cos(s * par.gamma - tilt)
                            n0 = par.m * par.R * math.sin(s * par.gamma - tilt)
                            start = (par.J * (-F[0] - n0 * rate * rate) + c0 * par.g * n0) / (
                                par.M * par.J - c0 * c0) - (A[0] if highest >= 0 else 0.0)
                        if start == 0 and highest >= 1:
                            start = -A[1]
                        moving = 0.0 if start == 0 else (1.0 if start > 0 else -1.0)
                    if moving != direction and moving != 0:
                        direction, anchor_x = moving, bx
                        if par.law == ALGEBRAIC:
                            anchor_travel = virtual_travel(direction, z, par.dk, par.alpha, par.d0, par.f0)
                    if par.law == ALGEBRAIC:
                        y0 = anchor_travel + direction * (bx - anchor_x)
                        q[0] = y0 ** (1 - par.alpha)
                        if direction == 0:
                            q[0] = 0.0
                    elif par.law == BOUC_WEN:
                        q[0] = z
                if mode == CONTACT:
                    contact_series(order, par, direction, 1.0 / y0, highest, A, x, v, q, F, absolute)
                    h = allowed_step(v, order, tolerance, h)
                else:
                    angle = s * par.gamma - tilt
                    phi[0], w[0], S[0], C[0] = tilt, rate, math.sin(angle), math.cos(angle)
                    F0 = F[0] if par.on_base else 0.0
                    if tilt == 0 and rate != 0 and kind != LINEAR_GROUND:
                        # a hop: its length tells the order it needs
                        q_hop = hop_deceleration(par, s, A[0] if highest >= 0 else 0.0, F0)
                        if q_hop > 0:
                            hop = 4 * omega * abs(rate) / q_hop
                            if hop < 0.5:
                                used = min(order, max(5, int(math.log(tolerance * 0.01) / math.log(hop)) + 3))
                    while True:
                        if par.on_base:
                            base_series(used, par, direction, 1.0 / y0, highest, A, phi, w, S, C, x, v, q, F, absolute)
                        else:
                            rigid_series(used, par.p2, par.g, highest, A, phi, w, S, C)
                        if fresh_uplift:
                            phi[2], w[1] = 0.0, 0.0
                        if used == order:
                            h = allowed_step(w, order, tolerance, h)
                            if par.on_base:
                                h = allowed_step(v, order, tolerance, h)
                            break
                        # short series: the hop must end inside the step it is good for
                        reach = min(h, 1.2 * hop / omega * 0.5)
                        good = allowed_step(w, used, 0.1 * tolerance, reach)
                        if par.on_base:
                            good = min(good, allowed_step(v, used, 0.1 * tolerance, reach))
                        if good >= reach:
                            h = reach
                            break
                        used = order
                if not (h > 1e-15 * max(t, 1e-3)) or not math.isfinite(h):
                    status = STUCK if math.isfinite(h) else NOT_FINITE
                    break

            # ---- events inside the step, the earliest one first
            if mode == CONTACT:
                if found == 0:
                    row = ABSOLUTE if par.on_base else GROUND
                    reach = h
                    size, power = abs(P[row, 0]), 1.0
                    for k in range(1, used + 1):
                        power *= h
                        size += abs(P[row, k]) * power
                    if size >= threshold:
                        for side in (-1.0, 1.0):
                            for k in range(used + 1):
                                event[k] = side * P[row, k]
                            event[0] += threshold
                            if blocked and abs(event[0]) <= 1e-9 * threshold:
                                event[0] = 0.0  # the touch just refused; a later crossing still counts
                                if event[1] < 0:
                                    continue
                            root = first_root(event, used, reach, work)
                            if root >= 0:
                                found, h_event, reach = 1, root, root
            else:
                for k in range(used + 1):
                    event[k] = s * phi[k]
                if fresh_uplift and not event[3] > 0:
                    # grazing: the onset is no onset, the block stays down for the rest of this step
                    mode, s, fresh_uplift, blocked = CONTACT, 0.0, False, True
                    if record:
                        n_uplifts -= 1
                    continue
                root = first_root(event, used, h, work)
                if root >= 0:
                    found, h_event = 2, root
                reach = h if found == 0 else h_event
                top, power = s * tilt, 1.0
                for k in range(1, used + 1):
                    power *= reach
                    if event[k] > 0:
                        top += event[k] * power
                if record and unstable_time < 0 and top > par.gamma:
                    for k in range(used + 1):
                        event[k] = -s * phi[k]
                    event[0] += par.gamma
                    root = first_root(event, used, reach, work)
                    if root >= 0:
                        unstable_time = t + root
                if top > overturn:
                    for k in range(used + 1):
                        event[k] = -s * phi[k]
                    event[0] += overturn
                    root = first_root(event, used, reach, work)
                    if root >= 0:
                        found, h_event = 4, root
            if par.on_base and direction != 0:
                reach = h if found == 0 else h_event
                lowest, power = direction * v[0], 1.0
                for k in range(1, used + 1):
                    power *= reach
                    lowest -= abs(v[k]) * power
                if lowest <= 0:
                    for k in range(used + 1):
                        event[k] = direction * v[k]
                    root = first_root(event, used, reach, work)
                    if root > 0:
                        found, h_event = 3, root
            if found != 0:
                h = h_event
            idle = idle + 1 if h <= 0 else 0
            if idle > PATIENCE:
                status = STUCK
                break

            # ---- what is read off the step
            rocking = mode == ROCKING
            if rocking:
                end_rate = value(w, used, h)
                end_tilt = value(phi, used, h)
                if s * rate > 0 and s * end_rate < 0:
                    for k in range(used + 1):
                        event[k] = s * w[k]
                    peak_tilt = max(peak_tilt, abs(value(phi, used, bracketed_root(event, 0, used, 0.0, h))))
                peak_tilt = max(peak_tilt, abs(end_tilt))
            while written < outputs and written * options.output_step <= t + h and not (
                    h == 0 and written * options.output_step == t):
                d = min(max(written * options.output_step - t, 0.0), h)
                history[written] = 0.0
                history[written, 0] = written * options.output_step
                if rocking:
                    history[written, 1], history[written, 2] = value(phi, used, d), value(w, used, d)
                if par.on_base:
                    history[written, 3], history[written, 4] = value(x, used, d), value(v, used, d)
                    history[written, 5] = value(F, used, d)
                written += 1
            if record and h > 0:
                for probe in range(PROBES + 1):
                    d = h * probe / PROBES
                    if rocking:
                        rate_d, second = value(w, used, d), 0.0
                        angle = s * par.gamma - value(phi, used, d)
                        for k in range(used, 0, -1):
                            second = second * d + k * w[k]
                        if par.on_base:
                            a_base = value(absolute, used, d)
                        else:
                            a_base = value(A, highest, d) if highest >= 0 else 0.0
                        c, n = par.R * math.cos(angle), par.R * math.sin(angle)
                        horizontal = a_base + c * second + n * rate_d * rate_d
                        vertical = par.g + n * second - c * rate_d * rate_d
                        normal = min(normal, vertical / par.g)
                    else:
                        if par.on_base:
                            a_base = value(absolute, used, d)
                        else:
                            a_base = value(A, highest, d) if highest >= 0 else 0.0
                        horizontal, vertical = a_base, par.g
                    if vertical > 0:
                        friction = max(friction, abs(horizontal) / vertical)
                    else:
                        friction = math.inf
                    peak_absolute = max(peak_absolute, abs(a_base))
                # energy: input -int a_g d(M x - m n), n' = -c phi'
                if par.on_base or rocking:
                    for k in range(used + 1):
                        total = 0.0
                        if rocking:
                            for j in range(k + 1):
                                total += C[j] * w[k - j]
                            total *= par.m * par.R
                        momentum[k] = total + (par.M * v[k] if par.on_base else 0.0)
                    if highest >= 0:
                        for k in range(highest + 1, used + 1):
                            A[k] = 0.0
                        work_in -= integral_of_product(A, momentum, used, h)
                if par.on_base:
                    for k in range(used + 1):
                        hysteretic[k] = F[k] / par.count - par.kb * x[k] - par.damping * v[k] if par.count else 0.0
                    work_hysteretic += par.count * integral_of_product(hysteretic, v, used, h)
                    if par.damping > 0:
                        work_viscous += par.count * par.damping * integral_of_product(v, v, used, h)

            # ---- to the end of the step
            if par.on_base:
                bx_end, bv_end = value(x, used, h), value(v, used, h)
                if found == 3:
                    bv_end = 0.0
                if par.law == ALGEBRAIC and direction != 0:
                    y = anchor_travel + direction * (bx_end - anchor_x)
                    z = direction * (par.dk * (y ** (1 - par.alpha) - par.d0) / (1 - par.alpha) + par.f0)
                elif par.law == BOUC_WEN:
                    z = value(q, used, h)
                bx, bv = bx_end, bv_end
                peak_x = max(peak_x, abs(bx))
            if rocking:
                tilt, rate = end_tilt, end_rate
            if h > 0:
                fresh_uplift, blocked = False, False
            if found == 0 and h == length - tau:
                tau = length
            else:
                tau += h
            t = begin + tau

            # ---- and across the event
            if found == 1:
                source = value(absolute, used, h) if par.on_base else value(A, used, h)
                s = -1.0 if source > 0 else 1.0
                mode, tilt, rate = ROCKING, 0.0, 0.0
                fresh_uplift = abs(source) < threshold * (1 + 1e-9)
                n_uplifts += 1
                if record:
                    if n_uplifts <= capacity:
                        uplifts[n_uplifts - 1] = t
            elif found == 2:
                before, mc = rate, par.m * par.R * math.cos(par.gamma)
                rate = par.e * before  # (7)
                jump = 0.0
                if par.on_base:
                    jump = par.mt * par.R * math.cos(par.gamma) * (before - rate)  # (8), from momentum
                impact_loss += (0.5 * par.J * (before * before - rate * rate) + mc * (bv * (before - rate) - jump * rate)
                                - 0.5 * par.M * jump * (2 * bv + jump))
                bv += jump
                tilt = 0.0
                n_impacts += 1
                if record:
                    if n_impacts <= capacity:
                        i = n_impacts - 1
                        impacts[i, 0], impacts[i, 1], impacts[i, 2], impacts[i, 3] = t, before, rate, jump
                s = 1.0 if rate > 0 else -1.0
                a_now = 0.0
                if highest >= 0:
                    a_now = value(A, highest, h)
                force = par.count * (par.kb * bx + z + par.damping * bv) if par.on_base else 0.0
                landed = rate == 0
                limit = t
                if not landed and abs(rate) < options.rest_rate * omega:
                    remaining = remaining_hops(par, rate, a_now, force)
                    if remaining >= 0:
                        landed, limit = True, t + remaining
                if landed:
                    if rate != 0:  # the hops left out: their momentum stays with the base
                        left = par.mt * par.R * math.cos(par.gamma) * rate if par.on_base else 0.0
                        impact_loss += 0.5 * par.J * rate * rate + mc * bv * rate - 0.5 * par.M * left * (2 * bv + left)
                        bv += left
                    mode, rate, s = CONTACT, 0.0, 0.0
                    n_rests += 1
                    if record:
                        if n_rests <= capacity:
                            rests[n_rests - 1] = limit
            elif found == 4:
                mode, tilt = OVERTURNED, s * overturn
                peak_tilt = overturn
                break
            if not (math.isfinite(tilt) and math.isfinite(bx)):
                status = NOT_FINITE
                break
        if mode != OVERTURNED and status == COMPLETE:
            begin = finish
            t = finish
    totals[STATUS], totals[MODE], totals[TIME], totals[PEAK_TILT], totals[PEAK_X] = status, mode, t, peak_tilt, peak_x
    totals[PEAK_ACCELERATION], totals[UNSTABLE_TIME] = peak_absolute, unstable_time
    totals[FRICTION], totals[NORMAL] = friction, normal
    totals[INPUT], totals[HYSTERETIC], totals[VISCOUS], totals[IMPACT_LOSS] = (work_in, work_hysteretic, work_viscous,
                                                                            impact_loss)
    totals[STEPS], totals[IMPACTS], totals[UPLIFTS], totals[RESTS] = steps, n_impacts, n_uplifts, n_rests
    totals[WILL_OVERTURN] = 1.0 if (will_overturn or mode == OVERTURNED) else 0.0
    lifted = n_uplifts > 0 or par.tilt != 0 or par.rate != 0
    totals[LIFTED] = 1.0 if lifted else 0.0
    return ((tilt, rate, bx, bv, z), impacts[:n_impacts], uplifts[:n_uplifts], rests[:n_rests], history[:written])
