"""What is shown of the speed-error study."""

import statistics
from collections.abc import Iterable
from typing import Any

import numpy as np

from engines import ENGINES

from ...running.provenance import Result
from ...showing.figures import beside, lines
from ...showing.parts import (
    COST,
    Column,
    Head,
    Judgement,
    Mark,
    Page,
    Row,
    cheapest,
    grouped,
    number,
    percent,
    short,
    table,
    where,
)
from ...showing.parts import NAME as SOLVER
from .cases import NEEDED, PLAIN
from .growth import fit

FIRST = ("free-sliding", PLAIN)  # scenes of the report's first page
LEVELS = (1e-2, 1e-3, 1e-4, 1e-5)  # of an error
FINE, FINE_LEVELS, FINEST = "horizon_tilt", (1e-6, 1e-9, 1e-12), 1e-16  # of integrators alone; the last is drawn
ASKED = 1e-3
USUAL = 1e-8  # tolerance of the kernel in comparisons with engines at default levels; its own default takes longer
DRAWN, ROUNDING = 1e-9, 1e-13  # errors below the first are drawn there, those below the second tell no order
NOISE = 95  # percentile of the spread of costs over the rounds, below which two costs are not distinguished
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
AGAINST = {"duration": "duration [s]", "samples": "record samples per second [1/s]"}
MIB = 2**20

NAME = Column("solver", "name")
SCENE = Column("scene", "title")
CPU = Column("CPU time of a run [s]", "cpu_seconds")


def page(result: Result) -> Page:
    shown = levels_run(result)
    every = where(shown, principal=True)
    rows = [row for row in where(shown, model=NEEDED) if row["law"] != "bouc-wen"]
    errors = grouped(rows, "scene", "measure")
    first = [key for key in errors if key[0] in FIRST] or list(errors)[-1:]
    shown_scene = next((key for key in first if key[0] == PLAIN), first[-1])
    top = [key for key in first if key[0] == shown_scene[0]]
    others = [key for key in errors if key not in first]
    growth = where(result.rows, part="growth", failure=None)
    return Page(
        _title(result, errors[shown_scene], _noise(every)),
        (
            "Every solver runs through levels of its accuracy parameter; error and CPU time come from the same runs. "
            "Cheapest is the cheapest level at which it and all finer ones keep the error: none counts by chance.",
            "In brackets: CPU time over the analytic model's; level of the accuracy parameter. Assisted: the adapter "
            f"applies the impact. Costs within a factor of {number(_noise(every), 3)} are of one rank: the cost of "
            "one level differs as much between rounds.",
        ),
        first=(
            _figure([row for key in first for row in errors[key]], CPU, CAPTION, rows),
            *(_costs(result, errors[key]) for key in top),
            _defaults_table(result),
        ),
        more=(
            Head("The other scenes"),
            _figure([row for key in others if key[1] != FINE for row in errors[key]], CPU, CAPTION, rows),
            _figure([row for key in others if key[1] == FINE for row in errors[key]], CPU, FINE_CAPTION, rows),
            *(_costs(result, some) for key, some in errors.items() if key not in top),
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
            *_growth(growth),
        ),
        how=_how(result, every),
        evidence=tuple(
            (
                f"{row['name']} at {_level(row)}, {row['title']}: {row['failure']['reason']}",
                row["failure"].get("message", ""),
            )
            for row in every
            if row["failure"]
        ),
    )


def judgements(result: Result) -> tuple[Judgement, ...]:
    """CPU time at the default levels over the analytic model's, by (engine, variant); none without that scene."""
    marks = {
        (row["engine"], row["variant"]): Mark(
            f"{RATIO.text(row)} ×",
            "none",
            f"error of restitution {number(row['restitution'], 2)}"
            + (f"; {SHARE.head} {SHARE.text(row)}" if row["share"] is not None else "")
            + (f"; {row['lost']} impacts missed" if row["lost"] else ""),
            RATIO.of(row),
        )
        for row in _defaults(result)
    }
    heading = "CPU time over the analytic model's, isolated rocking"
    return (Judgement(heading, marks, COST, says="{} the model's CPU time"),) if marks else ()


RATIO = Column("CPU time over the analytic model's [-]", "ratio")
SHARE = Column("engine's own share", lambda row: "not measured" if row["share"] is None else percent(row["share"]))


