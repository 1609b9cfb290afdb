"""What an error costs: the levels that were run as one row for each error, the cost at an equal error, and what the
report's first screen says of it.
"""

import math
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from engines import ENGINES

from ...measuring.scripts import NAME as SCRIPT
from ...running.provenance import Result
from ...showing.figures import mains
from ...showing.glance import Curve, Glance
from ...showing.parts import (
    COST,
    NAME,
    UNITS,
    Column,
    Judgement,
    Mark,
    Row,
    Table,
    cheapest,
    grouped,
    kept_from,
    number,
    percent,
    short,
    table,
    where,
)
from ...showing.wording import listed
from .cases import NEEDED, PLAIN

FINE, FINE_LEVELS, FINEST = "horizon_tilt", (1e-6, 1e-9, 1e-12), 1e-16  # of integrators alone; the last is drawn
KERNEL = "analytic, kernel"
# What is shown of a scene: the errors of one line that it has, of the first line of which it has any. All are numbers
# without a unit.
SHOWN = (("boundary_shift",), ("restitution", "peak_tilt"), ("peak_displacement",), (FINE,))
MEASURES = {
    "restitution": "error of restitution, rms [-]",
    "peak_tilt": "error of peak tilt over slenderness [-]",
    "peak_displacement": "error of peak displacement [-]",
    "boundary_shift": "error of overturning boundary [-]",
    FINE: "error of |tilt| at the horizon over slenderness [-]",
}
WANTED = (1e-2, 1e-3, 1e-4)  # errors at which costs are compared
ASKED = 1e-3
JUDGED = ("peak_tilt", "boundary_shift")  # errors by which a level is recommended
CPU = Column("CPU time of a run [s]", "cpu_seconds")
TIMES = "cpu_seconds", "cpu_per_second", "cpu_per_step"
NOISE = 95  # percentile of the levels
SHORT = {KERNEL: "analytic model", "time-stepping": "our time stepping"}


def levels_run(result: Result) -> list[dict[str, Any]]:
    """The rows of all solvers at their levels, one for each error shown: with name, title of the scene, measure, error.

    CPU times are the least of the rounds, as what else the machine does only adds to them (Chen, Revels 2016, Robust
    benchmarking in noisy environments). The error is None where the run failed, missed impacts or found no boundary.
    principal: it is the scene's first.
    """
    scenes = result.settings["scenes"]
    return [
        {
            **row,
            **_least(row),
            "name": NAME.of(row) + (", Bouc-Wen" if row["law"] == "bouc-wen" else ""),
            "title": scenes[row["scene"]]["title"],
            "measure": measure,
            "principal": not place,
            "error": None if row["failure"] or row["lost"] else row["errors"].get(measure),
        }
        for row in where(result.rows, part="work-precision")
        for place, measure in enumerate(measures_of(scenes[row["scene"]]))
    ]


def _least(row):
    """Its CPU times, of the round that took least."""
    share = row["cpu_low"] / row["cpu_seconds"] if "cpu_seconds" in row else None
    return {key: row[key] * share for key in TIMES if share and row.get(key)}


def measures_of(scene: dict[str, Any]) -> list[str]:
    """The errors shown of a scene."""
    return next(found for line in SHOWN if (found := [measure for measure in line if measure in scene["measures"]]))


def as_needed(result: Result) -> list[dict[str, Any]]:
    """Those of `levels_run` in which no more is modelled than the scene needs."""
    return [row for row in where(levels_run(result), model=NEEDED) if row["law"] != "bouc-wen"]


def passing(rows: Iterable[dict[str, Any]], level: float) -> dict[str, Row]:
    """{name: the cheapest of its rows at which it and all finer ones keep an error}, cheapest first; of one scene and
    one measure."""
    return cheapest(rows, "name", lambda row: _within(row, level), CPU.of)


def _within(row, error):
    return row["error"] is not None and row["error"] <= error


def cost_at(rows: Sequence[dict[str, Any]], error: float) -> float | None:
    """CPU time [s/s] at which a solver has an error, between its levels (logarithmic): `rows`, from coarse to fine.

    Between the coarsest level from which on all keep the error and the one before it, if that has an error; that of the
    coarsest level itself where it is the first. None: not reached.
    """
    first = len(rows) - len(kept_from(rows, lambda row: _within(row, error)))
    if first == len(rows):
        return None
    fine = rows[first]
    if not first or rows[first - 1]["error"] is None:
        return fine["cpu_per_second"]
    coarse, least = rows[first - 1], 1e-17
    logs = [math.log(max(one, least)) for one in (coarse["error"], fine["error"], error)]
    share = (logs[0] - logs[2]) / (logs[0] - logs[1])
    return coarse["cpu_per_second"] ** (1 - share) * fine["cpu_per_second"] ** share


