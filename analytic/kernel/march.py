"""The compiled event-driven integrator: full contact, uplift, rocking, impact, rest, overturning.

It is a Taylor series integrator. Steps end at every corner of the ground motion. Events inside a step are located as
roots of the step's polynomials (dense output), so that their times are as accurate as the step. The parts of a step and
the equations are in `steps`, the bearing laws in `laws`, the events in `events`.
"""

import math
from typing import Any

import numpy as np
from numba.np.unsafe.ndarray import to_fixed_tuple

from ..laws import Constants
from . import layout as L
from .compiled import entry, inner
from .decision import peaks_are_final, will_not_overturn
from .events import NEARLY_ELASTIC, gravity_at, land, settle, write_history
from .polynomial import MAX_ORDER, SCRATCH, value
from .steps import (
    PATIENCE,
    QUIET,
    ROUNDING,
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

# Impacts of a nearly elastic block lose almost no energy: below this fraction of omega_r there are millions per second,
# with swings of some 1e-9 rad.
ELASTIC_REST_RATE = 1e-4
# Acceleration this close to the threshold, over g tan(gamma), counts as uplift: the onset is of third order, phi'' = 0.
ONSET = 1e-9


# The parameters of a run, by name, as one entry of an array.
ROW = np.dtype([(name, float) for name in (*L.Parameters._fields[:-1], *Constants._fields)])
OWN, SIZE, SHAKING = len(L.Parameters._fields) - 1, len(ROW.descr), len(L.Shaking._fields)
tuple_of: Any = to_fixed_tuple


NO_EVENTS = np.empty((0, 4)), np.empty(0), np.empty(0)


def row_of(par: L.Parameters) -> tuple[float, ...]:
    """Return the parameters as an entry of an array of dtype `ROW`."""
    return (*par[:-1], *par.constants)


def arrays(totals: np.ndarray, capacity: int = 0, outputs: int = 0) -> tuple[np.ndarray, ...]:
    """Return the workspace of runs, with room for `capacity` events of a kind and `outputs` rows of history.

    totals : (n, TOTALS), a row for each run. Returns the fields of `layout.Arrays`.
    """
    workspace, scratch = np.zeros((L.ROWS, MAX_ORDER + 2)), np.empty(SCRATCH)
    events = (np.empty((capacity, 4)), np.empty(capacity), np.empty(capacity)) if capacity else NO_EVENTS
    return workspace, scratch, *events, np.empty((outputs, 6)), totals


def run(
    par: L.Parameters, ground: L.Ground, options: L.Options
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Simulate one run; return (totals, impacts, uplifts, rests, history), totals by the slots of `layout`.

    impacts : (n, 4) time, rates before and after, base velocity jump; uplifts, rests : (n,); history : (n, 6) at
    multiples of output_step: time, tilt, rate, x, v, F (empty if output_step is 0).
    """
    outputs = int(math.floor(par.duration / options.output_step * (1 + 1e-14))) + 1 if options.output_step > 0 else 0
    into = arrays(np.empty((1, L.TOTALS)), options.capacity if options.record else 0, outputs)
    rows, pulses = np.fromiter(row_of(par), float)[None], np.fromiter(ground.shaking, float)[None]
    run_rows(rows, pulses, ground, options, into)
    _, _, impacts, uplifts, rests, history, (totals,) = into
    count = totals.tolist()
    events = impacts[: int(count[L.IMPACTS])], uplifts[: int(count[L.UPLIFTS])], rests[: int(count[L.RESTS])]
    return totals, *events, history[: int(count[L.WRITTEN])]


def run_rows(
    rows: np.ndarray, pulses: np.ndarray, ground: L.Ground, options: L.Options, into: tuple[np.ndarray, ...]
) -> None:
    """Run each of `rows` under its own of `pulses` and the samples of `ground`.

    rows : (n, SIZE), entries of `ROW`. pulses : (n, SHAKING). into : `arrays`; events and history are the last run's.
    """
    # Plain tuples: numba takes twice as long to recognise a named one, longer than a short run takes.
    _run_rows(rows, pulses, (ground.kind, ground.dt, ground.samples), ground.upright, (*options,), into)


# One long function, as two loops share some twenty state variables.
@inner
def _integrate(par, ground, upright, options, arrays):
    """Integrate one run. upright : an argument of its own, see `steps`."""
    P, work, totals, shaking = arrays.P, arrays.work, arrays.totals, ground.shaking
    totals[:] = 0.0
    totals[L.UNSTABLE_TIME], totals[L.NORMAL] = 0.0 if abs(par.tilt) >= par.gamma else -1.0, 1.0
    tilt, rate, base = par.tilt, par.rate, L.Base(par.x, par.v, par.z)
    status, mode, s, t = L.COMPLETE, L.STICK, 0.0, 0.0
    if tilt != 0 or rate != 0:
        mode, s = L.ROCK, math.copysign(1.0, tilt if tilt != 0 else rate)
    no, none = math.isnan(0.0), math.floor(0.0)  # a literal argument would compile a function once more
    fresh, refused = no, no  # onset just located: phi'' = 0 exactly; onset refused: a touch (graze) of the threshold
    shape = L.Shape(par.gamma, par.slope, par.on_base)
    branch = L.Branch(0.0, par.x, 1.0, 0.0)
    peak_tilt, peak_x, will_overturn = abs(par.tilt), abs(par.x), False
    held = 0.0, 1.0, 0.0, peak_x, 0.0  # friction demand, N/(m g), peaks of the base, time: up to |tilt| = gamma
    segment, begin, written, idle, steps, highest = none, 0.0, none, none, none, none
    rest_rate = max(options.rest_rate, ELASTIC_REST_RATE) if par.e > NEARLY_ELASTIC else options.rest_rate
    rest_rate *= math.sqrt(par.p2)
    while begin < par.duration and mode != L.FALLEN and status == L.COMPLETE:
        stretch = stretch_of_ground(ground, upright, segment, begin, options.order, par.duration)
        kind, finish, order = stretch.kind, stretch.end, stretch.order
        after = kind == QUIET and begin >= shaking.end  # the motion is over
        segment += 1
        length, tau = finish - begin, 0.0
        while tau < length:
            h, t = length - tau, begin + tau
            if h <= ROUNDING * finish:
                break
            body = L.Body(s, tilt, rate)
            if kind == QUIET and s == 0 and not par.on_base:  # the block stands on rigid ground
                if options.decide and after:
                    h = min(h, max(options.shortest - t, 0.0))
                    status = L.DECIDED
                still = L.Step(t, h, order, none, par.g, (0.0, 0.0, 0.0), math.inf)
                written = write_history(par, body, still, options.output_step, arrays, written)
                t += h
                break
            if after:
                early = t < options.shortest * (1 - ROUNDING)
                if options.decide and early and (options.record or par.on_base):
                    h = min(h, options.shortest - t)
                elif options.decide or par.on_base and not early:
                    final, will_overturn, top, further = _is_final(par, options, body, base, peak_tilt, peak_x, totals)
                    if final:
                        peak_tilt, status = max(peak_tilt, top), L.DECIDED
                        totals[L.IMPACTS] += further
                        break
            steps += 1
            if steps > options.most_steps:
                status = L.SPENT
                break

            highest, h = ground_of_step(shaking, stretch, tau, h, P[L.GROUND])
            if upright is not None:
                gravity_of_step(shaking, par.g, stretch, tau, P[L.GRAVITY])
            gravity, used, factors, corner = gravity_at(par, upright, P, highest, 0.0), order, (0.0, 0.0, 0.0), math.inf
            if par.on_base:
                branch, factors, corner = bearing_of_step(par, body, base, branch, gravity, highest, P)
            step = L.Step(t, h, order, highest, gravity, factors, corner)
            if s != 0:
                used, h = rocking_of_step(par, upright, kind, body, fresh, step, options.tolerance, P)
                if fresh and not s * P[L.PHI, 3] > 0:  # a graze of the threshold: no uplift
                    mode, s, fresh, refused = L.STICK, 0.0, False, True
                    totals[L.UPLIFTS] -= 1
                    continue
            else:
                h = contact_of_step(par, step, options.tolerance, P)
            if not (math.isfinite(h) and h > 0):
                status = L.NOT_FINITE if not math.isfinite(h) else L.STUCK
                break

            step = L.Step(t, h, used, highest, gravity, factors, corner)
            event, h = first_event(shape, upright, body, refused, branch.direction, step, P, work)
            idle = idle + 1 if tau + h <= tau else 0
            if idle > PATIENCE:
                status = L.STUCK
                break

            step = L.Step(t, h, used, highest, gravity, factors, corner)
            written = read_step(par, upright, body, step, options, arrays, written)
            if s != 0:
                tilt, rate, peak_tilt = end_of_block(body, step, peak_tilt, P, work)
            if par.on_base:
                base, branch = end_of_base(par, event, base, branch, step, P)
                peak_x = max(peak_x, abs(base.x))
            if event == L.PASSAGE:
                tilt = s * par.gamma
                if totals[L.UNSTABLE_TIME] < 0:
                    totals[L.UNSTABLE_TIME] = t + h
            if abs(tilt) <= par.gamma:  # otherwise the last fall, unless the block comes back
                held = totals[L.FRICTION], totals[L.NORMAL], totals[L.PEAK_ACCELERATION], peak_x, t + h
            if h > 0:
                fresh, refused = False, False
            tau = length if event == L.NONE and h == length - tau else tau + h
            t = begin + tau

            if event == L.UPLIFT:
                onset = value(P[L.ABSOLUTE if par.on_base else L.GROUND], used, h)
                mode, s, tilt, rate = L.ROCK, -math.copysign(1.0, onset), 0.0, 0.0
                fresh = abs(onset) < (gravity_at(par, upright, P, highest, h) + ONSET * par.g) * par.slope
                if totals[L.UPLIFTS] < arrays.uplifts.shape[0]:
                    arrays.uplifts[int(totals[L.UPLIFTS])] = t
                totals[L.UPLIFTS] += 1
            elif event == L.IMPACT:
                level = value(P[L.GROUND], highest, h) if highest >= 0 else 0.0
                gravity = gravity_at(par, upright, P, highest, h)
                rate, v, stays = land(par, rate, base, gravity, level, rest_rate, t, arrays)
                mode, s, tilt, base = L.ROCK, math.copysign(1.0, rate), 0.0, L.Base(base.x, v, base.z)
                if stays:
                    mode, s = L.STICK, 0.0
            elif event == L.OVERTURNING:
                tilt, peak_tilt = s * 0.5 * math.pi, 0.5 * math.pi
                mode, will_overturn = L.FALLEN, True
                break
            if not (math.isfinite(tilt) and math.isfinite(base.x)):
                status = L.NOT_FINITE
                break
        if mode != L.FALLEN and status == L.COMPLETE:
            begin, t = finish, finish
    if mode == L.FALLEN:
        totals[L.FRICTION], totals[L.NORMAL], totals[L.PEAK_ACCELERATION], peak_x, totals[L.FALL_TIME] = held
    totals[L.STATUS], totals[L.MODE], totals[L.TIME], totals[L.STEPS] = status, mode, t, steps
    totals[L.PEAK_TILT], totals[L.PEAK_X], totals[L.WILL_OVERTURN] = peak_tilt, peak_x, will_overturn
    totals[L.END_TILT], totals[L.END_RATE], totals[L.WRITTEN] = tilt, rate, written
    totals[L.END_X], totals[L.END_V], totals[L.END_Z] = base
    _conclude(par, shaking.end, L.Body(s, tilt, rate), base, totals)


@inner
def _lifted(par, totals):
    return totals[L.UPLIFTS] > 0 or par.tilt != 0 or par.rate != 0


@inner
def _is_final(par, options, body, base, peak_tilt, peak_x, totals):
    """Return, after the motion, (whether the run may end, will overturn?, further peak tilt, further impacts)."""
    if not options.record and not par.on_base:
        return settle(par, body)
    peaks = peak_tilt, peak_x, totals[L.PEAK_ACCELERATION] if options.record else -1.0
    final = will_not_overturn(par, body, base, _lifted(par, totals)) and peaks_are_final(par, body, base, peaks)
    return final, False, 0.0, 0


@inner
def _conclude(par, end_of_motion, body, base, totals):
    """Determine whether the outcome at the end is certain; fill the rest of `totals`."""
    lifted, overturned = _lifted(par, totals), totals[L.MODE] == L.FALLEN
    certain = overturned or totals[L.STATUS] == L.DECIDED
    if totals[L.STATUS] == L.COMPLETE and not certain and totals[L.TIME] >= end_of_motion:
        certain = will_not_overturn(par, body, base, lifted)
        if not certain and not par.on_base:
            certain, totals[L.WILL_OVERTURN], _, _ = settle(par, body)  # (c)
    totals[L.LIFTED], totals[L.CERTAIN] = lifted, certain


# It stands below all that it calls, as the key of its compiled form is taken here, see `cache`.
@entry
def _run_rows(rows, pulses, ground, upright, options, into):
    """Run the rows. ground : kind, dt and samples; upright : an argument of its own, see `steps`."""
    (kind, dt, samples), chosen = ground, L.Options(*options)
    P, work, impacts, uplifts, rests, history, totals = into
    for i in range(rows.shape[0]):
        numbers = tuple_of(rows[i], SIZE)
        par = L.Parameters(*numbers[:OWN], Constants(*numbers[OWN:]))  # type: ignore[call-arg]  # of one length
        ground_of_run = L.Ground(kind, dt, samples, None, L.Shaking(*tuple_of(pulses[i], SHAKING)))
        _integrate(par, ground_of_run, upright, chosen, L.Arrays(P, work, impacts, uplifts, rests, history, totals[i]))
