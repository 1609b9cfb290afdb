"""Extremes and, if asked for, the history of a run of the second implementation."""

import math
from collections.abc import Sequence

import numpy as np

from .response import History

ROUNDING = 1e-12  # of a passage of the slenderness that was found as a root


class Extremes:
    """Largest tilt [rad], base displacement [m], absolute acceleration [m/s2] and friction demand, least N/(m g).

    All except the tilt leave out the last fall. `held`: their values, and the time [s], when |tilt| last was at most
    the slenderness.
    """

    def __init__(self, tilt: float, x: float, history: bool) -> None:
        self.tilt, self.x, self.acceleration, self.friction, self.normal = abs(tilt), abs(x), 0.0, 0.0, 1.0
        self.held = self.x, self.acceleration, self.friction, self.normal, 0.0
        self.rows: list[Sequence[float]] | None = [] if history else None

    def step(self, row: Sequence[float], absolute: float, horizontal: float, normal: float, slenderness: float) -> None:
        """Include one state: a row of the history, the base's acceleration [m/s2], contact forces over m g."""
        t, tilt, _, x, *_ = row
        self.tilt, self.x = max(self.tilt, abs(tilt)), max(self.x, abs(x))
        self.acceleration = max(self.acceleration, abs(absolute))
        self.friction = max(self.friction, abs(horizontal) / normal if normal > 0 else math.inf)
        self.normal = min(self.normal, normal)
        if abs(tilt) <= slenderness * (1 + ROUNDING):
            self.held = self.x, self.acceleration, self.friction, self.normal, t
        if self.rows is not None:
            self.rows.append(row)

    def exclude_overturning(self) -> float:
        """Remove the last fall of a block that has overturned; returns the time [s] at which it began."""
        self.x, self.acceleration, self.friction, self.normal, began = self.held
        return began

    def history(self) -> History | None:
        """The `History`, or None."""
        if self.rows is None:
            return None
        return History(*np.array(self.rows).reshape(-1, len(History.COLUMNS)).T)
