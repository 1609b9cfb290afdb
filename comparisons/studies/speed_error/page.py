"""The page of the speed-error study: the error of each level, and its CPU time.

Each level that was run gives one row for each error. From these rows follow the cost at an equal error, what the
report's first screen says of it, and the figures and tables of the page.
"""

import math
import statistics
from collections.abc import Iterable
from typing import Any

import numpy as np
import numpy.typing as npt

from engines import ENGINES

from ...execution.by_solver import timed_apart
from ...execution.results import Result
from ...metrics.scripts import NAME as SCRIPT
from ...plotting.figures import Series, beside, lines, mains
from ...plotting.glance import Curve, Glance
from ...plotting.parts import (
    COST,
    Head,
    Judgement,
    Mark,
    Page,
    Table,
    cheapest,
    grouped,
    kept_from,
    setting_of,
    table,
    where,
)
from ...plotting.wording import listed
from ...schemas.columns import NAME, Column, Row, number, percent, short
from ...schemas.columns import NAME as SOLVER
from .study import COLUMNS, NEEDED, PLAIN

# errors of integrators alone; the last is the smallest drawn
FINE, FINE_LEVELS, FINEST = "horizon_tilt", (1e-6, 1e-9, 1e-12), 1e-16
KERNEL = "analytic, kernel"
# Errors shown of a scene: of the first line whose first error it has, all that it has. All are numbers without a unit.
SHOWN = (("boundary_shift", "peak_tilt"), ("restitution", "peak_tilt"), ("peak_displacement",), (FINE,))
MEASURES = {
    "restitution": "error of restitution, rms [-]",
    "peak_tilt": "error of peak tilt over slenderness [-]",
    "peak_displacement": "error of peak displacement [-]",
    "boundary_shift": "error of overturning boundary [-]",
    FINE: "error of |tilt| at the horizon over slenderness [-]",
}
WANTED = (1e-2, 1e-3, 1e-4)  # errors at which costs are compared
ASKED = 1e-3
PEAK, BOUNDARY = "peak_tilt", "boundary_shift"
CPU = COLUMNS["cpu_seconds"]
TIMES = "cpu_seconds", "cpu_per_second", "cpu_per_step"
NOISE = 95  # percentile over the levels, see `noise`
NOT_REACHED = Mark("not reached", "none")
APART = "timed apart"  # on another processor, or with the code of another commit, than the model
SHORT = {KERNEL: "analytic model", "time-stepping": "our time stepping"}


def levels_run(result: Result) -> list[dict[str, Any]]:
    """Return the rows of all solvers at their levels, one for each error shown.

    They also have name, title of the scene, measure and error. principal: whether the error is the first of its scene.

    CPU times are those of the fastest round, because whatever else the machine does only adds to them (Chen, Revels
    2016, Robust benchmarking in noisy environments). The error is None where the run failed, missed impacts or found no
    boundary.
    """
    scenes = result.settings["scenes"]
    return [
        {
            **row,
            **_fastest_round(row),
            "name": NAME.of(row) + (", Bouc-Wen" if row["law"] == "bouc-wen" else ""),
            "title": scenes[row["scene"]]["title"],
            "measure": measure,
            "principal": not place,
            "error": None if row["failure"] or row["lost"] else row["errors"].get(measure),
        }
        for row in where(result.rows, part="work-precision")
        for place, measure in enumerate(measures_of(scenes[row["scene"]]))
    ]


def _fastest_round(row):
    """CPU times of the fastest round."""
    share = row["cpu_low"] / row["cpu_seconds"] if "cpu_seconds" in row else None
    return {key: row[key] * share for key in TIMES if share and row.get(key)}


def measures_of(scene: dict[str, Any]) -> list[str]:
    """Return the errors shown of a scene, the principal one first."""
    line = next(line for line in SHOWN if line[0] in scene["measures"])
    return [measure for measure in line if measure in scene["measures"]]


def as_needed(result: Result) -> list[dict[str, Any]]:
    """Return the rows of `levels_run` in which no more is modelled than the scene needs."""
    return [row for row in where(levels_run(result), model=NEEDED) if row["law"] != "bouc-wen"]


