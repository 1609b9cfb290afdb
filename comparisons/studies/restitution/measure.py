"""One run of the restitution study: what is kept of it, and what is measured on it."""

import dataclasses
import math

import numpy as np

from analytic.response import History, Impact, Response, State
from analytic.rocking import base_jump_length, base_jump_length_as_printed, restitution

from ...measuring.measures import base_jump_error, state_restitution, swing_restitution

# Of the run's fastest: slower impacts are no swings but the engine's own chatter.
SLOWEST_IMPACT = 0.1
COLUMNS = ("time", "tilt", "tilt_rate")


def kept(response):
    """Reducer: the impacts, and of each swing its first and last sample and the one at its peak.

    These samples are all that `swing_restitution` reads.
    """
    impacts, history = strong_impacts(response), response.history
    edges = np.searchsorted(history.time, [-math.inf] + [impact.time for impact in impacts] + [math.inf])
    samples = set()
    for first, end in zip(edges[:-1], edges[1:], strict=True):
        if end > first:
            samples |= {first, first + np.abs(history.tilt_rate[first:end]).argmin(), end - 1}
    samples = sorted(int(sample) for sample in samples)
    return {"outcome": response.outcome, "end": response.end.time, "steps": response.steps,
            "impacts": [dataclasses.astuple(impact) for impact in impacts],
            "swings": {name: getattr(history, name)[samples].tolist() for name in COLUMNS},
            "settings": response.settings}


def strong_impacts(response):
    """The impacts of a response that are at least `SLOWEST_IMPACT` as fast as its fastest."""
    fastest = max((abs(impact.rate_before) for impact in response.impacts), default=0.0)
    return tuple(impact for impact in response.impacts if abs(impact.rate_before) >= SLOWEST_IMPACT * fastest)


def measured(scene, values, most):
    """Errors of the first `most` impacts of a run, from what `kept` kept of it.

    Returns
    -------
    dict
        Arrays of shape (impacts,): swing and state, restitution less eq. (7), from the energies of the swings and
        from the states at the impact; time [s]; on a base also jump, of the base velocity, relative: against
        momentum with the run's own rates (jump), against e_x of eq. (8) corrected (jump_8) and as printed
        (jump_8_printed). NaN where a swing has no peak.
    """
    response = _response(values)
    rates = np.array([impact.rate_before for impact in response.impacts])
    errors = {"swing": swing_restitution(scene, response) - restitution(scene),
              "state": state_restitution(response) - restitution(scene),
              "time": np.array([impact.time for impact in response.impacts])}
    if scene.base is not None:
        jumps = np.array([impact.base_velocity_jump for impact in response.impacts])
        errors["jump"] = base_jump_error(scene, response)
        errors["jump_8"] = jumps / (-base_jump_length(scene) * rates) - 1
        errors["jump_8_printed"] = jumps / (-base_jump_length_as_printed(scene) * rates) - 1
    return {name: array[:most] for name, array in errors.items()}


def _response(values):
    """The `Response` that the measures need."""
    swings = {name: np.array(values["swings"][name], dtype=float) for name in COLUMNS}
    zeros, nan = np.zeros(len(swings["time"])), math.nan
    history = History(**swings, base_displacement=zeros, base_velocity=zeros, bearing_force=zeros,
                      ground_acceleration=zeros)
    return Response(
        engine="", variant="", outcome=values["outcome"], overturning_time=None, unstable_time=None, peak_tilt=nan,
        peak_tilt_ratio=nan, peak_base_displacement=nan, peak_base_acceleration=nan,
        impacts=tuple(Impact(*impact) for impact in values["impacts"]), uplifts=(), rests=(), friction_demand=nan,
        min_normal_ratio=nan, end=State(values["end"], nan, nan, nan, nan, nan), cpu_seconds=nan,
        steps=values["steps"], settings={}, versions={}, history=history)
