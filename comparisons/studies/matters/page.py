"""What matters, ranked: in words, a table and a picture, from the result alone."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...measuring.statistics import wilson
from ...showing.parts import Section, Table, figure_of, number, percent
from .figures import ANALYTIC, at_best, draw, draw_vertical, parted, ranked, speed

if TYPE_CHECKING:
    from ...running.provenance import Result

USUAL = 0.7  # V/H of the sentence on the contact


def section(result: Result) -> Section:
    """The `Section` of a result of this study."""
    s = result.settings
    asked = (
        f"{s['motions']} synthetic motions at "
        f"{'; '.join(_scene(name, scene) for name, scene in s['scenes'].items())}. Their factors lie lognormally, with "
        f"a deviation of {s['spread']:g}, about the one that overturns half: near the boundary, where verdicts flip. "
        "Each is changed in one way at a time; a flip is another verdict than the analytic model's of the motion as it "
        f"is. {_engines(s)} The vertical motion is another seed's, and bearings are taken as "
        "stiff vertically: real ones sway at 10 to 20 Hz, so that twice the motion is run too."
    )
    answers = [_answer(result, scene) for scene in s["scenes"]]
    raised = [sentence for scene in s["scenes"] for sentence in (_vertical(result, scene), _contact(result, scene))]
    figure = figure_of(
        draw(result),
        f"Share of verdicts flipped by each change and each engine, ranked, with 95 % intervals. {' '.join(answers)}",
        "Share of verdicts that each change flips, with 95 % Wilson intervals. Grey: changes of the scene in the "
        "analytic model; coloured: engines on the unchanged scene, filled at their best, open in other variants.",
    )
    over = figure_of(
        draw_vertical(result),
        f"Share of verdicts that the vertical motion flips, over V/H. {' '.join(raised)}",
        "Share of verdicts that the vertical motion flips over its peak, with 95 % Wilson intervals, for "
        "vertical motions "
        "as fast as the horizontal ones, twice and four times as fast. Diamonds: recorded triples in all "
        "directions about "
        "the factor that overturns half, with the mean frequency of their vertical over that of their "
        "horizontal motion.",
    )
    title = "What matters more than the engine"
    return Section(title, (asked, *answers, *raised), tuple(_tables(result)), (figure, over))


def _scene(name, scene):
    return f"{name}, slenderness {', '.join(f'{x:g}' for x in scene['slendernesses'])} ({scene['scene']})"


def _engines(settings):
    """What engines are given, and what so few runs resolve."""
    if not settings["best"]:
        return "No engine took part."
    best, others = settings["motions_of_engines"], settings["motions_of_other_variants"]
    slender = "; ".join(f"{value:g} ({name})" for name, value in settings["slenderness_of_engines"].items())
    return (
        f"Engines run the first {best} at their best, {others} in other variants, whose peak is at least "
        f"{settings['lifting']:g} g tan γ, at slenderness {slender}: without a flip among them, a share up "
        f"to {percent(wilson(0, best)[1])} and {percent(wilson(0, others)[1])} is not excluded."
    )


def _vertical(result, scene):
    """One sentence: what V/H and how fast the vertical motion is make of it; recorded triples beside it."""
    rows = [row for row in parted(result, "vertical", scene) if row["ratio"]]
    told = []
    for faster in dict.fromkeys(row["faster"] for row in rows):
        first, *_, last = [row for row in rows if row["faster"] == faster]
        told.append(
            f"{percent(first['flips'] / first['runs'])} at V/H {first['ratio']:g} to "
            f"{percent(last['flips'] / last['runs'])} at {last['ratio']:g}, {speed(faster)}"
        )
    words = f"{scene.capitalize()}: the vertical motion flips {'; '.join(told)}."
    recorded = parted(result, "record", scene)
    if recorded:
        words += " Recorded triples: " + "; ".join(
            f"{percent(row['flips'] / row['runs'])} of {row['runs']} verdicts at V/H {row['ratio']:.2f}, "
            f"{speed(round(row['faster'], 1))} (turned by 30°: {percent(row['turned'] / row['runs'])})"
            for row in recorded
        )
        words += "; runs of one record are no sample, so that these have no intervals."
    return words


def _contact(result, scene):
    """One sentence: friction demand against coefficients and the normal force against zero, without and with it."""
    told = []
    rows = parted(result, "vertical", scene)
    for row in [row for row in rows if row["ratio"] in (0, USUAL, max(row["ratio"] for row in rows))]:
        if row["faster"] == 1:
            sliding = ", ".join(f"{limit} in {percent(n / row['runs'])}" for limit, n in row["sliding"].items())
            told.append(
                f"at V/H {row['ratio']:g} the block needs more friction than {sliding} of the runs, and N "
                "reaches zero, "
                f"where the model ends, in {percent(row['lifts_off'] / row['runs'])}"
            )
    return f"{scene.capitalize()}: " + "; ".join(told) + "."


def _answer(result, scene):
    """One sentence: the three changes that flip most, and what the best engines flip beside them."""
    rows = ranked(result, scene)
    changed = [row for row in rows if row["solver"] == ANALYTIC]
    best = [row for row in rows if row["solver"] != ANALYTIC and at_best(result, row)]
    rest = [row for row in rows if row["solver"] != ANALYTIC and not at_best(result, row)]
    words = f"{scene.capitalize()}: most verdicts are flipped by {'; '.join(_said(row) for row in changed[:3])}."
    if best:
        words += f" Engines at their best: {'; '.join(_said(row) for row in best)}."
        least = max(row["high"] for row in best)
        above = [row for row in changed if row["low"] > least]
        words += f" {len(above)} of {len(changed)} changes certainly flip more than the worst of these."
    if rest:
        words += f" In other variants up to {_said(rest[0])}."
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
                for row in ranked(result, scene)
            ],
        )
