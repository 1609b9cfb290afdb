"""What is shown of the speed-error study."""

import math
import statistics

import numpy as np
import numpy.typing as npt

from ...measuring.scripts import NAME as SCRIPT
from ...running.age import timed_apart
from ...running.provenance import Result
from ...showing.figures import beside, lines, mains
from ...showing.parts import NAME as SOLVER
from ...showing.parts import Column, Head, Page, grouped, number, percent, short, table, where
from .cases import NEEDED, PLAIN
from .costs import (
    APART,
    ASKED,
    CPU,
    FINE,
    FINE_LEVELS,
    FINEST,
    KERNEL,
    MEASURES,
    NOISE,
    as_needed,
    equal_cost_tables,
    glance,
    judgements,
    level_words,
    levels_run,
    measures_of,
    noise,
    passing,
    reached,
    times,
)

__all__ = ["glance", "judgements", "page"]
LEVELS = (1e-2, 1e-3, 1e-4, 1e-5)  # of an error
DRAWN, ROUNDING = 1e-9, 1e-13  # errors below the first are drawn there, those below the second tell no order
# (scene, error) of the figure of the report's page; the first screen has that of the peak tilt
FIRST = (("free-rigid", "restitution"), (PLAIN, "restitution"), ("near-overturning", "boundary_shift"),
         ("near-overturning-jump", "boundary_shift"))  # fmt: skip
PANELS = {"restitution": "restitution", "peak_tilt": "peak tilt", "peak_displacement": "displacement",
          "boundary_shift": "amplitude", FINE: "tilt"}  # fmt: skip

NAME = Column("solver", "name")
SCENE = Column("scene", "title")


def page(result: Result) -> Page:
    shown = levels_run(result)
    every, rows = where(shown, principal=True), as_needed(result)
    errors = grouped(rows, "scene", "measure")
    first = [key for key in errors if key in FIRST] or list(errors)[-1:]
    others = [key for key in errors if key not in first]
    coarse, asked, fine = equal_cost_tables(result)
    return Page(
        _title(result),
        (
            "Every solver is run at several levels of its accuracy parameter. Error and CPU time come from the same "
            "runs. The cost of an error is that of the cheapest level that keeps it, if all finer levels keep it too. "
            f"Costs within a factor of {number(noise(result), 2)} are not distinguished."
            + "".join(f" {engine} was timed {why}: no ratio is given." for engine, why in timed_apart(result).items()),
        ),
        first=(_figure([row for key in first for row in errors[key]], CPU, MAIN_CAPTION, rows, _leads(result)), asked),
        more=(
            coarse,
            fine,
            Head("The other scenes"),
            _figure([row for key in others if key[1] != FINE for row in errors[key]], CPU, CAPTION, rows),
            _figure([row for key in others if key[1] == FINE for row in errors[key]], CPU, FINE_CAPTION, rows),
            Head("The cheapest level of each solver"),
            *(_costs(result, some) for some in errors.values()),
            _without_error(every),
            Head("Step and order"),
            _figure(rows, Column("mean step [s]", "step"), "Mean step: simulated time over steps.", rows),
            *(
                _orders(measure, some, result.settings["scenes"])
                for (measure,), some in grouped(rows, "measure").items()
            ),
            table(
                "Cost over all scenes and levels, lowest to highest",
                [{"name": name, "rows": some} for (name,), some in grouped(rows, "name").items()],
                NAME,
                Column("CPU time per simulated second [s/s]", lambda row: _range(row["rows"], "cpu_per_second", 1)),
                Column("CPU time per step [µs]", lambda row: _range(row["rows"], "cpu_per_step", 1e6)),
            ),
            *_more_than_needed(result, every),
        ),
        how=_how(result, every),
        evidence=tuple(
            (
                f"{row['name']} at {level_words(row)}, {row['title']}: {row['failure']['reason']}",
                row["failure"].get("message", ""),
            )
            for row in every
            if row["failure"]
        ),
    )


MAIN_CAPTION = (
    "Lower left is better. Coloured, where they keep 0.001 at a level and all finer ones: main variants, scripts as "
    "written (open) and the first of each other solver. Grey: the rest, named under the pointer. No error is given for "
    "levels that failed, missed impacts or found no boundary. Errors below 10⁻⁹ are drawn there."
)
CAPTION = (
    "Lower left is better. Coloured: solvers that keep 0.001 at a level and all finer ones. Grey: the others, named "
    "under the pointer. No error is given for levels that failed, missed impacts or found no boundary; the study’s "
    "page lists them. Errors below 10⁻⁹ are drawn there."
)

