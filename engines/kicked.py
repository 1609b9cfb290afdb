"""A base that still vibrates on its bearings when the next impact kicks it: its displacement depends on the phase."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, TypeGuard

import numpy as np

from analytic.bearing import BearingLaw

from .swings import find_swings

if TYPE_CHECKING:
    from analytic import Scene

    from .swings import Trace

UNSURE = 0.015  # relative, of the peak base displacement
LEAST = 1e-5  # peak base displacement over R gamma that is worth a word: 3 micrometres for the Caryatid


def sound(trace: Trace | None) -> TypeGuard[Trace]:
    """Whether there is a trace of finite numbers: what is not fails elsewhere, with the evidence."""
    return trace is not None and bool(np.isfinite(trace.tilt).all() and np.isfinite(trace.base_displacement).all())


def unsure_displacement(scene: Scene, trace: Trace | None, *, drift: float, lag: float = 0.0) -> Iterator[str]:
    """A sentence where the peak base displacement hangs on the phase in which an impact finds a vibrating base.

    The vibration's amplitude before the last impact up to the peak is that of its velocity, so that what the ground or
    the block pushes slowly does not count. What is left of it by dampers and hysteresis is in the trace.

    Parameters
    ----------
    scene : Scene
    trace : Trace or None
    drift : float
        Relative error of the time between impacts, or of the vibration's frequency.
    lag : float
        Time [s] by which each impact comes off, beside it.
    """
    if scene.base is None or scene.bearings is None or not sound(trace):
        return
    swings, size = find_swings(trace), np.abs(trace.base_displacement)
    peak = int(np.argmax(size))
    last = int(np.searchsorted(swings.first, peak, side="right")) - 1
    if last < 1 or size[peak] < LEAST * scene.block.radius * scene.block.slenderness:
        return  # no impact before the peak
    law = BearingLaw.of(scene.bearings)
    frequency = math.sqrt(law.count * (law.kb + law.dk) / scene.base.mass)
    impact = swings.first[last]
    flight = slice((swings.first[last - 1] + impact) // 2, impact)
    amplitude = float(np.abs(trace.base_velocity[flight]).max()) / frequency
    phase = frequency * lag + frequency / scene.rocking_frequency * drift
    if phase * amplitude > UNSURE * size[peak]:
        yield (
            f"the base vibrates at {frequency / scene.rocking_frequency:.4g} times the rocking frequency, and still "
            f"does when impacts kick it again: their phase is sure to {phase:.2g} rad, the peak base displacement to "
            f"{phase * amplitude / size[peak]:.2g} of itself; give the bearings their damping"
        )
