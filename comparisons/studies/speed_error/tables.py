"""What the rows of the speed-error study say: cost at an error, observed order, what extra modelling costs."""

from __future__ import annotations

import statistics
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from .growth import fit
from .ladders import NEEDED

if TYPE_CHECKING:
    from ...running.provenance import Result

LEVELS = (1e-2, 1e-3, 1e-4, 1e-6, 1e-9)  # of the scene's principal measure
FLOOR = 1e-13  # errors below it are rounding and tell no order
TIE = 1.1  # solvers whose CPU times differ by less share a rank, however quiet the machine was
NOISE = 95  # percentile of the settings' spread over the rounds, below which two solvers are not told apart
FULL_CONTACT = "full contact integrated as rocking"


def ladder(result: Result) -> list[dict[str, Any]]:
    return [row for row in result.rows if row["table"] == "ladder"]


def principal(result: Result, scene: str) -> str:
    """Name of the scene's principal measure."""
    return result.settings["scenes"][scene]["measures"][0]


def error(row: Mapping[str, Any], measure: str) -> float | None:
    """The row's error, or None where it has none, lost impacts, or failed."""
    return None if row["failure"] or row["lost_impacts"] else row["errors"].get(measure)


def cost_at_error(
    result: Result,
    scene: str,
    level: float,
    measure: str | None = None,
    seconds: Sequence[float] | np.ndarray | None = None,
) -> dict[str, dict[str, Any]]:
    """{family: cheapest row that reaches the level}, cheapest family first; of what the scene needs only.

    seconds: CPU time per row of `ladder(result)` in place of the medians.
    """
    measure = measure or principal(result, scene)
    best = {}
    for index, row in enumerate(ladder(result)):
        off = error(row, measure)
        if row["scene"] != scene or row["model"] != NEEDED or off is None or off > level:
            continue
        cost = row["cpu_seconds"] if seconds is None else seconds[index]
        if np.isfinite(cost) and (row["family"] not in best or cost < best[row["family"]][0]):
            best[row["family"]] = cost, row
    return {family: row for family, (cost, row) in sorted(best.items(), key=lambda item: item[1][0])}


def orders(result: Result, scene: str, axis: str = "value") -> dict[str, tuple[float, float, int]]:
    """{family: (order, standard error, points)}: error ~ knob^order (axis "value") or ~ mean step^order ("step").

    Errors at rounding and runs that lost impacts are left out; three points or more.
    """
    measure, fits = principal(result, scene), {}
    for family in dict.fromkeys(row["family"] for row in ladder(result)):
        rows = [
            row
            for row in ladder(result)
            if row["scene"] == scene
            and row["family"] == family
            and row["model"] == NEEDED
            and (error(row, measure) or 0) > FLOOR
            and row.get(axis)
        ]
        if len(rows) >= 3:
            fits[family] = *fit([row[axis] for row in rows], [error(row, measure) for row in rows]), len(rows)
    return fits


def ranking_stability(result: Result) -> tuple[float, int, list[tuple[str, float, str, str]]]:
    """How the ranking of solvers repeats between the odd and the even rounds.

    Returns
    -------
    tie : float
        Ratio of CPU times that the study resolves: most settings differ by less than it between their own rounds.
    pairs : int
        Of solvers that both reach a level in a scene, at CPU times further apart than `tie`.
    changed : list of (scene, level, solver, solver)
        Those of them that changed places.
    """
    seconds = result.arrays["cpu_seconds"]
    known = seconds[np.isfinite(seconds).all(axis=1)]
    tie = max(TIE, float(np.percentile(known.max(axis=1) / known.min(axis=1), NOISE)))
    halves = [np.array([_median(line[k::2]) for line in seconds]) for k in (0, 1)]
    pairs, changed = 0, []
    for scene in result.settings["scenes"]:
        for level in LEVELS:
            costs = cost_at_error(result, scene, level)
            ranks = [list(cost_at_error(result, scene, level, seconds=half)) for half in halves]
            common = [family for family in ranks[0] if family in ranks[1]]
            for i, one in enumerate(common):
                for other in common[i + 1 :]:
                    if 1 / tie < costs[one]["cpu_seconds"] / costs[other]["cpu_seconds"] < tie:
                        continue
                    pairs += 1
                    if ranks[1].index(one) > ranks[1].index(other):
                        changed.append((scene, level, one, other))
    return tie, pairs, changed


