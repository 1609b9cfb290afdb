"""The command ``rocking report``: the page on the user's scenes, or on the Caryatid."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Annotated

import typer

from analytic import simulate
from analytic.errors import SettingError
from analytic.response import UNCOMPARED
from engines import get_engine

from ..execution.by_solver import results_in
from ..execution.command_runs import (
    ANALYTIC,
    RECORD_OPTIONS,
    BothSigns,
    Channel,
    Column,
    Directions,
    EngineNames,
    JsonFile,
    Records,
    Step,
    Units,
    check_solver,
    ground_motion,
    in_file,
    named_by_options,
    other_motions,
)
from ..execution.progress import bar, compile_kernels, say, stdout_to_stderr
from ..execution.results import RESULTS, read_result
from ..execution.writing import check_folder, check_writable, write_text
from ..schemas.runs import MotionRun, Report, Reported


# Long because of its many options.
def report(
    scene: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[SCENE]...",
            help="Scene files (TOML), or names of shipped scenes. Default: the Caryatid, on rigid ground and isolated.",
        ),
    ] = None,
    record: Annotated[
        str | None,
        typer.Option(
            metavar="FILE",
            help="Recorded ground motion (see rocking record --help). Default: the shipped synthetic motion.",
        ),
    ] = None,
    units: Units = None,
    dt: Step = None,
    column: Column = None,
    channel: Channel = None,
    engine: EngineNames = None,
    variant: Annotated[
        str | None, typer.Option(help="Variant of the engine, if one is named. Default: its main one.")
    ] = None,
    records: Records = None,
    both_signs: BothSigns = False,
    directions: Directions = None,
    output: Annotated[str, typer.Option(metavar="DIR", help="Folder for the page and its result files.")] = "report",
    studies: Annotated[
        str | None,
        typer.Option(
            metavar="DIR", help="Folder of study results, written by rocking study all. Default: the shipped results."
        ),
    ] = None,
    json_file: JsonFile = None,
) -> None:
    """Write a web page that compares all solvers on your scenes.

    It shows outcomes, agreement and cost, and below them the findings of the stored studies. The result files that it
    is made from are written beside it. A record given with scenes replaces their motions.

    Example: rocking report bust.toml --output bust
    """
    from ..report.write import write_page

    check_folder(output)
    shown = _studies(studies)
    check_writable([json_file], inputs=[*(scene or ()), *([record] if record is not None else ())])
    for name in engine or ():
        check_solver(name)
    engines = [name for name in engine if name != ANALYTIC] if engine else None
    variants = _variants(variant, engines or [], scene)
    units_of_record = None if record is None and records is not None else units
    motion = _motion(scene, record, {"units": units_of_record, "dt": dt, "column": column, "channel": channel})
    if not scene and (records is not None or both_signs or directions is not None):
        raise SettingError("--records, --both-signs and --directions belong to scenes of your own; name one")
    many = (records, both_signs, directions, None if records is None else units)
    calls = _simulate(output, scene, motion, engines, variants, many)
    with bar(f"studies and pages: {len(results_in(shown))} stored results") as progress:
        page = write_page(output, shown, progress, calls)
    if json_file:
        write_text(json_file, form(page).text())
    if json_file != "-":
        print(page)


def _motion(scene, record, stated):
    """The motion of the record, or the shipped motion; None if the scenes keep their own motions."""
    with named_by_options(RECORD_OPTIONS):
        motion = ground_motion(record, **stated)  # also refuses options that belong to a record
    if scene and record is None:
        return None
    say(f"ground motion: {motion.label}")
    return motion


def _simulate(output, scene, motion, engines, variants, many):
    """Write the result files of the page. Return {scene: (its file and options, what to do before)}."""
    from ..report.runs import load_scenes, make_own_results, make_results

    with stdout_to_stderr():  # engines print on import
        if not scene:
            make_results(output, motion, engines=engines)
            return {}
        scenes = load_scenes(scene, motion)
        compile_kernels()
        for place, loaded in zip(scene, scenes.values(), strict=True):
            with in_file(place):  # before the engines' runs
                simulate(loaded, history=False)
        motions, left = {}, {}
        for name, loaded in scenes.items():
            motions[name], left[name] = other_motions(loaded, *many)
        make_own_results(output, scenes, engines=engines, variants=variants, motions=motions, left=left)
    first = "" if motion is None else "First write this motion into the table [motion] of its file."
    return {name: (_call(place, *many), first) for name, place in zip(scenes, scene, strict=True)}


def _call(place, records, both_signs, directions, units):
    """A scene file and the options for its motions, as the user types them."""
    options = {"--records": records, "--directions": directions, "--units": records and units}
    given = [word for name, value in options.items() if value is not None for word in (name, str(value))]
    return shlex.join([place, *given, *(["--both-signs"] if both_signs else [])])


def _studies(folder):
    """The folder of the studies' results, checked."""
    if folder is not None and not results_in(folder):
        raise SettingError(f"--studies {folder}: holds no result; rocking study all --output {folder} writes them")
    return RESULTS if folder is None else Path(folder)


def form(page: Path) -> Report:
    """Return the content of the JSON file for a page, read from the result files beside it."""
    from ..plotting.margins import headline
    from ..report.runs import RESTITUTION, SCENES

    files = [page.with_name(name) for name in (SCENES, RESTITUTION) if page.with_name(name).exists()]
    result = read_result(files[0])
    rows = []
    for row in result.rows:
        reported = {**(row.get("agreement") or {}), **row, "failure": row["failure"] and row["failure"]["reason"]}
        reported |= {name: row.get(name) or [] for name in ("warnings", "differences")}
        reported["comparable"] = row.get("comparable") or UNCOMPARED
        rows.append(Reported.model_validate({name: reported.get(name) for name in Reported.model_fields}))
    statues = result.settings.get("statues", {})
    return Report(
        page=str(page),
        results=[str(file) for file in files],
        missing=result.settings["missing"],
        rows=rows,
        motions={name: [MotionRun(**row) for row in statue["motions"]] for name, statue in statues.items()},
        left_out={name: statue["left_out"] for name, statue in statues.items()},
        headlines={name: headline(statue["motions"], statue["left_out"]) for name, statue in statues.items()},
        sizes={name: statue.get("sizes") for name, statue in statues.items()},
        pedestals={name: statue.get("pedestal") for name, statue in statues.items()},
    )


def _variants(variant, engines, scene):
    """{engine: variant} of the option --variant, checked."""
    if variant is None:
        return {}
    if not scene or len(engines) != 1:
        raise SettingError(f"--variant {variant}: belongs to one engine and to scenes; name both")
    known = get_engine(engines[0]).variants
    if variant not in known:
        raise SettingError(f"{engines[0]} has no variant {variant!r}: choose one of {', '.join(known)}")
    return {engines[0]: variant}
