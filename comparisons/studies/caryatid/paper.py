"""What the Caryatid paper prints, as far as it is known here, and what kind of agreement each number got."""

from dataclasses import dataclass
from typing import Any

REPRODUCED, CORRECTED, NOT_REPRODUCIBLE = "reproduced", "corrected", "not reproducible"
GIVEN, DERIVED, ADDED, OTHER_MOTION = "input", "not printed, derived", "added here", "other motion"

# Table 1(a): targets; Table 1(b): the bearings designed for them
PERIOD, X_MAX, DAMPING = 2.0, 0.30, 0.30  # s, m, share of critical
KA, KB, ALPHA, DELTA_K = 6.22e4, 6.22e3, 44.69, 1e-20  # N/m, N/m, -, N/m
COUNT, MASS, BASE_MASS, OMEGA_R = 4, 3172.05, 212.0, 2.60  # -, kg, kg, rad/s
# Figs 4 to 6, Duzce 12 November 1999, East-West
PEAK_DISPLACEMENT, PEAK_ACCELERATION_G = 0.212, 0.236  # m, g
VULNERABLE_PERIOD = 4.0  # s, "about"
# About 35 s in the paper's trace, which starts about 28 s before the one with its peak at 3.415 s.
OVERTURNING_AFTER_PEAK = 35.0 - 28.0 - 3.415  # s
# How "about" is read: 35 s and 28 s are each given to a second, 4 s to half a second.
OVERTURNING_ABOUT, VULNERABLE_ABOUT = 1.0, 0.5  # s

# Known to exist, but neither text nor numbers of it are at hand.
UNKNOWN = (
    "Figs 1 and 2; the damping ratios of Fig. 5(b); the values on the axes of Figs 3 to 6; the dimensions of "
    "the Caryatid and of its bearings beyond Table 1; the slenderness."
)


@dataclass(frozen=True)
class Value:
    """One number of the paper beside this study's.

    where: table, figure or equation; quantity: what, with its unit; paper, study: numbers or words; status: one of
    the above; note: why.
    """

    where: str
    quantity: str
    paper: float | str
    study: float | str
    status: str
    note: str = ""

    def row(self) -> dict[str, Any]:
        """As a row of the result file, with the difference where both are numbers."""
        numbers = isinstance(self.paper, float) and isinstance(self.study, float)
        difference = self.study - self.paper if numbers and self.status != GIVEN else None  # type: ignore[operator]  # both are numbers
        return {
            "part": "value",
            "where": self.where,
            "quantity": self.quantity,
            "paper": self.paper,
            "study": self.study,
            "difference": difference,
            "status": self.status,
            "note": self.note,
        }


def judged(where: str, quantity: str, paper: float, study: float, within: float, note: str = "") -> Value:
    """A `Value` that is reproduced if it lies within half a printed digit, or within what "about" allows."""
    status = REPRODUCED if abs(study - paper) <= within else NOT_REPRODUCIBLE
    return Value(where, quantity, paper, study, status, note)