def passing(rows: Iterable[dict[str, Any]], level: float) -> dict[str, Row]:
    """Return {name: its cheapest row that keeps an error}, cheapest first.

    All finer levels of the solver must keep the error too. rows: those of one scene and one measure. level: the error.
    """
    return cheapest(rows, "name", lambda row: _within(row, level), CPU.of)


def _within(row, error):
    """Return whether a row has an error, and keeps the given one."""
    return row["error"] is not None and row["error"] <= error


def level_costs(result: Result) -> dict[str, dict[tuple[str, str], dict[float, float]]]:
    """Return {solver: {(scene, measure): {error: CPU time [s/s] of the cheapest level that keeps it}}}.

    All finer levels must keep the error too. The errors are those of `WANTED` that are reached; the scenes of the
    problems A and B are left out.
    """
    costs: dict[str, dict[tuple[str, str], dict[float, float]]] = {}
    for (scene, measure), rows in grouped(as_needed(result), "scene", "measure").items():
        if measure != FINE:
            for row in rows:
                costs.setdefault(row["name"], {}).setdefault((scene, measure), {})
            for error in WANTED:
                for name, row in passing(rows, error).items():
                    costs[name][scene, measure][error] = row["cpu_per_second"]
    return costs


def equal_cost_tables(result: Result) -> list[Table | None]:
    """Return a table for each error: what it costs every solver in every scene."""
    costs, scenes, apart = level_costs(result), result.settings["scenes"], timed_apart(result)
    places = list(dict.fromkeys(place for by_place in costs.values() for place in by_place))

    def cell(place, error):
        model = costs.get(KERNEL, {}).get(place, {}).get(error)

        def text(row):
            if place not in row["costs"]:
                return "–"
            if (cost := row["costs"][place].get(error)) is None:
                return "not reached"
            over = f" ({ratio_words(cost / model)} ×)" if model and row["name"] != KERNEL else ""
            over = f" ({APART})" if row["name"].split(", ")[0] in apart else over
            return f"{number(1e3 * cost, 2)}{over}"

        return Column(f"{scenes[place[0]]['title']}: {MEASURES[place[1]].removesuffix(' [-]')}", text)

    return [
        table(
            "CPU time per simulated second [ms] (over the model’s) of the cheapest level whose error, like that of all "
            f"finer levels, is at most {percent(error, 1)}",
            [{"name": name, "costs": by_place} for name, by_place in costs.items()],
            Column("solver", "name"),
            *(cell(place, error) for place in places),
        )
        for error in WANTED
    ]


def judgements(result: Result) -> tuple[Judgement, ...]:
    """Judge CPU time over the analytic model's at an equal error, by (engine, variant); empty without that scene."""
    cheapest_rows, apart, marks = keeping(result, ASKED), timed_apart(result), {}
    for name, *pair in (
        grouped(_main_scene_rows(result), "name", "engine", "variant") if KERNEL in cheapest_rows else ()
    ):
        ratio = (
            name in cheapest_rows and cheapest_rows[name]["cpu_per_second"] / cheapest_rows[KERNEL]["cpu_per_second"]
        )
        if name in {NAME.of(variant) for variant in result.settings["variants"]}:
            mark = Mark(f"{ratio_words(ratio)} ×", "none", value=ratio) if ratio else NOT_REACHED
            marks[tuple(pair)] = Mark(APART, "none", apart[pair[0]]) if ratio and pair[0] in apart else mark
    heading = f"CPU time over the analytic model's for a peak tilt within {percent(ASKED, 1)}, isolated rocking"
    return (Judgement(heading, marks, COST),) if marks else ()


def ratio_words(ratio: float) -> str:
    """Return a ratio of CPU times in two digits, more than which their scatter does not allow."""
    return number(float(f"{ratio:.2g}"), 2)


def level_words(row: Row) -> str:
    """Return the accuracy parameter of a row and its level with its unit, in words."""
    return setting_of(row) if row["parameter"] else "as written"


def glance(result: Result) -> Glance | None:
    """Return the curves of the report's first screen; None without the scene `PLAIN`."""
    rows = _main_scene_rows(result)
    if not rows:
        return None
    return Glance(
        says={"cost": at_a_glance(result)},
        levels=tuple((row["engine"], row["level"]) for row in reached(result)),
        curves=tuple(_curves(result, rows)),
        scene=result.settings["scenes"][PLAIN]["title"],
    )


