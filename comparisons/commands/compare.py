"""``rocking compare``: all solvers on one scene."""

from dataclasses import replace
from typing import Annotated

import typer

from ..cli.output import write_output
from ..running.options import refused
from ..running.progress import say, spinner
from ..running.readable import readable
from ..running.solving import (
    ANALYTIC,
    TIME_LIMIT,
    TIME_LIMIT_HELP,
    check_solver,
    check_time_limit,
    in_file,
    near_motion,
    print_failures,
    simulate,
)


def command(
    scene: Annotated[str, typer.Argument(help="Scene file (TOML), or the name of a shipped scene.")],
    engine: Annotated[
        list[str] | None, typer.Option(help="An engine to compare; may be repeated. Default: all that are installed.")
    ] = None,
    plot: Annotated[str | None, typer.Option(metavar="FILE", help="Overlay the histories (.png, .svg, .pdf).")] = None,
    json_file: Annotated[
        str | None, typer.Option("--json", metavar="FILE", help="Write the results; - prints them.")
    ] = None,
    time_limit: Annotated[float, typer.Option(metavar="SECONDS", help=TIME_LIMIT_HELP)] = TIME_LIMIT,
) -> None:
    """Simulate one scene with the analytic model and the engines: outcomes, errors and CPU times.

    If an engine fails, only its row is lost. Status 1: the analytic model failed.
    Example: rocking compare free-rocking-rigid --plot compared.svg
    """
    from analytic.limits import scene_warnings
    from analytic.scene_file import load_scene

    from ..running.files import check_writable
    from ..showing.terminal import comparison, show

    check_time_limit(time_limit)
    check_writable([json_file], picture=plot, inputs=[scene])
    for name in engine or ():
        check_solver(name)
    what = load_scene(scene)
    with in_file(scene):
        first, *others = _responses(what, engine, time_limit)
    responses = [replace(first, warnings=(*first.warnings, *near_motion(what))), *others]
    horizons = {} if responses[0].failure else _sensitivity(what, responses, time_limit)
    horizon = min((each.horizon for each in horizons.values() if each.parts), default=None)
    drawn = [response for response in responses if response.history]
    if plot and not drawn:
        say("there is no history to draw")
        plot = None

    def draw():
        from ..showing.plots import draw_histories

        return draw_histories(what, drawn, horizon)

    print_failures(responses)
    about = scene_warnings(what)
    told = [replace(responses[0], warnings=(*about, *responses[0].warnings)), *responses[1:]]
    form = _form(what, told, horizons, horizon)
    write_output({json_file: form}, lambda: show(comparison(what, responses, horizons), responses, about), plot, draw)
    if responses[0].failure:
        raise typer.Exit(1)


def _responses(scene, asked, time_limit):
    """Responses of the analytic model and the engines asked for; by default of all that are installed."""
    from analytic.errors import EngineNotInstalled, SceneError
    from engines import ENGINES, get_engine

    names = [ANALYTIC, *(name for name in dict.fromkeys(asked or ENGINES) if name != ANALYTIC)]
    responses = []
    for number, name in enumerate(names, 1):
        words = f"{scene.name}: {name} ({number} of {len(names)})"
        try:
            responses.append(simulate(scene, name, time_limit=time_limit, words=words, compare=True))
        except EngineNotInstalled:
            if asked:
                raise
        except SceneError as error:  # not possible in this engine, such as a given restitution: only its row is lost
            if name == ANALYTIC:
                raise
            responses.append(refused(scene, error, engine=name, variant=get_engine(name).default_variant))
    return responses


def _sensitivity(scene, responses, time_limit):
    """`_horizons` in a process of its own; none, with a message, if that does not end."""
    from engines.guard import run_apart

    words = spinner(f"{scene.name}: sensitivity horizons")
    horizons, failure = run_apart(_horizons, scene, responses, time_limit=time_limit, meanwhile=words)
    if not failure:
        return horizons
    say(f"no sensitivity horizons: {failure.reason}. {readable(failure.message.partition(chr(10))[0])}")
    return {}


def _form(scene, responses, horizons, horizon):
    """Content of the JSON file."""
    from ..schemas.runs import Comparison, Run, Sensitivity

    return Comparison(
        scene=scene.name,
        sensitivity_horizon=horizon,
        sensitivity={
            name: Sensitivity(perturbation=each.perturbation, horizon=each.horizon if each.parts else None)
            for name, each in horizons.items()
        },
        responses=[Run(**response.to_json()) for response in responses],
    )


def _horizons(scene, responses):
    """{solver: its `Horizon`} of all runs that did not fail; the first is the reference."""
    from ..measuring.horizon import solver_horizon

    return {
        response.engine: solver_horizon(scene, response, responses[0])
        for response in responses[1:]
        if not response.failure
    }