FINE_CAPTION = (
    "Integrators alone, left and low is better. Problems A (a free block) and B (a block under a pulse) have "
    "references of 30 digits. All integrate the same two equations, set up for speed: scipy without classes and with "
    "a first step of the length of the hop. scipy restarts at each impact."
)


def _assisted(result):
    """Names of variants whose adapter applies the impact."""
    return {SOLVER.of(variant) for variant in where(result.settings["variants"], applies_impact=True)}


def _title(result):
    place = f"Cost against error: {percent(ASKED, 1)} of peak tilt"
    if not (cost := times(result)):
        return f"{place} is reached by {f'engines {APART}' if reached(result) else 'no engine in question'}"
    return f"{place} takes {cost}"


def _panel(row):
    """The title of a panel: no two have one."""
    return f"{row['title'].replace(' boundary', '')}: {PANELS.get(row['measure'], row['measure'])}"


def _leads(result):
    """(engine, variant) of engines' main variants, of scripts, and of the first variant of each other solver."""
    found = mains([*result.settings["variants"], *as_needed(result)])
    return [*found.items(), *((engine, SCRIPT) for engine in found)]


def _figure(rows, x, caption, like, leads=()):
    """Error over x, a panel for each scene; scenes of one kind of error share their axes. leads: the solvers that may
    have a colour, in their order; none: all."""
    kept = {
        (*key, name)
        for key, some in grouped(rows, "scene", "measure").items()
        for name, row in passing(some, ASKED).items()
        if not leads or (row["engine"], row["variant"]) in leads
    }
    ranks = {pair: rank for rank, pair in enumerate(leads)}
    like = sorted(like, key=lambda row: ranks.get((row["engine"], row["variant"]), len(ranks)))
    figures = [
        lines(
            [row for row in some if row["error"] is not None],
            x,
            Column(MEASURES[measure], lambda row: max(row["error"], FINEST if row["measure"] == FINE else DRAWN)),
            caption,
            panel=_panel,
            grey=lambda row: (row["scene"], row["measure"], row["name"]) not in kept,
            log="xy",
            says=lambda row: f"{row['name']}, {level_words(row)}: {number(row['error'], 2)} in {CPU.text(row)} s",
            like=like,
        )
        for (measure,), some in grouped(rows, "measure").items()
    ]
    return beside(*figures)


def _costs(result, rows):
    levels = FINE_LEVELS if rows[0]["measure"] == FINE else LEVELS
    found = {level: passing(rows, level) for level in levels}
    assisted = _assisted(result)

    def cell(level):
        kept = found[level]

        def text(row):
            if (best := kept.get(row["name"])) is None:
                return None
            fine = rows[0]["measure"] == FINE and KERNEL in kept  # others are compared at an equal error
            ratio = f"{number(CPU.of(best) / CPU.of(kept[KERNEL]), 2)} ×; " if fine else ""
            return f"{number(1e3 * CPU.of(best), 2)} ({ratio}{level_words(best)})"

        return Column(f"≤ {short(level)}", text)

    return table(
        f"{rows[0]['title']}: CPU time [ms] to keep the {MEASURES[rows[0]['measure']]}",
        [{"name": name} for name in dict.fromkeys(name for kept in found.values() for name in kept)],
        Column("solver", lambda row: row["name"] + (" (assisted)" if row["name"] in assisted else "")),
        *map(cell, levels),
    )


def _without_error(every):
    """Levels that failed, missed impacts or found no boundary, which figures and tables of cost leave out."""
    counted = []
    for (name, model, title, measure), some in grouped(every, "name", "model", "title", "measure").items():
        sound = [row for row in some if not row["failure"]]
        counted.append(
            {
                "name": name if model == NEEDED else f"{name}: {model}",
                "title": title,
                "all": len(some),
                "failed": len(some) - len(sound),
                "lost": sum(bool(row["lost"]) for row in sound),
                "none": sum(measure not in row["errors"] for row in sound) if measure == "boundary_shift" else 0,
            }
        )
    return table(
        "Levels without an error, of those run",
        [row for row in counted if row["failed"] or row["lost"] or row["none"]],
        NAME,
        SCENE,
        Column("levels [-]", "all"),
        Column("failed [-]", "failed"),
        Column("impacts missed [-]", "lost"),
        Column("no overturning boundary near the reference's [-]", "none"),
    )


def _orders(measure, rows, scenes):
    fits = {}
    for (name, scene), some in grouped(rows, "name", "scene").items():
        known = [(row["level"], row["error"]) for row in some if (row["error"] or 0) > ROUNDING]
        if len(known) >= 3:
            order, error = fit(*zip(*known, strict=True))
            words = f"{round(order, 2) + 0.0:.2f} ± {error:.2f}".replace("-", "−")  # no minus before 0.00
            fits.setdefault(name, dict.fromkeys(scene for (scene,) in grouped(rows, "scene")))[scene] = words
    return table(
        f"Observed order q, ± its standard error: the {MEASURES[measure]} grows as the accuracy parameter to the power "
        "q; of three levels or more above rounding",
        [{"name": name, **orders} for name, orders in fits.items()],
        NAME,
        *(Column(scenes[scene]["title"], scene) for (scene,) in grouped(rows, "scene")),
    )


