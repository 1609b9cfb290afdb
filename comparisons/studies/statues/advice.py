"""Which level is advised for an accuracy, in short and in full, and what all levels do on the second draw."""

from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np

from ...execution.results import Result
from ...metrics.statistics import wilson
from ...plotting.parts import Table, grouped, setting_of, table, where
from ...plotting.wording import listed
from ...schemas.columns import NAME, Column, number, percent
from .levels import ACCURACIES, FALLS, FIRST, SECOND, advised, changed, holds, misses, tally

ASKED = ACCURACIES[:2]  # on the first screen
EXAMPLE = "caryatid-isolated"  # a shipped scene
LEVEL = Column("level", setting_of)
COST = Column("CPU time [ms/s], median (range)", lambda row: _cost_in_words(row["cpu"]))
OTHER = Column("other outcomes or failed: all (away from a boundary)", "{changed} of {statues} ({away})")


def advised_levels(result: Result) -> tuple[Table, ...]:
    """Return the first screen's table of the levels to use; none without rows of levels."""
    if not where(result.rows, part="level"):
        return ()
    second = where(result.rows, part="level", draw=2)
    statues, upright = len({row["index"] for row in second}), _upright(second)
    rows = [row for accuracy in ASKED for row in _advised_rows(result, accuracy)]
    finest = "." if any(row["held"] for row in rows) else ": here the finest, as none passed on a first draw."
    lines = [
        {
            **members[0],
            "missed on": "; ".join(
                f"{percent(row['accuracy'], 1)}: {_missed(row)} (at most {_most(row)})" for row in members
            ),
        }
        for members in grouped(rows, "engine", "level").values()
    ]
    return (
        table(
            f"Which level to use{finest} It was tested on {statues} other random statues; {upright} stay upright. An "
            "accuracy is missed if the outcome is not the model's, or if the error of peak tilt (over the slenderness) "
            f"or of base displacement exceeds it. ✓: it is missed on {percent(SECOND, 1)} or fewer of the {upright}, "
            "and no outcome changes away from an outcome boundary; ✗: otherwise. At most: the upper 95 % limit. CPU "
            "times (of runs side by side) are per simulated second",
            lines,
            Column("accuracy, missed on", "missed on"),
            NAME,
            LEVEL,
            COST,
            Column("command, for example", lambda row: row["command"].replace("SCENE", EXAMPLE)),
        ),
    )


def at_a_glance(result: Result) -> tuple[str, str]:
    """Return how often the levels to use miss `ASKED`, and what the misses are; "" without rows of levels."""
    answer, details, told = [], [], set()
    for accuracy in ASKED if where(result.rows, part="level") else ():
        rows, share = [*_advised_rows(result, accuracy)], percent(accuracy, 1)
        names = [(row["engine"], setting_of(row)) for row in rows]
        missed = listed(
            [
                f"{_missed(row)} ({name[0] if name in told else ', '.join(name)})"
                for row, name in zip(rows, names, strict=True)
            ]
        )
        told |= {*names}
        passes = "" if any(holds(row, SECOND) for row in rows) else ", and no level tested keeps it"
        answer.append(f"{share} accuracy is missed on {missed} of the random statues that stay upright{passes}.")
        near = listed([f"{row['missed_near']} of {row['missed']} ({row['engine']})" for row in rows])
        details.append(f"Of the misses of {share}, {near} are near an outcome boundary.")
    if answer:
        details += [
            f"✓: {percent(SECOND, 1)} or fewer; the rule stands at the table, and was fixed in advance.",
            *_at_defaults(result),
        ]
    return " ".join(answer), " ".join(details)


def _at_defaults(result):
    """Yield a sentence on the variants' own levels, with which the other studies are run."""
    rows = [
        (variant, tally(_row(result, variant, variant["default"])[1], ASKED[0]))
        for variant, levels in _levels(result)
        if variant["default"] in levels
    ]
    missed = [
        f"{counts['missed']} of {counts['upright']} ({variant['engine']}, "
        f"{setting_of({**variant, 'level': variant['default']})})"
        for variant, counts in rows
    ]
    if missed:
        yield (
            "Restitution, outcomes and real blocks use the levels that tuned variants take unless told otherwise. At "
            f"these, {percent(ASKED[0], 1)} is missed on {listed(missed)}."
        )


def _missed(row):
    """Return on how many of the statues that stay upright an accuracy is missed, and a mark of whether that passes."""
    return f"{row['missed']} of {row['upright']} {'✓' if holds(row, SECOND) else '✗'}"


def _most(row):
    """Return the upper 95 % limit of that share."""
    return percent(wilson(row["missed"], row["upright"])[1]) if row["upright"] else "–"


def missed_at_levels(result: Result) -> dict[tuple[str, float], tuple[int, int]]:
    """Return {(engine, level): (statues that stay upright on which `ASKED[-1]` is missed, all of these)}."""
    counts = {(row["engine"], row["level"]): row["by"][ASKED[-1]] for row in _all_rows(result)}
    return {level: (count["missed"], count["upright"]) for level, count in counts.items()}


def _upright(rows):
    """Return how many statues stay upright in the model."""
    return len({row["index"] for row in rows if row["model_outcome"] != FALLS})


