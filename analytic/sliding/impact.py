"""Impact of a corner, or of both, on the support: plastic, with impulses inside Coulomb's cone (Moreau), compiled.

h and b: height of the centre of mass and half width; with impulses P, Q of the support on the block, horizontal and
upward, D the horizontal velocity of the centre of mass from the base and Y its vertical one, the jumps are

    (I1)  J_G [phi'] = -c P - n Q           (n, -c): the corner from the centre of mass, as in equations.py
    (I2)  [D] = P (1/m + 1/m_b)             on rigid ground 1/m_b = 0
    (I3)  m [Y] = Q
    (I4)  m_b [x'] = -P

An impact with the level is the first of these that is admissible: the new corner sticks; it slips; both corners stay
and stick; both stay and slip. From rest exactly one is; with several the block slid before at a friction below mu_c
(`run.slipping_friction`), where laws of impact differ.
"""

import math

from .. import layout as L
from ..compiled import inner
from ..events import LONGEST_LAST_HOP
from ..layout import BOTH_SLIP, BOTH_STICK, FLIGHT, NEW_SLIPS, NEW_STICKS, STICK, Block, Start, Velocity
from .equations import accelerations, choose

# Of the impulse: a contact that is right on the edge of the cone sticks.
EDGE = 1e-12


@inner
def one_corner(par, contact, c, n, sigma, before, given):
    """After the impact of one corner alone: (`Velocity`, P, Q); sigma 0: it sticks, else it slips that way.

    given : the restitution comes from the scene, a couple does what (I1) lacks."""
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
    """After an impact after which both corners stay: (drift, P, Q)."""
    moving, up = par.m * contact.mb / par.M if par.on_base else par.m, -par.m * climb
    across = -moving * drift if sigma == 0 else -sigma * contact.mu * up
    return (0.0 if sigma == 0 else drift + across / moving), across, up


@inner
def within(across, up, mu):
    return up >= 0 and abs(across) <= mu * up * (1 + EDGE)


@inner
def level_impact(par, contact, s, before):
    """Impact of a block that comes down from side s: (kind, `Velocity` after it, P, number of admissible kinds).

    A given restitution knows one kind, the new corner that sticks; kind is -1 where that is not admissible.
    """
    b, h, mu = par.R * math.sin(par.gamma), par.R * math.cos(par.gamma), contact.mu
    rate, drift, climb = before
    r, kind, found, impulse, count = -s, -1, before, 0.0, 0
    for sigma in (0.0, 1.0, -1.0):
        after, push, normal = one_corner(par, contact, h, r * b, sigma, before, contact.given)
        good = r * after.rate >= 0 and normal >= 0
        if sigma == 0:
            good = good and within(push, normal, mu)
        else:
            slip = sigma * (after.drift - h * after.rate)
            good = good and not contact.given and slip > EDGE * (abs(drift) + h * abs(rate))
        if good:
            count += 1
            if count == 1:
                kind, found, impulse = NEW_STICKS if sigma == 0 else NEW_SLIPS, after, push
    if contact.given:
        return kind, found, impulse, 1
    for sigma in (0.0, 1.0, -1.0):
        across, push, normal = both_corners(par, contact, h, sigma, drift, climb)
        tilting = abs(contact.centre * rate - h * push) / b  # (I1): difference of the impulses of the corners
        good = normal >= 0 and tilting < normal * (1 - EDGE)
        good = good and (within(push, normal, mu) if sigma == 0 else sigma * across > EDGE * abs(drift))
        if good:
            count += 1
            if count == 1:
                kind, impulse = BOTH_STICK if sigma == 0 else BOTH_SLIP, push
                found = Velocity(0.0, across, 0.0)
    return kind, found, impulse, count


@inner
def kinetic(par, contact, velocity, v):
    """Kinetic energy [J]."""
    rate, drift, climb = velocity
    moving = par.m * ((v + drift) ** 2 + climb**2) + contact.centre * rate**2
    return 0.5 * (moving + contact.mb * v * v if par.on_base else moving)


@inner
def struck(par, contact, block, base, rest_rate, at, t, into):
    """(block, base, status) after an impact. at : what acts then, a `Start`; its force is that before the impact."""
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
    """(`Velocity`, P) after the impact of the lower corner of a block in flight: it sticks, or slips."""
    after, push, normal = one_corner(par, contact, c, n, 0.0, before, False)
    if not within(push, normal, contact.mu):
        for sigma in (1.0, -1.0):
            after, push, normal = one_corner(par, contact, c, n, sigma, before, False)
            if normal >= 0 and sigma * (after.drift - c * after.rate) > 0:
                break
    return after, push


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