def fit(x: npt.ArrayLike, y: npt.ArrayLike) -> tuple[float, float]:
    """(exponent, its standard error) of y ~ x^exponent by least squares of the logarithms; three points or more."""
    (slope, _), covariance = np.polyfit(np.log(x), np.log(y), 1, cov=True)
    return float(slope), math.sqrt(covariance[0, 0])


def _range(rows, key, unit):
    values = [unit * row[key] for row in rows if row.get(key)]
    return f"{number(min(values), 2)} – {number(max(values), 2)}" if values else None


def _more_than_needed(result, every):
    """Rows with another model or law beside those of the same solver at the same level."""
    plain = {
        (row["scene"], row["engine"], row["variant"], row["level"]): row
        for row in where(every, model=NEEDED)
        if row["law"] != "bouc-wen" and "cpu_seconds" in row
    }
    pairs = [
        {**row, "plain": plain[key], "ratio": CPU.of(row) / CPU.of(plain[key])}
        for row in every
        for key in ((row["scene"], row["engine"], row["variant"], row["level"]),)
        if key in plain and row is not plain[key] and "cpu_seconds" in row
    ]
    laws = [
        {"name": SOLVER.of(some[0]), "title": some[0]["title"], "ratios": [row["ratio"] for row in some], **changes}
        for (scene, _), some in grouped(where(pairs, law="bouc-wen"), "scene", "name").items()
        for changes in (result.settings["scenes"][scene]["bouc_wen"],)
    ]

    def error(row):
        lost = f" (missed: {row['lost']})" if row["lost"] else ""
        return number(row["errors"].get(row["measure"]), 2) + lost

    yield Head("More than the scene needs")
    yield table(
        "A scene modelled with more than it needs, at the same level: ratio of CPU times, errors as in the tables "
        "above, missed impacts",
        [row for row in pairs if row["model"] != NEEDED],
        Column("modelled", "model"),
        NAME,
        Column("level", level_words),
        SCENE,
        Column("CPU time ratio [-]", "ratio", digits=3),
        Column("error of the model needed", lambda row: error(row["plain"])),
        Column("error with more", error),
    )
    yield table(
        "A Bouc-Wen bearing: CPU time over the algebraic law's at the same level; what it changes in the scene itself. "
        "That it costs more is not confirmed here; the paper's own case (sub-stepped inside a time-step scheme) is not "
        "tested",
        laws,
        NAME,
        SCENE,
        Column("CPU time ratio, median [-]", lambda row: statistics.median(row["ratios"]), digits=3),
        Column("lowest [-]", lambda row: min(row["ratios"]), digits=3),
        Column("highest [-]", lambda row: max(row["ratios"]), digits=3),
        Column("peak displacement changed by", "peak_displacement", percent=True),
        Column("peak tilt changed by", "peak_tilt", percent=True),
    )


def _how(result, every):
    same = sum(row["repeatable"] for row in every)
    differing = sorted({row["name"] for row in every if not row["repeatable"]})
    scenes = result.settings["scenes"].values()
    differences = [one["reference_difference"].get(measure, 0.0) for one in scenes for measure in measures_of(one)]
    machine, load = result.provenance["machine"], result.settings.get("load")
    beside = f" Other processes took {percent(max(load))} of it at most." if load else ""
    return (
        f"{result.settings['rounds']} fresh processes one after the other; in each, every solver has its turn after a "
        "warm-up. CPU times are the least of the rounds, of the simulation "
        "without import, compilation and building of the scene. The median round took up to "
        f"{number(noise(result), 2)} times as long as the least for {NOISE} % of the levels: costs closer than that "
        f"are not distinguished. Machine: {machine['processor']}, {machine['logical_cores']} cores.{beside}",
        "References are the kernel at its tightest; an independent solution by scipy differs from them by at most "
        f"{number(max(differences), 1)} in the errors shown. Solvers of the equations apply eq. (7): their error of "
        f"restitution under a motion is rounding. The errors of {same} of {len(every)} levels are the same bit for "
        f"bit in every round{'; not those of ' + ', '.join(differing) if differing else ''}.",
        "On a free base the largest tilt is that of the start and has no error. Errors of the peak displacement and "
        "of the overturning boundary are relative. The boundary is searched: six runs, each at the amplitude where "
        "the one before would just overturn.",
    )
