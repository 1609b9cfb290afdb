"""Which mode follows: the one whose accelerations are admissible (compiled)."""

import math

from ..compiled import inner
from .equations import accelerations
from .layout import FLIGHT, ROCK, SLIDE, SLIDE_ROCK, STICK, Block


@inner
def _admissible(par, mu, mode, s, sigma, level, found):
    alpha, slipping, rising, across, normal = found
    if mode == FLIGHT:
        return rising > 0
    if normal < 0:
        return False
    if sigma == 0 and abs(across) > mu * normal:
        return False
    if sigma != 0 and not sigma * slipping > 0:
        return False
    if s == 0:  # the resultant is between the corners
        return abs(across) <= par.slope * normal
    return not level or s * alpha > 0


@inner
def choose(par, contact, block, start):
    """(block in its next mode, number of admissible modes). Its mode, and in full contact its side, are chosen anew.

    A corner that slides goes on to slide; else the accelerations decide. block.s : 0 for a block that lies level, with
    tilt rate 0.
    """
    level, moving = block.s == 0, block.speed != 0
    mu, none = contact.mu, math.floor(0.0)
    found, count = block, none
    for which in range(9):  # the modes of a block in full contact, of one about its left and about its right corner
        mode, s = STICK, 0.0
        if which < 3:
            mode = STICK if which == 0 else SLIDE
            if not level:
                continue
        else:
            s = 1.0 if which < 6 else -1.0
            mode = ROCK if which % 3 == 0 else SLIDE_ROCK
            if not level and s != block.s:
                continue
        sigma = 0.0 if which % 3 == 0 else (1.0 if which % 3 == 1 else -1.0)
        if moving and sigma != math.copysign(1.0, block.speed):
            continue
        there = accelerations(
            par, contact, mode, s, sigma, block.tilt, block.rate, start.gravity, start.ground, start.force
        )
        if moving:  # its friction has its direction
            there = there[0], sigma, there[2], there[3], there[4]
        if _admissible(par, mu, mode, s, sigma, level, there):
            count += 1
            if count == 1:
                found = Block(
                    mode, s, sigma, block.tilt, block.rate, block.slip, block.speed, block.gap, block.rise
                )
    s = 1.0 if level else block.s  # of a level block both corners rise alike
    there = accelerations(
        par, contact, FLIGHT, s, 0.0, block.tilt, block.rate, start.gravity, start.ground, start.force
    )
    if _admissible(par, mu, FLIGHT, s, 0.0, level, there):
        count += 1
        if count == 1:
            found = Block(FLIGHT, s, 0.0, block.tilt, block.rate, block.slip, block.speed, block.gap, block.rise)
    return found, count
