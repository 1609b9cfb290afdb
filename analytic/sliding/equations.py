"""Equations of a block with Coulomb friction in each mode, the ends of a mode, and the next mode (compiled).

The series are filled coefficient by coefficient. Ends that are impacts are in `march`.

Corner s = +1 or -1 lies at (n, -c) from the centre of mass, c = R cos(s gamma - phi), n = R sin(s gamma - phi).
G = g + a_v, X = a_g + x'', x: base to ground; u: slip of the corner along the base, eta: its gap; H, N: force of the
support on the block. By Newton and Euler (Shenton 1996 for a rigid ground)

    (S1)  J_G phi'' = -c H - n N
    (S2)  m (X + u'' + (c phi')') = H
    (S3)  m (G + eta'' + (n phi')') = N
    (S4)  m_b X = -F - H                on rigid ground x = 0

closed by: stick phi = u = 0; slide phi = 0 and H = -sigma mu N; rock u'' = eta'' = 0; slide-rock eta'' = 0 and
H = -sigma mu N; flight H = N = 0. sigma is the direction of slip.
"""

import math

from ..kernel import layout as L
from ..kernel.compiled import inner
from ..kernel.events import TOUCH, find_fall, find_passage, find_turn
from ..kernel.layout import (
    CLIMB,
    CONE,
    DRIFT,
    FLIGHT,
    GAP,
    LANDING,
    LEVEL,
    LOSS,
    RISE,
    ROCK,
    SLIDE,
    SLIDE_ROCK,
    SLIP,
    SPEED,
    STICK,
    STOP,
    Block,
    H,
    N,
)
from ..kernel.polynomial import INVERSE, first_root
from ..laws import law_function

_bearing_term = law_function("term")

# Share of the friction, or of the threshold of uplift, by which a jump of the ground exceeds it if it is no rounding.
ONSET = 1e-9
# A graze is located to the root of the rounding; a limit that falls by more of its size in a step is exceeded.
GRAZE = 1e-6


@inner
def accelerations(par, contact, block, start):
    """Return (phi'', u'', eta'', H, N) at an instant, by (S1) to (S4); start: what acts on block and base then."""
    mode, s, sigma, tilt, rate = block.mode, block.s, block.sigma, block.tilt, block.rate
    gravity, ground, force = start
    m, mu, R = par.m, contact.mu, par.R
    angle = s * par.gamma - tilt
    c, n = R * math.cos(angle), R * math.sin(angle)
    push, moving = (-force / contact.mb, m * contact.mb / par.M) if par.on_base else (ground, m)
    centrifugal, lifted = n * rate * rate, gravity - c * rate * rate  # of (S2), (S3) without phi''
    alpha = 0.0
    if mode == FLIGHT:
        across, normal = 0.0, 0.0
    elif s == 0:
        normal = m * gravity
        across = moving * push if mode == STICK else -sigma * mu * normal
    elif mode == ROCK:
        alpha = -(c * moving * (push + centrifugal) + n * m * lifted) / (contact.centre + c * c * moving + n * n * m)
        across, normal = moving * (push + c * alpha + centrifugal), m * (lifted + n * alpha)
    else:
        lever = n - sigma * mu * c
        alpha = -lever * m * lifted / (contact.centre + lever * n * m)
        normal = m * (lifted + n * alpha)
        across = -sigma * mu * normal
    absolute = -(force + across) / contact.mb if par.on_base else ground
    slipping = 0.0 if mode == STICK or mode == ROCK else across / m - absolute - c * alpha - centrifugal
    rising = -lifted - n * alpha if mode == FLIGHT else 0.0
    return alpha, slipping, rising, across, normal


@inner
def weight_term(par, upright, k, highest, G):
    """Return term k of the series of g + a_v."""
    if upright is None:
        return par.g if k == 0 else 0.0
    return G[k] if k <= max(highest, 0) else 0.0