def _main_scene_rows(result):
    """Rows of the scene in which engines are compared, with the error of their peak tilt."""
    return where(as_needed(result), scene=PLAIN, measure=PEAK)


def _curves(result, rows):
    """Yield one curve for every engine's main variant and defaults, for every script, and for every other solver."""
    listed = {NAME.of(settings): settings for settings in result.settings["variants"]}
    main, apart = mains(result.settings["variants"]), timed_apart(result)
    for (name_of_curve, engine, variant), levels in grouped(rows, "name", "engine", "variant").items():
        tier = listed[name_of_curve]["tier"] if name_of_curve in listed else ""
        if name_of_curve in listed and tier != "defaults" and main[engine] != variant:
            continue
        names = {"tuned": f"{engine}, tuned", "defaults": f"{engine}, defaults"}
        name = names.get(tier, f"{engine}, script" if variant == SCRIPT else SHORT.get(name_of_curve, engine))
        name += f" ({APART})" if engine in apart else ""
        points = tuple(
            (row["cpu_per_second"], row["errors"]["peak_tilt"], not row["lost"], _tooltip(row))
            for row in levels
            if not row["failure"] and "peak_tilt" in row["errors"]
        )
        kind = tier or ("tuned" if engine in ENGINES else "model")
        yield Curve(name_of_curve, name, kind, engine in ENGINES and ENGINES[engine].subject, points)


def _tooltip(row):
    """Tooltip of a level: its error, its cost and its missed impacts."""
    lost = f", {row['lost']} impacts missed" if row["lost"] else ""
    error, cost = number(row["errors"]["peak_tilt"], 2), number(1e3 * row["cpu_per_second"], 2)
    return f"{row['name']}, {level_words(row)}: {error} in {cost} ms{lost}"


def keeping(result: Result, error: float) -> dict[str, Row]:
    """Return {solver: the row in `PLAIN` of its cheapest level that keeps an error}, cheapest first.

    All finer levels must keep the error too. The error is that of the peak tilt in `PLAIN` and of the overturning
    boundaries.
    """
    cheapest_levels, rows = {}, as_needed(result)
    judged = [*where(rows, scene=PLAIN, measure=PEAK), *where(rows, measure=BOUNDARY)]
    for (name,), members in grouped(judged, "name").items():
        by_scene = grouped(members, "scene")
        levels_kept = [
            {row["level"] for row in kept_from(scene_rows, lambda row: _within(row, error))}
            for scene_rows in by_scene.values()
        ]
        levels = [row for row in by_scene.get((PLAIN,), ()) if all(row["level"] in levels for levels in levels_kept)]
        if levels:
            cheapest_levels[name] = min(levels, key=lambda row: row["cpu_per_second"])
    return dict(sorted(cheapest_levels.items(), key=lambda item: item[1]["cpu_per_second"]))


def times(result: Result) -> str:
    """Return CPU times of tuned subject engines over the model's at the error `ASKED`, in words.

    For example "94 (a) and 200 (b) times the analytic model’s CPU time"; "" where none reaches the error.
    """
    ratios = [f"{ratio_words(cost / model)} ({engine})" for engine, cost, model in _costs_at_asked(result)]
    return f"{listed(ratios)} times the analytic model’s CPU time" if ratios else ""


def at_a_glance(result: Result) -> tuple[str, str]:
    """Return the CPU times at the error `ASKED`, and further sentences; "" where none reaches it."""
    costs = _costs_at_asked(result)
    if not costs:
        return "", ""
    levels = listed([f"{level_words(row)} ({row['engine']})" for row in reached(result)])
    engine_costs = listed([f"{number(1e3 * cost, 2)} ms ({engine})" for engine, cost, _ in costs])
    over = listed([ratio_words(cost / model) for _, cost, model in costs])
    alike = max(cost for _, cost, _ in costs) <= noise(result) * min(cost for _, cost, _ in costs)
    answer = (
        f"in one isolated scene, a peak tilt within {percent(ASKED, 1)} of the slenderness takes tuned engines "
        f"{engine_costs} of CPU time per simulated second: about {over} times the {number(1e3 * costs[0][2], 2)} ms of "
        "the analytic model."
    )
    details = [f"Levels: {levels}.", *_elsewhere(result)]
    if alike and len(costs) > 1:
        details.append(
            f"Measured times vary by a factor of {number(noise(result))}, so that the engines are not shown to "
            "differ in cost."
        )
    scripts = [
        f"{number(1e3 * row['cpu_per_second'], 2)} ms ({row['engine']}, error {percent(row['error'])})"
        for row in _main_scene_rows(result)
        if row["variant"] == SCRIPT and row["error"] is not None
    ]
    if scripts:
        details.append(f"The scripts that rocking script writes take {listed(scripts)}.")
    return answer, " ".join(details)


