"""Figures of the study that are no lines of rows: reliability, and the tests in the plane of PGA and PGV/PGA."""

from bisect import bisect_right
from collections.abc import Sequence
from typing import Any

import numpy as np

from ...measuring.statistics import wilson
from ...showing.charts import Axis, Chart, curve, figure, key_of
from ...showing.parts import Figure, grouped, percent
from .at_hand import AtHand
from .campaign import outcomes_of
from .measures import measures_of

BOUNDS = (0.1, 0.3, 0.5, 0.7, 0.9)  # of probability, between the tones
TICKS = ((0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5), (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1))


def tone(probability: float) -> str:
    """The colour of a probability, from the one of what stands to the one of what overturns."""
    share = 100 * bisect_right(BOUNDS, probability) // len(BOUNDS)
    return f"color-mix(in srgb, var(--ghost) {share}%, var(--accent))"


def reliabilities(rows: Sequence[dict[str, Any]]) -> Figure | None:
    """The share that overturned over the predicted probability, by cells of tests; a panel for each specimen."""
    names = [name for (name,) in grouped(rows, "forecast")]
    looks = {name: curve(place) for place, name in enumerate(names)}
    charts = []
    for (specimen,), members in grouped(rows, "specimen").items():
        chart = Chart(
            Axis("predicted probability [-]", 0.0, 1.0),
            Axis("share that overturned [-]", 0.0, 1.0),
            f"{specimen}: share that overturned over the probability predicted by {', '.join(names)}.",
            title=specimen,
            height=300,
        )
        chart.line([0, 1], [0, 1], tone="var(--faint)")
        for (name,), cells in grouped(members, "forecast").items():
            xs, ys = [cell["mean"] for cell in cells], [cell["happened"] / cell["size"] for cell in cells]
            lows, highs = zip(*(wilson(cell["happened"], cell["size"]) for cell in cells), strict=True)
            says = [f"{name}: {cell['happened']} of {cell['size']} at {percent(cell['mean'])}" for cell in cells]
            chart.reach(xs, ys, lows, highs, tone=looks[name].tone)
            chart.dots(xs, ys, name, says=says, look=looks[name])
        charts.append(chart)
    keys = {name: key_of(name, joined=False, look=look) for name, look in looks.items()}
    caption = (
        "On the line a probability means what it says. Cells of five tests or more, with 95 % Wilson intervals by test."
    )
    return figure(charts, caption, keys, keys) if charts else None


def agreement(specimens: Sequence[dict[str, Any]], right: dict[str, np.ndarray]) -> Figure | None:
    """Right answers over the slenderness, a line for each restitution; right: {kind of model: by specimen and
    slenderness}."""
    looks = {name: curve(place) for place, name in enumerate(right)}
    low, high = (float(find([find(one) for one in right.values()])) for find in (np.min, np.max))
    charts = []
    for k, specimen in enumerate(specimens):
        angles = np.degrees(specimen["grid"])
        chart = Chart(
            Axis("slenderness [deg]", float(angles[0]), float(angles[-1])),
            Axis("right answers", 0.98 * low, max(1.02 * high, 1.0)),
            f"{specimen['name']}: right answers of the model over the slenderness; {', '.join(right)}.",
            title=specimen["name"],
            height=300,
        )
        for name, look in looks.items():
            chart.line(angles, right[name][k], name, look=look)
        charts.append(chart)
    keys = {name: key_of(name, look=look) for name, look in looks.items()}
    caption = (
        "Right answers of the model over its slenderness, as it is and with its restitution times a factor. Nothing is "
        "fitted; sums over all tests."
    )
    return figure(charts, caption, keys, keys) if charts else None


def plane(cells: Sequence[dict[str, Any]], here: AtHand | None) -> Figure | None:
    """Where in the plane of PGA and PGV/PGA it overturned, and what the model says: every test with the campaign at
    hand, else cells of tests."""
    groups = grouped(cells, "specimen")
    if not groups:
        return None
    if here is None:
        charts = [_of_cells(name, members) for (name,), members in groups.items()]
        caption = (
            "Cells of neighbouring tests, each at their mean: the colour is the model’s mean probability, the number "
            "beside it the share that overturned, in tenths."
        )
    else:
        charts = [_of_tests(name, k, here) for k, (name,) in enumerate(groups)]
        caption = "Every test: filled, it overturned; open, it did not. The colour: the model’s probability, held out."
    return figure(charts, f"{caption} From blue, surely stands, to orange, surely overturns; in six steps.")


def _chart(name, x, y, words):
    (across, up) = (
        Axis(label, low, high, "log", tuple((tick, f"{tick:g}") for tick in ticks if low <= tick <= high))
        for label, values, ticks in zip(("PGA [g]", "PGV/PGA [s]"), (x, y), TICKS, strict=True)
        for low, high in ((0.9 * min(values), 1.3 * max(values)),)  # room for the words beside a cell
    )
    return Chart(across, up, f"{name}: {words} over PGA and PGV/PGA.", title=name, height=320)


def _of_cells(name, members):
    x, y = ([row[key] for row in members] for key in ("pga", "ratio"))
    chart = _chart(name, x, y, "the model’s mean probability and the share that overturned")
    for row in members:
        words = f"{row['overturned']} of {row['size']} overturned; model {percent(row['mean'])}"
        chart.dots([row["pga"]], [row["ratio"]], says=[words], tone=tone(row["mean"]), mark="s")
        chart.beside(row["pga"], row["ratio"], f"{10 * row['overturned'] / row['size']:.0f}")
    return chart


def _of_tests(name, k, here):
    tests, measures = here.campaign.tests, measures_of(here.campaign)
    x, y = measures["PGA"], measures["PGV"] / (here.campaign.specimens[k].scene.gravity * measures["PGA"])
    chart = _chart(name, x, y, "every test, filled where it overturned, by the model’s probability")
    fell, probability = outcomes_of(tests, k), here.probabilities[k]
    order = np.argsort(np.abs(probability - fell))  # what surprises the model lies on top
    for place in order.tolist():
        ending, share = "overturned" if fell[place] else "stood", float(probability[place])
        words = f"test {tests[place].name}: {ending}; model {percent(share)}"
        chart.dots(
            [x[place]], [y[place]], says=[words], tone=tone(share), mark="o", filled=bool(fell[place]), small=True
        )
    return chart
