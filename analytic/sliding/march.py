"""The march of a block that may slide through its modes, with its impacts (compiled).

It is a Taylor series integrator with events, as the kernel is. The modes, their equations and ends are in `equations`.
Between two events all is smooth, and events are located as roots of the step's polynomials. The outcome is decided by
the rules of `decision`.

An impact of a corner, or of both, on the support is plastic, with impulses inside Coulomb's cone (Moreau). h and b:
height of the centre of mass and half width; with impulses P, Q of the support on the block, horizontal and upward, D
the horizontal velocity of the centre of mass from the base and Y its vertical one, the jumps are

    (I1)  J_G [phi'] = -c P - n Q           (n, -c): the corner from the centre of mass, as in equations.py
    (I2)  [D] = P (1/m + 1/m_b)             on rigid ground 1/m_b = 0
    (I3)  m [Y] = Q
    (I4)  m_b [x'] = -P

An impact with the level is the first of these that is admissible: the new corner sticks; it slips; both corners stay
and stick; both stay and slip. From rest exactly one is; with several the block slid before at a friction below mu_c
(`run.slipping_friction`), where laws of impact differ.
"""

import math

import numpy as np

from ..kernel import layout as L
from ..kernel.compiled import entry, inner
from ..kernel.decision import largest_force, peaks_are_final, recoverable_energy
from ..kernel.events import (
    LONGEST_LAST_HOP,
    PROBES,
    find_fall,
    gravity_at,
    integral_of_product,
    read_bearings,
    top,
    write_history,
)
from ..kernel.layout import (
    BOTH_SLIP,
    BOTH_STICK,
    CLIMB,
    CONE,
    DRIFT,
    EDGE,
    FALLEN,
    FLIGHT,
    LANDING,
    LEVEL,
    LOSS,
    NEW_SLIPS,
    NEW_STICKS,
    OFF,
    ROCK,
    SLIDE,
    SPEED,
    STICK,
    STOP,
    Block,
    H,
    N,
    Start,
    Velocity,
)
from ..kernel.polynomial import MAX_ORDER, SCRATCH, bound, largest, value
from ..kernel.steps import (
    FARTHEST,
    PATIENCE,
    QUIET,
    ROUNDING,
    allowed_step,
    branch_of,
    end_of_base,
    end_of_block,
    gravity_of_step,
    ground_of_step,
    stretch_of_ground,
)
from .equations import accelerations, after_event, choose, fresh_series, impossible, mode_series, next_event

# Of the impulse: a contact that is right on the limit of the cone sticks.
LIMIT = 1e-12


@inner
def one_corner(par, contact, c, n, sigma, before, given):
    """Return (`Velocity`, P, Q) after the impact of one corner alone; sigma 0: it sticks, else it slips that way.

    given : the restitution comes from the scene, and a couple supplies what (I1) lacks.
    """
    moving, (rate, drift, climb) = par.m * contact.mb / par.M if par.on_base else par.m, before
    if sigma == 0:
        inertia = contact.centre + c * c * moving + n * n * par.m
        after = (contact.centre * rate + c * moving * drift + n * par.m * climb) / inertia
        if given:
            after = par.e * rate
        across, up = moving * (c * after - drift), par.m * (n * after - climb)
    else:
        lever = n - sigma * contact.mu * c
        after = (contact.centre * rate + lever * par.m * climb) / (contact.centre + lever * n * par.m)
        up = par.m * (n * after - climb)
        across = -sigma * contact.mu * up
    return Velocity(after, drift + across / moving, n * after), across, up


@inner
def both_corners(par, contact, c, sigma, drift, climb):
    """Return (drift, P, Q) after an impact after which both corners stay."""
    moving, up = par.m * contact.mb / par.M if par.on_base else par.m, -par.m * climb
    across = -moving * drift if sigma == 0 else -sigma * contact.mu * up
    return (0.0 if sigma == 0 else drift + across / moving), across, up


@inner
def within(across, up, mu):
    """Return whether the impulses lie inside Coulomb's cone."""
    return up >= 0 and abs(across) <= mu * up * (1 + LIMIT)


