"""``rocking run``: one scene, one solver."""

import io
from dataclasses import replace
from typing import Annotated

import typer

from ..cli.output import write_output
from ..running.options import BothSigns, Directions, Records, Units, end_with, other_motions, rows_of
from ..running.progress import say
from ..running.solving import (
    TIME_LIMIT,
    TIME_LIMIT_HELP,
    check_solver,
    check_time_limit,
    in_file,
    near_motion,
    parse_settings,
    print_failures,
    simulate,
    with_near,
)


def command(
    scene: Annotated[str, typer.Argument(help="Scene file (TOML), or the name of a shipped scene.")],
    engine: Annotated[str, typer.Option(help="analytic, or an engine; see `rocking engines`.")] = "analytic",
    variant: Annotated[str | None, typer.Option(help="Variant of the engine; see `rocking engines`.")] = None,
    settings: Annotated[
        list[str] | None, typer.Option("--set", metavar="NAME=VALUE", help="A setting of the solver; may be repeated.")
    ] = None,
    records: Records = None,
    both_signs: BothSigns = False,
    directions: Directions = None,
    units: Units = None,
    json_file: Annotated[
        str | None, typer.Option("--json", metavar="FILE", help="Write the result; - prints it.")
    ] = None,
    csv: Annotated[str | None, typer.Option(metavar="FILE", help="Write the history; - prints it.")] = None,
    plot: Annotated[str | None, typer.Option(metavar="FILE", help="Draw the history (.png, .svg or .pdf).")] = None,
    time_limit: Annotated[float, typer.Option(metavar="SECONDS", help=TIME_LIMIT_HELP)] = TIME_LIMIT,
) -> None:
    """Simulate one scene. Status 1: the solver failed on it, or under one of its motions; 2: the scene, a setting or a
    file is wrong.

    Example: rocking run caryatid-isolated --engine exudyn --plot isolated.svg
    """
    from analytic.limits import scene_warnings
    from analytic.scene_file import load_scene

    from ..running.files import check_writable
    from ..schemas.runs import MotionRun, Run
    from ..showing.margins import headline, print_motions
    from ..showing.terminal import show, summary

    check_time_limit(time_limit)
    check_writable([json_file, csv], picture=plot, inputs=[scene])
    check_solver(engine)
    what, chosen = load_scene(scene), parse_settings(settings or [])
    about, (groups, left) = scene_warnings(what), other_motions(what, records, both_signs, directions, units)
    with in_file(scene):
        response = simulate(
            what,
            engine,
            variant,
            chosen,
            history=bool(csv or plot),
            time_limit=time_limit,
            words=f"{what.name}: {engine}",
            compare=True,
        )
    rows = rows_of(
        what.with_(duration=None),  # it is of the scene's own motion
        groups,
        lambda one: with_near(one, simulate(one, engine, variant, chosen, False, time_limit)),
    )
    response = replace(response, warnings=(*response.warnings, *near_motion(what)))
    if response.history is None and (csv or plot):
        say("there is no history to write")
        csv = plot = None
    history = io.StringIO()
    if csv and response.history is not None:
        response.history.to_csv(history)

    def tell():
        show(summary(what, response), [response], about)
        print_motions(what, rows, left)

    def draw():
        from ..showing.plots import draw_histories

        return draw_histories(what, [response])

    told = replace(response, warnings=(*about, *response.warnings))
    form = Run(
        **told.to_json(), motions=[MotionRun(**row) for row in rows], left_out=left, headline=headline(rows, left)
    )
    print_failures([response])
    write_output({json_file: form, csv: history.getvalue()}, tell, plot, draw)
    end_with(rows, response)
