"""May a run that another solver made end here? The rules of `decision.py`, applied to the run's own end state."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from .decision import longest_duration, motion_end, peaks_are_final, shortest_duration, will_not_overturn
from .solver import parameters

if TYPE_CHECKING:
    from .response import Response
    from .scene import Scene
    from .taylor import Parameters


def is_decided(scene: Scene, response: Response, *, contact_tilt: float = 0.0) -> bool:
    """Is the outcome of a run certain at its end? Rules (a), (b) and (c), applied to the run's own end state.

    Parameters
    ----------
    scene : Scene
    response : Response
    contact_tilt : float
        Tilt [rad] up to which the solver's block counts as in full contact.

    Returns
    -------
    bool
        False for a failed run, and where it ended before the ground motion.
    """
    return _at_end(scene, response, contact_tilt)[0]


def is_finished(scene: Scene, response: Response, *, contact_tilt: float = 0.0) -> bool:
    """Is the outcome of a run certain at its end, and can its peaks no longer grow? See `is_decided`."""
    decided, par, state = _at_end(scene, response, contact_tilt)
    if not decided or state is None:
        return decided
    return bool(
        peaks_are_final(
            par,  # type: ignore[arg-type]  # with a state come parameters
            *state,
            response.peak_tilt,
            response.peak_base_displacement,
            response.peak_base_acceleration,
        )
    )


def _at_end(
    scene: Scene, response: Response, contact_tilt: float
) -> tuple[bool, Parameters | None, tuple[bool, float, float, float, float, float] | None]:
    """(decided, kernel's parameters, (rocking, tilt, rate, x, v, z) or None where it has overturned or failed)."""
    if response.outcome in ("overturns", "failed"):
        return response.outcome == "overturns", None, None
    par, end = parameters(scene), response.end
    if end.time < motion_end(scene) * (1 - 1e-9):
        return False, par, None
    x, v, z = end.base_displacement, end.base_velocity, 0.0
    if par.count:
        z = end.bearing_force / par.count - par.kb * x - par.damping * v
        z = min(max(z, -par.f0), par.f0)
    rocking = abs(end.tilt) > contact_tilt or contact_tilt == 0 and end.tilt_rate != 0
    tilt, rate = (end.tilt, end.tilt_rate) if rocking else (0.0, 0.0)
    state = rocking, tilt, rate, x, v, z
    return bool(will_not_overturn(par, rocking, response.outcome == "rocks", tilt, rate, x, v, z)), par, state


def until_decided(
    simulate: Callable[[Scene], Response],
    scene: Scene,
    *,
    at_least: float = 0.0,
    finished: Callable[[Scene, Response], bool] = is_finished,
) -> Response:
    """``simulate(scene)`` with durations that grow until the run has finished, or the longest is reached.

    Parameters
    ----------
    simulate : callable
        From a scene with a duration to a `Response`.
    scene : Scene
        Without a duration.
    at_least : float
        The first duration tried [s], if it is longer than `shortest_duration`.
    finished : callable
        Of (scene, response): may the run end here?
    """
    longest, begin = longest_duration(scene), motion_end(scene)
    duration = min(max(shortest_duration(scene), at_least), longest)
    while True:
        response = simulate(scene.with_(duration=duration))
        if response.outcome == "failed" or duration >= longest or finished(scene, response):
            return response
        duration = min(begin + 2 * (duration - begin), longest)