@inner
def level_impact(par, contact, s, before):
    """Return (kind, `Velocity` after it, P, number of admissible kinds) of the impact of a block that comes down.

    s : the side from which it comes. A given restitution knows one kind, the new corner that sticks; kind is -1 where
    that is not admissible.
    """
    b, h, mu = par.R * math.sin(par.gamma), par.R * math.cos(par.gamma), contact.mu
    rate, drift, climb = before
    r, kind, velocity, impulse, count = -s, -1, before, 0.0, 0
    for sigma in (0.0, 1.0, -1.0):
        after, push, normal = one_corner(par, contact, h, r * b, sigma, before, contact.given)
        good = r * after.rate >= 0 and normal >= 0
        if sigma == 0:
            good = good and within(push, normal, mu)
        else:
            slip = sigma * (after.drift - h * after.rate)
            good = good and not contact.given and slip > LIMIT * (abs(drift) + h * abs(rate))
        if good:
            count += 1
            if count == 1:
                kind, velocity, impulse = NEW_STICKS if sigma == 0 else NEW_SLIPS, after, push
    if contact.given:
        return kind, velocity, impulse, 1
    for sigma in (0.0, 1.0, -1.0):
        across, push, normal = both_corners(par, contact, h, sigma, drift, climb)
        tilting = abs(contact.centre * rate - h * push) / b  # (I1): difference of the impulses of the corners
        good = normal >= 0 and tilting < normal * (1 - LIMIT)
        good = good and (within(push, normal, mu) if sigma == 0 else sigma * across > LIMIT * abs(drift))
        if good:
            count += 1
            if count == 1:
                kind, impulse = BOTH_STICK if sigma == 0 else BOTH_SLIP, push
                velocity = Velocity(0.0, across, 0.0)
    return kind, velocity, impulse, count


@inner
def kinetic(par, contact, velocity, v):
    """Return the kinetic energy [J]."""
    rate, drift, climb = velocity
    moving = par.m * ((v + drift) ** 2 + climb**2) + contact.centre * rate**2
    return 0.5 * (moving + contact.mb * v * v if par.on_base else moving)


@inner
def struck(par, contact, block, base, rest_rate, at, t, into):
    """Return (block, base, status) after an impact.

    at : what acts then, a `Start`; its force is that before the impact.
    """
    impacts, totals, v, s = into.impacts, into.totals, base.v, block.s
    c, n = par.R * math.cos(s * par.gamma - block.tilt), par.R * math.sin(s * par.gamma - block.tilt)
    before = Velocity(block.rate, block.speed + c * block.rate, block.rise + n * block.rate)
    count, status = 1, L.COMPLETE
    if block.tilt == 0:
        kind, after, push, count = level_impact(par, contact, s, before)
        if kind < 0:  # a level block that lands may pivot about either corner
            s = -s
            kind, after, push, count = level_impact(par, contact, s, before)
        if contact.given and (kind != L.NEW_STICKS or block.sigma != 0):
            status = L.GIVEN_JUMPS if block.mode == FLIGHT else L.GIVEN_LEAVES if block.sigma == 0 else L.GIVEN_SLIDES
        s, slips = 0.0 if after.rate == 0 else -s, kind == L.NEW_SLIPS or kind == L.BOTH_SLIP
        c = par.R * math.cos(par.gamma)
    else:
        kind, (after, push) = L.LANDS, landed(par, contact, c, n, before)
        slips = after.drift != c * after.rate
    jump = -push / contact.mb if par.on_base else 0.0
    speed = after.drift - c * after.rate if slips else 0.0
    number = int(totals[L.IMPACTS])
    if number < impacts.shape[0]:
        impacts[number, 0], impacts[number, 1], impacts[number, 2] = t, before.rate, after.rate
        impacts[number, 3], impacts[number, 4], impacts[number, 5] = jump, kind, speed
    totals[L.IMPACTS] += 1
    force = at.force + par.count * par.damping * jump
    lifted = Block(STICK, s, 0.0, block.tilt, after.rate, block.slip, speed, 0.0, 0.0)
    end, left, doubt = settled(par, contact, lifted, rest_rate, Start(at.gravity, at.ground, force))
    if status == L.COMPLETE and (count != 1 or doubt != 1):
        status = L.NO_MODE
    if s != 0 and end.s == 0 and end.mode != FLIGHT:  # without the swings that were left out
        after = Velocity(0.0, end.speed, 0.0)
    totals[L.IMPACT_LOSS] += kinetic(par, contact, before, v) - kinetic(par, contact, after, v + jump + left)
    return end, L.Base(base.x, v + jump + left, base.z), status


