"""The class of a run compared with the analytic model's, one word, the same in every study."""

from __future__ import annotations

from collections.abc import Collection

from analytic.response import COMPARED

CLASSES = ("right", "differs", "failed", "left out")


def class_of(comparable: str, quantities: Collection[str] | None, counted: Collection[str] | None = None) -> str:
    """One of `CLASSES`.

    Parameters
    ----------
    comparable : str
        Of the scene, by the model alone; a run of one that is not "yes" is left out, of all engines alike.
    quantities : collection of str or None
        In what the run differs (`Response.differences`); None: it failed.
    counted : collection of str or None
        The quantities that count; None: all.
    """
    if comparable != COMPARED:
        return "left out"
    if quantities is None:
        return "failed"
    return "differs" if set(quantities) & set(quantities if counted is None else counted) else "right"