def _defaults(result):
    """A row for each variant at its default level in the scene `PLAIN`, with ratio and share; cheapest first."""
    rows = [row for row in where(levels_run(result), scene=PLAIN, model=NEEDED, principal=True) if "cpu_seconds" in row]
    kernel = where(rows, name=KERNEL, level=USUAL)
    shares = {SOLVER.of(row): row["share"] for row in where(result.rows, part="share", failure=None)}
    defaults = {SOLVER.of(variant): variant["default"] for variant in result.settings["variants"]}
    found = [
        {
            **row,
            **dict.fromkeys(SHOWN[1]),
            **row["errors"],
            "ratio": CPU.of(row) / CPU.of(kernel[0]),
            "share": shares.get(row["name"]),
        }
        for row in rows
        if kernel and row["level"] == defaults.get(row["name"])
    ]
    return sorted(found, key=CPU.of)


def _defaults_table(result):
    return table(
        f"Isolated, rocking, default levels; the analytic model at a tolerance of {short(USUAL)}. Own share: CPU "
        "time inside the engine's compiled functions over that of the run; the rest is Python, mostly the adapter's",
        _defaults(result),
        NAME,
        RATIO,
        SHARE,
        *(Column(MEASURES[key], key) for key in SHOWN[1]),
        Column("impacts missed [-]", "lost"),
    )


CAPTION = (
    "Left and low is better. Coloured: solvers of which a level and all finer ones keep 0.001; grey: the others, named "
    "under the pointer. No error is given for levels with missed impacts. Errors below 10⁻⁹ are drawn there."
)

FINE_CAPTION = (
    "Integrators alone, left and low is better. Problems A (a free block) and B (a block under a pulse) have "
    "references of 30 digits. All integrate the same two equations, set up for speed: scipy without classes and with "
    "a first step of the length of the hop. scipy restarts at each impact; heyoka's impacts are a callback in its own "
    "loop, or they stop it and Python applies them."
)


def levels_run(result: Result) -> list[dict[str, Any]]:
    """The rows of all solvers at their levels, one for each error shown: with name, title of the scene, measure, error.

    The error is None where the run failed, missed impacts or found no boundary. principal: it is the scene's first.
    """
    scenes = result.settings["scenes"]
    return [
        {
            **row,
            "name": SOLVER.of(row) + (", Bouc-Wen" if row["law"] == "bouc-wen" else ""),
            "title": scenes[row["scene"]]["title"],
            "measure": measure,
            "principal": not place,
            "error": None if row["failure"] or row["lost"] else row["errors"].get(measure),
        }
        for row in where(result.rows, part="work-precision")
        for place, measure in enumerate(_measures(scenes[row["scene"]]))
    ]


def _measures(scene):
    return next(found for line in SHOWN if (found := [measure for measure in line if measure in scene["measures"]]))


def passing(rows: Iterable[dict[str, Any]], level: float) -> dict[str, Row]:
    """{name: the cheapest of its rows at which it and all finer ones keep an error}, cheapest first; of one scene and
    one measure."""
    return cheapest(rows, "name", lambda row: row["error"] is not None and row["error"] <= level, CPU.of)


def _assisted(result):
    """Names of variants whose adapter applies the impact."""
    return {SOLVER.of(variant) for variant in where(result.settings["variants"], applies_impact=True)}


def _level(row):
    return f"{row['parameter'].replace('_', ' ')} {short(row['level'])}"


def _title(result, rows, noise):
    found = passing(rows, ASKED)
    assisted = _assisted(result)
    own = {name: CPU.of(row) for name, row in found.items() if row["engine"] in ENGINES and name not in assisted}
    place = f"Cost against error: {rows[0]['title']}, {MEASURES[rows[0]['measure']]} at most {ASKED:g}"
    if not own or KERNEL not in found:
        return f"{place}: no engine reaches it by its own contact"
    least = min(own.values())
    ranked = [name for name, cpu in own.items() if cpu <= noise * least]
    ratios = [number(own[name] / CPU.of(found[KERNEL]), 2) for name in (ranked[0], ranked[-1])]
    times = f"{' to '.join(dict.fromkeys(ratios))} times the analytic model's CPU time"
    if len(ranked) > 1:
        return f"{place}: {' and '.join(ranked)}, of one rank, at {times}, are the cheapest engines"
    return f"{place}: {ranked[0]}, at {times}, is the cheapest engine"