def equal_costs(result: Result) -> dict[str, dict[tuple[str, str], dict[float, float | None]]]:
    """{solver: {(scene, measure): {error: `cost_at` it}}} for the errors `WANTED`, of all scenes but the problems."""
    found: dict[str, dict[tuple[str, str], dict[float, float | None]]] = {}
    for (name, scene, measure), rows in grouped(as_needed(result), "name", "scene", "measure").items():
        if measure != FINE:
            found.setdefault(name, {})[scene, measure] = {error: cost_at(rows, error) for error in WANTED}
    return found


def equal_cost_tables(result: Result) -> list[Table | None]:
    """A table for each error: what it costs every solver in every scene."""
    costs, scenes = equal_costs(result), result.settings["scenes"]
    places = list(dict.fromkeys(place for some in costs.values() for place in some))

    def cell(place, error):
        model = costs.get(KERNEL, {}).get(place, {}).get(error)

        def text(row):
            if place not in row["costs"]:
                return "–"
            if (cost := row["costs"][place][error]) is None:
                return "not reached"
            over = f" ({number(cost / model, 2)} ×)" if model and row["name"] != KERNEL else ""
            return f"{number(1e3 * cost, 2)}{over}"

        return Column(f"{scenes[place[0]]['title']}: {MEASURES[place[1]].removesuffix(' [-]')}", text)

    return [
        table(
            f"CPU time per simulated second [ms] (over the model’s) at an error of {percent(error, 1)}, "
            "between levels; “not reached” at any level",
            [{"name": name, "costs": some} for name, some in costs.items()],
            Column("solver", "name"),
            *(cell(place, error) for place in places),
        )
        for error in WANTED
    ]


def plain_costs(result: Result) -> dict[str, float | None]:
    """{solver: CPU time [s/s] at the error `ASKED` of the peak tilt in `PLAIN`}; None: not reached."""
    found = equal_costs(result)
    return {name: some[PLAIN, "peak_tilt"][ASKED] for name, some in found.items() if (PLAIN, "peak_tilt") in some}


def judgements(result: Result) -> tuple[Judgement, ...]:
    """CPU time over the analytic model's at an equal error, by (engine, variant); none without that scene."""
    pairs = {NAME.of(one): (one["engine"], one["variant"]) for one in result.settings["variants"]}
    costs = plain_costs(result)
    model = costs.get(KERNEL)
    marks = {
        pairs[name]: Mark("not reached", "none")
        if cost is None
        else Mark(f"{number(cost / model, 2)} ×", "none", value=cost / model)
        for name, cost in costs.items()
        if name in pairs and model
    }
    heading = f"CPU time over the analytic model's at {percent(ASKED, 1)} of peak tilt, isolated rocking"
    return (Judgement(heading, marks, COST),) if marks else ()


def level_words(row: Row) -> str:
    return f"{row['parameter'].replace('_', ' ')} {short(row['level'])}" if row["parameter"] else "as written"


def glance(result: Result) -> Glance | None:
    """The curves of the first screen's chart of costs, and the recommendation by accuracy; None without the scene."""
    rows = where(as_needed(result), scene=PLAIN, measure="peak_tilt")
    if not rows:
        return None
    return Glance(
        says={"cost": words} if (words := at_a_glance(result)) else {},
        curves=tuple(_curves(result, rows)),
        scene="an isolated block in an earthquake",
        advice=advice(result),
    )


def _curves(result, rows):
    """Of every solver once: engines' main variants and those as they come, scripts, and the other solvers."""
    listed = {NAME.of(one): one for one in result.settings["variants"]}
    main = mains(result.settings["variants"])
    for (who, engine, variant), some in grouped(rows, "name", "engine", "variant").items():
        tier = listed[who]["tier"] if who in listed else ""
        if who in listed and tier != "defaults" and main[engine] != variant:
            continue
        known = {"tuned": f"{engine}, tuned", "defaults": f"{engine}, defaults"}
        name = known.get(tier, f"{engine}, script" if variant == SCRIPT else SHORT.get(who, engine))
        points = tuple(
            (row["cpu_per_second"], row["errors"]["peak_tilt"], not row["lost"], _says(row))
            for row in some
            if not row["failure"] and "peak_tilt" in row["errors"]
        )
        kind = tier or ("tuned" if engine in ENGINES else "model")
        yield Curve(who, name, kind, engine in ENGINES and ENGINES[engine].subject, points)


def _says(row):
    lost = f", {row['lost']} impacts missed" if row["lost"] else ""
    error, cost = number(row["errors"]["peak_tilt"], 2), number(1e3 * row["cpu_per_second"], 2)
    return f"{row['name']}, {level_words(row)}: {error} in {cost} ms{lost}"


