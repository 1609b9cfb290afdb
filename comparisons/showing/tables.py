"""Tables for the terminal."""

from __future__ import annotations

import dataclasses
import inspect
import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from engines.statue_range import in_words

from ..running.readable import readable
from .wording import differing

if TYPE_CHECKING:
    from analytic import Response, Scene
    from engines.contract import Engine

    from ..measuring.horizon import Horizon

TITLE_CHARACTERS = 100
MOTION = "motion"  # the kind of warning that is of the scene, not of a solver


def _number(value, form=".4g"):
    return "-" if value is None or math.isnan(value) else f"{value:{form}}"


def _name(scene):
    return readable(scene.name, TITLE_CHARACTERS)


def summary(scene: Scene, response: Response) -> Table:
    """The main figures of one response, as a table."""
    title = Text(f"{_name(scene)}: {response.engine}" + (f", {response.variant}" if response.variant else ""))
    table = Table(title=title, box=box.SIMPLE, show_header=False)
    rows = {
        "outcome": response.verdict,
        "overturning time [s]": _number(response.overturning_time, ".6g"),
        "peak tilt [rad]": _number(response.peak_tilt),
        "peak tilt / slenderness": _number(response.peak_tilt_ratio),
        "peak base displacement [m]": _number(response.peak_base_displacement),
        "peak base acceleration [m/s2]": _number(response.peak_base_acceleration),
        "impacts": str(response.impact_count),
        "friction demand |H|/N": _number(response.friction_demand),
        "least normal force N/(m g)": _number(response.min_normal_ratio),
        "CPU time [s]": _number(response.cpu_seconds, ".3g"),
        "steps": str(response.steps),
    }
    for name, value in rows.items():
        table.add_row(Text(name), Text(value))  # as text: a unit in brackets is no markup
    return table


def comparison(scene: Scene, responses: Sequence[Response], horizons: Mapping[str, Horizon]) -> Table:
    """Responses of several solvers side by side, the first being the reference; horizons: {solver: its `Horizon`}."""
    limit = "Not sensitive: the histories can be compared to the end." if horizons else "No sensitivity horizon known."
    if any(found.parts for found in horizons.values()):
        limit = "Sensitivity horizon, beyond which only outcomes can be compared,\nby each solver's own size of error:"
        limit += "".join(
            f"\n{name} {f'{found.horizon:.3g} s' if found.parts else 'none, to the end'} ({found.perturbation:.0e})"
            for name, found in horizons.items()
        )
    table = Table(
        title=Text(_name(scene)),
        box=box.SIMPLE_HEAD,
        show_edge=False,
        padding=(0, 1, 0, 0),
        caption="over: time of overturning; tilt: peak tilt over slenderness;\n"
        "base: peak base displacement; d: difference from the first row.\n" + limit,
    )
    for name in (
        "solver",
        "outcome",
        "over\n[s]",
        "tilt\n[-]",
        "d\n[-]",
        "base\n[m]",
        "d\n[%]",
        "im-\npacts",
        "CPU\n[ms]",
    ):
        table.add_column(Text(name), justify="left" if name in ("solver", "outcome") else "right", no_wrap=True)
    reference = responses[0]
    for response in responses:
        tilt, displacement = "", ""
        if response is not reference and not response.failure and not reference.failure:
            if "overturns" not in (response.outcome, reference.outcome):
                tilt = f"{response.peak_tilt_ratio - reference.peak_tilt_ratio:+.0e}"
            if reference.peak_base_displacement > 0:
                displacement = f"{100 * (response.peak_base_displacement / reference.peak_base_displacement - 1):+.0e}"
        outcome = response.verdict.replace(" ", "\n", 1)  # narrow: undecided, and so far what
        table.add_row(
            f"{response.engine}\n{response.variant}".rstrip(),
            outcome,
            _number(response.overturning_time, ".4f"),
            _number(response.peak_tilt_ratio, ".4f"),
            tilt,
            _number(response.peak_base_displacement, ".4f"),
            displacement,
            str(response.impact_count),
            _number(1e3 * response.cpu_seconds, ".1f"),
        )
    return table


def show(table: Table, responses: Sequence[Response]) -> None:
    """Print a table of responses, and below it in what each differs from the analytic model, and its warnings.

    Where the result depends on little of the motion, that stands last, in bold.
    """
    console = Console()
    console.print(table)
    for response in responses:
        for words in remarks(response):
            console.print(Text(readable(words)), soft_wrap=True)
    for warning in (warning for response in responses for warning in response.warnings if warning.kind == MOTION):
        console.print(Text(readable(str(warning)), "bold"), soft_wrap=True)


def remarks(response: Response) -> list[str]:
    """Sentences: in what a response differs from the analytic model, or why it cannot be compared; and its warnings."""
    name, words = response.engine, differing(response.comparable, response.differences)
    warnings = [warning for warning in response.warnings if warning.kind != MOTION]
    return [f"{name} {one}" for one in words] + [f"Warning, {name}: {warning}" for warning in warnings]


def engines_table(engines: Sequence[Engine]) -> Table:
    """Who does what: of every variant its tier, what the engine computes and what the adapter imposes."""
    table = Table(
        box=box.SIMPLE_HEAD,
        show_edge=False,
        padding=(0, 1, 0, 0),
        caption=Text(f"Tested for {in_words()}.\nrocking engines NAME: settings, refinement levels, versions."),
        caption_justify="left",
    )
    for head in ("engine", "variant", "tier", "the engine computes", "the adapter imposes"):
        table.add_column(head, no_wrap=head in ("engine", "variant", "tier"))
    for engine in engines:
        for name, variant in engine.variants.items():
            first = engine.name if name == engine.default_variant else ""
            table.add_row(*map(Text, (first, name, variant.tier, variant.computes, variant.imposes)))
    return table


def engine_text(engine: Engine) -> str:
    """What an `Engine` says of itself: versions, and of each variant tier, settings (the accuracy parameter first),
    refinement levels, and who does what."""
    versions = ", ".join(f"{package} {version}" for package, version in engine.versions().items())
    lines = [f"{engine.name} ({versions})"]
    for name, variant in engine.variants.items():
        default = "default, " if name == engine.default_variant else ""
        about = (inspect.getdoc(type(variant.settings)) or name).split("\n\n")[0].replace("\n", " ")
        values = [f"{field}={value:.6g}" for field, value in dataclasses.asdict(variant.settings).items()]
        values[:1] = [f"{value} (accuracy parameter)" for value in values[:1]]
        lines += [
            f"  --variant {name} ({default}{variant.tier}): {about}",
            f"      settings: {', '.join(values)}",
            f"      levels, coarse to fine: {', '.join(f'{value:.4g}' for value in variant.ladder)}",
            f"      the engine computes: {variant.computes}",
            f"      the adapter imposes: {variant.imposes}",
        ]
    return "\n".join(lines) + "\n"
