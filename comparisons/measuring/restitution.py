"""Error of restitution: the one way from a run's impacts to its errors, for agreement, report and studies."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING

import numpy as np

from analytic.rocking import base_jump_length, base_jump_length_as_printed, restitution

from .measures import base_jump_error, state_restitution, swing_restitution

if TYPE_CHECKING:
    import numpy.typing as npt

    from analytic import Impact, Response, Scene

# Of the run's fastest: slower impacts are no swings but an engine's own chatter on its way to rest.
SLOWEST_IMPACT = 0.1


def strong_impacts(response: Response) -> tuple[Impact, ...]:
    """The impacts of a response that are at least `SLOWEST_IMPACT` as fast as its fastest."""
    fastest = max((abs(impact.rate_before) for impact in response.impacts), default=0.0)
    return tuple(impact for impact in response.impacts if abs(impact.rate_before) >= SLOWEST_IMPACT * fastest)


def impact_errors(scene: Scene, response: Response, most: int | None = None) -> dict[str, np.ndarray]:
    """Errors of the strong impacts of a run, of the first `most` of them.

    Returns
    -------
    dict
        Arrays of shape (impacts,): state, restitution less eq. (7), from the states at the impact; time [s]; for free
        rocking with a history also swing, the same from the energies of the swings, NaN where a swing has no peak;
        on a base also jump, of the base velocity, relative: against momentum with the run's own rates (jump), against
        e_x of eq. (8) corrected (jump_8) and as printed (jump_8_printed).
    """
    response = dataclasses.replace(response, impacts=strong_impacts(response))
    expected = restitution(scene)
    errors = {
        "state": state_restitution(response) - expected,
        "time": np.array([impact.time for impact in response.impacts]),
    }
    if scene.motion is None and scene.bearings is None and response.history is not None:
        errors["swing"] = swing_restitution(scene, response) - expected
    if scene.base is not None:
        rates = np.array([impact.rate_before for impact in response.impacts])
        jumps = np.array([impact.base_velocity_jump for impact in response.impacts])
        errors["jump"] = base_jump_error(scene, response)
        errors["jump_8"] = jumps / (-base_jump_length(scene) * rates) - 1
        errors["jump_8_printed"] = jumps / (-base_jump_length_as_printed(scene) * rates) - 1
    return {name: values[:most] for name, values in errors.items()}


def rate_restitution(response: Response) -> np.ndarray:
    """Restitution of each strong impact of free rocking from successive rates, shape (impacts kept,).

    The swing between two impacts keeps its energy (and the base's momentum), so the rate before the next impact is the
    rate after this one: a solver that applies eq. (7) exactly is judged by what it does to the swing. No history is
    needed.
    """
    before = np.array([impact.rate_before for impact in response.impacts])
    fast = np.abs(before) >= SLOWEST_IMPACT * np.abs(before).max(initial=0.0)
    kept = fast[:-1] & fast[1:] & (before[:-1] * before[1:] < 0)
    return np.abs(before[1:] / before[:-1])[kept]


def rms(values: npt.ArrayLike) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def worst(values: npt.ArrayLike) -> float:
    """Largest absolute value."""
    return float(np.abs(values).max())