@inner
def landed(par, contact, c, n, before):
    """Return (`Velocity`, P) after the impact of the lower corner of a block in flight: it sticks, or slips."""
    after, push, normal = one_corner(par, contact, c, n, 0.0, before, False)
    if not within(push, normal, contact.mu):
        for sigma in (1.0, -1.0):
            after, push, normal = one_corner(par, contact, c, n, sigma, before, False)
            if normal >= 0 and sigma * (after.drift - c * after.rate) > 0:
                break
    return after, push


@inner
def settled(par, contact, block, rest_rate, start):
    """Return (block after an impact in its next mode, velocity that the base gains, number of admissible modes).

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
                h = par.R * math.cos(par.gamma)
                speed, share = block.speed + h * block.rate, par.m / par.M if par.on_base else 0.0
                if after.sigma != 0:
                    across = after.sigma * contact.mu * par.m * par.R * math.sin(par.gamma) * abs(block.rate)
                    left = -across / contact.mb if par.on_base else 0.0
                    speed = after.sigma * max(after.sigma * (speed + across / par.m - left), 0.0)
                if abs(speed) < h * rest_rate:  # with a friction above tan(gamma) it could tip, and impacts go on
                    speed, left = 0.0, left + share * speed
                block = Block(STICK, 0.0, 0.0, 0.0, 0.0, block.slip, speed, 0.0, 0.0)
    if block.s == 0:
        after, count = choose(par, contact, block, start)
    return after, left, count


def arrays(capacity, outputs):
    """Return the workspace of a run, with room for `capacity` events of a kind and `outputs` rows of the history."""
    return L.Marched(
        np.zeros((L.ROWS, MAX_ORDER + 2)),
        np.empty(SCRATCH),
        np.empty((capacity, 6)),
        np.empty((capacity, 2)),
        np.empty((outputs, 8)),
        np.zeros(L.TOTALS),
    )


@inner
def state_series(block, P):
    """Set entries 0 of the series to the state of the block."""
    P[L.PHI, 0], P[L.W, 0], P[L.SLIP, 0], P[L.SPEED, 0] = block.tilt, block.rate, block.slip, block.speed
    P[L.GAP, 0], P[L.RISE, 0] = block.gap, block.rise


@inner
def usable_step(par, block, order, h, tolerance, P):
    """Return the step that the series allow [s]."""
    if block.s != 0:
        h = allowed_step(P[L.W], order, tolerance, min(h, FARTHEST / math.sqrt(par.p2)))
    if block.sigma != 0 or block.mode == FLIGHT:
        h = allowed_step(P[L.DRIFT], order, tolerance, h)
    if block.mode == FLIGHT:  # the tilt rate is constant, its sine is not
        h = allowed_step(P[L.S], order, tolerance, allowed_step(P[L.C], order, tolerance, h))
    if par.on_base:
        h = allowed_step(P[L.F], order, tolerance, allowed_step(P[L.V], order, tolerance, h))
    return h


@inner
def acting(par, base, upright, highest, h, P):
    """Return what acts at h [s] in the step, a `Start`."""
    ground = value(P[L.GROUND], highest, h) if highest >= 0 else 0.0
    force = par.count * (par.kb * base.x + base.z + par.damping * base.v)
    return Start(gravity_at(par, upright, P, highest, h), ground, force)


@inner
def bearing_of_step(par, contact, block, base, branch, start, highest, P):
    """Return (branch, factors of the bearing's series, the bearing's next corner), as `steps.bearing_of_step`."""
    P[L.X, 0], P[L.V, 0], P[L.F, 0], moving = base.x, base.v, start.force, math.copysign(1.0, base.v)
    if base.v == 0:  # that of the first derivative that is not zero
        _, _, _, across, _ = accelerations(par, contact, block, start)
        begins = -(start.force + across) / contact.mb - start.ground
        if begins == 0 and highest >= 1:
            begins = -P[L.GROUND, 1]
        moving = 0.0 if begins == 0 else math.copysign(1.0, begins)
    return branch_of(par, moving, base, branch, P)


@inner
def end_of_step(par, block, event, step, P, totals, work):
    """Return the block at the end of a step, in its old mode; keep peaks and the path that it slid."""
    tilt, rate, order, h = block.tilt, block.rate, step.order, step.h
    if block.s != 0:
        tilt, rate, totals[L.PEAK_TILT] = end_of_block(L.Body(block.s, tilt, rate), step, totals[L.PEAK_TILT], P, work)
    slip, speed, gap, rise = value(P[L.SLIP], order, h), value(P[L.SPEED], order, h), 0.0, 0.0
    if block.mode == FLIGHT:
        gap, rise = value(P[L.GAP], order, h), value(P[L.RISE], order, h)
        root = find_fall(P[L.SPEED], math.copysign(1.0, block.speed), 0.0, order, h, P[L.EVENT], work)
        if root > 0:  # in contact the slip turns back at an event
            totals[L.PEAK_SLIP] = max(totals[L.PEAK_SLIP], abs(value(P[L.SLIP], order, root)))
    elif block.sigma != 0:
        totals[L.PATH] += abs(slip - block.slip)
    else:
        speed = 0.0
    totals[L.PEAK_SLIP] = max(totals[L.PEAK_SLIP], abs(slip))
    if block.mode >= ROCK:
        totals[L.LIFTED] = 1.0
    if event == L.PASSAGE:
        tilt = block.s * par.gamma
        if totals[L.UNSTABLE_TIME] < 0:
            totals[L.UNSTABLE_TIME] = step.t + h
    elif event == L.IMPACT or event == LEVEL:
        tilt = 0.0
    elif event == STOP:
        speed = 0.0
    return Block(block.mode, block.s, block.sigma, tilt, rate, slip, speed, gap, rise)


@inner
def fallen(block, event, none):
    """Return the block at |tilt| = pi/2, or off its pedestal; none : 0."""
    mode, tilt = (OFF, block.tilt) if event == EDGE else (FALLEN, block.s * 0.5 * math.pi)
    return Block(none + mode, block.s, 0.0, tilt, block.rate, block.slip, block.speed, block.gap, block.rise)


@inner
def misses(par, contact, block):
    """Return whether a corner that lands is beyond the edge of the pedestal."""
    return abs(block.slip + block.s * par.R * math.sin(par.gamma)) > contact.edge


@inner
def noted(block, last, t, into):
    """Store the time at which a mode began; return the mode."""
    changes, totals = into.changes, into.totals
    if block.mode != last:
        number = int(totals[L.CHANGES])
        if number < changes.shape[0]:
            changes[number, 0], changes[number, 1] = t, block.mode
        totals[L.CHANGES] += 1
    return block.mode


@inner
def read(par, contact, upright, block, step, options, into, written):
    """Write the step to history, diagnostics and ledger; return the rows of the history written."""
    P, rows = into.P, into.history
    first, written = written, write_history(par, block, step, options.output_step, into, written)
    for k in range(first, written):
        d = min(max(rows[k, 0] - step.t, 0.0), step.h)
        rows[k, 6], rows[k, 7] = value(P[L.SLIP], step.order, d), value(P[SPEED], step.order, d)
    if options.record and step.h > 0:
        forces(par, contact, block, step, P, into.totals, into.work)
        ledger(par, upright, block, step, P, into.totals)
    return written


@inner
def forces(par, contact, block, step, P, totals, work):
    """Read peak absolute base acceleration, friction demand |H|/N and least N/(m g) within the step."""
    h, order = step.h, step.order
    row, last = (L.ABSOLUTE, order) if par.on_base else (L.GROUND, step.highest)
    known_peak = totals[L.PEAK_ACCELERATION]
    if last >= 0 and bound(P[row], last, h) > known_peak:
        known_peak = largest(P[row], 1.0, last, h, known_peak, P[L.EVENT], work)
        totals[L.PEAK_ACCELERATION] = largest(P[row], -1.0, last, h, known_peak, P[L.EVENT], work)
    if block.sigma != 0:
        totals[L.FRICTION] = contact.mu
    demand, demand_before, lift, lift_before = 0.0, 0.0, 0.0, 0.0
    for probe in range(PROBES + 1):
        across, normal = value(P[H], order, h * probe / PROBES), value(P[N], order, h * probe / PROBES)
        held = normal > 0 and block.sigma == 0 and block.mode != FLIGHT
        ratio, low = abs(across) / normal if held else 0.0, -normal / (par.m * par.g)
        if probe > 1:
            reached = min(top(demand_before, demand, ratio), contact.mu)  # where it is more, an event ends the step
            totals[L.FRICTION] = max(totals[L.FRICTION], reached)
            totals[L.NORMAL] = min(totals[L.NORMAL], -top(lift_before, lift, low))
        demand_before, demand, lift_before, lift = demand, ratio, lift, low


@inner
def ledger(par, upright, block, step, P, totals):
    """Read the work of ground, bearings and friction within the step [J]."""
    h, order, highest, momentum, part = step.h, step.order, step.highest, P[L.PRODUCT_A], P[L.PRODUCT_B]
    if highest >= 0:  # -int a_g (M x' + m drift) + a_v m climb dt
        for k in range(order + 1):
            momentum[k] = par.m * P[DRIFT, k] + (par.M * P[L.V, k] if par.on_base else 0.0)
        totals[L.INPUT] -= integral_of_product(P[L.GROUND], min(highest, order), momentum, order, h)
    if upright is not None:
        for k in range(max(highest, 0) + 1):
            part[k] = P[L.GRAVITY, k]
        part[0] -= par.g
        totals[L.INPUT] -= par.m * integral_of_product(part, max(highest, 0), P[CLIMB], order, h)
    if block.sigma != 0:
        totals[L.FRICTION_WORK] -= integral_of_product(P[H], order, P[SPEED], order, h)
    read_bearings(par, step, P, totals)


@inner
def at_rest(resting, block, base, totals):
    """Return whether, after the motion, the block lies still for good, and no peak of the base can grow."""
    level, acceleration = L.Body(0.0, 0.0, 0.0), totals[L.PEAK_ACCELERATION]
    peaks = totals[L.PEAK_TILT], totals[L.PEAK_X], acceleration if acceleration > 0 else -1.0
    return block.mode == STICK and block.s == 0 and peaks_are_final(resting, level, base, peaks)


@inner
def remaining(par, contact, block, base):
    """Return the energy [J] that can still reach the block; see `decision`."""
    angle = block.s * par.gamma - block.tilt if block.s != 0 else par.gamma
    c, n = par.R * math.cos(angle), par.R * math.sin(angle)
    velocity = Velocity(block.rate, block.speed + c * block.rate, block.rise + n * block.rate)
    moving = kinetic(par, contact, velocity, base.v)
    height = c - par.R * math.cos(par.gamma) + block.gap
    stored = 0.5 * par.kb * base.x**2 + recoverable_energy(par.law, par.constants, base.z) if par.count > 0 else 0.0
    return moving + par.m * par.g * height + par.count * stored


@inner
def conclude(par, resting, contact, end_of_motion, block, base, held, totals):
    """Determine whether the outcome is certain; fill the rest of `totals`.

    held : peaks before a last fall, and its time.
    """
    mode, status = block.mode, totals[L.STATUS]
    certain = mode >= FALLEN or status == L.DECIDED
    if not certain and status == L.COMPLETE and totals[L.TIME] >= end_of_motion:
        energy = remaining(par, contact, block, base)
        upright = mode != FLIGHT and abs(block.tilt) < par.gamma
        if totals[L.LIFTED] > 0:
            certain = upright and energy < par.m * par.g * par.R * (1 - math.cos(par.gamma))  # (a)
        elif totals[L.PATH] > 0 and contact.mu < par.slope:
            certain = True  # a level block cannot lift, as |H| <= mu N < N tan(gamma)
        elif mode == SLIDE:
            certain = not par.on_base or largest_force(par, energy) < par.M * par.g * par.slope  # (b)
        else:
            certain = not par.on_base or largest_force(par, energy) < resting.M * par.g * resting.slope  # (b)
    totals[L.CERTAIN], totals[L.MODE] = certain, mode
    totals[L.END_TILT], totals[L.END_RATE], totals[L.END_SLIP] = block.tilt, block.rate, block.slip
    totals[L.END_SPEED], totals[L.END_GAP], totals[L.END_RISE] = block.speed, block.gap, block.rise
    totals[L.END_X], totals[L.END_V], totals[L.END_Z] = base
    if mode == FALLEN:
        totals[L.PEAK_TILT] = 0.5 * math.pi
        totals[L.FRICTION], totals[L.NORMAL], totals[L.PEAK_ACCELERATION], totals[L.PEAK_X], totals[L.FALL_TIME] = held


# One long function, as two loops share their state.
@entry
def march(par, resting, contact, ground, upright, options, into):
    """March through one run from rest or from the start that `par` holds.

    Fills totals, impacts, modes and history of `into`. resting : `par` with the smaller of slope and friction in place
    of the slope: what a level block bears at rest. upright : an argument of its own, see `steps`.
    """
    P, work, totals, shaking = into.P, into.work, into.totals, ground.shaking
    base, branch, none = L.Base(par.x, par.v, par.z), L.Branch(0.0, par.x, 1.0, 0.0), math.floor(0.0)
    s = math.copysign(1.0, par.tilt if par.tilt != 0 else par.rate) if par.tilt != 0 or par.rate != 0 else 0.0
    block = Block(none + STICK, s, 0.0 * s, par.tilt, par.rate, 0.0 * s, 0.0 * s, 0.0 * s, 0.0 * s)
    previous, fresh, refused, last = block, none + L.NONE, none + L.NONE, none - 1
    status, t, segment, begin, written, idle, steps, highest = L.COMPLETE, 0.0, none, 0.0, none, none, none, none
    totals[L.UNSTABLE_TIME], totals[L.NORMAL] = 0.0 if abs(par.tilt) >= par.gamma else -1.0, 1.0
    totals[L.PEAK_TILT], totals[L.PEAK_X] = abs(par.tilt), abs(par.x)
    held = 0.0, 1.0, 0.0, abs(par.x), 0.0  # friction demand, N/(m g), peaks of the base, time: up to |tilt| = gamma
    rest_rate = options.rest_rate * math.sqrt(par.p2)
    while begin < par.duration and block.mode < FALLEN and status == L.COMPLETE:
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
                    status = L.NO_MODE
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
            event, h, side = next_event(par, contact, block, refused, branch.direction, step, P, work)
            idle = idle + 1 if tau + h <= tau else none
            if idle > PATIENCE:
                status = L.STUCK
                break
            step = L.Step(t, h, order, highest, start.gravity, factors, corner)
            written = read(par, contact, upright, block, step, options, into, written)
            block = end_of_step(par, block, event, step, P, totals, work)
            if par.on_base:
                base, branch = end_of_base(par, event, base, branch, step, P)
                totals[L.PEAK_X] = max(totals[L.PEAK_X], abs(base.x))
            if abs(block.tilt) <= par.gamma:
                held = totals[L.FRICTION], totals[L.NORMAL], totals[L.PEAK_ACCELERATION], totals[L.PEAK_X], step.t + h
            if h > 0:
                fresh, refused = none + L.NONE, none + L.NONE
            tau = length if event == L.NONE and h == length - tau else tau + h
            t, previous, count = begin + tau, block, 1
            if event == L.OVERTURNING or event == EDGE or event == LANDING and misses(par, contact, block):
                block = fallen(block, event if event == L.OVERTURNING else none + EDGE, none)
                break
            start = acting(par, base, upright, highest, h, P)
            if event == L.IMPACT or event == LANDING:
                block, base, status = struck(par, contact, block, base, rest_rate, start, t, into)
                last = none - 1
            elif event >= CONE or event == L.UPLIFT:
                block, count = after_event(par, contact, block, event, side, start)
                if event == CONE or event == L.UPLIFT or event == LOSS:
                    fresh = none + (LOSS if block.mode == FLIGHT else event)
            if status == L.COMPLETE and count != 1:
                status = L.NO_MODE
            if not (math.isfinite(block.tilt) and math.isfinite(base.x) and math.isfinite(block.slip)):
                status = L.NOT_FINITE
            if status != L.COMPLETE:
                break
        if block.mode < FALLEN and status == L.COMPLETE:
            begin, t = finish, finish
    totals[L.STATUS], totals[L.TIME], totals[L.STEPS], totals[L.WRITTEN] = status, t, steps, written
    conclude(par, resting, contact, shaking.end, block, base, held, totals)
