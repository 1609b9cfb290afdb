"""When the outcome of a block that may slide is decided, by the rules of `decision` (compiled)."""

import math

from .. import layout as L
from ..compiled import inner
from ..decision import largest_force, peaks_are_final, recoverable_energy
from . import layout as S
from .impact import kinetic
from .layout import FALLEN, FLIGHT, SLIDE, STICK, Velocity


@inner
def at_rest(resting, block, base, totals):
    """After the motion: whether the block lies still for good, and no peak of the base can grow."""
    level, acceleration = L.Body(0.0, 0.0, 0.0), totals[S.PEAK_ACCELERATION]
    peaks = totals[S.PEAK_TILT], totals[S.PEAK_X], acceleration if acceleration > 0 else -1.0
    return block.mode == STICK and block.s == 0 and peaks_are_final(resting, level, base, peaks)


@inner
def remaining(par, contact, block, base):
    """Energy [J] that can still reach the block; see `decision`."""
    angle = block.s * par.gamma - block.tilt if block.s != 0 else par.gamma
    c, n = par.R * math.cos(angle), par.R * math.sin(angle)
    velocity = Velocity(block.rate, block.speed + c * block.rate, block.rise + n * block.rate)
    moving = kinetic(par, contact, velocity, base.v)
    height = c - par.R * math.cos(par.gamma) + block.gap
    stored = 0.5 * par.kb * base.x**2 + recoverable_energy(par.law, par.constants, base.z) if par.count > 0 else 0.0
    return moving + par.m * par.g * height + par.count * stored


@inner
def conclude(par, resting, contact, end_of_motion, block, base, totals):
    """Whether the outcome is certain; fills the rest of `totals`."""
    mode, status = block.mode, totals[S.STATUS]
    certain = mode == FALLEN or status == L.DECIDED
    if not certain and status == L.COMPLETE and totals[S.TIME] >= end_of_motion:
        energy = remaining(par, contact, block, base)
        upright = mode != FLIGHT and abs(block.tilt) < par.gamma
        if totals[S.LIFTED] > 0:
            certain = upright and energy < par.m * par.g * par.R * (1 - math.cos(par.gamma))  # (a)
        elif totals[S.PATH] > 0 and contact.mu < par.slope:
            certain = True  # a level block cannot lift, as |H| <= mu N < N tan(gamma)
        elif mode == SLIDE:
            certain = not par.on_base or largest_force(par, energy) < par.M * par.g * par.slope  # (b)
        else:
            certain = not par.on_base or largest_force(par, energy) < resting.M * par.g * resting.slope  # (b)
    totals[S.CERTAIN], totals[S.END_MODE] = certain, mode
    totals[S.END_TILT], totals[S.END_RATE], totals[S.END_SLIP] = block.tilt, block.rate, block.slip
    totals[S.END_SPEED], totals[S.END_GAP], totals[S.END_RISE] = block.speed, block.gap, block.rise
    totals[S.END_X], totals[S.END_V], totals[S.END_Z] = base
    if mode == FALLEN:
        totals[S.PEAK_TILT], totals[S.PEAK_X] = 0.5 * math.pi, totals[S.HELD_X]
        totals[S.FRICTION] = totals[S.HELD_FRICTION]
        totals[S.NORMAL], totals[S.PEAK_ACCELERATION] = totals[S.HELD_NORMAL], totals[S.HELD_ACCELERATION]
