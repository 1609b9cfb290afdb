"""What is shown of the autopsy study."""

import numpy as np

from ...running.provenance import Result
from ...showing.charts import Axis, Chart, figure
from ...showing.figures import MOVED
from ...showing.parts import NAME, Column, Page, table, where

RIGID = "rigid ground"
WINDOW = 20.0  # ms before and after the landing that are drawn
INSTANT = 1.0  # ms: marks of a landing that takes less stand beside those of other engines
MARKED = 40  # values of a line, at most, to mark each
# frame: (its title, key of its values, unit of the page, label)
FRAMES = {
    "straddle": ("1. the steps straddle the impact", "landing", 1e3, "height of the corner [mm]"),
    "penetration": ("2. the corner sinks in", "landing", 1e3, "height of the corner [mm]"),
    "rebound": ("3. it is pushed out again", "speed", 1.0, "speed away from the ground [-]"),
    "energy": ("4. energy is lost, or made", "energy", 1.0, "energy over that before [-]"),
}
ERROR = Column("error of restitution [-]", "error")


def page(result: Result) -> Page:
    settings = result.settings
    told = [row for row in result.rows if row["failure"] is None and "why_not" not in row]
    ranked = sorted(told, key=lambda row: -abs(row["error"]))
    wrong, best = [row for row in ranked if row["cause"]], where(ranked, best=True)
    sound = where(best, cause=None)
    columns = (
        NAME,
        Column("ground", "ground"),
        ERROR,
        Column("cause", lambda row: row["cause"] or f"none (below {settings['least']:g})"),
        Column("steps in contact [-]", "steps"),
        Column("deepest [mm]", lambda row: 1e3 * row["deepest"] if "deepest" in row else None),
        Column("energy lost", "energy_lost", digits=3, percent=True),
    )
    causes = ", ".join(dict.fromkeys(row["cause"] for row in wrong)) or "none"
    return Page(
        f"Why engines err: {len(sound)} of {len(best)} impacts of main variants are within {settings['least']:g}; "
        f"causes elsewhere: {causes}",
        (
            "Newton’s laws give the impulses that an engine must have used between two steps, whatever its solver "
            "calls them. They split the error of restitution into parts that add up to it. The parts show the cause, "
            "without the engine’s settings.",
        ),
        first=(
            _frames([row for row in where(told, ground=RIGID) if row["best"] or row["tier"] == "defaults"]),
            table(
                "The first impact: those with a cause, and all of the engines’ main variants",
                [*wrong, *sound],
                *columns,
            ),
        ),
        more=(
            table("The other impacts", where(ranked, cause=None, best=False), *columns),
            table(
                "Causes",
                [{"cause": cause, "words": words} for cause, words in settings["causes"].items()],
                Column("cause", "cause"),
                Column("how it shows: what it is", "words"),
            ),
        ),
        how=(
            f"A block of slenderness {settings['slenderness']:g} rad is released from {settings['start']:g} of it, on "
            "rigid ground and on the Caryatid’s base sliding freely. Its first impact is taken apart in every engine "
            f"and variant at its default level. A cause is named for errors from {settings['least']:g} on.",
        ),
        evidence=tuple(
            (f"{NAME.of(row)}, {row['ground']}", row.get("why_not") or row["failure"]["reason"])
            for row in result.rows
            if row["failure"] is not None or "why_not" in row
        ),
    )


def _frames(rows):
    """The contact in four frames; not as `lines`: hundreds of values are a curve, and their ends lie outside."""
    charts = []
    for name, (title, key, unit, label) in FRAMES.items():
        series = []
        for row in sorted(rows, key=lambda row: row["best"]):
            frame = row["frames"].get(name, {"time": []})
            time = 1e3 * np.array(frame["time"])
            near = np.abs(time) <= 1.5 * WINDOW
            if near.any():
                series.append((row, time[near], unit * np.array(frame[key])[near]))
        if not series:
            continue
        low, high = np.percentile(np.concatenate([values for *_, values in series]), (1, 99))
        room = 0.08 * float(high - low) or 1.0
        chart = Chart(
            Axis("time from the landing [ms]", -WINDOW, WINDOW),
            Axis(label, float(low) - room, float(high) + room),
            f"{title}: {label} in {', '.join(dict.fromkeys(row['engine'] for row, *_ in series))}.",
            title=title,
            height=260,
            left=70,
        )
        for row, time, values in series:
            grey = not row["best"]
            chart.line(time, values, row["engine"], grey=grey)
            if len(values) <= MARKED:
                at_once = not grey and float(np.ptp(time)) < INSTANT
                if at_once:  # one mark of several in one place
                    kept = np.sort(np.unique(np.round(values / room), return_index=True)[1])
                    time, values = time[kept], values[kept]
                says = [f"{NAME.of(row)}: {value:.3g}" for value in values]
                chart.dots(time, values, row["engine"], grey=grey, filled=not grey, says=says, apart=at_once)
        charts.append(chart)
    caption = (
        "The first impact on rigid ground. Coloured: each engine’s main variant; grey: kind “defaults”. Only engines "
        "whose position of the block is read have frames 2 and 3."
    )
    caption += MOVED if any(chart.moved for chart in charts) else ""
    return figure(charts, caption, [row["engine"] for row in rows if row["best"]])