@inner
def mode_series(order, par, contact, block, factors, highest, upright, P):
    """Fill all rows up to `order` (H and N, too); entry 0 of PHI, W, SLIP, SPEED, GAP, RISE, X, V, F is given."""
    mode, sigma = block.mode, block.sigma
    A, G, phi, w, S, C = P[L.GROUND], P[L.GRAVITY], P[L.PHI], P[L.W], P[L.S], P[L.C]
    x, v, q, F, absolute, drift, climb, across, normal = (
        P[L.X], P[L.V], P[L.Q], P[L.F], P[L.ABSOLUTE], P[DRIFT], P[CLIMB], P[H], P[N]
    )  # fmt: skip
    m, mb, R, mu, pivots, sliding = par.m, contact.mb, par.R, contact.mu, block.s != 0, sigma != 0
    moving = m * mb / par.M if par.on_base else m
    angle = block.s * par.gamma - phi[0]
    S[0], C[0] = math.sin(angle), math.cos(angle)
    drift[0] = P[SPEED, 0] + R * C[0] * w[0]
    climb[0] = P[RISE, 0] + R * S[0] * w[0]
    lever = S[0] - sigma * mu * C[0]
    inertia = contact.centre + R * R * (lever * S[0] * m if sliding else C[0] * C[0] * moving + S[0] * S[0] * m)
    for k in range(order + 1):
        if par.on_base and k > 0:
            z = _bearing_term(par.law, k, factors, x, v, q)
            F[k] = par.count * (par.kb * x[k] + z + par.damping * v[k])
        shaking = A[k] if k <= highest else 0.0
        weight = weight_term(par, upright, k, highest, G)
        push, alpha = -F[k] / mb if par.on_base else shaking, 0.0
        if mode == FLIGHT:
            across[k], normal[k] = 0.0, 0.0
        elif not pivots:
            normal[k] = m * weight
            across[k] = -sigma * mu * normal[k] if sliding else moving * push
        if pivots:
            # of (S2) and (S3) what is known before phi'' of this order, S and C of the next order
            sine, cosine = 0.0, 0.0
            for j in range(k + 1):
                sine += w[j] * C[k - j]
                cosine += w[j] * S[k - j]
            S[k + 1], C[k + 1] = -sine * INVERSE[k + 1], cosine * INVERSE[k + 1]
            swing, lift, turn = C[k + 1] * w[0], S[k + 1] * w[0], 0.0
            for j in range(1, k + 1):
                swing += C[j] * w[k + 1 - j]
                lift += S[j] * w[k + 1 - j]
                turn += C[j] * across[k - j] + S[j] * normal[k - j]
            swing, lift = R * (k + 1) * swing, R * (k + 1) * lift
            if mode == ROCK:
                alpha = C[0] * moving * (push + swing) + S[0] * m * (weight + lift)
                alpha = -R * (alpha + turn) / inertia
                across[k] = moving * (push + swing + R * C[0] * alpha)
            elif mode == SLIDE_ROCK:
                alpha = -R * (lever * m * (weight + lift) + turn) / inertia
            if mode != FLIGHT:
                normal[k] = m * (weight + lift + R * S[0] * alpha)
            if mode == SLIDE_ROCK:
                across[k] = -sigma * mu * normal[k]
        absolute[k] = -(F[k] + across[k]) / mb if par.on_base else shaking
        if k < order:
            w[k + 1] = alpha * INVERSE[k + 1]
            phi[k + 1] = w[k] * INVERSE[k + 1]
            v[k + 1] = (absolute[k] - shaking) * INVERSE[k + 1] if par.on_base else 0.0
            x[k + 1] = v[k] * INVERSE[k + 1]
            drift[k + 1] = (across[k] / m - absolute[k]) * INVERSE[k + 1]
            climb[k + 1] = (normal[k] / m - weight) * INVERSE[k + 1]
    _corner_series(order, par, block, P)


