"""Check that an engine holds the values it was given; no run uses other values."""

from collections.abc import Iterable
from typing import Any

import numpy as np

from .contract import Mismatch

RELATIVE, ABSOLUTE = 1e-12, 1e-14  # round-off


def require(values: Iterable[tuple[str, Any, Any]]) -> None:
    """Raise `Mismatch` naming what an engine holds that differs from what it was given.

    Parameters
    ----------
    values : iterable of (name, used, wanted)
        Numbers or arrays; one number may be wanted for all entries of an array.
    """
    wrong = [
        f"{name} is {np.asarray(used).tolist()}, not {np.asarray(wanted).tolist()}"
        for name, used, wanted in values
        if not _same(used, wanted)
    ]
    if wrong:
        raise Mismatch("; ".join(wrong))


def _same(used: Any, wanted: Any) -> bool:
    if isinstance(used, int | float) and isinstance(wanted, int | float):
        return abs(used - wanted) <= ABSOLUTE + RELATIVE * abs(wanted)  # not for NaN
    return np.size(wanted) in (1, np.size(used)) and np.allclose(used, wanted, RELATIVE, ABSOLUTE)
