"""March through the modes of a block that may slide: a Taylor series integrator with events, as the kernel (compiled).

Modes, their equations and ends: `equations`, `choice`, `impact`. Between two events all is smooth, and events are
located as roots of the step's polynomials.
"""

import math

import numpy as np

from .. import layout as L
from ..compiled import entry, inner
from ..events import find_fall
from ..laws import law_function
from ..polynomial import MAX_ORDER, SCRATCH, value
from ..readings import gravity_at
from ..steps import end_of_base, end_of_block, gravity_of_step, ground_of_step, stretch_of_ground
from ..taylor import QUIET, allowed_step
from . import layout as S
from .choice import choose
from .ending import at_rest, conclude
from .equations import accelerations, mode_series
from .layout import CONE, FALLEN, FLIGHT, LANDING, LEVEL, LOSS, ROCK, STICK, STOP, Block, Start
from .reading import read
from .strike import struck
from .transitions import after_event, fresh_series, impossible, next_event

PATIENCE = 1000
ROUNDING = 4e-16
FARTHEST = 4.0
mark, begin_step = law_function("mark"), law_function("begin")


def arrays(capacity, outputs):
    """Workspace of a run: `capacity` events of a kind are kept, and rows of the history."""
    return (
        np.zeros((S.ROWS, MAX_ORDER + 2)),
        np.empty(SCRATCH),
        np.empty((capacity, 6)),
        np.empty((capacity, 2)),
        np.empty((outputs, 8)),
        np.zeros(S.TOTALS),
    )


@inner
def state_series(block, P):
    """State of the block as entries 0."""
    P[L.PHI, 0], P[L.W, 0], P[S.SLIP, 0], P[S.SPEED, 0] = block.tilt, block.rate, block.slip, block.speed
    P[S.GAP, 0], P[S.RISE, 0] = block.gap, block.rise


@inner
def usable_step(par, block, order, h, tolerance, P):
    """The step that the series allow [s]."""
    if block.s != 0:
        h = allowed_step(P[L.W], order, tolerance, min(h, FARTHEST / math.sqrt(par.p2)))
    if block.sigma != 0 or block.mode == FLIGHT:
        h = allowed_step(P[S.DRIFT], order, tolerance, h)
    if block.mode == FLIGHT:  # the tilt rate is constant, its sine is not
        h = allowed_step(P[L.S], order, tolerance, allowed_step(P[L.C], order, tolerance, h))
    if par.on_base:
        h = allowed_step(P[L.F], order, tolerance, allowed_step(P[L.V], order, tolerance, h))
    return h


@inner
def acting(par, base, upright, highest, h, P):
    """What acts at h [s] in the step, a `Start`."""
    ground = value(P[L.GROUND], highest, h) if highest >= 0 else 0.0
    force = par.count * (par.kb * base.x + base.z + par.damping * base.v)
    return Start(gravity_at(par, upright, P, highest, h), ground, force)


@inner
def bearing_of_step(par, contact, block, base, branch, start, highest, P):
    """As `steps.bearing_of_step`: (branch, factors of the bearing's series, the bearing's next corner)."""
    (x, v, z), (direction, x_c, mark_c) = base, branch
    P[L.X, 0], P[L.V, 0], P[L.F, 0], moving = x, v, start.force, math.copysign(1.0, v)
    if v == 0:  # that of the first derivative that is not zero
        _, _, _, across, _ = accelerations(par, contact, block, start)
        begins = -(start.force + across) / contact.mb - start.ground
        if begins == 0 and highest >= 1:
            begins = -P[L.GROUND, 1]
        moving = 0.0 if begins == 0 else math.copysign(1.0, begins)
    if moving != direction and moving != 0:
        direction, x_c = moving, x
        mark_c = mark(par.law, direction, z, par.constants)
    travel = mark_c + direction * (x - x_c)
    P[L.Q, 0], factors, corner = begin_step(par.law, direction, z, travel, par.constants)
    return L.Branch(direction, x_c, mark_c), factors, corner