@inner
def _corner_series(order, par, block, P):
    """Fill slip and gap of the corner: u' = drift - c phi', eta' = climb - n phi', velocities of the centre of mass."""
    w, S, C = P[L.W], P[L.S], P[L.C]
    for k in range(1, order + 1):
        across, up = 0.0, 0.0
        if block.s != 0:
            for j in range(k + 1):
                across += C[j] * w[k - j]
                up += S[j] * w[k - j]
        P[SPEED, k] = P[DRIFT, k] - par.R * across if block.sigma != 0 or block.mode == FLIGHT else 0.0
        P[RISE, k] = P[CLIMB, k] - par.R * up if block.mode == FLIGHT else 0.0
        P[SLIP, k] = P[SPEED, k - 1] * INVERSE[k]
        P[GAP, k] = P[RISE, k - 1] * INVERSE[k]


@inner
def _admissible(par, contact, block, start, level):
    _, slipping, rising, across, normal = motion = accelerations(par, contact, block, start)
    if block.mode == FLIGHT:
        return rising > 0
    if normal < 0:
        return False
    if block.sigma == 0:
        if abs(across) > contact.mu * normal:
            return False
    elif block.speed == 0 and not block.sigma * slipping > 0:
        return False
    if block.s == 0:  # the resultant is between the corners
        return abs(across) <= par.slope * normal
    return not level or block.s * motion[0] > 0


@inner
def choose(par, contact, block, start):
    """Return (block in its next mode, number of admissible modes), by the accelerations.

    A block that slides goes on to slide. block.s : 0 for a block that lies level, with tilt rate 0. Without an
    admissible mode the friction is above the bound of Painleve (`run.paradoxical_friction`).
    """
    level, first, count = block.s == 0, block, math.floor(0.0)
    for which in range(10):  # in full contact, about its left corner, about its right one, in flight
        side, slips = which // 3, which % 3
        s, sigma = (0.0, -1.0, 1.0)[side % 3], (0.0, 1.0, -1.0)[slips]
        mode = ROCK + min(slips, 1) if side > 0 else min(slips, 1)
        if side == 3:
            mode, s = FLIGHT, 1.0 if level else block.s  # of a level block both corners rise alike
        elif not level and s != block.s or block.speed != 0 and sigma != math.copysign(1.0, block.speed):
            continue
        tried = Block(mode, s, sigma, block.tilt, block.rate, block.slip, block.speed, block.gap, block.rise)
        if _admissible(par, contact, tried, start, level):
            count += 1
            if count == 1:
                first = tried
    return first, count


@inner
def crossing(limit, side, refused, order, h, P, work):
    """Return the first time at which limit N + side H falls below 0 in the step, or -1."""
    event, across, normal = P[L.EVENT], P[L.H], P[L.N]
    for k in range(order + 1):
        event[k] = limit * normal[k] + side * across[k]
    if refused and abs(event[0]) <= TOUCH * limit * abs(normal[0]):
        event[0] = 0.0
        if event[1] < 0:  # a graze turns back; if not, no mode is admissible (`run.paradoxical_friction`)
            return 0.0 if event[1] * h < -GRAZE * limit * abs(normal[0]) else -1.0
    return first_root(event, order, h, work)


@inner
def tilt_event(par, block, step, P, work):
    """Return (kind, time) of the first event of the tilt: it passes 0, the slenderness or pi/2.

    Without one NONE and the step's end.
    """
    kind, h, order, s = L.NONE, step.h, step.order, block.s
    root = find_fall(P[L.PHI], s, 0.0, order, h, P[L.EVENT], work)
    if root >= 0 and not (block.mode == FLIGHT and root == 0):
        kind, h = LEVEL if block.mode == FLIGHT else L.IMPACT, root
    return find_passage(par.gamma, s, block.tilt, (kind, h), order, P, work)


