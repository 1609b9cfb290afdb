"""Rows of the table of agreement tolerances; each engine defines its own beside its adapter."""

from dataclasses import dataclass

# Sources of error that several engines share.
STEP = "step; first order, by the phase of the impact in it"
LARGE_STEP = "steps in flight and at rest"
HELD = "what the contact gives at rest"
READING = "steps, and their force and momentum as read between them"
ROUNDING = "history committed once per accepted step; round-off"


@dataclass(frozen=True)
class ToleranceRow:
    """The error of `quantity` over `scenes` is at most `bound`. `measured`: the worst value found when the bound was
    set; `source`: the cause of the error.

    Where the source is `ROUNDING`, the bound is a requirement, and the measured value is far below it.
    """

    quantity: str
    scenes: str
    bound: float
    measured: float
    source: str
