"""What impacts add up: a base that still vibrates when the next one kicks it, and small swings that grow in many."""

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

# Swings below SMALL slendernesses that grow from impact to impact: after 14 of them a peak is off by a third (MuJoCo)
SMALL, SHAKEN = 0.02, 5


def sound(trace: Trace | None) -> TypeGuard[Trace]:
    """Whether there is a trace of finite numbers: what is not fails elsewhere, with the evidence."""
    return trace is not None and bool(np.isfinite(trace.tilt).all() and np.isfinite(trace.base_displacement).all())


def unsure_displacement(scene: Scene, trace: Trace | None, *, drift: float, lag: float = 0.0) -> Iterator[str]:
    """A sentence where the peak base displacement hangs on the phase in which an impact finds a vibrating base.

    The vibration's amplitude before the last impact up to the peak is that of its velocity, so that what the ground or
    the block pushes slowly does not count, and at most half of the way that the base goes to and fro, so that what
    moves it fast on soft bearings does not either. What is left of it by dampers and hysteresis is in the trace.

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
    amplitude = min(
        float(np.abs(trace.base_velocity[flight]).max()) / frequency, float(np.ptp(trace.base_displacement[flight])) / 2
    )
    phase = frequency * lag + frequency / scene.rocking_frequency * drift
    if phase * amplitude > UNSURE * size[peak]:
        yield (
            f"the base vibrates at {frequency / scene.rocking_frequency:.4g} times the rocking frequency, and still "
            f"does when impacts kick it again: their phase is sure to {phase:.2g} rad, the peak base displacement to "
            f"{phase * amplitude / size[peak]:.2g} of itself; give the bearings their damping"
        )


def shaken(scene: Scene, trace: Trace | None) -> Iterator[str]:
    """A sentence where small swings grow to their peak from impact to impact."""
    if scene.motion is None or not sound(trace):
        return
    peak = int(np.argmax(np.abs(trace.tilt)))
    size, impacts = abs(trace.tilt[peak]) / scene.block.slenderness, int((find_swings(trace).first <= peak).sum()) - 1
    if size < SMALL and impacts > SHAKEN:
        yield (
            f"the peak tilt, {size:.2g} slendernesses, comes after {impacts} impacts of a block that the ground hardly "
            "lifts, each with its error: do not trust it"
        )
