"""What the report shows of speed against error: one sentence, one figure, one short table."""

from __future__ import annotations

from typing import TYPE_CHECKING

from engines import ENGINES

from ...showing.charts import Chart, figure, log_axis
from ...showing.parts import Section, Table, number
from .ladders import NEEDED
from .measure import MEASURES
from .tables import error, ladder, principal

if TYPE_CHECKING:
    from ...running.provenance import Result

SHOWN = ("free-sliding", "isolated-rocking")
LEVELS = (1e-2, 1e-3, 1e-4)
FLOOR = 1e-14
KERNEL = "kernel"


def finding(result: Result) -> Section:
    """The `Section` of the report about cost."""
    scenes = [scene for scene in SHOWN if scene in result.settings["scenes"]] or list(result.settings["scenes"])[:2]
    last = scenes[-1]
    costs = passing(result, last, LEVELS[1])
    applied = result.settings["applied_impacts"]
    engine = next((row for family, row in costs.items() if row["solver"] in ENGINES and family not in applied), None)
    kernel = costs.get(KERNEL)
    where = result.settings["scenes"][last]["title"]
    title = "Cost against error: " + (
        f"{where}, to {LEVELS[1]:g}: {engine['family']}, at {number(engine['cpu_seconds'] / kernel['cpu_seconds'], 2)} "
        "times the analytic model, is the cheapest engine"
        if engine and kernel
        else f"{where}: no engine reaches {LEVELS[1]:g}"
    )
    text = (
        "Every solver runs a ladder of its accuracy knob; error and CPU time come from the same runs. Cheapest is the "
        "cheapest setting at which it and all finer ones keep the error: a lucky point does not count.",
    )
    return Section(
        title,
        text,
        (_table(result, last),),
        (figure([_panel(result, scene) for scene in scenes], _caption(), _engines(result)),),
        measured=(_how(result),),
    )


def passing(result: Result, scene: str, level: float) -> dict[str, dict]:
    """{family: cheapest row at which it and all finer ones reach a level}, cheapest first; none of what failed."""
    found = {}
    for family, rows in _families(result, scene).items():
        good = []
        for row in reversed(rows):  # the finest first
            off = error(row, principal(result, scene))
            if row["failure"] or off is None or off > level or row.get("lost_impacts"):
                break
            good.append(row)
        if good:
            found[family] = min(good, key=lambda row: row["cpu_seconds"])
    return dict(sorted(found.items(), key=lambda item: item[1]["cpu_seconds"]))


def _families(result, scene):
    families = {}
    for row in ladder(result):
        if row["scene"] == scene and row["model"] == NEEDED and row["law"] != "bouc-wen":
            families.setdefault(row["family"], []).append(row)
    return families


def _engines(result):
    return ["analytic", *dict.fromkeys(row["solver"] for row in ladder(result) if row["solver"] in ENGINES)]


def _panel(result, scene):
    """Error over CPU time: settings that reach 1e-3 in colour, with a line along each ladder; the rest grey."""
    measure = principal(result, scene)
    families = _families(result, scene)
    points = {
        family: [
            (row["cpu_seconds"], max(off, FLOOR), row)
            for row in sorted(rows, key=lambda row: row["value"])
            if "cpu_seconds" in row and not row["failure"] and (off := error(row, measure)) is not None
        ]
        for family, rows in families.items()
    }
    every = [point for found in points.values() for point in found]
    chart = Chart(
        log_axis("CPU time of a run [s]", [point[0] for point in every]),
        log_axis(f"error: {MEASURES[measure][0]}", [point[1] for point in every]),
        f"Error against CPU time, {result.settings['scenes'][scene]['title']}.",
        title=result.settings["scenes"][scene]["title"],
        height=330,
    )
    trusted = passing(result, scene, LEVELS[1])
    for grey in (True, False):
        for family, found in points.items():
            known = family == KERNEL or (found and found[0][2]["solver"] in ENGINES)
            if not found or (not known or family not in trusted) != grey:
                continue
            who = "analytic" if family == KERNEL else found[0][2]["solver"]
            xs, ys = [point[0] for point in found], [point[1] for point in found]
            lost = [bool(point[2].get("lost_impacts")) for point in found]
            if not any(lost):
                chart.line(xs, ys, who, grey=grey)
            says = [
                f"{family}, {row['knob']} {number(row['value'])}: {number(y, 2)} in {number(x, 2)} s"
                for x, y, row in found
            ]
            for mark, chosen in (("x", True), (None, False)):
                which = [k for k, one in enumerate(lost) if one is chosen]
                chart.dots([xs[k] for k in which], [ys[k] for k in which], who, grey=grey, filled=not grey,
                           says=[says[k] for k in which], mark=mark)  # fmt: skip
    return chart


def _caption():
    return (
        "Left and low is better. Coloured: solvers of which a setting and all finer ones reach 1e-3; grey: all others, "
        "named under the pointer; crosses: impacts lost. Rounding is drawn at 10⁻¹⁴."
    )


def _table(result, scene):
    found = {level: passing(result, scene, level) for level in LEVELS}
    kernel = {level: rows[KERNEL]["cpu_seconds"] for level, rows in found.items() if KERNEL in rows}
    families = list(dict.fromkeys(family for level in LEVELS for family in found[level]))
    return Table(
        f"{result.settings['scenes'][scene]['title']}: CPU time to keep an error [ms] (times the model's; setting)",
        ("solver", *(f"≤ {level:g}" for level in LEVELS)),
        [[family, *(_cell(found[level].get(family), kernel.get(level)) for level in LEVELS)] for family in families],
    )


def _cell(row, kernel):
    if row is None:
        return "–"
    ratio = f"{number(row['cpu_seconds'] / kernel, 2)} ×; " if kernel else ""
    return f"{number(1e3 * row['cpu_seconds'], 2)} ({ratio}{row['knob']} {number(row['value'])})"


def _how(result):
    s = result.settings
    return (
        f"{s['rounds']} fresh processes one after the other, in each every solver has its turn after a warm-up; "
        "medians of the CPU time of the simulation alone: no import, compilation or building of the scene. Other "
        "scenes, orders and growth with duration are on the study's page."
    )
