"""Ends of the modes of a block that may slide, and what follows where it is no impact (compiled)."""

import math

from .. import layout as L
from ..compiled import inner
from ..events import TOUCH, find_fall, find_passage, find_turn
from ..layout import CONE, FLIGHT, LANDING, LEVEL, LOSS, ROCK, SLIDE, SLIDE_ROCK, STICK, STOP, Block
from ..polynomial import first_root
from .equations import accelerations, choose

# Share of the friction, or of the threshold of uplift, by which a jump of the ground exceeds it if it is no rounding.
ONSET = 1e-9
# A graze is located to the root of the rounding; a limit that falls by more of its size in a step is exceeded.
GRAZE = 1e-6


@inner
def crossing(limit, side, refused, order, h, P, work):
    """First time at which limit N + side H falls below 0 in the step, or -1."""
    event, across, normal = P[L.EVENT], P[L.H], P[L.N]
    for k in range(order + 1):
        event[k] = limit * normal[k] + side * across[k]
    if refused and abs(event[0]) <= TOUCH * limit * abs(normal[0]):
        event[0] = 0.0
        if event[1] < 0:  # a graze turns back; if not, no mode is admissible (`bounds.paradoxical_friction`)
            return 0.0 if event[1] * h < -GRAZE * limit * abs(normal[0]) else -1.0
    return first_root(event, order, h, work)


@inner
def tilt_event(par, block, step, P, work):
    """(kind, time) of the first event of the tilt, which passes 0, the slenderness or pi/2; NONE and the step's end."""
    found, h, order, s = L.NONE, step.h, step.order, block.s
    root = find_fall(P[L.PHI], s, 0.0, order, h, P[L.EVENT], work)
    if root >= 0 and not (block.mode == FLIGHT and root == 0):
        found, h = LEVEL if block.mode == FLIGHT else L.IMPACT, root
    return find_passage(par.gamma, s, block.tilt, (found, h), order, P, work)


@inner
def contact_event(par, contact, block, refused, sooner, order, P, work):
    """(kind, time, side) of the first event of the contact; sooner : (kind, time) of another one, else returned."""
    (found, h), side, event = sooner, 0.0, P[L.EVENT]
    if block.mode == FLIGHT:
        root = find_fall(P[L.GAP], 1.0, 0.0, order, h, event, work)
        if root >= 0:
            found, h = LANDING, root
    elif block.sigma == 0:
        lifts = block.mode == STICK and par.slope <= contact.mu
        kind, limit = (L.UPLIFT, par.slope) if lifts else (CONE, contact.mu)
        for sign in (1.0, -1.0):
            root = crossing(limit, sign, refused == kind, order, h, P, work)
            if root >= 0:
                found, h, side = kind, root, sign
    else:
        root = find_fall(P[L.SPEED], block.sigma, 0.0, order, h, event, work)
        if root >= 0:
            found, h = STOP, root
        root = find_fall(P[L.N], 1.0, 0.0, order, h, event, work)
        if root >= 0 and refused != LOSS:
            found, h = LOSS, root
    return found, h, side


@inner
def next_event(par, contact, block, refused, direction, step, P, work):
    """(kind of the first event in the step, its time since the start, side)."""
    found, h, order = L.NONE, step.h, step.order
    if block.s != 0:
        found, h = tilt_event(par, block, step, P, work)
    found, h, side = contact_event(par, contact, block, refused, (found, h), order, P, work)
    found, h = find_turn(direction, step.corner, (found, h), order, P, work)
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
        P[L.SPEED, 0], P[L.SPEED, 1], P[L.SLIP, 1], P[L.SLIP, 2] = 0.0, 0.0, 0.0, 0.0
        return not block.sigma * P[L.SPEED, 2] > 0
    if fresh == L.UPLIFT:
        P[L.W, 0], P[L.W, 1], P[L.PHI, 1], P[L.PHI, 2] = 0.0, 0.0, 0.0, 0.0
        return not block.s * P[L.W, 2] > 0
    if fresh == LOSS:
        P[L.RISE, 0], P[L.RISE, 1], P[L.GAP, 0], P[L.GAP, 1], P[L.GAP, 2] = 0.0, 0.0, 0.0, 0.0, 0.0
        return not P[L.RISE, 2] > 0
    return False


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
