"""What matters, ranked: in words, a table and a picture, from the result alone."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from ...showing.parts import Section, Table, figure_of, number, percent
from ...showing.plots import marker, style

if TYPE_CHECKING:
    from ...running.provenance import Result

ANALYTIC = "analytic"
CHANGED = "0.25"
BEST = "best"


def section(result: Result) -> Section:
    """The `Section` of a result of this study."""
    s = result.settings
    asked = (
        f"{s['motions']} synthetic motions, the first {s['motions_of_engines']} of them for the engines, at "
        f"{'; '.join(_scene(name, scene) for name, scene in s['scenes'].items())}. Their factors lie lognormally, with "
        f"a deviation of {s['spread']:g}, about the one that overturns half: near the boundary, where verdicts flip. "
        "Each is changed in one way at a time, and run in every engine at every rung; a flip is another verdict than "
        "the analytic model's of the motion as it is. The vertical motion is another seed's, and bearings are taken as "
        "stiff vertically: real ones sway at 10 to 20 Hz, so that twice the motion is run too."
    )
    answers = [_answer(result, scene) for scene in s["scenes"]]
    figure = figure_of(
        draw(result),
        f"Share of verdicts flipped by each change and each engine, ranked, with 95 % intervals. {' '.join(answers)}",
        "Share of verdicts that each change flips, with 95 % Wilson intervals. Grey: changes of the scene in the "
        "analytic model; coloured: engines on the unchanged scene, filled at their best, open at other rungs.",
    )
    return Section("What matters more than the engine", (asked, *answers), tuple(_tables(result)), (figure,))


def draw(result: Result) -> Figure:
    """Share of flipped verdicts, ranked; a panel per scene."""
    scenes = list(result.settings["scenes"])
    most = max(len(_ranked(result, scene)) for scene in scenes)
    figure = Figure(figsize=(6.4 * len(scenes), 1.2 + 0.26 * most), layout="constrained")
    for axis, scene in zip(figure.subplots(1, len(scenes), squeeze=False)[0], scenes, strict=True):
        rows = _ranked(result, scene)[::-1]
        for place, row in enumerate(rows):
            engine = row["solver"] != ANALYTIC
            colour = style(row["solver"])["color"] if engine else CHANGED
            share = 100 * row["flips"] / row["runs"]
            reach = [[share - 100 * row["low"]], [100 * row["high"] - share]]
            axis.errorbar(
                share,
                place,
                xerr=np.maximum(reach, 0),
                fmt=marker(row["solver"]) if engine else "o",
                color=colour,
                markersize=5,
                capsize=2,
                markerfacecolor=colour if not engine or _rung(result, row) == BEST else "white",
            )
        axis.set_xscale("symlog", linthresh=0.1)
        axis.set(title=scene, xlabel="verdicts flipped [%]", xlim=(-0.02, 110), ylim=(-0.7, len(rows) - 0.3))
        axis.set_xticks([0, 0.1, 0.3, 1, 3, 10, 30, 100], labels=["0", "0.1", "0.3", "1", "3", "10", "30", "100"])
        axis.minorticks_off()
        axis.set_yticks(range(len(rows)), labels=[row["change"] for row in rows], fontsize="small")
        axis.grid(axis="x", color="0.9")
        axis.spines[["top", "right"]].set_visible(False)
    return figure


def _scene(name, scene):
    return f"{name}, slenderness {', '.join(f'{x:g}' for x in scene['slendernesses'])} ({scene['scene']})"


def _rung(result, row):
    return result.settings["rungs"].get(row["change"])


def _ranked(result, scene):
    rows = [row for row in result.rows if row["scene"] == scene and row["runs"]]
    return sorted(rows, key=lambda row: (-row["flips"] / row["runs"], row["change"]))


def _answer(result, scene):
    """One sentence: the three changes that flip most, and what the best engines flip beside them."""
    rows = _ranked(result, scene)
    changed = [row for row in rows if row["solver"] == ANALYTIC]
    best = [row for row in rows if row["solver"] != ANALYTIC and _rung(result, row) == BEST]
    rest = [row for row in rows if row["solver"] != ANALYTIC and _rung(result, row) != BEST]
    words = f"{scene.capitalize()}: most verdicts are flipped by {'; '.join(_said(row) for row in changed[:3])}."
    if best:
        words += f" Engines at their best: {'; '.join(_said(row) for row in best)}."
        least = max(row["high"] for row in best)
        above = [row for row in changed if row["low"] > least]
        words += f" {len(above)} of {len(changed)} changes certainly flip more than the worst of these."
    if rest:
        words += f" At other rungs up to {_said(rest[0])}."
    return words


def _said(row):
    return f"{row['change']} ({percent(row['flips'] / row['runs'])})"


def _tables(result):
    for scene in result.settings["scenes"]:
        yield Table(
            f"{scene}: verdicts flipped, ranked; medians over those upright in both",
            (
                "change",
                "flips",
                "of",
                "95 % interval",
                "to overturning",
                "p (McNemar)",
                "peak tilt",
                "displacement",
                "failed",
            ),
            [
                (
                    row["change"],
                    str(row["flips"]),
                    str(row["runs"]),
                    f"{percent(row['low'])} to {percent(row['high'])}",
                    str(row["falls"]),
                    number(row["p_value"]),
                    percent(row["tilt"]),
                    percent(row["displacement"]),
                    str(row["failed"]),
                )
                for row in _ranked(result, scene)
            ],
        )
