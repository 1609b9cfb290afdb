"""The margins of a verdict, as a table for the terminal and as a picture."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from matplotlib.figure import Figure
from matplotlib.patches import Patch
from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from ..running.readable import readable
from .plots import TITLE_CHARACTERS

if TYPE_CHECKING:
    from analytic import Scene
    from analytic.margins import Contact, Margin

# Okabe and Ito; the hatches tell them apart in print.
COLOURS = {"stands": ("#009E73", ""), "rocks": ("#F0E442", ".."), "overturns": ("#D55E00", "//"), "failed": ("0.4", "")}


def print_margins(scene: Scene, margins: Sequence[Margin], contact: Contact, span: float) -> None:
    """Print a row for each `Margin`, the nearest first, and what the contact has to spare."""
    outcome, nearest = margins[0].outcome, margins[0]
    table = Table(
        title=Text(f"{readable(scene.name, TITLE_CHARACTERS)}: {outcome}"), box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0)
    )
    for name in ("quantity", "value", "flips below at", "flips above at", "flips", "left at"):
        table.add_column(Text(name), justify="left" if name == "quantity" else "right", no_wrap=True)
    table.caption = (
        "Each quantity alone: slenderness at fixed R, mass and J_O; size at fixed mass and shape.\n"
        f"flips: boundaries within ± {span:g} %; left at: from there on the model does not hold."
    )
    for margin in margins:
        table.add_row(
            margin.quantity,
            f"{margin.value:.5g}" + (f" {margin.unit}" if margin.unit != "-" else ""),
            _flip(margin, margin.down),
            _flip(margin, margin.up),
            str(sum(a.outcome != b.outcome for a, b in zip(margin.bands[:-1], margin.bands[1:], strict=True))),
            _percent(margin.leaves_model),
        )
    console = Console(highlight=False)
    console.print(table)
    if nearest.nearest is None:
        console.print(f"No change of up to {span:g} % of any one quantity flips the verdict.", soft_wrap=True)
    else:
        console.print(
            f"Nearest flip: {nearest.quantity} {_percent(nearest.nearest)}, the block then "
            f"{nearest.beyond(nearest.nearest)}.",
            soft_wrap=True,
        )
    if frayed := [margin for margin in margins if margin.frayed]:
        console.print(
            f"Frayed in {', '.join(margin.quantity for margin in frayed)}: bands narrower than "
            f"{200 * frayed[0].step:.2g} % alternate there, and still narrower ones may lie nearer than the flip that "
            "is given: do not rest a decision on this margin.",
            soft_wrap=True,
        )
    console.print(f"{_normal_words(contact)} {_friction_words(contact)}", soft_wrap=True)
    if scene.bearings is not None:
        console.print("Assumed: the bearings are stiff vertically (real ones sway at 10 to 20 Hz).", soft_wrap=True)


def draw_margins(scene: Scene, margins: Sequence[Margin]) -> Figure:
    """Outcomes over the relative change of each quantity, a strip for each `Margin`: a matplotlib Figure."""
    figure = Figure(figsize=(8, 1.5 + 0.42 * len(margins)), layout="constrained")
    axis = figure.subplots()
    for row, margin in enumerate(margins):
        for band in margin.bands:
            colour, hatch = COLOURS[band.outcome]
            left, width = 100 * band.low, 100 * (band.high - band.low)
            axis.barh(row, width, left=left, height=0.7, color=colour, hatch=hatch, edgecolor="0.25", linewidth=0)
            if not band.holds:
                axis.barh(row - 0.39, width, left=left, height=0.08, color="#CC79A7")
        for change in (margin.down, margin.up):
            if change is not None:
                _label(axis, row, change)
    axis.axvline(0, color="black", linewidth=1)
    axis.set_yticks(range(len(margins)), [f"{margin.quantity}" for margin in margins])
    axis.invert_yaxis()
    axis.set_xlim(
        100 * min(margin.bands[0].low for margin in margins), 100 * max(margin.bands[-1].high for margin in margins)
    )
    axis.set_xlabel("change of one quantity [%]")
    axis.set_title(f"{readable(scene.name, TITLE_CHARACTERS)}: {margins[0].outcome}", loc="left")
    shown = {band.outcome for margin in margins for band in margin.bands}
    handles = [
        Patch(facecolor=colour, hatch=hatch, edgecolor="0.25", linewidth=0, label=name)
        for name, (colour, hatch) in COLOURS.items()
        if name in shown
    ]
    if any(not band.holds for margin in margins for band in margin.bands):
        handles.append(Patch(facecolor="#CC79A7", label="outside the model (N ≤ 0, or sliding)"))
    figure.legend(handles=handles, loc="outside lower center", ncols=len(handles), frameon=False)
    return figure


def _label(axis, row, change):
    axis.annotate(
        _percent(change),
        (100 * change, row),
        (-4 if change > 0 else 4, 0),
        textcoords="offset points",
        ha="right" if change > 0 else "left",
        va="center",
        fontsize="small",
        bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 1},
    )


def _percent(change):
    if change is None:
        return ""
    return "now" if change == 0 else f"{100 * change:+.3g} %"


def _flip(margin, change):
    return "" if change is None else f"{_percent(change)} {margin.beyond(change)}"


def _normal_words(contact):
    if contact.least_normal <= 0:
        return f"The normal force falls to {contact.least_normal:.3g} m g: the outcome is outside the model."
    return f"The normal force falls to {contact.least_normal:.3g} m g; at 0 the block would jump."


def _friction_words(contact):
    demand = f"The friction demand is {contact.friction_demand:.3g}"
    if contact.friction is None:
        return f"{demand}; the scene gives no coefficient to hold it against."
    if contact.friction_demand > contact.friction:
        return f"{demand}, above the scene's {contact.friction:g}: the outcome is outside the model."
    spare = contact.friction / contact.friction_demand if contact.friction_demand else math.inf
    return f"{demand} of the scene's {contact.friction:g}, {spare:.3g} times less."
