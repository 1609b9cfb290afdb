"""The rules of `decision.py` applied to the end state of another solver's run: whether that run may end."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

from .decision import longest_duration, motion_end, peaks_are_final, shortest_duration, will_not_overturn
from .layout import Base, Body
from .solver import parameters

if TYPE_CHECKING:
    from .layout import Parameters
    from .response import Response
    from .scene import Scene


def is_decided(scene: Scene, response: Response, *, contact_tilt: float = 0.0) -> bool:
    """Whether the outcome of a run is certain at its end, by rules (a), (b) and (c).

    Parameters
    ----------
    scene : Scene
    response : Response
    contact_tilt : float
        Tilt [rad] up to which the solver's block counts as in full contact.

    Returns
    -------
    bool
        False for a failed run, and for one that ended before the ground motion.
    """
    return _at_end(scene, response, contact_tilt)[0]


def is_finished(scene: Scene, response: Response, *, contact_tilt: float = 0.0) -> bool:
    """Whether the outcome of a run is certain at its end and its peaks can no longer grow; see `is_decided`."""
    decided, state = _at_end(scene, response, contact_tilt)
    if not decided or state is None:
        return decided
    peaks = response.peak_tilt, response.peak_base_displacement, response.peak_base_acceleration
    return bool(peaks_are_final(*state, peaks))


def _at_end(scene: Scene, response: Response, contact_tilt: float) -> tuple[bool, tuple[Parameters, Body, Base] | None]:
    """(decided, the kernel's parameters and state; None if the block has overturned or the run failed)."""
    if response.outcome in ("overturns", "failed"):
        return response.outcome == "overturns", None
    par, end = parameters(scene), response.end
    if scene.friction is not None:  # at rest the block slides where it does not lift
        par = par._replace(slope=min(par.slope, scene.friction))
    if end.time < motion_end(scene) * (1 - 1e-9):
        return False, None
    x, v, z = end.base_displacement, end.base_velocity, 0.0
    if par.count:
        z = end.bearing_force / par.count - par.kb * x - par.damping * v
        z = min(max(z, -par.constants.f0), par.constants.f0)
    body = Body(0.0, 0.0, 0.0)
    if abs(end.tilt) > contact_tilt or contact_tilt == 0 and end.tilt_rate != 0:
        body = Body(math.copysign(1.0, end.tilt if end.tilt != 0 else end.tilt_rate), end.tilt, end.tilt_rate)
    state = par, body, Base(x, v, z)
    return bool(will_not_overturn(*state, response.outcome == "rocks")), state


def until_decided(
    simulate: Callable[[Scene], Response],
    scene: Scene,
    *,
    at_least: float = 0.0,
    finished: Callable[[Scene, Response], bool] = is_finished,
) -> Response:
    """``simulate(scene)`` with increasing durations until the run has finished or the longest is reached.

    Parameters
    ----------
    simulate : callable
        From a scene with a duration to a `Response`.
    scene : Scene
        Without a duration.
    at_least : float
        First duration [s], if longer than `shortest_duration`.
    finished : callable
        (scene, response) -> whether the run may end here.
    """
    longest, begin = longest_duration(scene), motion_end(scene)
    duration = min(max(shortest_duration(scene), at_least), longest)
    while True:
        response = simulate(scene.with_(duration=duration))
        if response.outcome == "failed" or duration >= longest or finished(scene, response):
            return response
        duration = min(begin + 2 * (duration - begin), longest)
