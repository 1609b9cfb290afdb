"""Impact of a corner, or of both, on the support: plastic, with impulses inside Coulomb's cone (Moreau), compiled.

h and b: height of the centre of mass and half width; with impulses P, Q of the support on the block, horizontal and
upward, D the horizontal velocity of the centre of mass from the base and Y its vertical one, the jumps are

    (I1)  J_G [phi'] = -c P - n Q           (n, -c): the corner from the centre of mass, as in equations.py
    (I2)  [D] = P (1/m + 1/m_b)             on rigid ground 1/m_b = 0
    (I3)  m [Y] = Q
    (I4)  m_b [x'] = -P

An impact with the level is the first of these that is admissible: the new corner sticks; it slips; both corners stay
and stick; both stay and slip. From rest exactly one is; with several the block slid before at a friction below mu_c
(`bounds`), where laws of impact differ.
"""

import math

from ..compiled import inner
from .layout import BOTH_SLIP, BOTH_STICK, NEW_SLIPS, NEW_STICKS, Velocity

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
