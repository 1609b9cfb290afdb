"""What the readable twin keeps of its steps: extremes and, where asked for, the history."""

import math
from collections.abc import Sequence

import numpy as np

from .response import History


class Extremes:
    """Largest tilt [rad], base displacement [m], absolute acceleration [m/s2] and friction demand, least N/(m g).

    Friction demand and normal force of the last fall do not count: what the contact gives at steps with |tilt| above
    the slenderness waits until the block is below it again, or the run is over.
    """

    def __init__(self, tilt: float, x: float, history: bool) -> None:
        self.tilt, self.x, self.acceleration = abs(tilt), abs(x), 0.0
        self.friction, self.normal = 0.0, 1.0
        self.waiting: list[tuple[float, float]] = []  # (friction demand, N/(m g))
        self.rows: list[Sequence[float]] | None = [] if history else None

    def step(self, row: Sequence[float], absolute: float, horizontal: float, normal: float, slenderness: float) -> None:
        """One step: a row of the history, the base's acceleration [m/s2], forces at the contact over m g."""
        _, tilt, _, x, *_ = row
        self.tilt, self.x = max(self.tilt, abs(tilt)), max(self.x, abs(x))
        self.acceleration = max(self.acceleration, abs(absolute))
        self.waiting.append((abs(horizontal) / normal if normal > 0 else math.inf, normal))
        if abs(tilt) <= slenderness:  # what comes later is the last fall, or it comes back
            self.count_waiting()
        if self.rows is not None:
            self.rows.append(row)

    def count_waiting(self) -> None:
        for demand, normal in self.waiting:
            self.friction, self.normal = max(self.friction, demand), min(self.normal, normal)
        self.waiting.clear()

    def history(self) -> History | None:
        """The `History`, or None."""
        if self.rows is None:
            return None
        return History(*np.array(self.rows).reshape(-1, len(History.COLUMNS)).T)
