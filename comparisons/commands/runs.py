"""The commands that run one scene: ``rocking run``, ``compare`` and ``script``; and ``rocking engines``."""

import io
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from analytic.errors import EngineNotInstalled, SceneError, SettingError
from analytic.response import scene_warnings
from analytic.scene_file import load_scene
from engines import BROKEN, ENGINES, available_engines, get_engine, guard, missing_words
from engines.loads import unkept_friction

from ..execution.command_runs import (
    ANALYTIC,
    TIME_LIMIT,
    TIME_LIMIT_HELP,
    BothSigns,
    Directions,
    EngineNames,
    JsonFile,
    Records,
    SceneFile,
    Units,
    check_solver,
    check_time_limit,
    end_with,
    in_file,
    named_engines,
    near_motion,
    other_motions,
    parse_settings,
    pedestal_check,
    print_failures,
    refused,
    rows_of,
    simulate,
    with_near,
)
from ..execution.progress import compile_kernels, say, spinner, stdout_to_stderr
from ..execution.writing import check_writable, readable, write_text
from ..schemas.runs import Comparison, Run, Sensitivity
from .output import write_output


def run(
    scene: SceneFile,
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
    json_file: JsonFile = None,
    csv: Annotated[str | None, typer.Option(metavar="FILE", help="Write the history as CSV; - prints it.")] = None,
    plot: Annotated[str | None, typer.Option(metavar="FILE", help="Draw the history (.png, .svg or .pdf).")] = None,
    time_limit: Annotated[float, typer.Option(metavar="SECONDS", help=TIME_LIMIT_HELP)] = TIME_LIMIT,
) -> None:
    """Simulate one scene.

    The result is compared with the analytic model. Status 1: the solver failed on the scene or under one of its
    motions. Status 2: the scene, a setting or a file is wrong.

    Example: rocking run caryatid-isolated --engine exudyn --plot isolated.svg
    """
    from ..plotting.margins import print_motions
    from ..plotting.terminal import show, summary

    check_time_limit(time_limit)
    check_writable([json_file, csv], picture=plot, inputs=[scene])
    check_solver(engine)
    loaded, solver = load_scene(scene), (engine, variant, parse_settings(settings or []))
    (support, warned, stays), (groups, left) = (
        pedestal_check(loaded),
        other_motions(loaded, records, both_signs, directions, units),
    )
    about = (*scene_warnings(loaded), *warned)
    with in_file(scene):
        words = f"{loaded.name}: {engine}"
        response = simulate(loaded, *solver, bool(csv or plot), time_limit, words, compare=True)
    rows = rows_of(
        loaded.with_(duration=None),  # it is of the scene's own motion
        groups,
        lambda moved: with_near(moved, simulate(moved, *solver, False, time_limit)),
    )
    response = replace(response, warnings=(*response.warnings, *near_motion(loaded)))
    if response.history is None and (csv or plot):
        say("there is no history to write")
        csv = plot = None

    def tell():
        show(summary(loaded, response), [response], about, stays)
        print_motions(loaded, rows, left)

    print_failures([response])
    results = {json_file: _run_form(response, about, rows, left, support), csv: _history_text(response) if csv else ""}
    write_output(results, tell, plot, lambda: _drawn(loaded, [response]))
    end_with(rows, response)


def _run_form(response, about, rows, left, support):
    """The content of the JSON file of `run`."""
    from ..plotting.margins import headline

    values = replace(response, warnings=(*about, *response.warnings)).to_json()
    return Run(**values, motions=rows, left_out=left, headline=headline(rows, left), pedestal=support)


def _history_text(response):
    """The history as CSV."""
    text = io.StringIO()
    response.history.to_csv(text)
    return text.getvalue()


def _drawn(scene, responses, horizon=None):
    """The figure of the histories. matplotlib is imported only here."""
    from ..plotting.plots import draw_histories

    return draw_histories(scene, responses, horizon)


def compare(
    scene: SceneFile,
    engine: EngineNames = None,
    plot: Annotated[
        str | None, typer.Option(metavar="FILE", help="Overlay the histories (.png, .svg or .pdf).")
    ] = None,
    json_file: JsonFile = None,
    time_limit: Annotated[float, typer.Option(metavar="SECONDS", help=TIME_LIMIT_HELP)] = TIME_LIMIT,
) -> None:
    """Compare the engines with the analytic model on one scene.

    The table shows outcomes, errors and CPU times. If an engine fails, only its row is lost. Status 1: the analytic
    model failed.

    Example: rocking compare free-rocking-rigid --plot compared.svg
    """
    from ..plotting.terminal import comparison, show

    check_time_limit(time_limit)
    check_writable([json_file], picture=plot, inputs=[scene])
    for name in engine or ():
        check_solver(name)
    loaded = load_scene(scene)
    with in_file(scene):
        first, *others = _responses(loaded, engine, time_limit)
    responses = [replace(first, warnings=(*first.warnings, *near_motion(loaded))), *others]
    horizons = {} if responses[0].failure or loaded.is_stack else _sensitivity(loaded, responses, time_limit)
    horizon = min((each.horizon for each in horizons.values() if each.parts), default=None)
    with_history = [response for response in responses if response.history]
    if plot and not with_history:
        say("there is no history to draw")
        plot = None
    print_failures(responses)
    support, cautions, stays = pedestal_check(loaded)
    about = (*scene_warnings(loaded), *cautions)
    warned = [replace(responses[0], warnings=(*about, *responses[0].warnings)), *responses[1:]]
    write_output(
        {json_file: _comparison_form(loaded, warned, horizons, horizon, support)},
        lambda: show(comparison(loaded, responses, horizons), responses, about, stays),
        plot,
        lambda: _drawn(loaded, with_history, horizon),
    )
    if responses[0].failure:
        raise typer.Exit(1)


