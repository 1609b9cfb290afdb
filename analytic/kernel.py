"""The compiled event-driven integrator: full contact, uplift, rocking, impact, rest, re-uplift, overturning.

Taylor steps stop at every corner of the ground motion; inside a step all events are roots of the step's own
polynomials, so their times are as exact as the step. The parts of a step stand in steps.py, the equations in taylor.py,
the bearings' laws in laws, the events in events.py.
"""

import math

import numpy as np
from numba import njit

from . import layout as L
from ._unowned import unowned
from .decision import peaks_are_final, will_not_overturn
from .events import NEARLY_ELASTIC, land, settle
from .polynomial import BISECTIONS, MAX_ORDER, value
from .readings import gravity_at, write_history
from .steps import (
    bearing_of_step,
    contact_of_step,
    end_of_base,
    end_of_block,
    first_event,
    gravity_of_step,
    ground_of_step,
    read_step,
    rocking_of_step,
    stretch_of_ground,
)
from .taylor import QUIET

# Events without progress of time that count as stuck (none is known; a guard, not a rule).
PATIENCE = 1000
# Impacts of a nearly elastic block lose next to nothing: followed further down than this fraction of omega_r they are
# millions per second, each hop some 1e-9 rad high.
ELASTIC_REST_RATE = 1e-4
# Steps shorter than this fraction of the time are below its rounding.
ROUNDING = 4e-16
# Acceleration this close to the threshold at uplift, over g tan(gamma): the onset is of third order, phi'' = 0.
ONSET = 1e-9


@njit(cache=True, nogil=True)  # so that Ctrl-C is heard
def run(par, ground, options, totals):
    """Simulate; fills `totals` (slots of layout.py) and returns (end state, impacts, uplifts, rests, history).

    end : (tilt, rate, x, v, z); impacts : (n, 4) time, rates before and after, base velocity jump; uplifts, rests :
    (n,); history : (n, 6) at multiples of output_step: time, tilt, rate, x, v, F (empty if output_step is 0).
    """
    return _run(par, ground, ground.vertical, options, totals)  # an argument of its own: see layout.Ground


@njit(cache=True, nogil=True)
def _run(par, ground, vertical, options, totals):
    workspace, scratch = np.zeros((L.ROWS, MAX_ORDER + 2)), np.empty((BISECTIONS + 2, MAX_ORDER + 1))
    capacity = options.capacity if options.record else 0
    impacts, uplifts, rests = np.empty((capacity, 4)), np.empty(capacity), np.empty(capacity)
    outputs = int(math.floor(par.duration / options.output_step * (1 + 1e-14))) + 1 if options.output_step > 0 else 0
    history = np.empty((outputs, 6))
    totals[:] = 0.0
    totals[L.UNSTABLE_TIME], totals[L.NORMAL] = 0.0 if abs(par.tilt) >= par.gamma else -1.0, 1.0
    shaking = L.Ground(
        ground.kind,
        ground.dt,
        unowned(ground.samples),  # type: ignore[call-arg]  # numba gives the first
        ground.scale,
        ground.frequency,
        ground.phase,
        ground.start,
        ground.end,
        None,
    )
    end, written = _march(
        par,
        shaking,
        vertical,
        options,
        unowned(workspace),
        unowned(scratch),
        unowned(impacts),
        unowned(uplifts),
        unowned(rests),
        unowned(history),
        unowned(totals),
    )
    workspace[0, 0], scratch[0, 0] = 0.0, ground.samples[0]  # used last, so alive until here
    kept_impacts, kept_uplifts, kept_rests = int(totals[L.IMPACTS]), int(totals[L.UPLIFTS]), int(totals[L.RESTS])
    return end, impacts[:kept_impacts], uplifts[:kept_uplifts], rests[:kept_rests], history[:written]


