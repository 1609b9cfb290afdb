"""Motion of a block with Coulomb friction in each mode, coefficient by coefficient (compiled).

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

from .. import layout as L
from ..compiled import inner
from ..laws import law_function
from ..layout import CLIMB, DRIFT, FLIGHT, GAP, RISE, ROCK, SLIDE_ROCK, SLIP, SPEED, STICK, Block, H, N
from ..polynomial import INVERSE

_bearing_term = law_function("term")


@inner
def accelerations(par, contact, block, start):
    """(phi'', u'', eta'', H, N) at an instant, by (S1) to (S4); start: what acts on block and base then."""
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
    """Term k of the series of g + a_v."""
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
    """Slip and gap of the corner: u' = drift - c phi', eta' = climb - n phi', velocities of the centre of mass."""
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
    _, slipping, rising, across, normal = found = accelerations(par, contact, block, start)
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
    return not level or block.s * found[0] > 0


@inner
def choose(par, contact, block, start):
    """(block in its next mode, number of admissible modes), by the accelerations; one that slides goes on to slide.

    block.s : 0 for a block that lies level, with tilt rate 0. Without an admissible mode the friction is above the
    bound of Painleve (`bounds`).
    """
    level, found, count = block.s == 0, block, math.floor(0.0)
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
                found = tried
    return found, count