def _responses(scene, wanted, time_limit):
    """The responses of the analytic model and of the engines named in `wanted`; of all installed engines without it."""
    names = [ANALYTIC, *(name for name in dict.fromkeys(wanted or ENGINES) if name != ANALYTIC)]
    responses = []
    for number, name in enumerate(names, 1):
        words = f"{scene.name}: {name} ({number} of {len(names)})"
        try:
            responses.append(simulate(scene, name, time_limit=time_limit, words=words, compare=True))
        except EngineNotInstalled:
            if wanted:
                raise
        except SceneError as error:  # the engine cannot run it (such as a given restitution): only its row is lost
            if name == ANALYTIC:
                raise
            responses.append(refused(scene, error, engine=name, variant=get_engine(name).default_variant))
    return responses


def _sensitivity(scene, responses, time_limit):
    """`_horizons` in a process of its own. If that fails, a message says so and the result is empty."""
    words = spinner(f"{scene.name}: sensitivity horizons")
    horizons, failure = guard.run_apart(_horizons, scene, responses, time_limit=time_limit, meanwhile=words)
    if not failure:
        return horizons
    say(f"no sensitivity horizons: {failure.reason}. {readable(failure.message.partition(chr(10))[0])}")
    return {}


def _comparison_form(scene, responses, horizons, horizon, support):
    """The content of the JSON file of `compare`."""
    return Comparison(
        scene=scene.name,
        sensitivity_horizon=horizon,
        sensitivity={
            name: Sensitivity(perturbation=each.perturbation, horizon=each.horizon if each.parts else None)
            for name, each in horizons.items()
        },
        responses=[Run(**response.to_json()) for response in responses],
        pedestal=support,
    )


def _horizons(scene, responses):
    """{solver: its `Horizon`} of all runs that did not fail, compared with the first response."""
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
    from ..plotting.terminal import echo
    from ..plotting.variants import engine_text, engines_table

    with stdout_to_stderr():  # engines print on import
        names, missing = ((), {}) if name else available_engines()
        shown = [get_engine(each) for each in (named_engines([name]) if name else names)]
        for engine in shown:
            engine.load()
    if name:
        return echo(engine_text(shown[0]))
    broken = [f"{name}: cannot be used. {error}" for name, error in BROKEN.items()]
    echo(engines_table(shown), *missing_words(missing), *broken)


SUFFIX, NO_EDGE = ".py", "The script's support has no edge: the block does not fall off its pedestal there."


def script(
    engine: Annotated[str, typer.Argument(help="Engine that the script uses.")],
    scene: SceneFile,
    output: Annotated[
        str | None, typer.Option(metavar="FILE", help="Script to write. Default: SCENE-ENGINE.py.")
    ] = None,
) -> None:
    """Write a stand-alone Python script that runs a scene.

    The script uses only the engine's own calls, in its tuned variant, and needs nothing of this project. A record is
    written beside the script.

    Example: rocking script pybullet caryatid-isolated --output caryatid.py
    """
    from engines.scripting import write_script

    from ..plotting.terminal import echo

    if engine in BROKEN:
        raise BROKEN[engine]
    with_script = [name for name, record in ENGINES.items() if record.script]
    if engine not in with_script:
        raise SettingError(f"{engine}: no engine with a script; choose one of {', '.join(with_script)}")
    if output is not None and Path(output).suffix != SUFFIX:
        raise SettingError(f"--output {output}: end the name in {SUFFIX}")
    loaded = load_scene(scene)
    if loaded.duration is None or loaded.friction is not None:  # the model is run
        compile_kernels()
    with in_file(scene):
        files = write_script(ENGINES[engine], loaded, Path(output).stem if output else None)
    folder = Path(output).parent if output else Path()
    texts = {str(folder / file): text for file, text in files.items()}
    check_writable(texts, inputs=[scene])
    for path, text in texts.items():
        write_text(path, text)
    echo(
        *(f"{path} written" for path in texts),
        *filter(None, [unkept_friction(loaded), NO_EDGE if loaded.pedestal and loaded.friction else ""]),
    )
