"""The quantities of the sheet from a run of any solver."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from analytic import simulate
from analytic.response import State

from .problems import IMPACT, STATE

if TYPE_CHECKING:
    from analytic import Response, Scene

    from .problems import Problem, Quantity

Value = float | str
HISTORY_STEP = 1e-3  # s, of which every time asked for is a multiple


def answers_of(problem: Problem, response: Response, states: Mapping[float, State]) -> dict[str, Value]:
    """{quantity: value} of all that a run shows: its response, and the states by their time [s]."""
    values = {one.name: _value(one, response, states) for one in problem.quantities}
    return {name: value for name, value in values.items() if value is not None}


def _value(quantity: Quantity, response: Response, states: Mapping[float, State]) -> Value | None:
    """The answer; None where the run has no such event or state."""
    if quantity.source in STATE:
        return getattr(states.get(quantity.index), quantity.source, None)
    if quantity.source in IMPACT:
        hits = response.impacts[int(quantity.index) - 1 :]
        return getattr(hits[0], quantity.source) if hits else None
    found: Any = getattr(response, quantity.source)
    return found if not isinstance(found, tuple) else found[0] if found else None  # of uplifts and rests, the first


def of_response(problem: Problem, response: Response) -> dict[str, Value]:
    """The answers of a `Response` with a history."""
    history = response.history
    states = {
        t: State(*(float(np.interp(t, history.time, getattr(history, name))) for name in State.__dataclass_fields__))
        for t in problem.times
        if history is not None and t <= history.time[-1]
    }
    return answers_of(problem, response, states)


def solved(problem: Problem, scene: Scene | None = None, tolerance: float = 1e-16) -> dict[str, Value]:
    """The answers of the analytic model, to the problem's scene or another one in its place."""
    return of_response(problem, simulate(scene or problem.scene, tolerance=tolerance, output_step=HISTORY_STEP))