def _noise(rows):
    """The factor by which the cost of one level differs between rounds, without the largest ones."""
    return float(
        np.percentile([row["cpu_high"] / row["cpu_low"] for row in rows if "cpu_seconds" in row] or [1], NOISE)
    )


def _figure(rows, x, caption, like):
    """Error over x, a panel for each scene; scenes of one kind of error share their axes."""
    kept = {(*key, name) for key, some in grouped(rows, "scene", "measure").items() for name in passing(some, ASKED)}
    figures = [
        lines(
            [row for row in some if row["error"] is not None],
            x,
            Column(MEASURES[measure], lambda row: max(row["error"], FINEST if row["measure"] == FINE else DRAWN)),
            caption,
            panel="title",
            grey=lambda row: (row["scene"], row["measure"], row["name"]) not in kept,
            log="xy",
            says=lambda row: f"{row['name']}, {_level(row)}: {number(row['error'], 2)} in {CPU.text(row)} s",
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
            ratio = f"{number(CPU.of(best) / CPU.of(kept[KERNEL]), 2)} ×; " if KERNEL in kept else ""
            return f"{number(1e3 * CPU.of(best), 2)} ({ratio}{_level(best)})"

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
        Column("level", _level),
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


def _growth(rows):
    if not rows:
        return
    figures = [
        lines(where(rows, against=against), Column(head, "value"), CPU, "How the cost of one run grows.", log="xy")
        for against, head in AGAINST.items()
    ]
    grown = []
    for (against, engine, variant), some in grouped(rows, "against", "engine", "variant").items():
        x, y = ([row[key] for row in some] for key in ("value", "cpu_seconds"))
        exponent, error = fit(x, y) if len(some) >= 3 else (None, None)
        last = float(np.log(y[-1] / y[-2]) / np.log(x[-1] / x[-2])) if len(some) >= 2 else None
        sizes = {
            key: [None if row[key] is None else row[key] / MIB for row in (some[0], some[-1])]
            for key in ("traced_bytes", "resident_bytes")
        }
        grown.append(
            {"name": f"{engine}, {variant}", "against": AGAINST[against], "x": [x[0], x[-1]], "exponent": exponent,
             "error": error, "last": last, **sizes}
        )  # fmt: skip
    yield Head("Growth of the cost")
    yield beside(*figures)
    yield table(
        "CPU time as a power of duration or sample rate; peak memory of a run without history, at the first and the "
        "last value. Adapters of engines keep every step until the run is measured.",
        grown,
        NAME,
        Column("against", "against"),
        Column("first, last value", "x", digits=None),
        Column("exponent [-]", "exponent", digits=3),
        Column("standard error [-]", "error", digits=1),
        Column("exponent of the last two [-]", "last", digits=3),
        Column("allocated [MiB]", "traced_bytes", digits=3),
        Column("resident, increase [MiB]", "resident_bytes", digits=3),
    )


def _how(result, every):
    same = sum(row["repeatable"] for row in every)
    differing = sorted({row["name"] for row in every if not row["repeatable"]})
    scenes = result.settings["scenes"].values()
    differences = [scene["reference_difference"].get(measure, 0.0) for scene in scenes for measure in _measures(scene)]
    return (
        f"{result.settings['rounds']} fresh processes one after the other; in each, every solver has its turn after a "
        "warm-up. CPU times are medians, of the simulation without import, compilation and building of the scene. The "
        f"cost of one level differs between rounds by up to a factor of {number(_noise(every), 3)} for "
        f"{NOISE} % of the levels: costs closer than that are not distinguished.",
        "References are the kernel at its tightest; an independent solution by scipy differs from them by at most "
        f"{number(max(differences), 1)} in the errors shown. The model's own solvers apply eq. (7): their error of "
        f"restitution under a motion is rounding. The errors of {same} of {len(every)} levels are the same bit for "
        f"bit in every round{'; not those of ' + ', '.join(differing) if differing else ''}.",
        "On a free base the largest tilt is that of the start and has no error. Errors of the peak displacement and "
        "of the overturning boundary are relative. The boundary is searched: six runs, each at the amplitude where "
        "the one before would just overturn.",
    )
