"""A `Choice` in words and as a picture."""

from __future__ import annotations

from typing import TYPE_CHECKING

from matplotlib.figure import Figure
from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from engines import missing_words

from ..running.readable import readable
from .plots import TITLE_CHARACTERS, marker, style

if TYPE_CHECKING:
    from ..advice.found import Choice, Setting

AXES = {
    "restitution": "error of restitution, rms, worst scene [-]",
    "tilt": "error of tilt / slenderness, worst [-]",
    "displacement": "error of displacement / its peak, worst [-]",
    "outcome": "share of neighbours with another outcome [-]",
}
ZERO = 1e-12  # an error of 0 is drawn here


def print_choice(choice: Choice) -> None:
    """Print a choice: the ladders as a table, the answer, and what need not be modelled."""
    console = Console(highlight=False)
    if choice.ladders:
        console.print(_table(choice))
    for line in answer(choice):
        console.print(Text(readable(line)), soft_wrap=True)
    if choice.command:
        console.print(f"\n  {choice.command}\n", markup=False, soft_wrap=True)
        console.print("\n".join(f"  {line}" for line in choice.snippet.splitlines()), markup=False, soft_wrap=True)  # type: ignore[union-attr]  # beside the command
    for part in choice.spared:
        need = "is needed" if part.needed else "need not be modelled"
        cost = f"; all the same it costs {part.cost:.2g} times the CPU time" if part.cost and not part.needed else ""
        cost = f"; it takes {part.cost:.2g} times the CPU time" if part.cost and part.needed else cost
        console.print(Text(f"{part.part.capitalize()} {need}: {part.why}{cost}."), soft_wrap=True)
    for words in missing_words(choice.missing):
        console.print(Text(f"Not tried: {words}."), soft_wrap=True)


def answer(choice: Choice) -> list[str]:
    """The answer in sentences."""
    share = f"{len(choice.neighbours)} scenes (start and motion times {choice.neighbours[0]:g}"
    share = f"{share}, {', '.join(f'{factor:g}' for factor in choice.neighbours[1:])})"
    if choice.chosen is None:
        reached = f"{choice.best.error:.1e} by {named(choice.best)}" if choice.best else "none"
        return [f"No setting passes {choice.error:g} for {choice.aim}. The best reached: {reached}."]
    one = choice.chosen
    if not choice.ladders:
        return [
            f"The analytic model: the block never lifts on {share}, and without contact there is no error of an engine "
            f"to choose by; {choice.cpu_seconds:.2g} s of CPU time for the whole scene. Engines all the same: --for."
        ]
    lines = [
        f"{named(one)}: it and all finer settings of its ladder pass {choice.error:g} for {choice.aim} on {share}, the "
        f"worst {one.error:.1e}; {one.cpu_per_second:.2g} s of CPU time per simulated second, {choice.cpu_seconds:.2g} "
        f"s for the whole scene (the analytic model: {choice.analytic_cpu_seconds:.2g} s)."
    ]
    ladder = _ladder_of(choice, one)
    if ladder.order is not None:
        lines.append(f"Its error goes as the {one.knob} to the power of {ladder.order:.2g}.")
    if ladder.applies_impact and choice.aim == "restitution":
        own = [
            other
            for each in choice.ladders
            if not each.applies_impact
            for other in each.settings
            if other.passes and other.cpu_per_second is not None
        ]
        least = min(own, key=lambda other: other.cpu_per_second or 0.0, default=None)
        lines.append(
            "Its adapter applies eqs (7) and (8) itself. The cheapest that passes and decides the impact itself: "
            + (f"{named(least)}, at {least.cpu_per_second:.2g} s/s." if least else "none.")
        )
    return lines


def named(one: Setting) -> str:
    """A setting as sentences call it."""
    return f"{one.engine}, {one.variant}, {one.knob} = {one.value:g}{' (the default)' if one.default else ''}"


def _ladder_of(choice, one):
    return next(each for each in choice.ladders if (each.engine, each.variant) == (one.engine, one.variant))


def _table(choice):
    table = Table(title=Text(f"{readable(choice.scene, TITLE_CHARACTERS)}: {choice.aim}"), box=box.SIMPLE_HEAD)
    for name in ("engine, variant", "knob", "error", "CPU\n[s/s]", ""):
        table.add_column(Text(name), justify="right" if name in ("error", "CPU\n[s/s]") else "left")
    for ladder in choice.ladders:
        for k, one in enumerate(ladder.settings):
            table.add_row(
                f"{ladder.engine}\n{ladder.variant}" if k == 0 else "",
                f"{one.knob}\n{one.value:.3g}" if k == 0 else f"{one.value:.3g}",
                "-" if one.error is None else f"{one.error:.1e}",
                "-" if one.cpu_per_second is None else f"{one.cpu_per_second:.2g}",
                Text("CHOSEN", style="bold")
                if one == choice.chosen
                else Text("passes" if one.passes else one.why or ""),
            )
    return table


def draw_choice(choice: Choice) -> Figure:
    """Error over CPU time along each ladder; filled where a setting passes, a ring around the one chosen."""
    figure = Figure(figsize=(8, 5), layout="constrained")
    axis = figure.subplots()
    for ladder in choice.ladders:
        points = [(_place(one), one.passes) for one in ladder.settings if one.error is not None and one.cpu_per_second]
        look = style(ladder.engine)
        axis.plot(
            [place[0] for place, _ in points],
            [place[1] for place, _ in points],
            color=look["color"],
            linewidth=0.8,
            linestyle="--" if ladder.tier != "tuned" else "-",
            label=f"{ladder.engine}, {ladder.variant}",
        )
        for place, passes in points:
            filled = look["color"] if passes else "white"
            axis.plot(*place, marker=marker(ladder.engine), color=look["color"], markerfacecolor=filled)
    if choice.chosen is not None:
        chosen = _place(choice.chosen)
        axis.plot(*chosen, "o", markersize=16, markerfacecolor="none", markeredgecolor="black", label="chosen")
    axis.axhline(choice.error, color="0.4", linestyle=":", label="asked for")
    axis.set(
        xscale="log",
        yscale="log" if choice.aim != "outcome" else "linear",
        xlabel="CPU time per simulated second [s/s]",
        ylabel=AXES[choice.aim],
    )
    axis.set_title(readable(choice.scene, TITLE_CHARACTERS), parse_math=False)
    axis.legend(fontsize="small", loc="best")
    return figure


def _place(one: Setting) -> tuple[float, float]:
    """(CPU seconds per second, error), both above 0."""
    return one.cpu_per_second or ZERO, max(one.error or 0.0, ZERO)
