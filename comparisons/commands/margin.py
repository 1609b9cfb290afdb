"""``rocking margin``: how far the verdict on a scene is from its nearest flip."""

import dataclasses
from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import typer

LEAST_SPAN = 0.1  # per cent


def command(
    scene: Annotated[str, typer.Argument(help="Scene file (TOML), or the name of a shipped scene.")],
    span: Annotated[float, typer.Option(metavar="PERCENT", help="Largest change of a quantity.")] = 20.0,
    plot: Annotated[
        str | None, typer.Option(metavar="FILE", help="Draw the outcomes over the changes (.png, .svg or .pdf).")
    ] = None,
    json_file: Annotated[
        str | None, typer.Option("--json", metavar="FILE", help="Write the margins; - prints them.")
    ] = None,
) -> None:
    """By how much must slenderness, restitution, motion, bearings ... change until the verdict flips?

    Each quantity is changed alone, in steps of a four-hundredth of the span, by the analytic model. The vertical
    stiffness of bearings is taken as infinite. Example: rocking margin caryatid-isolated --plot margins.svg
    """
    from analytic.errors import SettingError
    from analytic.margins import contact_margins, margins
    from analytic.scene_file import load_scene

    from ..running.files import check_writable, write_all
    from ..running.solving import compile_kernels, spinner
    from ..schemas.advice import Contact, Margin, Margins

    if not LEAST_SPAN <= span < 100:
        raise SettingError(f"--span {span:g}: give per cent, from {LEAST_SPAN:g} on and below 100")
    check_writable([json_file], picture=plot, inputs=[scene])
    what = load_scene(scene)
    compile_kernels()
    with spinner(f"{what.name}: margins") as tell:
        nearest = margins(
            what, span=span / 100, step=span / 100 / 400, progress=lambda name: tell(f"{what.name}: {name}")
        )
        contact = contact_margins(what)
    results: dict[str, str | Callable[[Path], object]] = {}
    if json_file:
        found = [Margin.model_validate(margin, from_attributes=True) for margin in nearest]
        spared = Contact(**dataclasses.asdict(contact))
        form = Margins(scene=what.name, outcome=nearest[0].outcome, span=span / 100, margins=found, contact=spared)
        results[json_file] = form.text()
    if plot:
        from ..showing.margins import draw_margins
        from ..showing.plots import save

        figure = draw_margins(what, nearest)
        results[plot] = lambda path: save(figure, path)
    problem = write_all(results)
    if json_file != "-":
        from ..showing.margins import print_margins

        print_margins(what, nearest, contact, span)
    if problem:
        raise problem