def _elsewhere(result):
    """Yield a sentence on the other scenes in which no level reaches the error `ASKED`."""
    others = [
        {*passing(rows, ASKED)}
        for (scene, measure), rows in grouped(as_needed(result), "scene", "measure").items()
        if measure == PEAK and scene != PLAIN
    ]
    unreached = {row["engine"]: sum(NAME.of(row) not in names for names in others) for row in reached(result)}
    if any(unreached.values()):
        counts = listed([f"{count} ({engine})" for engine, count in unreached.items()])
        yield f"In {counts} of {len(others)} other scenes, close to overturning, no level reaches it."


def _costs_at_asked(result):
    """List (engine, CPU time, the model's) of tuned subject engines that reach the error `ASKED`.

    Engines timed apart are left out.
    """
    cheapest_rows, apart = keeping(result, ASKED), timed_apart(result)
    model = cheapest_rows.get(KERNEL)
    return [
        (row["engine"], row["cpu_per_second"], model["cpu_per_second"])
        for row in reached(result)
        if model and row["engine"] not in apart
    ]


def reached(result: Result) -> list[Row]:
    """Return the rows of `keeping` at the error `ASKED` for tuned main variants of subject engines."""
    cheapest_rows, main = keeping(result, ASKED), mains(result.settings["variants"])
    return [
        cheapest_rows[NAME.of(variant)]
        for variant in where(result.settings["variants"], tier="tuned")
        if ENGINES[variant["engine"]].subject
        and main[variant["engine"]] == variant["variant"]
        and NAME.of(variant) in cheapest_rows
    ]


def noise(result: Result) -> float:
    """Return the factor below which two costs are not distinguished.

    It is the `NOISE` percentile, over all levels, of the CPU time of the median round over that of the fastest. Without
    its fastest round the cost of a level would be higher by this factor at most.
    """
    rows = where(result.rows, part="work-precision")
    ratios = [row["cpu_seconds"] / row["cpu_low"] for row in rows if "cpu_seconds" in row]
    return float(np.percentile(ratios or [1], NOISE))


LEVELS = (1e-2, 1e-3, 1e-4, 1e-5)  # errors in the tables of costs
DRAWN, ROUNDING = 1e-9, 1e-13  # errors below the first are drawn there; those below the second give no order
# (scene, error) of the figure on the report's first page; its first screen has that of the peak tilt
FIRST = ((PLAIN, "restitution"), ("near-overturning", "boundary_shift"))
PANELS = {
    "restitution": "restitution",
    "peak_tilt": "peak tilt",
    "peak_displacement": "displacement",
    "boundary_shift": "amplitude",
    FINE: "tilt",
}

NAME_COLUMN = Column("solver", "name")
SCENE = Column("scene", "title")


