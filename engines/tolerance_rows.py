"""Rows of the table of agreement tolerances, as an engine states them beside its adapter."""

from dataclasses import dataclass

# What errors come from, where engines share it.
STEP = "step; first order, by the phase of the impact in it"
LARGE_STEP = "steps in flight and at rest"
HELD = "what the contact gives at rest"
READING = "steps, and their force and momentum as read between them"
ROUNDING = "history committed once per accepted step; round-off"


@dataclass(frozen=True)
class ToleranceRow:
    """`quantity` over `scenes` is at most `bound`; `measured` is the worst found when that was set, `source` says what
    the error comes from.

    Where the source is `ROUNDING` the bound is what is asked for, and the measured value far below.
    """

    quantity: str
    scenes: str
    bound: float
    measured: float
    source: str