# Longer than others: two loops over some twenty numbers of state, which each further part would take and give back.
@njit(inline="always")
def _march(par, ground, vertical, options, P, work, impacts, uplifts, rests, history, totals):
    """The run itself, on arrays without references; returns (end state, rows of the history written)."""
    tilt, rate, base = par.tilt, par.rate, (par.x, par.v, par.z)
    status, mode, s, t = L.COMPLETE, L.CONTACT, 0.0, 0.0
    if tilt != 0 or rate != 0:
        mode, s = L.ROCKING, math.copysign(1.0, tilt if tilt != 0 else rate)
    fresh, refused = False, False  # onset just found: phi'' = 0 exactly; onset refused: only touched the threshold
    branch = 0.0, par.x, 1.0  # of the bearings: direction of travel, x_c and D_c of the last reversal
    peak_tilt, peak_x, will_overturn = abs(par.tilt), abs(par.x), False
    held = 0.0, 1.0, 0.0, peak_x, 0.0  # friction demand, N/(m g), peaks of the base, time: up to |tilt| = gamma
    segment, begin, written, idle, steps = 0, 0.0, 0, 0, 0
    rest_rate = max(options.rest_rate, ELASTIC_REST_RATE) if par.e > NEARLY_ELASTIC else options.rest_rate
    rest_rate *= math.sqrt(par.p2)
    inclination = math.tan(par.gamma)
    while begin < par.duration and mode != L.OVERTURNED and status == L.COMPLETE:
        kind, a0, slope, lift, rise, finish, order = stretch_of_ground(
            ground, vertical, segment, begin, options, par.duration
        )
        after = kind == QUIET and begin >= ground.end  # the motion is over
        segment += 1
        length, tau = finish - begin, 0.0
        while tau < length:
            h, t = length - tau, begin + tau
            if h <= ROUNDING * finish:
                break
            rocking = mode == L.ROCKING
            if kind == QUIET and not rocking and not par.on_base:  # nothing moves
                if options.decide and after:
                    h = min(h, max(options.shortest - t, 0.0))
                    status = L.DECIDED
                written = write_history(history, written, options.output_step, t, h, P, 0, False, False)
                t += h
                break
            if after:
                early = t < options.shortest * (1 - ROUNDING)
                if options.decide and early and (options.record or par.on_base):
                    h = min(h, options.shortest - t)
                elif options.decide or par.on_base and not early:
                    final, will_overturn, top, more = _is_final(
                        par, options, rocking, s, tilt, rate, base, peak_tilt, peak_x, totals
                    )
                    if final:
                        peak_tilt, status = max(peak_tilt, top), L.DECIDED
                        totals[L.IMPACTS] += more
                        break
            steps += 1
            if steps > options.most_steps:
                status = L.SPENT
                break

            highest, h = ground_of_step(ground, kind, a0, slope, tau, order, h, P[L.GROUND])
            if vertical is not None:
                gravity_of_step(ground, vertical, par.g, kind, lift, rise, tau, order, P[L.GRAVITY])
            gravity = gravity_at(par, vertical, P, highest, 0.0)
            used, factors, corner = order, (0.0, 0.0, 0.0), math.inf
            if par.on_base:
                branch, factors, corner = bearing_of_step(
                    par, gravity, rocking, s, tilt, rate, base, branch, highest, P
                )
            if rocking:
                used, h = rocking_of_step(
                    par, vertical, gravity, kind, s, tilt, rate, fresh, factors, highest, order, options.tolerance, h, P
                )
                if fresh and not s * P[L.PHI, 3] > 0:  # the threshold was only touched: the block stays down
                    mode, s, fresh, refused = L.CONTACT, 0.0, False, True
                    totals[L.UPLIFTS] -= 1
                    continue
            else:
                h = contact_of_step(par, factors, highest, order, options.tolerance, h, P)
            if not (math.isfinite(h) and h > 0):
                status = L.NOT_FINITE if not math.isfinite(h) else L.STUCK
                break

            found, h = first_event(
                par,
                vertical,
                gravity,
                rocking,
                s,
                tilt,
                inclination,
                refused,
                branch[0],
                corner,
                used,
                highest,
                h,
                P,
                work,
            )
            idle = idle + 1 if tau + h <= tau else 0
            if idle > PATIENCE:
                status = L.STUCK
                break

            written = read_step(
                par, vertical, rocking, s, used, highest, t, h, P, options, history, written, totals, work
            )
            if rocking:
                tilt, rate, peak_tilt = end_of_block(s, rate, used, h, P, peak_tilt, work)
            if par.on_base:
                base = end_of_base(par, found, base, branch, corner, used, h, P)
                peak_x = max(peak_x, abs(base[0]))
            if found == L.PASSAGE:
                tilt = s * par.gamma
                if totals[L.UNSTABLE_TIME] < 0:
                    totals[L.UNSTABLE_TIME] = t + h
            if abs(tilt) <= par.gamma:  # what comes later is the last fall, or it comes back
                held = totals[L.FRICTION], totals[L.NORMAL], totals[L.PEAK_ACCELERATION], peak_x, t + h
            if h > 0:
                fresh, refused = False, False
            tau = length if found == L.NONE and h == length - tau else tau + h
            t = begin + tau

            if found == L.UPLIFT:
                onset = value(P[L.ABSOLUTE if par.on_base else L.GROUND], used, h)
                mode, s, tilt, rate = L.ROCKING, -math.copysign(1.0, onset), 0.0, 0.0
                fresh = abs(onset) < (gravity_at(par, vertical, P, highest, h) + ONSET * par.g) * inclination
                if totals[L.UPLIFTS] < uplifts.shape[0]:
                    uplifts[int(totals[L.UPLIFTS])] = t
                totals[L.UPLIFTS] += 1
            elif found == L.IMPACT:
                shaking = value(P[L.GROUND], highest, h) if highest >= 0 else 0.0
                gravity = gravity_at(par, vertical, P, highest, h)
                rate, v, stays = land(par, rate, base, gravity, shaking, rest_rate, t, impacts, rests, totals)
                mode, s, tilt, base = L.ROCKING, math.copysign(1.0, rate), 0.0, (base[0], v, base[2])
                if stays:
                    mode, s = L.CONTACT, 0.0
            elif found == L.OVERTURNING:
                tilt, peak_tilt = s * 0.5 * math.pi, 0.5 * math.pi
                mode, will_overturn = L.OVERTURNED, True
                break
            if not (math.isfinite(tilt) and math.isfinite(base[0])):
                status = L.NOT_FINITE
                break
        if mode != L.OVERTURNED and status == L.COMPLETE:
            begin, t = finish, finish
    if mode == L.OVERTURNED:
        totals[L.FRICTION], totals[L.NORMAL], totals[L.PEAK_ACCELERATION], peak_x, totals[L.FALL_TIME] = held
    totals[L.STATUS], totals[L.MODE], totals[L.TIME], totals[L.STEPS] = status, mode, t, steps
    totals[L.PEAK_TILT], totals[L.PEAK_X], totals[L.WILL_OVERTURN] = peak_tilt, peak_x, will_overturn
    _conclude(par, ground, s, tilt, rate, base, totals)
    return (tilt, rate, *base), written


