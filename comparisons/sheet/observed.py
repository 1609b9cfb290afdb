"""What a run shows of what the sheet asks for, whoever made the run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from analytic import simulate
from analytic.response import State

from .problems import IMPACT, STATE

if TYPE_CHECKING:
    from analytic import Impact, Response, Scene

    from .problems import Problem, Quantity

Value = float | str
HISTORY_STEP = 1e-3  # s, of which every time asked for is a multiple


@dataclass(frozen=True)
class Observed:
    """The parts of a run that answers are read from; states by their time [s]."""

    outcome: str
    impacts: Sequence[Impact]
    uplifts: Sequence[float]
    rests: Sequence[float]
    peak_tilt: float
    peak_base_displacement: float
    overturning_time: float | None
    states: Mapping[float, State]

    def value(self, quantity: Quantity) -> Value | None:
        """The answer; None where the run has no such event or state."""
        if quantity.source in IMPACT:
            k = int(quantity.index) - 1
            return getattr(self.impacts[k], quantity.source) if k < len(self.impacts) else None
        if quantity.source in STATE:
            state = self.states.get(quantity.index)
            return None if state is None else getattr(state, quantity.source)
        found = getattr(self, quantity.source)
        if not quantity.index:
            return found
        k = int(quantity.index) - 1
        return found[k] if k < len(found) else None

    def answers(self, problem: Problem) -> dict[str, Value]:
        """{quantity: value} of all that the run shows."""
        values = {quantity.name: self.value(quantity) for quantity in problem.quantities}
        return {name: value for name, value in values.items() if value is not None}


def of_response(problem: Problem, response: Response) -> Observed:
    """What a `Response` with a history shows."""
    history = response.history
    states = {}
    for t in problem.times:
        if history is not None and t <= history.time[-1]:
            columns = (getattr(history, name) for name in State.__dataclass_fields__ if name != "time")
            states[t] = State(t, *(float(np.interp(t, history.time, column)) for column in columns))
    return Observed(
        response.outcome,
        response.impacts,
        response.uplifts,
        response.rests,
        response.peak_tilt,
        response.peak_base_displacement,
        response.overturning_time,
        states,
    )


def solved(problem: Problem, scene: Scene | None = None, tolerance: float = 1e-16) -> dict[str, Value]:
    """The answers of the analytic model, to the problem's scene or another one in its place."""
    chosen = problem.scene if scene is None else scene
    response = simulate(chosen, tolerance=tolerance, output_step=HISTORY_STEP)
    return of_response(problem, response).answers(problem)
