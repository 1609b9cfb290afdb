"""The section about the report's own runs: what each solver made of the same scenes, in one figure and one table."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from analytic.records import G

from ..showing.charts import Axis, Chart, figure
from ..showing.parts import Section, Table, number, percent
from .histories import thinned
from .sections import warned
from .summary import outcomes

if TYPE_CHECKING:
    from ..running.provenance import Result

ANALYTIC = "analytic"
TILT = 1.6  # limit of a tilt's axis, over slenderness
SHOWN = 700  # samples of a line
LEAST = 1e-9  # of a difference drawn


def earthquake(result: Result) -> Section:
    """The `Section` of the scenes under their motion."""
    scenes = result.settings["scenes"]
    charts = [chart for name in scenes for chart in _panels(result, name)]
    solvers = dict.fromkeys(row["engine"] for row in result.rows)
    moved = "One earthquake" if result.settings["motion"] else "One scene"
    title = f"{moved}: " + "; ".join(
        f"{scene['name']}: {outcomes([row for row in result.rows if row['scene'] == name])}"
        for name, scene in scenes.items()
    )
    motion = result.settings["motion"]
    under = f"Under {motion['label']}, peak {number(motion['peak'] / G)} g. " if motion else ""
    text = (
        f"{under}Each solver runs until its outcome is decided. Tilt is compared up to the sensitivity horizon only: "
        "beyond it a change as small as the solver's own errors makes another motion.",
    )
    warnings = [
        [scenes[name]["name"], ", ".join(who), words] for name in scenes for words, who in warned(result, name).items()
    ]
    failed = tuple(
        (f"{row['engine']} on {row['scene']}: {row['failure']['reason']}", row["failure"].get("message", ""))
        for row in result.rows
        if row["failure"]
    )
    tables = [_table(result)]
    if warnings:
        tables.append(
            Table("Warnings, and differences from the analytic model", ("scene", "solver", "warning"), warnings)
        )
    return Section(
        title,
        text,
        tuple(tables),
        (figure(charts, _caption(), solvers),) if charts else (),
        evidence=failed,
        measured=(
            "Distance of tilt graphs (Hausdorff): how far a point of one can lie from the other, time in units of "
            "2π/ω_r and tilt in units of γ. Friction demand and normal force are taken over the run, but for the fall "
            "of a block that overturns; engines' are computed from their states by the model's equations. All that was "
            "measured of these runs, the bearings' loops among it, is on the page of the runs.",
        ),
    )


def _panels(result, name):
    """Tilt where a block moves, and base displacement where there is a base; each beside what engines differ by."""
    scene = result.settings["scenes"][name]
    rows = [
        row
        for row in result.rows
        if row["scene"] == name and not row["failure"] and f"{name}/{row['engine']}/time" in result.arrays
    ]
    if any(row["outcome"] != "stands" for row in rows):
        yield from _pair(result, scene, name, rows, "tilt", "tilt φ/γ [-]", scene["block"]["slenderness"])
    if scene["base"]:
        yield from _pair(result, scene, name, rows, "base_displacement", "base displacement x [m]", 1.0)


def _pair(result, scene, name, rows, column, label, scale):
    lines, apart = {}, {}
    for row in rows:
        key = f"{name}/{row['engine']}"
        lines[row["engine"]] = _line(result, key, column, scale)
        if f"{key}/apart/time" in result.arrays and row["engine"] != ANALYTIC:
            apart[row["engine"]] = _line(result, f"{key}/apart", column, scale)
    end = max(float(time[-1]) for time, _ in lines.values())
    peak = max(float(np.abs(values).max()) for _, values in lines.values()) or 1.0
    limit = min(1.08 * peak, TILT) if column == "tilt" else 1.08 * peak
    horizon = scene["horizon"] if scene["horizon"] and scene["horizon"] < 0.99 * end else None
    whole = Chart(
        Axis("time [s]", 0.0, end),
        Axis(label, -limit, limit),
        f"{scene['name']}: {label} over time in {', '.join(lines)}.",
        title=scene["name"],
        height=240,
    )
    for who, (time, values) in lines.items():
        whole.line(time, values, who)
    yield whole
    if not apart:
        return
    sizes = {who: np.maximum(np.abs(values), LEAST) for who, (_, values) in apart.items()}
    most = max(float(values.max()) for values in sizes.values())
    beside = Chart(
        Axis("time [s]", 0.0, end),
        Axis("|engine − model|", LEAST, 10.0 ** max(np.ceil(np.log10(most)), -7), "log"),
        f"{scene['name']}: how far the engines are from the analytic model in {label}.",
        title="difference from the analytic model",
        height=240,
    )
    for who, values in sizes.items():
        beside.line(apart[who][0], values, who)
    if horizon is not None:
        beside.rule(horizon, "x", "sensitivity horizon")
    yield beside


def _line(result, key, column, scale):
    time, values = result.arrays[f"{key}/time"], result.arrays[f"{key}/{column}"] / scale
    kept = thinned(values, most=SHOWN, parts=SHOWN // 2)
    return time[kept], values[kept]


def _caption():
    return (
        "Left: all solvers over each other. Right: how far the engines are from the analytic model, logarithmic. A "
        "block that never lifts in any solver has no tilt to show."
    )


def _table(result):
    rows = []
    for row in result.rows:
        agreement = row.get("agreement") or {}
        engine = row["engine"] != ANALYTIC
        rows.append(
            [
                row["engine"],
                result.settings["scenes"][row["scene"]]["name"],
                row["verdict"],
                number(row.get("overturning_time"), 5),
                number(row.get("peak_tilt_ratio"), 3),
                number(row.get("peak_base_displacement"), 4),
                percent(agreement.get("peak_displacement_error")) if engine else "–",
                number(agreement.get("graph_distance"), 2) if engine else "–",
                number(agreement.get("until"), 3) if engine else "–",
                str(len(row.get("warnings") or ())),
            ]
        )
    return Table(
        "Outcomes, and distance from the analytic model up to the sensitivity horizon",
        (
            "solver",
            "scene",
            "outcome",
            "overturns at [s]",
            "peak |φ|/γ [-]",
            "peak x [m]",
            "its error",
            "distance of tilt graphs [-]",
            "horizon [s]",
            "warnings",
        ),
        rows,
    )