def _median(values):
    known = values[np.isfinite(values)]
    return float(np.median(known)) if len(known) else float("nan")


def extras(result: Result) -> list[dict[str, Any]]:
    """Rows modelled with more than the scene needs, each beside the needed model of the same family and setting.

    List of dicts: scene, model, family, value, cost_ratio, error, needed_error.
    """
    rows, compared = ladder(result), []
    for row in rows:
        if row["model"] == NEEDED:
            continue
        compared += _beside(result, row, row["model"], _same(rows, row))
    for family, integrated in result.settings["applied_impacts"].items():
        for row in rows:  # contact is integrated though the block never lifts, beside the adapter's own
            if row["scene"] == "isolated-standing" and row["family"] == integrated != family:
                given = cost_at_error(result, row["scene"], error(row, principal(result, row["scene"])) or 0.0)
                compared += _beside(result, row, FULL_CONTACT, given.get(family))
    return compared


def _same(rows, row):
    key = row["scene"], row["family"], row["value"]
    return next(
        (one for one in rows if one["model"] == NEEDED and (one["scene"], one["family"], one["value"]) == key), None
    )


def _beside(result, row, model, needed):
    measure = principal(result, row["scene"])
    if needed is None or "cpu_seconds" not in needed or "cpu_seconds" not in row:
        return []
    return [
        {
            "scene": row["scene"],
            "model": model,
            "family": row["family"],
            "knob": row["knob"],
            "value": row["value"],
            "needed": needed["family"],
            "needed_value": needed["value"],
            "cost_ratio": row["cpu_seconds"] / needed["cpu_seconds"],
            "error": row["errors"].get(measure),
            "needed_error": needed["errors"].get(measure),
            "lost_impacts": row["lost_impacts"],
            "needed_lost": needed["lost_impacts"],
        }
    ]


def law_cost(result: Result) -> dict[tuple[str, str], tuple[float, float, float]]:
    """{(scene, family): median over equal knob values of CPU time Bouc-Wen / algebraic, lowest, highest}."""
    timed: dict[tuple[str, str, float], float] = {}
    for row in ladder(result):
        if "cpu_seconds" in row:
            timed.setdefault((row["family"], row["scene"], row["value"]), row["cpu_seconds"])
    ratios: dict[tuple[str, str], list[float]] = {}
    for row in ladder(result):
        if row["law"] == "bouc-wen" and "cpu_seconds" in row:
            family = row["family"].removesuffix(", Bouc-Wen")
            algebraic = timed.get((family, row["scene"], row["value"]))
            if algebraic:
                ratios.setdefault((row["scene"], family), []).append(row["cpu_seconds"] / algebraic)
    return {key: (statistics.median(group), min(group), max(group)) for key, group in ratios.items()}


def growths(result: Result) -> dict[tuple[str, str], dict[str, Any]]:
    """{(against, family): dict of values, cpu_seconds, traced_bytes, resident_bytes, exponent, exponent_error, and
    last_exponent, that between the last two points}.
    """
    series = {}
    for row in result.rows:
        if row["table"] == "growth" and not row["failure"]:
            series.setdefault((row["against"], row["family"]), []).append(row)
    grown = {}
    for key, rows in series.items():
        entry = {
            name: [row[name] for row in rows] for name in ("value", "cpu_seconds", "traced_bytes", "resident_bytes")
        }
        if len(rows) >= 3:
            entry["exponent"], entry["exponent_error"] = fit(entry["value"], entry["cpu_seconds"])  # type: ignore[assignment]  # beside the lists
            (x0, x1), (y0, y1) = entry["value"][-2:], entry["cpu_seconds"][-2:]
            entry["last_exponent"] = float(np.log(y1 / y0) / np.log(x1 / x0))  # type: ignore[assignment]  # as above
        grown[key] = entry
    return grown


def unrepeatable(result: Result) -> list[dict[str, Any]]:
    """Rows whose values were not the same bit for bit in every round."""
    return [row for row in ladder(result) if not row["repeatable"]]
