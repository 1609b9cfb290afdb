"""The block after an impact (compiled)."""

import math

from .. import layout as L
from ..compiled import inner
from ..events import LONGEST_LAST_HOP
from . import layout as S
from .choice import choose
from .equations import accelerations
from .impact import kinetic, level_impact, one_corner, within
from .layout import FLIGHT, STICK, Block, Start, Velocity


@inner
def struck(par, contact, block, base, rest_rate, at, t, into):
    """(block, base, status) after an impact. at : what acts then, a `Start`; its force is that before the impact."""
    impacts, totals, v, s = into[2], into[5], base.v, block.s
    c, n = par.R * math.cos(s * par.gamma - block.tilt), par.R * math.sin(s * par.gamma - block.tilt)
    before = Velocity(block.rate, block.speed + c * block.rate, block.rise + n * block.rate)
    count, status = 1, L.COMPLETE
    if block.tilt == 0:
        kind, after, push, count = level_impact(par, contact, s, before)
        if kind < 0:  # a level block that lands may pivot about either corner
            s = -s
            kind, after, push, count = level_impact(par, contact, s, before)
        if contact.given and (kind != S.NEW_STICKS or block.sigma != 0):
            status = S.GIVEN_JUMPS if block.mode == FLIGHT else S.GIVEN_LEAVES if block.sigma == 0 else S.GIVEN_SLIDES
        s, slips = 0.0 if after.rate == 0 else -s, kind == S.NEW_SLIPS or kind == S.BOTH_SLIP
        c = par.R * math.cos(par.gamma)
    else:
        kind, (after, push) = S.LANDS, landed(par, contact, c, n, before)
        slips = after.drift != c * after.rate
    jump = -push / contact.mb if par.on_base else 0.0
    speed = after.drift - c * after.rate if slips else 0.0
    number = int(totals[S.IMPACTS])
    if number < impacts.shape[0]:
        impacts[number, 0], impacts[number, 1], impacts[number, 2] = t, before.rate, after.rate
        impacts[number, 3], impacts[number, 4], impacts[number, 5] = jump, kind, speed
    totals[S.IMPACTS] += 1
    force = at.force + par.count * par.damping * jump
    lifted = Block(STICK, s, 0.0, block.tilt, after.rate, block.slip, speed, 0.0, 0.0)
    end, left, doubt = settled(par, contact, lifted, rest_rate, Start(at.gravity, at.ground, force))
    if status == L.COMPLETE and (count != 1 or doubt != 1):
        status = S.NO_MODE
    if s != 0 and end.s == 0 and end.mode != FLIGHT:  # without the swings that were left out
        after = Velocity(0.0, end.speed, 0.0)
    totals[S.IMPACT_LOSS] += kinetic(par, contact, before, v) - kinetic(par, contact, after, v + jump + left)
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
