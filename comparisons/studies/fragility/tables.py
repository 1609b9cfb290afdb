"""The fragility study's tables, and how its numbers are written, from its result alone."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from ...showing.parts import Table, number
from .figures import is_shown, labelled, parted

if TYPE_CHECKING:
    from ...running.provenance import Result

LEVEL = 0.05  # of the test between a solver and the model


def fit_table(result: Result, scene: str) -> Table:
    """Median, dispersion and fit of every limit state and measure."""
    rows = []
    for row in parted(result, "fit", scene=scene):
        rows.append(
            (
                f"{row['state']}, {labelled(row['measure'])}",
                f"{row['exceeded']}/{row['size']}",
                ranged(row["median"], row["median_interval"]),
                ranged(row["dispersion"], row["dispersion_interval"]),
                "least" if row["best"] else _interval(row["ratio_interval"]),
                number(row["p_value"], 2),
                "no fit" if row["median"] is None else ("yes" if is_shown(row) else "no"),
            )
        )
    return Table(
        f"{scene}: lognormal curves of the analytic model, with 95 % bootstrap intervals over runs",
        (
            "limit state, measure",
            "exceeded",
            "median",
            "dispersion [-]",
            "over the least [-]",
            "p of the fit [-]",
            "curve shown",
        ),
        rows,
    )


def effect_table(result: Result, scene: str) -> Table:
    """Every solver against the analytic model, limit state by limit state."""
    costs = {row["solver"]: row["cpu_per_run"] for row in parted(result, "cost", scene=scene)}
    rows = []
    for row in parted(result, "effect", scene=scene):
        rows.append(
            (
                f"{row['solver']}, {row['state']}",
                str(size(row)),
                f"{row['only_a']}, {row['only_b']}",
                number(row["p_holm"], 2),
                *_shifts(row),
                shift(row["detectable_shift"]),
                "yes" if row["p_holm"] <= LEVEL else "not found",
                number(costs.get(row["solver"]), 2),
            )
        )
    return Table(
        f"{scene}: every solver against the analytic model on the same runs, with 95 % intervals from paired bootstrap",
        (
            "solver, limit state",
            "runs",
            "only the model, only the solver exceeds",
            "McNemar p after Holm [-]",
            "shift of the median",
            "dispersion over the model's [-]",
            "shift found with 80 %",
            "they differ",
            "CPU time per run [s]",
        ),
        rows,
    )


def _shifts(row):
    """Cells of the shifts of median and dispersion."""
    if not row["only_a"] + row["only_b"]:
        return "no run differs", "no run differs"
    return (
        shift(row["median_shift"], row["median_interval"]),
        ranged(row["dispersion_shift"], row["dispersion_interval"], 3),
    )


def shift(ratio: float | None, interval: Sequence[float] | None = None) -> str:
    """A ratio as a signed change in per cent, with its interval."""
    if ratio is None:
        return "–"
    words = f"{_signed(ratio)} %"
    return words if interval is None else f"{words} ({_signed(interval[0])} to {_signed(interval[1])})"


def _signed(ratio):
    change = 100 * (ratio - 1)
    return "0" if abs(change) < 1e-9 else ("+" if change > 0 else "") + number(change, 2)


def ranged(value: float | None, interval: Sequence[float] | None, digits: int = 2) -> str:
    """A number with its interval."""
    if value is None or interval is None:
        return number(value, digits)
    return f"{number(value, digits)} ({number(interval[0], digits)} to {number(interval[1], digits)})"


def _interval(interval):
    return "–" if interval is None else " to ".join(number(limit, 2) for limit in interval)


def size(row: dict[str, Any]) -> int:
    """Runs that were compared."""
    return row["both_stand"] + row["both_overturn"] + row["only_a"] + row["only_b"]
