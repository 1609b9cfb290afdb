"""The compiled event-driven integrator: full contact, uplift, rocking, impact, rest, re-uplift, overturning.

Taylor steps stop at every corner of the ground motion; inside a step all events are roots of the step's own
polynomials, so their times are as exact as the step. The equations stand in taylor.py, the bearing in bearing.py,
the events in events.py.
"""

import math

import numpy as np
from numba import njit

from . import layout as L
from ._unowned import unowned
from .decision import peaks_are_final, will_not_overturn
from .events import (
    NEARLY_ELASTIC,
    direction_from_rest,
    find_corner,
    find_exceedance,
    find_impact,
    find_reversal,
    find_uplift,
    hop_deceleration,
    impact_loss,
    remaining_hops,
    settle,
)
from .laws import chosen
from .polynomial import BISECTIONS, MAX_ORDER, bracketed_root, value
from .readings import read_contact, read_energy, write_history
from .taylor import (
    HARMONIC,
    LINEAR_GROUND,
    QUIET,
    SHORT_ORDER,
    allowed_step,
    base_series,
    contact_series,
    ground_series,
    hop_order,
    rigid_series,
)

# The bearings' law, see `laws.Law`.
mark, begin_step, reached, corner_ahead = chosen("mark"), chosen("begin"), chosen("reached"), chosen("corner")

# Events without progress of time that count as stuck (none is known; a guard, not a rule).
PATIENCE = 1000
# Impacts of a nearly elastic block lose next to nothing: followed further down than this fraction of omega_r they are
# millions per second, each hop some 1e-9 rad high.
ELASTIC_REST_RATE = 1e-4
# Steps shorter than this fraction of the time are below its rounding.
ROUNDING = 4e-16
# Acceleration this close to the threshold at uplift: the onset is of third order, phi'' = 0.
ONSET = 1e-9