def advised(result: Result, error: float) -> dict[str, Row]:
    """{variant: the row in `PLAIN` of the cheapest level that keeps an error}, cheapest first: tuned variants, whose
    engine computes the impact; the error is that of the peak tilt there and of the overturning boundaries."""
    kinds = {NAME.of(one): one for one in result.settings["variants"]}
    able = {name for name, one in kinds.items() if one["tier"] == "tuned" and not one["applies_impact"]}
    rows = [row for row in as_needed(result) if row["name"] in able and row["measure"] in JUDGED]
    found = {}
    for (name,), some in grouped(rows, "name").items():
        by_scene = grouped(some, "scene")
        plain = by_scene.get((PLAIN,), ())
        kept = [{row["level"] for row in kept_from(one, lambda row: _within(row, error))} for one in by_scene.values()]
        levels = [row for row in plain if all(row["level"] in levels for levels in kept)]
        if levels:
            found[name] = min(levels, key=lambda row: row["cpu_per_second"])
    return dict(sorted(found.items(), key=lambda item: item[1]["cpu_per_second"]))


def advice(result: Result) -> Table | None:
    """The recommendation: for each accuracy the cheapest of the engines in question, and of the others if cheaper."""
    rows, spread = [], noise(result)
    for error in WANTED:
        found = advised(result, error)
        subjects = {name: row for name, row in found.items() if ENGINES[row["engine"]].subject}
        for name, row in list(subjects.items())[:1] or [("", None)]:
            rows.append([f"{percent(error, 1)}", *_advised(name, row, found, spread)])
    names = listed([name for name, engine in ENGINES.items() if engine.subject])
    heads = (
        "accuracy",
        "tuned variant",
        "level",
        "CPU time per simulated second",
        "cheaper engine",
        "script (its cost: chart)",
    )
    caption = (
        f"What to use of {names}: the cheapest level that, as all finer ones, keeps peak tilt and overturning boundary "
        "this accurate"
    )
    return Table(caption, heads, rows)


def _advised(name, row, found, spread):
    if row is None:
        return ["not reached", "–", "–", "–", "–"]
    cheaper = next(iter(found.items()))
    alike = row["cpu_per_second"] <= spread * cheaper[1]["cpu_per_second"]
    other = "none" if alike else f"{cheaper[0]}, {number(1e3 * cheaper[1]['cpu_per_second'], 2)} ms"
    script = f"rocking script {row['engine']} SCENE" if ENGINES[row["engine"]].script else "–"
    unit = UNITS.get(row["parameter"], "")
    level = f"{row['parameter'].replace('_', ' ')} {number(row['level'], 2)} {unit}".strip()
    return [name, level, f"{number(1e3 * row['cpu_per_second'], 2)} ms", other, script]


def times(result: Result) -> str:
    """CPU time of the engines in question, tuned, over the model's at the error `ASKED`: "94 (a) and 200 (b) times the
    analytic model’s CPU time"; "" where none reaches it."""
    told = [f"{number(cost / model, 2)} ({engine})" for engine, cost, model in _asked(result)]
    return f"{listed(told)} times the analytic model’s CPU time" if told else ""


def at_a_glance(result: Result) -> str:
    """The same in a sentence with the times themselves."""
    found = _asked(result)
    own = listed([f"{number(1e3 * cost, 2)} ms ({engine})" for engine, cost, _ in found])
    over = listed([number(cost / model, 2) for _, cost, model in found])
    return (
        f"tuned, a peak tilt within {percent(ASKED, 1)} of the slenderness takes {own} of CPU time per simulated "
        f"second (between levels), {over} times the analytic model’s {number(1e3 * found[0][2], 2)} ms."
        if found
        else ""
    )


def _asked(result):
    """(engine, CPU time, the model's) of the engines in question, tuned, that reach the error `ASKED`."""
    costs, main, found = plain_costs(result), mains(result.settings["variants"]), []
    for one in result.settings["variants"]:
        subject = ENGINES[one["engine"]].subject and main[one["engine"]] == one["variant"]
        if subject and one["tier"] == "tuned" and (cost := costs.get(NAME.of(one))) and costs.get(KERNEL):
            found.append((one["engine"], cost, costs[KERNEL]))
    return found


def noise(result: Result) -> float:
    """The factor below which two costs are not distinguished: of the median round over the least, without the largest.

    Had the round that took least not been run, the cost would be higher by this factor at most.
    """
    rows = where(result.rows, part="work-precision")
    known = [row["cpu_seconds"] / row["cpu_low"] for row in rows if "cpu_seconds" in row]
    return float(np.percentile(known or [1], NOISE))
