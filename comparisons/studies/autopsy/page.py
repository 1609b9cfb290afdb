"""The autopsy in words, a table and four frames, from the result alone."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure as Canvas

from ...showing.charts import Axis, Chart, figure
from ...showing.parts import Section, Table, figure_of, number
from ...showing.plots import style

if TYPE_CHECKING:
    from ...running.provenance import Result

DEFAULTS = "defaults"
RIGID = "rigid ground"
WINDOW = 0.02  # s, about the landing that is drawn
# frame: (key of its values, unit of the page, times what, label, title)
FRAMES = {
    "straddle": ("landing", 1e3, "height of the corner [mm]", "1. the steps straddle the impact"),
    "penetration": ("landing", 1e3, "height of the corner [mm]", "2. the corner sinks in"),
    "rebound": ("speed", 1.0, "speed away from the ground [-]", "3. it is pushed out again"),
    "energy": ("energy", 1.0, "energy over that before [-]", "4. energy is lost, or made"),
}


def section(result: Result) -> Section:
    """The `Section` of a result of this study."""
    told = _told(result)
    causes = [f"{name}: {words}." for name, words in result.settings["causes"].items()]
    drawn = figure_of(
        draw(result),
        "Four frames of the first impact in every engine, from the landing corner's height to the energy.",
        "The first impact on rigid ground in every engine that tells where the block was. Lines: at its best; dotted: "
        "its default settings.",
    )
    return Section(
        "Autopsy of an impact",
        (_asked(result), _named(told), *causes),
        (_table(result, told),),
        (drawn,),
        evidence=_silent(result),
    )


def finding(result: Result) -> Section:
    """The `Section` of the report: why engines err at a corner."""
    told = _told(result)
    at_best = [row for row in told if row["best"]]
    named = [row for row in told if row["cause"]]
    sound = sum(row["cause"] is None for row in at_best)
    causes = dict.fromkeys(row["cause"] for row in sorted(named, key=lambda row: -abs(row["error"])))
    title = (
        f"Why engines err: {sound} of {len(at_best)} impacts at their best have no error worth a cause; the others’: "
        + ", ".join(causes)
        if causes
        else f"Why engines err: none of {len(told)} impacts has an error worth a cause"
    )
    text = (
        "Newton's laws give the impulses that an engine must have used between two steps, whatever its solver calls "
        "them. They split the error of restitution into parts that add up to it, and the parts name the cause; no "
        "setting is looked at.",
    )
    shown = sorted(named, key=lambda row: -abs(row["error"])) + [row for row in at_best if row["cause"] is None]
    charts = [_frame(result, name) for name in FRAMES]
    caption = (
        "The first impact on rigid ground, time from the landing. Coloured: engines at their best; grey: default "
        "settings; only those that tell where the block was have frames 2 and 3."
    )
    solvers = [row["engine"] for row in at_best]
    return Section(
        title, text, (_table(result, shown),), (figure(charts, caption, solvers),), measured=(_asked(result),)
    )


def draw(result: Result) -> Canvas:
    """The four frames as a matplotlib figure."""
    canvas = Canvas(figsize=(9.6, 6.4), layout="constrained")
    for axes, (name, (_, _, label, title)) in zip(canvas.subplots(2, 2).flat, FRAMES.items(), strict=True):
        for row, time, values in _series(result, name):
            best = row["best"]
            axes.plot(
                1e3 * time,
                values,
                **{**style(row["engine"]), "linewidth": 1.6 if best else 0.9, "alpha": 1 if best else 0.6},
            )
        axes.set(title=title, xlabel="time from the landing [ms]", ylabel=label, xlim=(-1e3 * WINDOW, 1e3 * WINDOW))
    return canvas


def _told(result):
    return [row for row in result.rows if row["failure"] is None and "why_not" not in row]


def _series(result: Result, name: str) -> Iterator[tuple[dict[str, Any], np.ndarray, np.ndarray]]:
    """(row, time [s], values) of a frame, default settings before the best."""
    key, unit, _, _ = FRAMES[name]
    rows = [row for row in _told(result) if row["ground"] == RIGID and (row["best"] or row["tier"] == DEFAULTS)]
    for row in sorted(rows, key=lambda row: row["best"]):
        frame = row["frames"].get(name)
        if frame is not None:
            time = np.array(frame["time"])
            near = np.abs(time) <= 1.5 * WINDOW
            yield row, time[near], unit * np.array(frame[key])[near]


def _frame(result, name):
    _, _, label, title = FRAMES[name]
    series = list(_series(result, name))
    values = np.concatenate([values for *_, values in series]) if series else np.zeros(1)
    low, high = float(np.percentile(values, 1)), float(np.percentile(values, 99))
    room = 0.08 * (high - low) or 1.0
    chart = Chart(
        Axis("time from the landing [ms]", -1e3 * WINDOW, 1e3 * WINDOW),
        Axis(label, low - room, high + room),
        f"{title}: {label} in {', '.join(dict.fromkeys(row['engine'] for row, *_ in series)) or 'no engine'}.",
        title=title,
        height=260,
        left=70,
    )
    for row, time, one in series:
        grey = not row["best"]
        chart.line(1e3 * time, one, row["engine"], grey=grey)
        says = [f"{row['engine']}, {row['variant']}: {number(value, 3)}" for value in one]
        if len(one) <= 40:
            chart.dots(1e3 * time, one, row["engine"], grey=grey, filled=not grey, says=says)
    return chart


def _table(result, rows):
    return Table(
        "The first impact: error of restitution, its cause, and the contact",
        ("engine, variant", "ground", "error [-]", "cause", "steps in contact [-]", "deepest [mm]", "energy lost [%]"),
        [
            [
                f"{row['engine']}, {row['variant']}",
                row["ground"],
                number(row["error"], 2),
                row["cause"] or f"none (below {result.settings['least']:g})",
                str(row["steps"]),
                number(1e3 * row["deepest"], 2) if "deepest" in row else "–",
                number(100 * row["lost"], 3),
            ]
            for row in rows
        ],
    )


def _named(told):
    """Whose impact has which cause, in one sentence."""
    found = {}
    for row in told:
        found.setdefault(f"{row['engine']}, {row['variant']}", []).append(row["cause"] or "none")
    words = [f"{name} {' and '.join(dict.fromkeys(causes))}" for name, causes in found.items()]
    return f"Causes found: {'; '.join(words) or 'no impact could be told'}."


def _asked(result):
    s = result.settings
    return (
        f"A block of slenderness {s['slenderness']:g} let go from {s['start']:g} of it, on rigid ground and on the "
        "Caryatid's base sliding freely; its first impact, every engine and variant as it comes. A cause is named from "
        f"an error of {s['least']:g} on."
    )


def _silent(result):
    """Runs that failed, and impacts that cannot be told."""
    return tuple(
        (f"{row['engine']}, {row['variant']}, {row['ground']}", row.get("why_not") or row["failure"]["reason"])
        for row in result.rows
        if row["failure"] is not None or "why_not" in row
    )
