"""What a kick gives to all that stands on the ground, for engines whose kicks stand between two steps."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from .ground_velocity import ground_velocity

if TYPE_CHECKING:
    from analytic.types import Motion


def pushes(motion: Motion | None, gravity: float) -> Callable[[float, float], tuple[float, float]]:
    """A function (time, interval [s]) -> gains of velocity, across and up [m/s], of all that stands on the ground.

    The interval ends at that time and begins where the one before ended; upward it is the weight's.
    """
    ground, upright = ground_velocity(motion), ground_velocity(motion and motion.vertical)
    gained = risen = 0.0

    def push(time, interval):
        nonlocal gained, risen
        if ground is None:
            return 0.0, -gravity * interval
        before, gained = gained, ground(time)
        if upright is None:
            return before - gained, -gravity * interval
        below, risen = risen, upright(time)
        return before - gained, below - risen - gravity * interval

    return push