def page(result: Result) -> Page:
    """Return the page of a result."""
    rows_by_error = levels_run(result)
    principal_rows, rows = where(rows_by_error, principal=True), as_needed(result)
    errors = grouped(rows, "scene", "measure")
    first = [key for key in errors if key in FIRST] or list(errors)[-1:]
    others = [key for key in errors if key not in first]
    coarse, usual, fine = equal_cost_tables(result)
    return Page(
        _title(result),
        (
            "Every solver is run at several levels of its accuracy parameter. Error and CPU time come from the same "
            "runs. The cost at a given error is that of the cheapest level that keeps it, provided that all finer "
            f"levels keep it too. Costs within a factor of {number(noise(result))} are not distinguished."
            + "".join(f" {engine} was timed {why}: no ratio is given." for engine, why in timed_apart(result).items()),
        ),
        first=(_figure([row for key in first for row in errors[key]], CPU, MAIN_CAPTION, rows, _leads(result)), usual),
        more=(
            coarse,
            fine,
            Head("The other scenes"),
            _figure([row for key in others if key[1] != FINE for row in errors[key]], CPU, CAPTION, rows),
            _figure([row for key in others if key[1] == FINE for row in errors[key]], CPU, FINE_CAPTION, rows),
            Head("The cheapest level of each solver"),
            *(_costs(result, members) for members in errors.values()),
            _without_error(principal_rows),
            Head("Step and order"),
            _figure(rows, COLUMNS["step"], "Mean step: simulated time over steps.", rows),
            *(
                _orders(measure, members, result.settings["scenes"])
                for (measure,), members in grouped(rows, "measure").items()
            ),
            table(
                "Cost over all scenes and levels, lowest to highest",
                [{"name": name, "rows": members} for (name,), members in grouped(rows, "name").items()],
                NAME_COLUMN,
                Column("CPU time per simulated second [s/s]", lambda row: _range(row["rows"], "cpu_per_second", 1)),
                Column("CPU time per step [µs]", lambda row: _range(row["rows"], "cpu_per_step", 1e6)),
            ),
            *_more_than_needed(result, principal_rows),
        ),
        how=_how(result, principal_rows),
        evidence=tuple(
            (
                f"{row['name']} at {level_words(row)}, {row['title']}: {row['failure']['reason']}",
                row["failure"].get("message", ""),
            )
            for row in principal_rows
            if row["failure"]
        ),
    )


MAIN_CAPTION = (
    "Lower left is better. Coloured: main variants, scripts as written (open marks) and the first variant of each "
    "other solver, if they keep an error of 0.001 at some level and at all finer ones. Grey: all others; the pointer "
    "shows their names. Levels that failed, missed impacts or found no boundary have no error and are not drawn. "
    "Errors below 10⁻⁹ are drawn at 10⁻⁹."
)
CAPTION = (
    "Lower left is better. Coloured: solvers that keep an error of 0.001 at some level and at all finer ones. Grey: "
    "the others; the pointer shows their names. Levels that failed, missed impacts or found no boundary have no error "
    "and are not drawn; a table lists them. Errors below 10⁻⁹ are drawn at 10⁻⁹."
)

FINE_CAPTION = (
    "Integrators alone. Lower left is better. The references of problems A (a free block) and B (a block under a "
    "pulse) have 30 digits. All integrators solve the same two equations and are set up for speed. scipy restarts at "
    "each impact; it runs without classes, and its first step after an impact spans a short hop at once."
)


def _assisted(result):
    """Names of variants whose adapter applies the impact."""
    return {SOLVER.of(variant) for variant in where(result.settings["variants"], applies_impact=True)}


def _title(result):
    """Title of the page: what the error `ASKED` costs subject engines."""
    place = f"Cost against error: a peak tilt within {percent(ASKED, 1)}"
    if not (cost := times(result)):
        return f"{place} is reached by {f'engines {APART}' if reached(result) else 'no subject engine'}"
    return f"{place} takes {cost}"


def _panel(row):
    """Title of a row's panel; no two panels have the same."""
    return f"{row['title'].replace(' boundary', '')}: {PANELS.get(row['measure'], row['measure'])}"


def _leads(result):
    """Pairs (engine, variant) of main variants, of scripts, and of the first variant of each other solver."""
    main_variants = mains([*result.settings["variants"], *as_needed(result)])
    return [*main_variants.items(), *((engine, SCRIPT) for engine in main_variants)]


def _figure(rows, x, caption, like, leads=()):
    """Figure of error over x, a panel for each scene; scenes of one kind of error share their axes.

    leads: the (engine, variant) that may have a colour, in their order; without any, all may.
    """
    coloured = {
        (*key, name)
        for key, members in grouped(rows, "scene", "measure").items()
        for name, row in passing(members, ASKED).items()
        if not leads or (row["engine"], row["variant"]) in leads
    }
    ranks = {pair: rank for rank, pair in enumerate(leads)}
    like = sorted(like, key=lambda row: ranks.get((row["engine"], row["variant"]), len(ranks)))
    figures = [
        lines(
            [row for row in members if row["error"] is not None],
            x,
            Column(MEASURES[measure], lambda row: max(row["error"], FINEST if row["measure"] == FINE else DRAWN)),
            caption,
            panel=_panel,
            series=Series(
                grey=lambda row: (row["scene"], row["measure"], row["name"]) not in coloured,
                like=like,
                says=lambda row: f"{row['name']}, {level_words(row)}: {number(row['error'], 2)} in {CPU.text(row)} s",
            ),
            log="xy",
        )
        for (measure,), members in grouped(rows, "measure").items()
    ]
    return beside(*figures)


