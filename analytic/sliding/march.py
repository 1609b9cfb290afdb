"""March through the modes of a block that may slide: a Taylor series integrator with events, as the kernel (compiled).

Modes, their equations and ends: `equations`, `choice`, `impact`. Between two events all is smooth, and events are
located as roots of the step's polynomials.
"""

import math

import numpy as np

from .. import layout as L
from ..compiled import entry, inner
from ..events import LONGEST_LAST_HOP, TOUCH, find_fall, upper_bound
from ..laws import law_function
from ..polynomial import MAX_ORDER, SCRATCH, first_root, value
from ..readings import gravity_at
from ..steps import end_of_base, end_of_block, gravity_of_step, ground_of_step, stretch_of_ground
from ..taylor import QUIET, allowed_step
from . import layout as S
from .choice import choose
from .ending import at_rest, conclude
from .equations import accelerations, mode_series
from .impact import kinetic, level_impact, one_corner, within
from .layout import CONE, FALLEN, FLIGHT, LANDING, LEVEL, LOSS, ROCK, SLIDE, SLIDE_ROCK, STICK, STOP, Block, Start
from .reading import read

PATIENCE = 1000
ROUNDING = 4e-16
# Share of the friction, or of the threshold of uplift, by which a jump of the ground exceeds it if it is no rounding.
ONSET = 1e-9
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
def crossing(limit, side, refused, order, h, P, work):
    """First time at which limit N + side H falls below 0 in the step, or -1."""
    event, across, normal = P[L.EVENT], P[S.H], P[S.N]
    for k in range(order + 1):
        event[k] = limit * normal[k] + side * across[k]
    if refused and abs(event[0]) <= TOUCH * limit * abs(normal[0]):
        event[0] = 0.0
        if event[1] < 0:
            return -1.0
    return first_root(event, order, h, work)


@inner
def next_event(par, contact, block, refused, direction, step, P, work):
    """(kind of the first event in the step, its time since the start, side)."""
    found, h, order, event, phi, side = L.NONE, step.h, step.order, P[L.EVENT], P[L.PHI], 0.0
    mode, s, sigma = block.mode, block.s, block.sigma
    if mode == ROCK or mode == SLIDE_ROCK or mode == FLIGHT:
        root = find_fall(phi, s, 0.0, order, h, event, work)
        if root >= 0 and not (mode == FLIGHT and root == 0):
            found, h = LEVEL if mode == FLIGHT else L.IMPACT, root
        top = upper_bound(phi, s, order, h)
        if top > par.gamma > s * block.tilt:
            root = find_fall(phi, -s, par.gamma, order, h, event, work)
            if root >= 0:
                found, h = L.PASSAGE, root
        if top > 0.5 * math.pi:
            root = find_fall(phi, -s, 0.5 * math.pi, order, h, event, work)
            if root >= 0:
                found, h = L.OVERTURNING, root
    if mode == FLIGHT:
        root = find_fall(P[S.GAP], 1.0, 0.0, order, h, event, work)
        if root >= 0:
            found, h = LANDING, root
    if mode == STICK or mode == ROCK:
        for sign in (1.0, -1.0):
            if mode == STICK and par.slope <= contact.mu:
                root = crossing(par.slope, sign, refused == L.UPLIFT, order, h, P, work)
                if root >= 0:
                    found, h, side = L.UPLIFT, root, sign
            else:
                root = crossing(contact.mu, sign, refused == CONE, order, h, P, work)
                if root >= 0:
                    found, h, side = CONE, root, sign
    if sigma != 0:
        root = find_fall(P[S.SPEED], sigma, 0.0, order, h, event, work)
        if root >= 0:
            found, h = STOP, root
        if refused != LOSS:
            root = find_fall(P[S.N], 1.0, 0.0, order, h, event, work)
            if root >= 0:
                found, h = LOSS, root
    if direction != 0:
        root = find_fall(P[L.V], direction, 0.0, order, h, event, work)
        if root > 0:
            found, h = L.REVERSAL, root
        if step.corner < math.inf:
            root = find_fall(P[L.Q], -direction, step.corner, order, h, event, work)
            if root >= 0:
                found, h = L.CORNER, root
    return found, h, side


@inner
def impossible(par, contact, block, start):
    """Whether the mode no longer holds at the start of a step, as after a jump of the ground's acceleration."""
    mode = block.mode
    if mode == FLIGHT:
        return False
    _, _, _, across, normal = accelerations(par, contact, block, start)
    edge = 1 + ONSET
    if mode == STICK:
        return abs(across) > min(contact.mu, par.slope) * normal * edge or normal < 0
    if mode == ROCK:
        return abs(across) > contact.mu * normal * edge or normal < 0
    return normal < 0