@inner
def end_of_step(par, block, found, step, P, totals, work):
    """The block at the end of a step, in its old mode; keeps peaks and the way that it slid."""
    tilt, rate, order, h = block.tilt, block.rate, step.order, step.h
    if block.s != 0:
        tilt, rate, totals[S.PEAK_TILT] = end_of_block(L.Body(block.s, tilt, rate), step, totals[S.PEAK_TILT], P, work)
    slip, speed, gap, rise = value(P[S.SLIP], order, h), value(P[S.SPEED], order, h), 0.0, 0.0
    if block.mode == FLIGHT:
        gap, rise = value(P[S.GAP], order, h), value(P[S.RISE], order, h)
        root = find_fall(P[S.SPEED], math.copysign(1.0, block.speed), 0.0, order, h, P[L.EVENT], work)
        if root > 0:  # in contact the slip turns back at an event
            totals[S.PEAK_SLIP] = max(totals[S.PEAK_SLIP], abs(value(P[S.SLIP], order, root)))
    elif block.sigma != 0:
        totals[S.PATH] += abs(slip - block.slip)
    else:
        speed = 0.0
    totals[S.PEAK_SLIP] = max(totals[S.PEAK_SLIP], abs(slip))
    if block.mode >= ROCK:
        totals[S.LIFTED] = 1.0
    if found == L.PASSAGE:
        tilt = block.s * par.gamma
        if totals[S.UNSTABLE_TIME] < 0:
            totals[S.UNSTABLE_TIME] = step.t + h
    elif found == L.IMPACT or found == LEVEL:
        tilt = 0.0
    elif found == STOP:
        speed = 0.0
    return Block(block.mode, block.s, block.sigma, tilt, rate, slip, speed, gap, rise)


@inner
def hold(t, totals):
    """Keeps peaks before what may be the last fall."""
    totals[S.FALL_TIME], totals[S.HELD_X], totals[S.HELD_FRICTION] = t, totals[S.PEAK_X], totals[S.FRICTION]
    totals[S.HELD_NORMAL], totals[S.HELD_ACCELERATION] = totals[S.NORMAL], totals[S.PEAK_ACCELERATION]


@inner
def fallen(block, none):
    """The block at |tilt| = pi/2; none : 0."""
    tilt = block.s * 0.5 * math.pi
    return Block(none + FALLEN, block.s, 0.0, tilt, block.rate, block.slip, block.speed, block.gap, block.rise)


@inner
def noted(block, last, t, into):
    """Stores the time at which a mode began; returns the mode."""
    changes, totals = into[3], into[5]
    if block.mode != last:
        number = int(totals[S.CHANGES])
        if number < changes.shape[0]:
            changes[number, 0], changes[number, 1] = t, block.mode
        totals[S.CHANGES] += 1
    return block.mode


