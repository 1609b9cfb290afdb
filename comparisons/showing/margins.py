"""The margins of a scene, as a table for the terminal and as a picture."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import TYPE_CHECKING

from matplotlib.figure import Figure
from matplotlib.patches import Patch

from analytic.limits import scene_warnings
from analytic.margins import limit_states

from ..running.readable import readable
from .plots import TITLE_CHARACTERS
from .terminal import Grid, echo, grid

if TYPE_CHECKING:
    from analytic import Scene
    from analytic.margins import Contact, Margin

# Okabe and Ito; hatches, and the lines’ places, tell them apart in print.
COLOURS = {"stands": ("#009E73", ""), "rocks": ("#F0E442", ".."), "overturns": ("#D55E00", "//"), "failed": ("0.4", "")}

# Lines along a strip: colour, and where they begin.
OUTSIDE, TILT, STROKE = ("#CC79A7", -0.43), ("#0072B2", 0.35), ("#56B4E9", 0.43)


def print_margins(scene: Scene, margins: Sequence[Margin], contact: Contact, span: float, tilt: float) -> None:
    """Print a row for each `Margin` with a change, in order, and the reserves of the contact."""
    nearest = margins[0]
    names = {state: name for state, name in _names(tilt).items() if state in limit_states(scene)}
    now = ", ".join(name for state, name in names.items() if nearest.reached(state))
    parts: list[Grid | str] = [
        *(f"Warning: {warning}" for warning in scene_warnings(scene)),
        f"{readable(scene.name, TITLE_CHARACTERS)}: {nearest.outcome}\nnow: {now or 'no limit state'}",
    ]
    rows = {margin: [margin.change(state) for state in names] for margin in margins}
    rows = {margin: changes for margin, changes in rows.items() if any([*changes, margin.leaves_model])}
    if rows:
        parts += [
            _table([f"no longer\n{name}" if nearest.reached(state) else name for state, name in names.items()], rows),
            "Each quantity alone, to the nearest change at which a limit state is reached, or no longer is, as its "
            "column says. Slenderness at fixed R, mass and J_O; size at fixed mass and shape."
            + (" Left at: from there on the model does not hold." if _leaves(rows) else ""),
        ]
    if still := ", ".join(margin.quantity for margin in margins if margin not in rows):
        parts.append(f"No change of up to {span:g} % of {still} changes any of these: {', '.join(names.values())}.")
    if nearest.nearest is None:
        parts.append(f"No change of up to {span:g} % of any one quantity changes the outcome.")
    else:
        parts.append(
            f"Nearest change of the outcome: {nearest.quantity} {_percent(nearest.nearest)}, the block then "
            f"{nearest.beyond(nearest.nearest)}."
        )
    if bands := [margin for margin in margins if margin.interleaved]:
        parts.append(
            f"The outcomes are interleaved in {', '.join(margin.quantity for margin in bands)}: bands narrower than "
            f"{200 * bands[0].step:.2g} % alternate there. Narrower ones may lie nearer than the change "
            "given: do not base a decision on this margin."
        )
    parts.append(f"{_normal_words(contact)} {_friction_words(contact)}")
    if scene.bearings is not None:
        parts.append("Assumed: the bearings are stiff vertically (real ones sway at 10 to 20 Hz).")
    echo(*parts, wrap=True)


def _names(tilt):
    """{limit state: as it is called here}."""
    return {"lifts": "lifts", "tilt": f"tilt > {tilt:g} γ", "stroke": "base > x_max", "overturns": "overturns"}


def named(changes: Mapping[str, float | None], reached: Collection[str], tilt: float) -> dict[str, str]:
    """{limit state as tables call it: its change in words} of {limit state: change} and those reached without one."""
    words = {state: _percent(change) for state, change in changes.items()}
    words |= {state: f"no longer\n{words[state]}" if words[state] else "now" for state in reached}
    return {_names(tilt)[state]: change for state, change in words.items()}


def _leaves(margins):
    return any(margin.leaves_model is not None for margin in margins)


def _table(names, rows):
    """names: of the limit states; rows: {margin: its change of each}."""
    outside = _leaves(rows)
    heads = ["quantity", "value", *names, *(["left at"] if outside else [])]
    cells = [
        [
            margin.quantity,
            f"{margin.value:.5g} {margin.unit}".removesuffix(" -"),
            *map(_percent, [*changes, *([margin.leaves_model] if outside else [])]),
        ]
        for margin, changes in rows.items()
    ]
    return grid([head.replace(" > ", "\n> ") for head in heads], cells)  # 80 columns hold the widest numbers


def draw_margins(scene: Scene, margins: Sequence[Margin], tilt: float) -> Figure:
    """Outcomes over the relative change of each quantity, a strip for each `Margin`: a matplotlib Figure.

    Lines along a strip: where the peak tilt exceeds its limit, the base its own, and where the model does not hold.
    """
    figure = Figure(figsize=(8, 1.5 + 0.42 * len(margins)), layout="constrained")
    axis = figure.subplots()
    for row, margin in enumerate(margins):
        for band in margin.bands:
            colour, hatch = COLOURS[band.outcome]
            left, width = 100 * band.low, 100 * (band.high - band.low)
            axis.barh(row, width, left=left, height=0.7, color=colour, hatch=hatch, edgecolor="0.25", linewidth=0)
            for colour, place in _lines(band):
                axis.barh(row + place, width, left=left, height=0.08, color=colour, align="edge")
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
    names = _names(tilt)
    labels = {TILT: names["tilt"], STROKE: names["stroke"], OUTSIDE: "outside the model (N ≤ 0, or sliding)"}
    drawn = {line for margin in margins for band in margin.bands for line in _lines(band)}
    handles += [Patch(facecolor=line[0], label=label) for line, label in labels.items() if line in drawn]
    figure.legend(handles=handles, loc="outside lower center", ncols=3, frameon=False)
    return figure


def _lines(band):
    """Those of OUTSIDE, TILT and STROKE that a band has."""
    found = {OUTSIDE: not band.holds, TILT: "tilt" in band.reached, STROKE: "stroke" in band.reached}
    return [line for line, shown in found.items() if shown]


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
    return f"{demand}, the scene's coefficient {contact.friction:g}."