def _costs(result, rows):
    """Table of the CPU time at which each solver keeps each error in one scene."""
    levels = FINE_LEVELS if rows[0]["measure"] == FINE else LEVELS
    by_level = {level: passing(rows, level) for level in levels}
    assisted = _assisted(result)

    def cell(level):
        cheapest_rows = by_level[level]

        def text(row):
            if (best := cheapest_rows.get(row["name"])) is None:
                return None
            fine = rows[0]["measure"] == FINE and KERNEL in cheapest_rows  # other errors have tables at an equal error
            ratio = f"{ratio_words(CPU.of(best) / CPU.of(cheapest_rows[KERNEL]))} ×; " if fine else ""
            return f"{number(1e3 * CPU.of(best), 2)} ({ratio}{level_words(best)})"

        return Column(f"≤ {short(level)}", text)

    return table(
        f"{rows[0]['title']}: CPU time [ms] to keep the {MEASURES[rows[0]['measure']]}",
        [
            {"name": name}
            for name in dict.fromkeys(name for cheapest_rows in by_level.values() for name in cheapest_rows)
        ],
        Column("solver", lambda row: row["name"] + (" (assisted)" if row["name"] in assisted else "")),
        *map(cell, levels),
    )


def _without_error(rows):
    """Table of levels that failed, missed impacts or found no boundary, which figures and tables of cost leave out."""
    counted = []
    for (name, model, title, measure), members in grouped(rows, "name", "model", "title", "measure").items():
        sound = [row for row in members if not row["failure"]]
        counted.append(
            {
                "name": name if model == NEEDED else f"{name}: {model}",
                "title": title,
                "all": len(members),
                "failed": len(members) - len(sound),
                "lost": sum(bool(row["lost"]) for row in sound),
                "none": sum(measure not in row["errors"] for row in sound) if measure == "boundary_shift" else 0,
            }
        )
    return table(
        "Levels that were run but have no error",
        [row for row in counted if row["failed"] or row["lost"] or row["none"]],
        NAME_COLUMN,
        SCENE,
        Column("levels [-]", "all"),
        COLUMNS["failed"],
        COLUMNS["lost"].called("impacts missed"),
        Column("no overturning boundary near the reference's [-]", "none"),
    )


def _orders(measure, rows, scenes):
    """Table of the observed order of each solver in each scene."""
    fits = {}
    for (name, scene), members in grouped(rows, "name", "scene").items():
        points = [(row["level"], row["error"]) for row in members if (row["error"] or 0) > ROUNDING]
        if len(points) >= 3:
            order, error = fit(*zip(*points, strict=True))
            words = f"{round(order, 2) + 0.0:.2f} ± {error:.2f}".replace("-", "−")  # no minus before 0.00
            fits.setdefault(name, dict.fromkeys(scene for (scene,) in grouped(rows, "scene")))[scene] = words
    return table(
        f"Observed order q ± its standard error: the {MEASURES[measure]} grows as the accuracy parameter to the power "
        "q. It is fitted to three levels or more whose error is above rounding",
        [{"name": name, **orders} for name, orders in fits.items()],
        NAME_COLUMN,
        *(Column(scenes[scene]["title"], scene) for (scene,) in grouped(rows, "scene")),
    )


def fit(x: npt.ArrayLike, y: npt.ArrayLike) -> tuple[float, float]:
    """Fit y ~ x^exponent by least squares of the logarithms; return (exponent, its standard error).

    x, y: three values or more each.
    """
    (slope, _), covariance = np.polyfit(np.log(x), np.log(y), 1, cov=True)
    return float(slope), math.sqrt(covariance[0, 0])