# One long function, as two loops share their state.
@entry
def march(par, resting, contact, ground, upright, options, into):
    """One run from rest or from the start that `par` holds; fills totals, impacts, modes and history of `into`.

    resting : `par` with the smaller of slope and friction in place of the slope: what a level block bears at rest.
    upright : an argument of its own, see steps.py.
    """
    P, work, totals, shaking = into[0], into[1], into[5], ground.shaking
    base, branch, none = L.Base(par.x, par.v, par.z), L.Branch(0.0, par.x, 1.0), math.floor(0.0)
    s = math.copysign(1.0, par.tilt if par.tilt != 0 else par.rate) if par.tilt != 0 or par.rate != 0 else 0.0
    block = Block(none + STICK, s, 0.0 * s, par.tilt, par.rate, 0.0 * s, 0.0 * s, 0.0 * s, 0.0 * s)
    previous, fresh, refused, last = block, none + L.NONE, none + L.NONE, none - 1
    status, t, segment, begin, written, idle, steps, highest = L.COMPLETE, 0.0, none, 0.0, none, none, none, none
    totals[S.UNSTABLE_TIME], totals[S.NORMAL] = 0.0 if abs(par.tilt) >= par.gamma else -1.0, 1.0
    totals[S.PEAK_TILT], totals[S.PEAK_X] = abs(par.tilt), abs(par.x)
    hold(0.0, totals)
    rest_rate = options.rest_rate * math.sqrt(par.p2)
    while begin < par.duration and block.mode != FALLEN and status == L.COMPLETE:
        stretch = stretch_of_ground(ground, upright, segment, begin, options.order, par.duration)
        finish, order = stretch.end, stretch.order
        after = options.decide and stretch.kind == QUIET and begin >= shaking.end
        segment += 1
        length, tau = finish - begin, 0.0
        while tau < length:
            h, t = length - tau, begin + tau
            if h <= ROUNDING * finish:
                break
            if after and t < options.shortest * (1 - ROUNDING):
                h = min(h, options.shortest - t)
            elif after and at_rest(resting, block, base, totals):
                status = L.DECIDED
                break
            steps += 1
            if steps > options.most_steps:
                status = L.SPENT
                break
            highest, h = ground_of_step(shaking, stretch, tau, h, P[L.GROUND])
            if upright is not None:
                gravity_of_step(shaking, par.g, stretch, tau, P[L.GRAVITY])
            start = acting(par, base, upright, highest, 0.0, P)
            if steps == 1 or fresh == L.NONE and refused == L.NONE and impossible(par, contact, block, start):
                block, count = choose(par, contact, block, start)
                if count != 1:
                    status = S.NO_MODE
                    break
            factors, corner = (0.0, 0.0, 0.0), math.inf
            if par.on_base:
                branch, factors, corner = bearing_of_step(par, contact, block, base, branch, start, highest, P)
            state_series(block, P)
            mode_series(order, par, contact, block, factors, highest, upright, P)
            if fresh != L.NONE and fresh_series(fresh, block, P):
                block, refused, fresh = previous, fresh, none + L.NONE
                continue
            h = usable_step(par, block, order, h, options.tolerance, P)
            if not (math.isfinite(h) and h > 0):
                status = L.NOT_FINITE if not math.isfinite(h) else L.STUCK
                break
            last = noted(block, last, t, into)
            step = L.Step(t, h, order, highest, start.gravity, factors, corner)
            found, h, side = next_event(par, contact, block, refused, branch.direction, step, P, work)
            idle = idle + 1 if tau + h <= tau else none
            if idle > PATIENCE:
                status = L.STUCK
                break
            step = L.Step(t, h, order, highest, start.gravity, factors, corner)
            written = read(par, contact, upright, block, step, options, into, written)
            block = end_of_step(par, block, found, step, P, totals, work)
            if par.on_base:
                base = end_of_base(par, found, base, branch, step, P)
                totals[S.PEAK_X] = max(totals[S.PEAK_X], abs(base.x))
            if abs(block.tilt) <= par.gamma:
                hold(step.t + h, totals)
            if h > 0:
                fresh, refused = none + L.NONE, none + L.NONE
            tau = length if found == L.NONE and h == length - tau else tau + h
            t, previous, count = begin + tau, block, 1
            if found == L.OVERTURNING:
                block = fallen(block, none)
                break
            start = acting(par, base, upright, highest, h, P)
            if found == L.IMPACT or found == LANDING:
                block, base, status = struck(par, contact, block, base, rest_rate, start, t, into)
                last = none - 1
            elif found >= CONE or found == L.UPLIFT:
                block, count = after_event(par, contact, block, found, side, start)
                if found == CONE or found == L.UPLIFT or found == LOSS:
                    fresh = none + (LOSS if block.mode == FLIGHT else found)
            if status == L.COMPLETE and count != 1:
                status = S.NO_MODE
            if not (math.isfinite(block.tilt) and math.isfinite(base.x) and math.isfinite(block.slip)):
                status = L.NOT_FINITE
            if status != L.COMPLETE:
                break
        if block.mode != FALLEN and status == L.COMPLETE:
            begin, t = finish, finish
    totals[S.STATUS], totals[S.TIME], totals[S.STEPS], totals[S.WRITTEN] = status, t, steps, written
    conclude(par, resting, contact, shaking.end, block, base, totals)
