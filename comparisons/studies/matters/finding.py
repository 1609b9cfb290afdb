"""What the report shows of what matters more: one sentence, one ranked picture, one short table."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...showing.charts import Axis, Chart, figure
from ...showing.parts import Section, Table, percent
from .figures import ANALYTIC, at_best, ranked
from .page import _answer, _contact, _engines, _vertical

if TYPE_CHECKING:
    from ...running.provenance import Result

LEAST = 0.05  # per cent, where shares of none are drawn
SHOWN = 14
TICKS = ((0.05, "0"), (1, "1"), (10, "10"), (100, "100"))
MOST = 27  # letters of a name in the figure
SHORTER = {
    "vertical motion, ": "vertical ",
    " of the horizontal": " of horizontal",
    "bearing stiffness ": "",
    "bearing exponent ": "",
    "time step of the record": "record's time step",
    "off by 0.1 % of the peak": "off by 0.1 %",
    " cut off after 95 % of its intensity": " cut off",
}


def finding(result: Result) -> Section:
    """The `Section` of the report about what flips verdicts."""
    scenes = list(result.settings["scenes"])
    first = [_changes(result, scene)[0] for scene in scenes]
    engines = [row for scene in scenes for row in ranked(result, scene) if at_best(result, row)]
    flipped = percent(first[0]["flips"] / first[0]["runs"])
    title = f"What matters more than the engine: {first[0]['change']} flips {flipped} of verdicts"
    if engines:
        most = max(engines, key=lambda row: row["flips"] / row["runs"])
        title += (
            f", engines at their best {percent(most['flips'] / most['runs'])} ({percent(most['high'])} not excluded)"
        )
    text = tuple(_answer(result, scene) for scene in scenes)
    return Section(
        title,
        text,
        tuple(_table(result, scene) for scene in scenes[:1]),
        (figure([_panel(result, scene) for scene in scenes], _caption(), [row["solver"] for row in engines]),),
        measured=(_how(result), *(told(result, scene) for scene in scenes for told in (_vertical, _contact))),
    )


def _changes(result, scene):
    return [row for row in ranked(result, scene) if row["solver"] == ANALYTIC]


def _shown(result, scene):
    """The changes that flip most, and every engine."""
    shown = _changes(result, scene)[:SHOWN]
    return [row for row in ranked(result, scene) if row in shown or row["solver"] != ANALYTIC]


def _panel(result, scene):
    """The changes, and engines at their best; other variants have too few runs to be looked at."""
    rows = [row for row in _shown(result, scene) if row["solver"] == ANALYTIC or at_best(result, row)]
    chart = Chart(
        Axis("verdicts flipped [%]", LEAST, 100, "log", TICKS),
        Axis("", len(rows) - 0.5, -0.5, ticks=tuple((k, _short(row["change"])) for k, row in enumerate(rows))),
        f"{scene}: share of verdicts flipped by each change and engine, ranked. {_answer(result, scene)}",
        left=196,
        title=scene,
        height=90 + 21 * len(rows),
    )
    for k, row in enumerate(rows):
        who = "" if row["solver"] == ANALYTIC else row["solver"]
        share, low, high = (max(100 * value, LEAST) for value in (row["flips"] / row["runs"], row["low"], row["high"]))
        chart.reach([share], [k], [low], [high], who, along="x")
        within = f"{percent(row['low'])} to {percent(row['high'])}"
        says = f"{row['change']}: {row['flips']} of {row['runs']}, 95 % interval {within}"
        chart.dots([share], [k], who, says=[says])
    return chart


def _short(words):
    for long, short in SHORTER.items():
        words = words.replace(long, short)
    return words if len(words) <= MOST else words[: MOST - 1] + "…"


def _caption():
    return (
        "Share of verdicts that each change flips, with 95 % Wilson intervals. Ink: changes of the scene in the "
        "analytic model; coloured: engines on the unchanged scene, at their best."
    )


def _table(result, scene):
    return Table(
        f"{scene}: verdicts flipped, and median change of peaks where the block stays upright",
        ("change", "flipped", "95 % interval", "peak tilt"),
        [
            [
                row["change"],
                f"{row['flips']} of {row['runs']}",
                f"{percent(row['low'])} to {percent(row['high'])}",
                percent(row["tilt"]),
            ]
            for row in _shown(result, scene)
        ],
    )


def _how(result):
    s = result.settings
    return (
        f"{s['motions']} synthetic motions at {len(next(iter(s['scenes'].values()))['slendernesses'])} slendernesses. "
        f"{_engines(s)} The motions' factors lie lognormally, with a deviation of "
        f"{s['spread']:g}, about the one that overturns half: near the boundary, where verdicts flip. The bearings are "
        "taken as stiff vertically; real ones sway at 10 to 20 Hz, so that twice the vertical motion is run too."
    )
