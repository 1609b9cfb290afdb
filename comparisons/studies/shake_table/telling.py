"""What of a campaign may be stored: nothing from which one test's outcome, PGA or PGV follows.

The campaign's own licence is another, or it is nobody's but its owner's. Told are our solvers' outcomes by test, sums
over tests, and cells of at least `FEWEST` tests. Two sums of right answers beside outcomes by test say, by their
difference, what was measured in the tests where the two solvers differ: so a sum is kept back where those are fewer.
"""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from ...measuring.forecasts import FEWEST
from .shaking import FAILED, OVERTURNS, STANDS

NOT_RUN = "-"
SPLIT = 4 * FEWEST  # tests of a cell that is split once more


def text_of(outcomes: Iterable[str | None]) -> str:
    """A digit for each test of the outcomes of a solver; None: not run."""
    digits = {None: NOT_RUN, "failed": FAILED, "overturns": OVERTURNS}
    return "".join(digits.get(outcome, STANDS) for outcome in outcomes)


def array_of(text: str) -> np.ndarray:
    """The digits of `text_of`, shape (tests,)."""
    return np.array(list(text))


def may_be_told(text: str, others: Sequence[str]) -> bool:
    """Whether a solver's right answers, beside those of others, say nothing of fewer than `FEWEST` tests.

    text, others: outcomes by test; the others' right answers are told, on the tests that both have run, too.
    """
    own = array_of(text)
    for other in map(array_of, others):
        apart = int(((own != other) & (own != NOT_RUN) & (other != NOT_RUN)).sum())
        if 0 < apart < FEWEST:
            return False
    return True


def cells(x: np.ndarray, y: np.ndarray) -> list[np.ndarray]:
    """Places of tests, cell by cell: the plane of two measures halved in turn, across and up, as long as each half has
    at least `2 FEWEST` of them. Every test is in one cell.
    """

    def split(members, across):
        if len(members) < SPLIT:
            return [members]
        values = (x if across else y)[members]
        order = np.argsort(values, kind="stable")
        half = len(members) // 2
        return split(members[order[:half]], not across) + split(members[order[half:]], not across)

    return split(np.arange(len(x)), True)


def cell_rows(
    measures: tuple[np.ndarray, np.ndarray], measured: np.ndarray, probability: np.ndarray
) -> list[dict[str, Any]]:
    """A row for each cell: its middle (geometric means), its tests, how many overturned, the model's mean probability.

    No edge of a cell is told, which may be the value of one test.
    """
    logs = [np.log(one) for one in measures]
    return [
        {
            "size": len(members),
            **{name: float(np.exp(one[members].mean())) for name, one in zip(("pga", "ratio"), logs, strict=True)},
            "overturned": int(measured[members].sum()),
            "mean": float(probability[members].mean()),
        }
        for members in cells(*logs)
        if len(members) >= FEWEST
    ]


def quarter_rows(ratio: np.ndarray, measured: np.ndarray, probability: np.ndarray) -> list[dict[str, Any]]:
    """A row for each quarter of the tests in the order of PGV/PGA: their geometric mean of it, how many there are, how
    many overturned, and the model's mean probability."""
    order = np.argsort(ratio, kind="stable")
    return [
        {
            "size": len(members),
            "ratio": float(np.exp(np.log(ratio[members]).mean())),
            "overturned": int(measured[members].sum()),
            "mean": float(probability[members].mean()),
        }
        for members in np.array_split(order, 4)
        if len(members) >= FEWEST
    ]
