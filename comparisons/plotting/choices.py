"""A `Choice` in words and as a picture."""

import textwrap

from matplotlib.figure import Figure
from rich.text import Text

from engines import missing_words

from ..advice.criteria import Choice, Level
from ..execution.files import readable
from .plots import TITLE_CHARACTERS, marker, style
from .terminal import digits, echo, grid

AXES = {
    "restitution": "error of restitution, rms, worst scene [-]",
    "tilt": "error of tilt / slenderness, worst [-]",
    "displacement": "error of displacement / its peak, worst [-]",
    "slip": "error of slip / its peak, worst [-]",
    "outcome": "share of neighbours with another outcome [-]",
}
ZERO = 1e-12  # an error of 0 is drawn here


def print_choice(choice: Choice, every_level: bool = False) -> None:
    """Print a choice: the answer and how it is used, a line per variant (or all its levels), what else was found."""
    echo(*(f"Warning: {readable(one.text)}" for one in choice.warnings), readable(answer(choice)))
    if choice.command:
        echo(f"\n  {choice.command}\n", textwrap.indent(choice.snippet or "", "  ").rstrip())
    if choice.variants:
        echo(_table(choice, every_level))
    lines = [*_remarks(choice), *map(_about_part, choice.parts)]
    lines += [f"Left out: {factor} of the scene, on which the model {why}." for factor, why in choice.left_out.items()]
    lines += [f"Not tried: {words}." for words in missing_words(choice.missing)]
    lines += ["All levels: --all."] if choice.variants and not every_level else []
    echo(*map(readable, lines))


def answer(choice: Choice) -> str:
    """The answer in a sentence: engine, variant, level, error and cost."""
    one = choice.chosen
    if one is None:
        reached = f"{choice.best.error:.1e} by {named(choice.best)}" if choice.best else "none"
        spare = f" with a factor of {choice.safety_factor:g} to spare" if choice.safety_factor > 1 else ""
        return f"No level passes {choice.error:g} for {choice.criterion}{spare}. The least error: {reached}."
    if not choice.variants:
        return (
            f"The analytic model: the block never lifts on {_scenes(choice)}, and without contact there is no error of "
            f"an engine to choose by; {choice.cpu_seconds:.2g} s of CPU time for the whole scene. Engines all the "
            "same: --for."
        )
    return (
        f"{named(one)}: error {_digits(one.error)} of {choice.criterion}, asked for {choice.error:g}; "
        f"{one.cpu_per_second:.2g} s of CPU time per simulated second, {choice.cpu_seconds:.2g} s for the whole scene "
        f"(the analytic model: {choice.analytic_cpu_seconds:.2g} s)."
    )


def named(one: Level) -> str:
    return f"{one.engine}, {one.variant}, {one.parameter} = {one.value:g}{' (the default)' if one.default else ''}"


def _digits(error):
    return f"{error:.1e}" if error else "0"


def _scenes(choice):
    first, *others = (f"{factor:g}" for factor in choice.neighbours)
    return f"{len(choice.neighbours)} scenes (start and motion times {first}, {', '.join(others)})"


def _remarks(choice):
    """Sentences on the level chosen: where it was tested, its order, and who applies the impact."""
    if choice.chosen is None or not choice.variants:
        return []
    one = choice.chosen
    own = next(each for each in choice.variants if (each.engine, each.variant) == (one.engine, one.variant))
    spare = f" with a factor of {choice.safety_factor:g} to spare" if choice.safety_factor > 1 else ""
    lines = [f"The level chosen and all finer ones pass on {_scenes(choice)}{spare}."]
    if any(level.untried for variant in choice.variants for level in variant.levels):
        lines.append(
            "Not tried: it passes the scene, and was not run on the others, as it costs more than the one chosen."
        )
    if own.order is not None:
        lines.append(f"Its error goes as the {one.parameter} to the power of {own.order:.2g}.")
    if own.applies_impact and choice.criterion == "restitution":
        levels = [each.cheapest() for each in choice.variants if not each.applies_impact]
        passing = [each for each in levels if each.passes]
        least = min(passing, key=lambda each: each.cpu_per_second, default=None)
        other = f"{named(least)}, at {least.cpu_per_second:.2g} s/s." if least else "none."
        lines.append(
            "Its adapter applies eqs (7) and (8) itself. The cheapest that passes and computes the impact: " + other
        )
    return lines


def _about_part(part):
    need = "is needed" if part.needed else "need not be modelled"
    takes = "it takes" if part.needed else "modelled, it costs"
    cost = f"; {takes} {part.cost:.2g} times the CPU time" if part.cost else ""
    return f"{part.part.capitalize()} {need}: {part.why}{cost}."


def _table(choice, every_level):
    levels = [one for each in choice.variants for one in (each.levels if every_level else [each.cheapest()])]
    rows = [
        [
            f"{one.engine}, {one.variant}",
            f"{one.parameter} = {one.value:.3g}",
            "-" if one.error is None else _digits(one.error),
            digits(one.cpu_per_second, ".2g"),
            Text("CHOSEN", "bold") if one == choice.chosen else "not tried" if one.untried else one.why or "passes",
        ]
        for one in levels
    ]
    title = Text(f"{readable(choice.scene, TITLE_CHARACTERS)}: {choice.criterion}")
    heads = ["engine, variant", "level", "error", "CPU\n[s/s]", "verdict"]
    return grid(heads, rows, left=["level", "verdict"], wraps=["verdict"], title=title)


def draw_choice(choice: Choice) -> Figure:
    """Error over CPU time along each variant's levels; filled where one passes, a ring around the one chosen."""
    figure = Figure(figsize=(8, 5), layout="constrained")
    axis = figure.subplots()
    for variant in choice.variants:
        points = [(_place(one), one.passes) for one in variant.levels if one.error is not None and one.cpu_per_second]
        look = style(variant.engine)
        axis.plot(
            [place[0] for place, _ in points],
            [place[1] for place, _ in points],
            color=look["color"],
            linewidth=0.8,
            linestyle="--" if variant.tier != "tuned" else "-",
            label=f"{variant.engine}, {variant.variant}",
        )
        for place, passes in points:
            filled = look["color"] if passes else "white"
            axis.plot(*place, marker=marker(variant.engine), color=look["color"], markerfacecolor=filled)
    if choice.chosen is not None:
        chosen = _place(choice.chosen)
        axis.plot(*chosen, "o", markersize=16, markerfacecolor="none", markeredgecolor="black", label="chosen")
    axis.axhline(choice.error, color="0.4", linestyle=":", label="asked for")
    axis.set(
        xscale="log",
        yscale="log" if choice.criterion != "outcome" else "linear",
        xlabel="CPU time per simulated second [s/s]",
        ylabel=AXES[choice.criterion],
    )
    axis.set_title(readable(choice.scene, TITLE_CHARACTERS), parse_math=False)
    axis.legend(fontsize="small", loc="best")
    return figure


def _place(one: Level) -> tuple[float, float]:
    """(CPU seconds per second, error), both above 0."""
    return one.cpu_per_second or ZERO, max(one.error or 0.0, ZERO)