@inner
def contact_event(par, contact, block, refused, sooner, order, P, work):
    """Return (kind, time, side) of the first event of the contact, or else `sooner`, (kind, time) of another event."""
    (first, h), side, event = sooner, 0.0, P[L.EVENT]
    if block.mode == FLIGHT:
        root = find_fall(P[L.GAP], 1.0, 0.0, order, h, event, work)
        if root >= 0:
            first, h = LANDING, root
    elif block.sigma == 0:
        lifts = block.mode == STICK and par.slope <= contact.mu
        kind, limit = (L.UPLIFT, par.slope) if lifts else (CONE, contact.mu)
        for sign in (1.0, -1.0):
            root = crossing(limit, sign, refused == kind, order, h, P, work)
            if root >= 0:
                first, h, side = kind, root, sign
    else:
        root = find_fall(P[L.SPEED], block.sigma, 0.0, order, h, event, work)
        if root >= 0:
            first, h = STOP, root
        root = find_fall(P[L.N], 1.0, 0.0, order, h, event, work)
        if root >= 0 and refused != LOSS:
            first, h = LOSS, root
    return first, h, side


@inner
def edge_event(par, contact, block, sooner, order, P, work):
    """Return (EDGE, time) where the block passes the edge of its pedestal, or else `sooner`, (kind, time).

    Level, its centre of pressure does, at -h H/N from the middle of the block; tilted, its lower corner does, unless it
    is past its balance, or in the air.
    """
    (first, time), event, height = sooner, P[L.EVENT], par.R * math.cos(par.gamma)
    if not contact.edge < math.inf or block.mode == FLIGHT or abs(block.tilt) > par.gamma:
        return first, time
    at = contact.mu * height * block.sigma if block.mode == SLIDE else block.s * par.R * math.sin(par.gamma)
    for side in (1.0, -1.0):
        for k in range(order + 1):
            event[k] = -side * P[L.SLIP, k]
        event[0] += contact.edge - side * at
        if block.mode == STICK:  # N times the room of the centre of pressure
            room = event[0]
            for k in range(order + 1):
                event[k] = room * P[L.N, k] + side * height * P[L.H, k]
        root = first_root(event, order, time, work)
        if root >= 0:
            first, time = L.EDGE, root
    return first, time


@inner
def next_event(par, contact, block, refused, direction, step, P, work):
    """Return (kind of the first event in the step, its time since the start, side)."""
    kind, h, order = L.NONE, step.h, step.order
    if block.s != 0:
        kind, h = tilt_event(par, block, step, P, work)
    kind, h, side = contact_event(par, contact, block, refused, (kind, h), order, P, work)
    kind, h = edge_event(par, contact, block, (kind, h), order, P, work)
    kind, h = find_turn(direction, step.corner, (kind, h), order, P, work)
    return kind, h, side


@inner
def impossible(par, contact, block, start):
    """Return whether the mode no longer holds at the start of a step, as after a jump of the ground's acceleration."""
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
    """Set to 0 what vanishes at an onset that was just located; return whether it is only a graze."""
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
def after_event(par, contact, block, kind, side, start):
    """Return (block in its mode after an event that is no impact, number of modes that were admissible)."""
    _, s, sigma, tilt, rate, slip, speed, gap, rise = block
    weak = 1e-9 * par.m * par.g
    if kind == CONE or kind == L.UPLIFT:
        _, _, _, _, normal = accelerations(par, contact, block, start)
        if normal < weak:
            return Block(FLIGHT, s if s != 0 else 1.0, 0.0, tilt, rate, slip, 0.0, 0.0, 0.0), 1
        # side N + H = 0 falls: H is -side limit N, and the block moves to side
        if kind == L.UPLIFT:
            return Block(ROCK, side, 0.0, 0.0, 0.0, slip, 0.0, 0.0, 0.0), 1
        return Block(SLIDE if s == 0 else SLIDE_ROCK, s, side, tilt, rate, slip, 0.0, 0.0, 0.0), 1
    if kind == STOP:
        return choose(par, contact, Block(STICK, s, 0.0, tilt, rate, slip, 0.0, 0.0, 0.0), start)
    if kind == LOSS:
        return Block(FLIGHT, s if s != 0 else 1.0, 0.0, tilt, rate, slip, speed, 0.0, 0.0), 1
    # LEVEL: the other corner becomes the lower one; gap and slip are those of both, their rates are not
    b = par.R * math.sin(par.gamma)
    return Block(FLIGHT, -s, 0.0, 0.0, rate, slip, speed, gap, rise + 2 * s * b * rate), 1
