"""What impacts add up: a base that still vibrates when the next one kicks it, and small swings that grow in many."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from .swings import find_swings
from .vibration import base_frequency

if TYPE_CHECKING:
    from analytic import Scene

    from .contract import Run
    from .swings import Swings, Trace

UNSURE = 0.015  # relative, of the peak base displacement
LEAST = 1e-5  # peak base displacement over R gamma that is worth a word: 3 micrometres for the Caryatid

# Swings below SMALL slendernesses that grow from impact to impact: after 14 of them a peak is off by a third (MuJoCo)
SMALL, SHAKEN = 0.02, 5


def warnings(scene: Scene, run: Run) -> Iterator[str]:
    """Sentences on what a run's impacts add up; none of a trace that is not finite, which fails, with the evidence."""
    trace = run.trace
    if trace is None or not (np.isfinite(trace.tilt).all() and np.isfinite(trace.base_displacement).all()):
        return
    swings = find_swings(trace)
    yield from unsure_displacement(scene, trace, swings, drift=run.drift, late=run.late)
    yield from shaken(scene, trace, swings)


def unsure_displacement(scene: Scene, trace: Trace, swings: Swings, *, drift: float, late: float) -> Iterator[str]:
    """A sentence where the peak base displacement hangs on the phase of a base that vibrates on its bearings.

    An impact that finds it in another phase adds to its amplitude, or takes from it, up to the error of the phase times
    it: before the peak that may change the peak, after it another one may be higher. Where all of the phase is lost the
    amplitude is, too: what yields in a contact damps it within thousands of periods.

    The amplitude is that of the velocity in the second half of the time between two impacts, so that what the ground or
    the block pushes slowly does not count, and at most half of the way that the base goes to and fro, so that what
    moves it fast on soft bearings does not either. What is left of it by dampers and hysteresis is in the trace.

    Parameters
    ----------
    scene : Scene
    trace : Trace
    swings : Swings
        Of the trace.
    drift, late : float
        As of `engines.contract.Run`.
    """
    size = np.abs(trace.base_displacement)
    peak = int(np.argmax(size))
    if scene.bearings is None or size[peak] < LEAST * scene.block.radius * scene.block.slenderness:
        return
    frequency = base_frequency(scene)
    phase = frequency * late + frequency / scene.rocking_frequency * drift
    edges = [0, *swings.first[1:], len(size)]
    reach, amplitude = [], []
    for begin, end in itertools.pairwise(edges):
        flight = slice((begin + end) // 2, end)
        way = float(np.ptp(trace.base_displacement[flight])) / 2
        amplitude.append(min(float(np.abs(trace.base_velocity[flight]).max()) / frequency, way))
        reach.append(size[begin:end].max())
    turned = min(phase, 2.0) * np.array([0.0, *amplitude[:-1]])  # what an impact's phase may add to the swing after it
    at = int(np.searchsorted(edges, peak, side="right")) - 1
    unsure = max(turned[at], float((reach + turned).max()) - size[peak], amplitude[at] if phase >= 1 else 0.0)
    if unsure > UNSURE * size[peak]:
        yield (
            f"the base vibrates at {frequency / scene.rocking_frequency:.4g} times the rocking frequency, and nothing "
            f"stops it before the next impact: its phase is sure to {phase:.2g} rad, the peak base displacement to "
            f"{unsure / size[peak]:.2g} of itself; give the bearings their damping"
        )


def shaken(scene: Scene, trace: Trace, swings: Swings) -> Iterator[str]:
    """A sentence where small swings grow to their peak from impact to impact."""
    if scene.motion is None:
        return
    peak = int(np.argmax(np.abs(trace.tilt)))
    size, impacts = abs(trace.tilt[peak]) / scene.block.slenderness, int((swings.first <= peak).sum()) - 1
    if size < SMALL and impacts > SHAKEN:
        yield (
            f"the peak tilt, {size:.2g} slendernesses, comes after {impacts} impacts of a block that the ground hardly "
            "lifts, each with its error: do not trust it"
        )
