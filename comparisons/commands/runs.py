"""``rocking run``: one scene, one solver.

``rocking compare``: all solvers on one scene.

``rocking engines``: the engines that can be used here, and their variants.

``rocking script``: a scene as a stand-alone script in plain calls of an engine.
"""

import io
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from ..execution.files import readable
from ..execution.progress import say, spinner
from ..execution.solving import (
    ANALYTIC,
    TIME_LIMIT,
    TIME_LIMIT_HELP,
    BothSigns,
    Directions,
    Records,
    Units,
    check_solver,
    check_time_limit,
    end_with,
    in_file,
    near_motion,
    other_motions,
    parse_settings,
    print_failures,
    refused,
    rows_of,
    simulate,
    with_near,
)
from .output import write_output


def run(
    scene: Annotated[str, typer.Argument(help="Scene file (TOML), or the name of a shipped scene.")],
    engine: Annotated[
        str, typer.Option(help="Solver: analytic, or an engine (`rocking engines` lists them).")
    ] = "analytic",
    variant: Annotated[str | None, typer.Option(help="Variant of the engine. Default: its main one.")] = None,
    settings: Annotated[
        list[str] | None, typer.Option("--set", metavar="NAME=VALUE", help="Setting of the solver; may be repeated.")
    ] = None,
    records: Records = None,
    both_signs: BothSigns = False,
    directions: Directions = None,
    units: Units = None,
    json_file: Annotated[
        str | None, typer.Option("--json", metavar="FILE", help="Write the result as JSON; - prints it.")
    ] = None,
    csv: Annotated[str | None, typer.Option(metavar="FILE", help="Write the history as CSV; - prints it.")] = None,
    plot: Annotated[str | None, typer.Option(metavar="FILE", help="Draw the history (.png, .svg or .pdf).")] = None,
    time_limit: Annotated[float, typer.Option(metavar="SECONDS", help=TIME_LIMIT_HELP)] = TIME_LIMIT,
) -> None:
    """Simulate one scene.

    The result is compared with the analytic model. Status 1: the solver failed on the scene or under one of its
    motions. Status 2: the scene, a setting or a file is wrong.

    Example: rocking run caryatid-isolated --engine exudyn --plot isolated.svg
    """
    from analytic.response import scene_warnings
    from analytic.scene_file import load_scene

    from ..execution.files import check_writable
    from ..plotting.margins import headline, print_motions
    from ..plotting.terminal import show, summary
    from ..schemas.runs import MotionRun, Run

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
        from ..plotting.plots import draw_histories

        return draw_histories(what, [response])

    told = replace(response, warnings=(*about, *response.warnings))
    form = Run(
        **told.to_json(), motions=[MotionRun(**row) for row in rows], left_out=left, headline=headline(rows, left)
    )
    print_failures([response])
    write_output({json_file: form, csv: history.getvalue()}, tell, plot, draw)
    end_with(rows, response)


def compare(
    scene: Annotated[str, typer.Argument(help="Scene file (TOML), or the name of a shipped scene.")],
    engine: Annotated[
        list[str] | None, typer.Option(help="Engine to compare; may be repeated. Default: all that are installed.")
    ] = None,
    plot: Annotated[
        str | None, typer.Option(metavar="FILE", help="Overlay the histories (.png, .svg or .pdf).")
    ] = None,
    json_file: Annotated[
        str | None, typer.Option("--json", metavar="FILE", help="Write the results as JSON; - prints them.")
    ] = None,
    time_limit: Annotated[float, typer.Option(metavar="SECONDS", help=TIME_LIMIT_HELP)] = TIME_LIMIT,
) -> None:
    """Compare the engines with the analytic model on one scene.

    The table shows outcomes, errors and CPU times. If an engine fails, only its row is lost. Status 1: the analytic
    model failed.

    Example: rocking compare free-rocking-rigid --plot compared.svg
    """
    from analytic.response import scene_warnings
    from analytic.scene_file import load_scene

    from ..execution.files import check_writable
    from ..plotting.terminal import comparison, show

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
        from ..plotting.plots import draw_histories

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
    from ..metrics.errors import solver_horizon

    return {
        response.engine: solver_horizon(scene, response, responses[0])
        for response in responses[1:]
        if not response.failure
    }


def engines(
    name: Annotated[str | None, typer.Argument(help="Engine to describe in full. Default: list all.")] = None,
) -> None:
    """List the engines and their variants.

    The table shows the kind of each variant, what the engine computes, and what our adapter imposes on it. With a
    name, the command also shows the engine's versions, and the settings, levels and engine calls of each variant.

    Example: rocking engines exudyn
    """
    from engines import BROKEN, available_engines, get_engine, missing_words

    from ..execution.progress import stdout_to_stderr
    from ..execution.solving import named_engines
    from ..plotting.terminal import echo, engine_text, engines_table

    with stdout_to_stderr():  # engines print on import
        names, missing = ((), {}) if name else available_engines()
        shown = [get_engine(one) for one in (named_engines([name]) if name else names)]
        for engine in shown:
            engine.load()
    if name:
        return echo(engine_text(shown[0]))
    broken = [f"{name}: cannot be used. {error}" for name, error in BROKEN.items()]
    echo(engines_table(shown), *missing_words(missing), *broken)


SUFFIX = ".py"


def script(
    engine: Annotated[str, typer.Argument(help="Engine that the script uses.")],
    scene: Annotated[str, typer.Argument(help="Scene file (TOML), or the name of a shipped scene.")],
    output: Annotated[
        str | None, typer.Option(metavar="FILE", help="Script to write. Default: SCENE-ENGINE.py.")
    ] = None,
) -> None:
    """Write a stand-alone Python script that runs a scene.

    The script uses only the engine's own calls, in its tuned variant, and needs nothing of this project. A record is
    written beside the script.

    Example: rocking script pybullet caryatid-isolated --output caryatid.py
    """
    from analytic.errors import SettingError
    from analytic.scene_file import load_scene
    from engines import BROKEN, ENGINES
    from engines.loads import unkept_friction
    from engines.scripting import write_script

    from ..execution.files import check_writable, write_text
    from ..execution.progress import compile_kernels
    from ..execution.solving import in_file
    from ..plotting.terminal import echo

    if engine in BROKEN:
        raise BROKEN[engine]
    able = [name for name, one in ENGINES.items() if one.script]
    if engine not in able:
        raise SettingError(f"{engine}: no engine with a script; choose one of {', '.join(able)}")
    if output is not None and Path(output).suffix != SUFFIX:
        raise SettingError(f"--output {output}: end the name in {SUFFIX}")
    what = load_scene(scene)
    if what.duration is None or what.friction is not None:  # the model is run
        compile_kernels()
    with in_file(scene):
        files = write_script(ENGINES[engine], what, Path(output).stem if output else None)
    folder = Path(output).parent if output else Path()
    places = {str(folder / file): text for file, text in files.items()}
    check_writable(places, inputs=[scene])
    for place, text in places.items():
        write_text(place, text)
    echo(*(f"{place} written" for place in places), *filter(None, [unkept_friction(what)]))