def level_tables(result: Result) -> tuple[Table, ...]:
    """Return the tables of the advised levels and of all levels on the second draw; none without rows of levels."""
    if not where(result.rows, part="level"):
        return ()
    second = where(result.rows, part="level", draw=2)
    statues, upright = len({row["index"] for row in second}), _upright(second)
    return (
        table(
            f"Which level of a tuned variant to use, tested on {statues} random statues. An accuracy is kept if the "
            "outcome is the model's and the errors of peak tilt (over the slenderness) and of peak base displacement "
            "are within it. The rule was fixed in advance. On a first draw, the coarsest level is chosen that misses "
            f"the accuracy on at most {percent(FIRST, 1)} of the statues that stay upright. On this second draw it "
            f"passes if it misses on at most {percent(SECOND, 1)} of the {upright} that stay upright and changes no "
            "outcome away from an outcome boundary of the model. CPU times depend on the machine",
            [row for accuracy in ACCURACIES for row in _advised_rows(result, accuracy)],
            Column("accuracy", lambda row: percent(row["accuracy"], 1)),
            NAME,
            LEVEL,
            Column("passes", lambda row: row["verdict"]),
            Column(
                "missed (share; 95 % upper limit), of these near a boundary",
                lambda row: _missed_in_words(row, bound=True),
            ),
            OTHER,
            Column("overturning boundaries within it", lambda row: row["edges"]),
            COST,
            Column("command", "command"),
        ),
        table(
            "All levels on the same statues: on how many of those that stay upright each accuracy is missed, near an "
            "outcome boundary or not",
            _all_rows(result),
            NAME,
            LEVEL,
            *(Column(percent(accuracy, 1), partial(_missed_at, accuracy)) for accuracy in ACCURACIES),
            OTHER,
            COST,
        ),
    )


def alarms(result: Result) -> Table:
    """Return the table of runs that say they are too coarse, beside those that miss `ACCURACIES[0]`, by draw."""
    rows = []
    for draw in (1, 2):
        runs = [row for row in where(result.rows, part="level", draw=draw) if row["outcome"] != "failed"]
        counts = {(bad, warned): 0 for bad in (True, False) for warned in (True, False)}
        for row in runs:
            numbers = row["model_outcome"] != FALLS and misses(row, ACCURACIES[0])
            counts[changed(row) or numbers, row["warned"]] += 1
        rows.append({"draw": draw, "runs": len(runs), "counts": counts})
    return table(
        "Do engines warn that a run is too coarse? A run misses the accuracy if its outcome is another or its peaks "
        f"are off by more than {percent(ACCURACIES[0], 1)}. The limit of the warning was chosen on the first draw",
        [row for row in rows if row["runs"]],
        Column("draw", "draw"),
        Column("runs that did not fail", "runs"),
        Column("false alarms, of runs that keep the accuracy", lambda row: _alarms_in_words(row["counts"], False)),
        Column("no warning, of runs that miss it", lambda row: _alarms_in_words(row["counts"], True)),
    )


def _alarms_in_words(counts, bad):
    """Words on how many runs are (not) `bad`, and say the opposite."""
    wrong, size = counts[bad, not bad], counts[bad, True] + counts[bad, False]
    return f"{wrong} of {size}" + (f" ({percent(wrong / size)})" if size else "")


def _levels(result):
    """Yield (settings of a variant that has rows of levels, its levels from coarse to fine, the order of its rows)."""
    for (engine, name), rows in grouped(where(result.rows, part="level"), "engine", "variant").items():
        (variant,) = where(result.settings["variants"], engine=engine, variant=name)
        yield variant, list(dict.fromkeys(row["level"] for row in rows))


def _row(result, variant, level, draw=2):
    """Runs of a level on a draw, with what names the level and costs."""
    runs = where(result.rows, part="level", engine=variant["engine"], level=level, draw=draw)
    cpu = [row["cpu_per_second"] for row in runs if "cpu_per_second" in row]
    names = {key: variant[key] for key in ("engine", "variant", "parameter")}
    return {**names, "level": level, "cpu": cpu}, runs


def _all_rows(result):
    """Yield a row for each level on the second draw."""
    for variant, levels in _levels(result):
        for level in levels:
            row, runs = _row(result, variant, level)
            by = {accuracy: tally(runs, accuracy) for accuracy in ACCURACIES}
            yield {**row, **by[ACCURACIES[0]], "by": by}


def _advised_rows(result, accuracy):
    """Yield a row for the level of each engine that the first draw chooses for an accuracy."""
    for variant, levels in _levels(result):
        level, held = advised(where(result.rows, part="level", engine=variant["engine"], draw=1), levels, accuracy)
        row, runs = _row(result, variant, level)
        counts = tally(runs, accuracy)
        shifts = where(result.rows, part="level shift", engine=variant["engine"], level=level)
        within = sum(shift["shift"] is not None and abs(shift["shift"]) <= accuracy for shift in shifts)
        yield {
            **row,
            **counts,
            "accuracy": accuracy,
            "edges": f"{within} of {len(shifts)}" if shifts else "not searched for",
            "verdict": _verdict(counts, held),
            "held": held,
            "command": f"rocking run SCENE --engine {row['engine']} --set {row['parameter']}={level:g}",
        }


def _verdict(counts: Mapping[str, Any], held: bool) -> str:
    """Return whether a level passes, in words."""
    words = "yes" if holds(counts, SECOND) else "no"
    return words if held else f"{words}; the finest level, as none held on the first draw"


def _missed_at(accuracy, row):
    return _missed_in_words(row["by"][accuracy])


def _missed_in_words(counts, bound=False):
    missed, upright = counts["missed"], counts["upright"]
    if not upright:
        return "–"
    words = f"{missed} of {upright} ({percent(missed / upright)}"
    return f"{words}; {percent(wilson(missed, upright)[1])}), {counts['missed_near']}" if bound else f"{words})"


def _cost_in_words(cpu):
    if not cpu:
        return "–"
    middle, low, high = (number(1e3 * value, 2) for value in (np.median(cpu), min(cpu), max(cpu)))
    return f"{middle} ({low} to {high})"
