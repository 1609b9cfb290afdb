"""Which mode follows: the one whose accelerations are admissible (compiled)."""

import math

from ..compiled import inner
from .equations import accelerations
from .layout import FLIGHT, ROCK, Block


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