@inner
def fresh_series(fresh, block, P):
    """Sets to 0 what is 0 at an onset that was just located; returns whether it is no onset, but a graze."""
    if fresh == CONE:
        P[S.SPEED, 0], P[S.SPEED, 1], P[S.SLIP, 1], P[S.SLIP, 2] = 0.0, 0.0, 0.0, 0.0
        return not block.sigma * P[S.SPEED, 2] > 0
    if fresh == L.UPLIFT:
        P[L.W, 0], P[L.W, 1], P[L.PHI, 1], P[L.PHI, 2] = 0.0, 0.0, 0.0, 0.0
        return not block.s * P[L.W, 2] > 0
    if fresh == LOSS:
        P[S.RISE, 0], P[S.RISE, 1], P[S.GAP, 0], P[S.GAP, 1], P[S.GAP, 2] = 0.0, 0.0, 0.0, 0.0, 0.0
        return not P[S.RISE, 2] > 0
    return False


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
    if par.on_base:
        h = allowed_step(P[L.F], order, tolerance, allowed_step(P[L.V], order, tolerance, h))
    return h


@inner
def struck(par, contact, block, base, found, rest_rate, at, t, into):
    """(block, base, status) after an impact. at : what acts then, a `Start`; its force is that before the impact."""
    impacts, totals, v, s = into[2], into[5], base.v, block.s
    c, n = par.R * math.cos(s * par.gamma - block.tilt), par.R * math.sin(s * par.gamma - block.tilt)
    rate, drift, climb = block.rate, block.speed + c * block.rate, block.rise + n * block.rate
    count, status = 1, L.COMPLETE
    if found == L.IMPACT or block.tilt == 0:
        kind, after, across, up, push, count = level_impact(par, contact, s, rate, drift, climb)
        if kind < 0:  # a level block that lands may pivot about either corner
            kind, after, across, up, push, count = level_impact(par, contact, -s, rate, drift, climb)
            s = -s
        if contact.given and (kind != S.NEW_STICKS or block.sigma != 0):
            status = S.GIVEN_LEAVES
        s, slips = 0.0 if kind >= S.BOTH_STICK else -s, kind == S.NEW_SLIPS or kind == S.BOTH_SLIP
        c = par.R * math.cos(par.gamma)
    else:
        kind, (after, across, up, push), slips = S.LANDS, landed(par, contact, c, n, rate, drift, climb), False
        slips = abs(across - c * after) > 0
    jump = -push / contact.mb if par.on_base else 0.0
    speed = across - c * after if slips else 0.0
    number = int(totals[S.IMPACTS])
    if number < impacts.shape[0]:
        impacts[number, 0], impacts[number, 1], impacts[number, 2] = t, rate, after
        impacts[number, 3], impacts[number, 4], impacts[number, 5] = jump, kind, speed
    totals[S.IMPACTS] += 1
    force = at.force + par.count * par.damping * jump
    lifted = Block(STICK, s, 0.0, block.tilt, after, block.slip, speed, 0.0, 0.0)
    end, left, doubt = settled(par, contact, lifted, rest_rate, Start(at.gravity, at.ground, force))
    if count != 1 or doubt != 1:
        status = S.NO_MODE
    if s != 0 and end.s == 0 and end.mode != FLIGHT:  # without the swings that were left out
        across, up, after = end.speed, 0.0, 0.0
    totals[S.IMPACT_LOSS] += kinetic(par, contact, rate, drift, climb, v) - kinetic(
        par, contact, after, across, up, v + jump + left
    )
    return end, L.Base(base.x, v + jump + left, base.z), status


@inner
def landed(par, contact, c, n, rate, drift, climb):
    """(rate, drift, climb, P) after the impact of the lower corner of a block in flight: it sticks, or slips."""
    after, across, up, push, normal = one_corner(par, contact, c, n, 0.0, rate, drift, climb, False)
    if not within(push, normal, contact.mu):
        for sigma in (1.0, -1.0):
            after, across, up, push, normal = one_corner(par, contact, c, n, sigma, rate, drift, climb, False)
            if normal >= 0 and sigma * (across - c * after) > 0:
                break
    return after, across, up, push