@njit(cache=True, nogil=True)  # so that Ctrl-C is heard
def run(par, ground, options, totals):
    """Simulate; fills `totals` (slots of layout.py) and returns (end state, impacts, uplifts, rests, history).

    end : (tilt, rate, x, v, z); impacts : (n, 4) time, rates before and after, base velocity jump; uplifts, rests :
    (n,); history : (n, 6) at multiples of output_step: time, tilt, rate, x, v, F (empty if output_step is 0).
    """
    record, tolerance = options.record, options.tolerance
    ground_kind, dt, ground_samples, scale, frequency, phase, ground_start, ground_end = ground
    samples = unowned(ground_samples)
    omega, threshold = math.sqrt(par.p2), par.g * math.tan(par.gamma)
    overturn = 0.5 * math.pi
    rest_rate = max(options.rest_rate, ELASTIC_REST_RATE) if par.e > NEARLY_ELASTIC else options.rest_rate
    lever = par.mt * par.R * math.cos(par.gamma)  # base velocity jump per jump of -phi', eq. (8)
    workspace, scratch = np.zeros((L.ROWS, MAX_ORDER + 2)), np.empty((BISECTIONS + 2, MAX_ORDER + 1))
    P, work = unowned(workspace), unowned(scratch)
    phi, w, S, C = P[L.PHI], P[L.W], P[L.S], P[L.C]
    x, v, q, F = P[L.X], P[L.V], P[L.Q], P[L.F]
    absolute, A, event = P[L.ABSOLUTE], P[L.GROUND], P[L.EVENT]
    # never rebound in the loop: numba would count references at every merge of the control flow
    capacity = options.capacity if record else 0
    impacts, uplifts, rests = np.empty((capacity, 4)), np.empty(capacity), np.empty(capacity)
    outputs = int(math.floor(par.duration / options.output_step * (1 + 1e-14))) + 1 if options.output_step > 0 else 0
    history = np.empty((outputs, 6))
    totals[:] = 0.0
    totals[L.UNSTABLE_TIME], totals[L.NORMAL] = -1.0, 1.0
    peak_tilt, peak_x, will_overturn = abs(par.tilt), abs(par.x), False
    held_friction, held_normal = 0.0, 1.0
    written, n_impacts, n_uplifts, n_rests, steps, idle = 0, 0, 0, 0, 0, 0

    tilt, rate, bx, bv, z = par.tilt, par.rate, par.x, par.v, par.z
    status, mode, s, t = L.COMPLETE, L.CONTACT, 0.0, 0.0
    if tilt != 0 or rate != 0:
        mode, s = L.ROCKING, math.copysign(1.0, tilt if tilt != 0 else rate)
    fresh, refused = False, False  # onset just found: phi'' = 0 exactly; onset refused: only touched the threshold
    direction, anchor_x, anchor_travel = 0.0, bx, 1.0  # bearing: direction of travel, x_c and D_c of the last reversal
    segment, begin = 0, 0.0
    last_segment = samples.shape[0] - 1 if ground_kind == LINEAR_GROUND else 2
    while begin < par.duration and mode != L.OVERTURNED and status == L.COMPLETE:
        # the next stretch of ground motion without a corner
        kind, a0, slope, finish = QUIET, 0.0, 0.0, par.duration
        if ground_kind == LINEAR_GROUND:
            if segment < last_segment:
                a0 = scale * samples[segment]
                slope = (scale * samples[segment + 1] - a0) / dt
                finish = min((segment + 1) * dt, par.duration)
                if a0 != 0 or slope != 0:
                    kind = LINEAR_GROUND
        elif ground_kind != QUIET:
            if segment == 0:
                finish = min(ground_start, par.duration)
            elif segment == 1:
                kind, a0, finish = ground_kind, scale, min(ground_end, par.duration)
        order = SHORT_ORDER if ground_kind == LINEAR_GROUND and segment < last_segment else options.order
        after = kind == QUIET and begin >= ground_end  # the motion is over
        segment += 1
        length, tau = finish - begin, 0.0
        while tau < length:
            h, t = length - tau, begin + tau
            if h <= ROUNDING * finish:
                break
            if kind == QUIET and mode == L.CONTACT and not par.on_base:  # nothing moves
                if options.decide and after:
                    h = min(h, max(options.shortest - t, 0.0))
                    status = L.DECIDED
                written = write_history(history, written, options.output_step, t, h, P, 0, False, False)
                t += h
                break
            if options.decide and after:
                rocking = mode == L.ROCKING
                if not record and not par.on_base:
                    certain, will_overturn, top, more = settle(par, s, tilt, rate)
                    if certain:
                        peak_tilt, n_impacts, status = max(peak_tilt, top), n_impacts + more, L.DECIDED
                        break
                elif t >= options.shortest * (1 - ROUNDING):
                    lifted = n_uplifts > 0 or par.tilt != 0 or par.rate != 0
                    if will_not_overturn(par, rocking, lifted, tilt, rate, bx, bv, z) and peaks_are_final(
                            par, rocking, tilt, rate, bx, bv, z, peak_tilt, peak_x,
                            totals[L.PEAK_ACCELERATION] if record else -1.0):
                        status = L.DECIDED
                        break
                else:
                    h = min(h, options.shortest - t)
            steps += 1

            # ---- the series of this step, and how far it reaches
            if kind == HARMONIC and frequency == 0:
                highest = ground_series(order, LINEAR_GROUND, a0, 0.0, 0.0, 0.0, A)
            else:
                highest = ground_series(order, kind, a0 + slope * tau, slope, frequency,
                                        phase + frequency * (t - ground_start), A)
                if kind > LINEAR_GROUND:
                    h = min(h, 1.0 / frequency)
            used, found = order, L.NONE
            factors, corner = (0.0, 0.0, 0.0), math.inf
            if par.on_base:
                x[0], v[0] = bx, bv
                F[0] = par.count * (par.kb * bx + z + par.damping * bv)
                moving = math.copysign(1.0, bv)
                if bv == 0:
                    moving = direction_from_rest(par, mode == L.ROCKING, s, tilt, rate, highest, P, F[0])
                if moving != direction and moving != 0:
                    direction, anchor_x = moving, bx
                    anchor_travel = mark(par.law, direction, z, par.dk, par.alpha, par.d0, par.f0)
                travel = anchor_travel + direction * (bx - anchor_x)
                q[0], factors = begin_step(par.law, direction, z, travel, par.dk, par.alpha, par.d0, par.f0)
                corner = corner_ahead(par.law, direction, z, par.dk, par.alpha, par.d0, par.f0)
            if mode == L.CONTACT:
                if par.on_base:
                    contact_series(order, par, factors, highest, A, x, v, q, F, absolute)
                    # the force too: where ka is close to kb it varies faster than the velocity shows
                    h = allowed_step(F, order, tolerance, allowed_step(v, order, tolerance, h))
                else:
                    for k in range(highest + 1, order + 1):
                        A[k] = 0.0
            else:
                angle = s * par.gamma - tilt
                phi[0], w[0], S[0], C[0] = tilt, rate, math.sin(angle), math.cos(angle)
                reach = h
                if tilt == 0 and rate != 0 and kind != LINEAR_GROUND:  # a hop: its length tells the order it needs
                    back = hop_deceleration(par, s, A[0] if highest >= 0 else 0.0, F[0])
                    if back > 0:
                        hop = 2 * abs(rate) / back
                        used = hop_order(omega * hop, order, tolerance)
                        if used < order:
                            reach = min(h, 1.2 * hop)
                while True:
                    good = reach
                    if par.on_base:
                        base_series(used, par, factors, highest, A, phi, w, S, C, x, v, q, F, absolute)
                        good = allowed_step(F, used, tolerance, allowed_step(v, used, tolerance, good))
                    else:
                        rigid_series(used, par.p2, par.g, highest, A, phi, w, S, C)
                    if fresh:
                        phi[2], w[1] = 0.0, 0.0
                    good = allowed_step(w, used, tolerance, good)
                    if used == order or good == reach:
                        h = good
                        break
                    used, reach = order, h  # the hop was longer than it looked
                if fresh and not s * phi[3] > 0:  # the threshold was only touched: the block stays down
                    mode, s, fresh, refused = L.CONTACT, 0.0, False, True
                    n_uplifts -= 1
                    continue
            if not (math.isfinite(h) and h > 0):
                status = L.NOT_FINITE if not math.isfinite(h) else L.STUCK
                break

            # ---- the first event inside the step
            if mode == L.CONTACT:
                row = L.ABSOLUTE if par.on_base else L.GROUND
                if abs(P[row, 0]) > threshold and not refused:
                    found, h = L.UPLIFT, 0.0
                else:
                    root = find_uplift(P, row, used, threshold, refused, h, event, work)
                    if root >= 0:
                        found, h = L.UPLIFT, root
            else:
                root = find_impact(phi, s, used, h, event, work)
                if root >= 0:
                    found, h = L.IMPACT, root
                if record and totals[L.UNSTABLE_TIME] < 0:
                    root = find_exceedance(phi, s, par.gamma, used, h, event, work)
                    if root >= 0:
                        totals[L.UNSTABLE_TIME] = t + root
                root = find_exceedance(phi, s, overturn, used, h, event, work)
                if root >= 0:
                    found, h = L.OVERTURNING, root
            if direction != 0:
                root = find_reversal(v, direction, used, h, event, work)
                if root > 0:
                    found, h = L.REVERSAL, root
                if corner < math.inf:
                    root = find_corner(q, direction, corner, used, h, event, work)
                    if root >= 0:
                        found, h = L.CORNER, root
            idle = idle + 1 if h <= 0 else 0
            if idle > PATIENCE:
                status = L.STUCK
                break

            # ---- what is read off the step, and its end
            rocking = mode == L.ROCKING
            if outputs > 0 and (h > 0 or t == 0):
                written = write_history(history, written, options.output_step, t, h, P, used, par.on_base, rocking)
            if record and h > 0:
                read_contact(par, s, rocking, P, used, highest, h, totals)
                if abs(tilt) <= par.gamma:  # what comes later is the last fall, or it comes back
                    held_friction, held_normal = totals[L.FRICTION], totals[L.NORMAL]
                if rocking or par.on_base:
                    read_energy(par, rocking, P, used, highest, h, totals)
            if rocking:
                tilt_end, rate_end = value(phi, used, h), value(w, used, h)
                if s * rate > 0 and s * rate_end < 0:
                    for k in range(used + 1):
                        event[k] = s * w[k]
                    peak_tilt = max(peak_tilt, abs(value(phi, used, bracketed_root(event, 0, used, 0.0, h))))
                tilt, rate = tilt_end, rate_end
                peak_tilt = max(peak_tilt, abs(tilt))
            if par.on_base:
                bx, bv = value(x, used, h), value(v, used, h)
                if found == L.REVERSAL:
                    bv = 0.0
                travel = anchor_travel + direction * (bx - anchor_x)
                z = reached(par.law, direction, z, q, used, h, travel, par.dk, par.alpha, par.d0, par.f0)
                if found == L.CORNER:
                    z = direction * corner
                peak_x = max(peak_x, abs(bx))
            if h > 0:
                fresh, refused = False, False
            tau = length if found == L.NONE and h == length - tau else tau + h
            t = begin + tau

            # ---- across the event
            if found == L.UPLIFT:
                onset = value(P[row], used, h)
                mode, s, tilt, rate = L.ROCKING, -math.copysign(1.0, onset), 0.0, 0.0
                fresh = abs(onset) < threshold * (1 + ONSET)
                n_uplifts += 1
                if n_uplifts <= capacity:
                    uplifts[n_uplifts - 1] = t
            elif found == L.IMPACT:
                before = rate
                tilt, rate = 0.0, par.e * before  # (7)
                jump = lever * (before - rate)  # (8), from momentum
                totals[L.IMPACT_LOSS] += impact_loss(par, bv, before, rate, jump)
                bv += jump
                s = math.copysign(1.0, rate)
                if n_impacts < capacity:
                    impacts[n_impacts, 0], impacts[n_impacts, 1] = t, before
                    impacts[n_impacts, 2], impacts[n_impacts, 3] = rate, jump
                n_impacts += 1
                ground_now = value(A, highest, h) if highest >= 0 else 0.0
                force = par.count * (par.kb * bx + z + par.damping * bv)
                landed = rate == 0
                remaining = -1.0
                if landed or abs(rate) < rest_rate * omega:
                    remaining = remaining_hops(par, rate, ground_now, force)
                if landed or remaining >= 0:
                    left = lever * rate  # the hops left out: their momentum stays with the base
                    totals[L.IMPACT_LOSS] += impact_loss(par, bv, rate, 0.0, left)
                    bv += left
                    mode, rate, s = L.CONTACT, 0.0, 0.0
                    if remaining >= 0:  # else it lands flat and lifts again at once
                        if n_rests < capacity:
                            rests[n_rests] = t + remaining
                        n_rests += 1
            elif found == L.OVERTURNING:
                mode, tilt, peak_tilt, will_overturn = L.OVERTURNED, s * overturn, overturn, True
                break
            if not (math.isfinite(tilt) and math.isfinite(bx)):
                status = L.NOT_FINITE
                break
        if mode != L.OVERTURNED and status == L.COMPLETE:
            begin, t = finish, finish
    if mode == L.OVERTURNED:
        totals[L.FRICTION], totals[L.NORMAL] = held_friction, held_normal
    totals[L.STATUS], totals[L.MODE], totals[L.TIME] = status, mode, t
    workspace[0, 0], scratch[0, 0] = 0.0, ground_samples[0]  # used last, so alive until here
    totals[L.PEAK_TILT], totals[L.PEAK_X], totals[L.STEPS] = peak_tilt, peak_x, steps
    totals[L.IMPACTS], totals[L.UPLIFTS], totals[L.RESTS] = n_impacts, n_uplifts, n_rests
    lifted = n_uplifts > 0 or par.tilt != 0 or par.rate != 0
    certain = mode == L.OVERTURNED or status == L.DECIDED
    if status == L.COMPLETE and not certain and t >= ground_end:
        certain = will_not_overturn(par, mode == L.ROCKING, lifted, tilt, rate, bx, bv, z)
        if not certain and not par.on_base:
            certain, will_overturn, _, _ = settle(par, s, tilt, rate)  # (c)
    totals[L.LIFTED], totals[L.CERTAIN], totals[L.WILL_OVERTURN] = lifted, certain, will_overturn
    return (tilt, rate, bx, bv, z), impacts[:n_impacts], uplifts[:n_uplifts], rests[:n_rests], history[:written]
