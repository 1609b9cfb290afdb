"""``rocking run``: one scene, one solver."""

import json
import sys
from typing import Annotated

import typer


def command(
    scene: Annotated[str, typer.Argument(help="Scene file (TOML), or the name of a shipped scene.")],
    engine: Annotated[str, typer.Option(help="analytic, or an engine; see `rocking engines`.")] = "analytic",
    variant: Annotated[str | None, typer.Option(help="How the engine is set up; see `rocking engines`.")] = None,
    settings: Annotated[list[str] | None, typer.Option("--set", metavar="NAME=VALUE",
                                                       help="A setting of the solver; may be repeated.")] = None,
    json_file: Annotated[str | None, typer.Option("--json", metavar="FILE",
                                                  help="Write the result; - prints it.")] = None,
    csv: Annotated[str | None, typer.Option(metavar="FILE", help="Write the history.")] = None,
    plot: Annotated[str | None, typer.Option(metavar="FILE", help="Draw the history (.png, .svg or .pdf).")] = None,
):
    """Simulate one scene. Status 1: the solver failed on it; 2: the scene or a setting is wrong."""
    from analytic.scene_file import load_scene

    from ..files import check_writable, write_text
    from ..solving import parse_settings, simulate, spinner

    check_writable([None if json_file == "-" else json_file, csv], picture=plot)
    what = load_scene(scene)
    chosen = parse_settings(settings or [])
    with spinner(f"{what.name}: {engine}"):
        response = simulate(what, engine, variant, chosen, history=bool(csv or plot))
    if json_file:
        text = json.dumps(response.to_json(), indent=2, allow_nan=False) + "\n"
        sys.stdout.write(text) if json_file == "-" else write_text(json_file, text)
    if (csv or plot) and response.history is None:
        print("there is no history to write", file=sys.stderr)
        csv = plot = None
    if csv:
        response.history.to_csv(csv)
    if plot:
        from ..plots import draw_histories, save

        save(draw_histories(what, [response]), plot)
    if json_file != "-":
        from rich.console import Console

        from ..tables import summary

        Console().print(summary(what, response))
    if response.failure:
        print(f"{response.engine} failed: {response.failure.reason}. {response.failure.message}", file=sys.stderr)
        raise typer.Exit(1)
