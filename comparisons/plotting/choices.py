"""The result of `rocking choose`, a `Choice`, in words and as a picture."""

import textwrap

from matplotlib.figure import Figure
from rich.text import Text

from engines import missing_words

from ..execution.writing import readable
from ..schemas.advice import Choice, Level
from .plots import marker, style
from .terminal import TITLE_CHARACTERS, digits, echo, grid

AXES = {
    "restitution": "error of restitution, rms, worst scene [-]",
    "tilt": "error of tilt / slenderness, worst [-]",
    "displacement": "error of displacement / its peak, worst [-]",
    "slip": "error of slip / its peak, worst [-]",
    "outcome": "share of neighbours with another outcome [-]",
}
ZERO = 1e-12  # an error of 0 is drawn here


def print_choice(choice: Choice, every_level: bool = False) -> None:
    """Print a choice: the answer, its command, a row for each variant (or for all its levels), and remarks."""
    echo(*(f"Warning: {readable(warning.text)}" for warning in choice.warnings), readable(answer(choice)))
    if choice.command:
        echo(f"\n  {choice.command}\n", textwrap.indent(choice.snippet or "", "  ").rstrip())
    if choice.variants:
        echo(_choice_table(choice, every_level))
    lines = [*_remarks(choice), *map(_about_part, choice.parts)]
    lines += [f"Left out: {factor} of the scene, on which the model {why}." for factor, why in choice.left_out.items()]
    lines += [f"Not tried: {words}." for words in missing_words(choice.missing)]
    lines += ["All levels: --all."] if choice.variants and not every_level else []
    echo(*map(readable, lines))


def answer(choice: Choice) -> str:
    """Return the answer in one sentence: engine, variant, level, error and cost."""
    chosen = choice.chosen
    if chosen is None:
        reached = f"{choice.best.error:.1e} by {named(choice.best)}" if choice.best else "none"
        spare = f" with a factor of {choice.safety_factor:g} to spare" if choice.safety_factor > 1 else ""
        return f"No level passes {choice.error:g} for {choice.criterion}{spare}. The least error: {reached}."
    if not choice.variants:
        return (
            f"The analytic model: the block never lifts on {_scenes(choice)}. Without contact there is no error to "
            f"choose an engine by. The model takes {choice.cpu_seconds:.2g} s of CPU time for the whole scene. To "
            "choose an engine nevertheless: --for."
        )
    return (
        f"{named(chosen)}: error {_digits(chosen.error)} of {choice.criterion}, asked for {choice.error:g}; "
        f"{chosen.cpu_per_second:.2g} s of CPU time per simulated second, {choice.cpu_seconds:.2g} s for the whole "
        f"scene (the analytic model: {choice.analytic_cpu_seconds:.2g} s)."
    )


def named(level: Level) -> str:
    """Engine, variant and level in words."""
    return f"{level.engine}, {level.variant}, {level.parameter} = {level.value:g}" + " (the default)" * level.default


def _digits(error):
    return f"{error:.1e}" if error else "0"


def _scenes(choice):
    first, *others = (f"{factor:g}" for factor in choice.neighbours)
    return f"{len(choice.neighbours)} scenes (start and motion times {first}, {', '.join(others)})"


def _remarks(choice):
    """Return sentences on the chosen level: where it was tested, its order, and who applies the impact."""
    if choice.chosen is None or not choice.variants:
        return []
    chosen = choice.chosen
    chosen_variant = next(
        variant for variant in choice.variants if (variant.engine, variant.variant) == (chosen.engine, chosen.variant)
    )
    spare = f" with a factor of {choice.safety_factor:g} to spare" if choice.safety_factor > 1 else ""
    lines = [f"The level chosen and all finer ones pass on {_scenes(choice)}{spare}."]
    if any(level.untried for variant in choice.variants for level in variant.levels):
        lines.append(
            "Not tried: the level passes the scene itself. It was not run on the others, as it costs more than the "
            "chosen one."
        )
    if chosen_variant.order is not None:
        lines.append(f"Its error goes as the {chosen.parameter} to the power of {chosen_variant.order:.2g}.")
    if chosen_variant.applies_impact and choice.criterion == "restitution":
        levels = [variant.cheapest() for variant in choice.variants if not variant.applies_impact]
        passing = [level for level in levels if level.passes]
        least = min(passing, key=lambda level: level.cpu_per_second, default=None)
        cheapest = f"{named(least)}, at {least.cpu_per_second:.2g} s/s." if least else "none."
        lines.append(
            "Its adapter applies eqs (7) and (8) itself. The cheapest that passes and computes the impact: " + cheapest
        )
    return lines


def _about_part(part):
    need = "is needed" if part.needed else "need not be modelled"
    takes = "it takes" if part.needed else "modelled, it costs"
    cost = f"; {takes} {part.cost:.2g} times the CPU time" if part.cost else ""
    return f"{part.part.capitalize()} {need}: {part.why}{cost}."


def _choice_table(choice, every_level):
    levels = [
        level for variant in choice.variants for level in (variant.levels if every_level else [variant.cheapest()])
    ]
    rows = [
        [
            f"{level.engine}, {level.variant}",
            f"{level.parameter} = {level.value:.3g}",
            "-" if level.error is None else _digits(level.error),
            digits(level.cpu_per_second, ".2g"),
            Text("CHOSEN", "bold")
            if level == choice.chosen
            else "not tried"
            if level.untried
            else level.why or "passes",
        ]
        for level in levels
    ]
    title = Text(f"{readable(choice.scene, TITLE_CHARACTERS)}: {choice.criterion}")
    heads = ["engine, variant", "level", "error", "CPU\n[s/s]", "verdict"]
    return grid(heads, rows, left=["level", "verdict"], wraps=["verdict"], title=title)


def draw_choice(choice: Choice) -> Figure:
    """Draw error over CPU time along each variant's levels: a matplotlib Figure.

    Marks of levels that pass are filled; a ring is around the chosen one.
    """
    figure = Figure(figsize=(8, 5), layout="constrained")
    axis = figure.subplots()
    for variant in choice.variants:
        points = [
            (_point(level), level.passes)
            for level in variant.levels
            if level.error is not None and level.cpu_per_second
        ]
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
        chosen = _point(choice.chosen)
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


def _point(level: Level) -> tuple[float, float]:
    """Return (CPU seconds per second, error), both above 0 for logarithmic axes."""
    return level.cpu_per_second or ZERO, max(level.error or 0.0, ZERO)
