"""``rocking compare``: all solvers on one scene."""

import json
import sys
from typing import Annotated

import typer


def command(
    scene: Annotated[str, typer.Argument(help="Scene file (TOML), or the name of a shipped scene.")],
    engine: Annotated[list[str] | None, typer.Option(help="An engine to compare; may be repeated. "
                                                          "Default: all that are installed.")] = None,
    plot: Annotated[str | None, typer.Option(metavar="FILE", help="Overlay the histories (.png, .svg, .pdf).")] = None,
    json_file: Annotated[str | None, typer.Option("--json", metavar="FILE",
                                                  help="Write the results; - prints them.")] = None,
):
    """Simulate one scene with the analytic model and the engines: outcomes, errors and CPU time side by side."""
    from analytic.scene_file import load_scene
    from engines import installed_engines

    from ..files import check_writable, write_text
    from ..horizon import solver_horizon
    from ..solving import ANALYTIC, simulate, spinner

    check_writable([None if json_file == "-" else json_file], picture=plot)
    what = load_scene(scene)
    names = [name for name in engine or installed_engines() if name != ANALYTIC]
    responses = []
    with spinner(what.name) as say:
        for number, name in enumerate([ANALYTIC, *names], 1):
            say(f"{what.name}: {name} ({number} of {len(names) + 1})")
            responses.append(simulate(what, name, history=True))
        horizons = {response.engine: solver_horizon(what, response, responses[0])
                    for response in responses[1:] if not response.failure}
    horizon = min((found.horizon for found in horizons.values() if found.parts), default=None)
    if json_file:
        content = {"scene": what.name, "sensitivity_horizon": horizon,
                   "sensitivity": {name: {"perturbation": found.perturbation,
                                          "horizon": found.horizon if found.parts else None}
                                   for name, found in horizons.items()},
                   "responses": [response.to_json() for response in responses]}
        text = json.dumps(content, indent=2, allow_nan=False) + "\n"
        sys.stdout.write(text) if json_file == "-" else write_text(json_file, text)
    if plot:
        from ..plots import draw_histories, save

        save(draw_histories(what, [response for response in responses if response.history], horizon), plot)
    if json_file != "-":
        from rich.console import Console

        from ..tables import comparison

        Console().print(comparison(what, responses, horizons))
    for response in responses:
        if response.failure:
            print(f"{response.engine} failed: {response.failure.reason}. {response.failure.message}", file=sys.stderr)