@njit(cache=True)
def _lifted(par, totals):
    return totals[L.UPLIFTS] > 0 or par.tilt != 0 or par.rate != 0


@njit(cache=True)
def _is_final(par, options, rocking, s, tilt, rate, base, peak_tilt, peak_x, totals):
    """After the motion: (may the run end here, will it overturn, peak tilt and impacts that are still to come)."""
    if not options.record and not par.on_base:
        return settle(par, s, tilt, rate)
    x, v, z = base
    peak_acceleration = totals[L.PEAK_ACCELERATION] if options.record else -1.0
    final = will_not_overturn(par, rocking, _lifted(par, totals), tilt, rate, x, v, z) and peaks_are_final(
        par, rocking, tilt, rate, x, v, z, peak_tilt, peak_x, peak_acceleration
    )
    return final, False, 0.0, 0


@njit(cache=True)
def _conclude(par, ground, s, tilt, rate, base, totals):
    """Is the outcome at the end certain? Fills the rest of `totals`."""
    x, v, z = base
    rocking, lifted = totals[L.MODE] == L.ROCKING, _lifted(par, totals)
    certain = totals[L.MODE] == L.OVERTURNED or totals[L.STATUS] == L.DECIDED
    if totals[L.STATUS] == L.COMPLETE and not certain and totals[L.TIME] >= ground.end:
        certain = will_not_overturn(par, rocking, lifted, tilt, rate, x, v, z)
        if not certain and not par.on_base:
            certain, totals[L.WILL_OVERTURN], _, _ = settle(par, s, tilt, rate)  # (c)
    totals[L.LIFTED], totals[L.CERTAIN] = lifted, certain