@inner
def settled(par, contact, block, rest_rate, start):
    """(block after an impact in its next mode, what the base gains, number of admissible modes).

    A block so slow that its further swings end at once lies level. Their impulses are left: where it sticks the base
    takes its momentum; where it slides their normal impulse, m b times the rate less than the weight's, takes as much
    from the friction.
    """
    after, count, left = block, 1, 0.0
    if block.s != 0:
        after, count = choose(par, contact, block, start)
        if block.tilt == 0 and abs(block.rate) < rest_rate and after.mode != FLIGHT:
            back, _, _, _, _ = accelerations(par, contact, after, start)
            short = LONGEST_LAST_HOP / math.sqrt(par.p2)
            if after.s * back < 0 and 2 * abs(block.rate) <= -after.s * back * short:
                speed, h = 0.0, par.R * math.cos(par.gamma)
                if after.sigma == 0:
                    left = par.arm * block.rate if par.on_base else 0.0
                else:
                    across = after.sigma * contact.mu * par.m * par.R * math.sin(par.gamma) * abs(block.rate)
                    left = -across / contact.mb if par.on_base else 0.0
                    speed = block.speed + h * block.rate + across / par.m - left
                    speed = after.sigma * max(after.sigma * speed, 0.0)
                block = Block(STICK, 0.0, 0.0, 0.0, 0.0, block.slip, speed, 0.0, 0.0)
    if block.s == 0:
        after, count = choose(par, contact, block, start)
    return after, left, count


@inner
def after_event(par, contact, block, found, side, start):
    """(block in its mode after an event that is no impact, number of modes that were admissible)."""
    _, s, sigma, tilt, rate, slip, speed, gap, rise = block
    weak = 1e-9 * par.m * par.g
    if found == CONE or found == L.UPLIFT:
        _, _, _, _, normal = accelerations(par, contact, block, start)
        if normal < weak:
            return Block(FLIGHT, s if s != 0 else 1.0, 0.0, tilt, rate, slip, 0.0, 0.0, 0.0), 1
        # side N + H = 0 falls: H is -side limit N, and the block moves to side
        if found == L.UPLIFT:
            return Block(ROCK, side, 0.0, 0.0, 0.0, slip, 0.0, 0.0, 0.0), 1
        return Block(SLIDE if s == 0 else SLIDE_ROCK, s, side, tilt, rate, slip, 0.0, 0.0, 0.0), 1
    if found == STOP:
        return choose(par, contact, Block(STICK, s, 0.0, tilt, rate, slip, 0.0, 0.0, 0.0), start)
    if found == LOSS:
        return Block(FLIGHT, s if s != 0 else 1.0, 0.0, tilt, rate, slip, speed, 0.0, 0.0), 1
    # LEVEL: the other corner becomes the lower one; gap and slip are those of both, their rates are not
    b = par.R * math.sin(par.gamma)
    return Block(FLIGHT, -s, 0.0, 0.0, rate, slip, speed, gap, rise + 2 * s * b * rate), 1


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
        tilt, rate, totals[S.PEAK_TILT] = end_of_block(
            L.Body(block.s, tilt, rate), step, totals[S.PEAK_TILT], P, work
        )
    slip, speed, gap, rise = value(P[S.SLIP], order, h), value(P[S.SPEED], order, h), 0.0, 0.0
    if block.mode == FLIGHT:
        gap, rise = value(P[S.GAP], order, h), value(P[S.RISE], order, h)
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
            written = read(par, upright, block, step, options, into, written)
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
                block = Block(none + FALLEN, block.s, 0.0, block.s * 0.5 * math.pi, block.rate, block.slip, block.speed, block.gap, block.rise)
                break
            start = acting(par, base, upright, highest, h, P)
            if found == L.IMPACT or found == LANDING:
                block, base, status = struck(par, contact, block, base, found, rest_rate, start, t, into)
                last = none - 1
            elif found >= CONE or found == L.UPLIFT:
                block, count = after_event(par, contact, block, found, side, start)
                if found == CONE or found == L.UPLIFT or found == LOSS:
                    fresh = none + (LOSS if block.mode == FLIGHT else found)
            if count != 1:
                status = S.NO_MODE
            if not (math.isfinite(block.tilt) and math.isfinite(base.x) and math.isfinite(block.slip)):
                status = L.NOT_FINITE
            if status != L.COMPLETE:
                break
        if block.mode != FALLEN and status == L.COMPLETE:
            begin, t = finish, finish
    totals[S.STATUS], totals[S.TIME], totals[S.STEPS], totals[S.WRITTEN] = status, t, steps, written
    conclude(par, resting, contact, shaking.end, block, base, totals)