def _range(rows, key, unit):
    values = [unit * row[key] for row in rows if row.get(key)]
    return f"{number(min(values), 2)} – {number(max(values), 2)}" if values else None


def _more_than_needed(result, rows):
    """Tables of rows with another model or law, beside those of the same solver at the same level."""
    needed = {
        (row["scene"], row["engine"], row["variant"], row["level"]): row
        for row in where(rows, model=NEEDED)
        if row["law"] != "bouc-wen" and "cpu_seconds" in row
    }
    pairs = [
        {**row, "plain": needed[key], "ratio": CPU.of(row) / CPU.of(needed[key])}
        for row in rows
        for key in ((row["scene"], row["engine"], row["variant"], row["level"]),)
        if key in needed and row is not needed[key] and "cpu_seconds" in row
    ]
    laws = [
        {
            "name": SOLVER.of(members[0]),
            "title": members[0]["title"],
            "ratios": [row["ratio"] for row in members],
            **changes,
        }
        for (scene, _), members in grouped(where(pairs, law="bouc-wen"), "scene", "name").items()
        for changes in (result.settings["scenes"][scene]["bouc_wen"],)
    ]

    def error(row):
        lost = f" (missed: {row['lost']})" if row["lost"] else ""
        return number(row["errors"].get(row["measure"]), 2) + lost

    yield Head("More than the scene needs")
    yield table(
        "Scenes modelled with more than they need, beside the model needed, at the same level. Ratio of the two CPU "
        "times, and errors as in the tables above, with missed impacts in brackets",
        [row for row in pairs if row["model"] != NEEDED],
        COLUMNS["model"],
        NAME_COLUMN,
        Column("level", level_words),
        SCENE,
        Column("CPU time ratio [-]", "ratio", digits=3),
        Column("error of the model needed", lambda row: error(row["plain"])),
        Column("error with more", error),
    )
    yield table(
        "A Bouc-Wen bearing in place of the algebraic law: ratio of the CPU times at the same level, and how far it "
        "changes the peaks of the scene. That Bouc-Wen costs more is not confirmed here. The paper's own case, "
        "Bouc-Wen sub-stepped inside a time-stepping scheme, is not tested",
        laws,
        NAME_COLUMN,
        SCENE,
        Column("CPU time ratio, median [-]", lambda row: statistics.median(row["ratios"]), digits=3),
        Column("lowest [-]", lambda row: min(row["ratios"]), digits=3),
        Column("highest [-]", lambda row: max(row["ratios"]), digits=3),
        Column("peak displacement changed by", "peak_displacement", percent=True),
        Column("peak tilt changed by", "peak_tilt", percent=True),
    )


def _how(result, rows):
    same = sum(row["repeatable"] for row in rows)
    differing = sorted({row["name"] for row in rows if not row["repeatable"]})
    scenes = result.settings["scenes"].values()
    differences = [
        scene["reference_difference"].get(measure, 0.0) for scene in scenes for measure in measures_of(scene)
    ]
    machine, load = result.provenance["machine"], result.settings.get("load")
    beside = f" Other processes took at most {percent(max(load))} of its CPU time." if load else ""
    return (
        f"{result.settings['rounds']} fresh processes run one after the other, one round each. In each, every solver "
        "is warmed up and timed. A CPU time is that of the fastest round, without import, compilation and building of "
        f"the scene. For {NOISE} % of the levels, the median round took at most {number(noise(result))} times as "
        f"long as the fastest, so closer costs are not distinguished. Machine: {machine['processor']}, "
        f"{machine['logical_cores']} cores.{beside}",
        "References are computed by the kernel at its tightest tolerance. An independent solution by scipy differs "
        f"from them by at most {number(max(differences), 1)} in the errors shown. Solvers of the equations apply eq. "
        "(7) themselves, so under a motion their error of restitution is rounding. The errors of "
        f"{same} of {len(rows)} levels are the same bit for bit in every round"
        f"{'; the exceptions are of ' + ', '.join(differing) if differing else ''}.",
        "On a free base the largest tilt is that at the start, so the peak tilt has no error. Errors of the peak "
        "displacement and of the overturning boundary are relative. A boundary is searched for by six runs; each takes "
        "the amplitude at which, by the run before it, the block would just overturn.",
    )
