"""``rocking choose``: the cheapest variant and level that are accurate enough for a scene."""

from typing import Annotated

import typer

from ..cli.output import write_output
from ..running.solving import check_time_limit, in_file


def command(
    scene: Annotated[str, typer.Argument(help="Scene file (TOML), or the name of a shipped scene.")],
    error: Annotated[
        float, typer.Option(help="Largest error; for outcomes the share of neighbours that differ.")
    ] = 1e-3,
    criterion: Annotated[
        str | None,
        typer.Option(
            "--for",
            help="restitution, tilt, displacement, slip or outcome. Default: restitution; tilt or slip of a block that "
            "slides; where the block never hits, displacement of its base.",
        ),
    ] = None,
    engine: Annotated[
        list[str] | None, typer.Option(help="An engine to try; may be repeated. Default: all that are installed.")
    ] = None,
    plot: Annotated[
        str | None, typer.Option(metavar="FILE", help="Draw error over CPU time (.png, .svg or .pdf).")
    ] = None,
    every_level: Annotated[bool, typer.Option("--all", help="Show every level that was run.")] = False,
    json_file: Annotated[
        str | None, typer.Option("--json", metavar="FILE", help="Write the choice; - prints it.")
    ] = None,
    time_limit: Annotated[
        float, typer.Option(metavar="SECONDS", help="A level whose run takes longer does not pass.")
    ] = 60.0,
) -> None:
    """Find the cheapest variant and level that are accurate enough for a scene, and what need not be modelled.

    The variants are run at their levels on the scene and on neighbours of it, with start and motion scaled by up to
    5 %, and compared with the analytic model; tilt and displacement only up to the sensitivity horizon. Status 1: none
    passes.
    Example: rocking choose caryatid-isolated --for displacement --error 1e-3
    """
    from analytic.scene_file import load_scene

    from ..advice import choose
    from ..advice.criteria import fitting
    from ..running.files import check_writable
    from ..running.progress import compile_kernels, say, stdout_to_stderr
    from ..showing.choices import draw_choice, print_choice

    check_time_limit(time_limit)
    check_writable([json_file], picture=plot, inputs=[scene])
    what = load_scene(scene)
    compile_kernels()
    with in_file(scene):
        shown = fitting(what) if criterion is None and engine else "restitution"
    if shown != "restitution":
        given = what.block.restitution is not None and shown == "tilt"
        why = (
            "it slides"
            if what.friction is not None and shown in ("tilt", "slip")
            else ("its restitution is given" if given else "it never has an impact: there is no restitution")
        )
        say(f"the block of {what.name}: {why}; the criterion is {shown}")
    with stdout_to_stderr(), in_file(scene):  # engines print on import
        choice = choose(
            what,
            error=error,
            criterion=criterion,
            engines=engine or None,
            time_limit=time_limit,
            progress=True,
            source=scene,
        )
    write_output({json_file: choice}, lambda: print_choice(choice, every_level), plot, lambda: draw_choice(choice))
    if choice.chosen is None:
        raise typer.Exit(1)
