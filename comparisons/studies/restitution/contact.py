"""What is shown of why engines err: the first impact of a block released, taken apart."""

import numpy as np

from ...running.provenance import Result
from ...showing.charts import Axis, Chart, figure, key_of
from ...showing.figures import as_it_comes, kind, subject
from ...showing.parts import NAME, Column, Page, table, where

RIGID = "rigid ground"
WINDOW = 20.0  # ms before and after the landing that are drawn
MARKED = 40  # values of a line, at most, to mark each
# frame: (its title, key of its values, unit of the page, label)
FRAMES = {
    "straddle": ("1. the steps straddle the impact", "landing", 1e3, "height of the corner [mm]"),
    "penetration": ("2. the corner sinks in", "landing", 1e3, "height of the corner [mm]"),
    "rebound": ("3. it is pushed out again", "speed", 1.0, "speed away from the ground [-]"),
    "energy": ("4. energy is lost or gained", "energy", 1.0, "energy over that before [-]"),
}
ERROR = Column("error of restitution [-]", "error")


def contact(result: Result) -> Page:
    """The parts of the study's page that say why, as if they were a page of their own."""
    settings, rows = result.settings["why"], where(result.rows, part="why")
    told = [row for row in rows if row["failure"] is None and "why_not" not in row]
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
        Column("main variant", lambda row: "yes" if row["best"] else "no"),
    )
    causes = ", ".join(dict.fromkeys(row["cause"] for row in wrong)) or "none"
    return Page(
        f"Why engines err: {len(sound)} of {len(best)} impacts of main variants are within {settings['least']:g}; "
        f"causes found: {causes}",
        (
            "Newton’s laws give the impulses that an engine must have applied between two steps. These impulses split "
            "the error of restitution into parts that add up to it. The parts show the cause without knowledge of the "
            "solver or its settings.",
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
            for row in rows
            if row["failure"] is not None or "why_not" in row
        ),
    )


def _frames(rows):
    """The contact in four frames; not as `lines`: hundreds of values are a curve, and their ends lie outside."""
    charts = []
    for name, (title, key, unit, label) in FRAMES.items():
        series = []
        for row in sorted(rows, key=_coloured):
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
            grey, who, inside = not _coloured(row), kind(row), np.abs(time) <= WINDOW
            chart.line(time, values, who, grey=grey)
            if len(values) <= MARKED:
                says = [f"{NAME.of(row)}: {value:.3g}" for value in values[inside]]
                filled = not as_it_comes(row)
                chart.dots(time[inside], values[inside], who, grey=grey, filled=filled, says=says, beyond=True)
        charts.append(chart)
    caption = (
        "First impact on rigid ground. Coloured: main variants, and defaults of the engines in question. Grey: other "
        "defaults. Open marks: defaults; arrowheads: beyond the frame. Frames 2 and 3 show only engines whose block "
        "position is read."
    )
    keys = {kind(row): key_of(kind(row), filled=not as_it_comes(row)) for row in rows if _coloured(row)}
    return figure(charts, caption, keys, keys)


def _coloured(row):
    return row["best"] or subject(row)
