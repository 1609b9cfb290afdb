"""The commands ``rocking study NAME``, each made from its `Study`, and ``rocking verify``."""

from __future__ import annotations

import inspect
import secrets
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer.core import TyperGroup

from analytic.errors import SettingError
from engines import ENGINES, get_engine, guard, installed_engines

from ..execution.by_solver import MODEL, save_parts
from ..execution.cases import name_of
from ..execution.command_runs import TIME_LIMIT, EngineNames, JsonFile, check_time_limit, named_engines
from ..execution.progress import compile_kernels, log, say, spinner, stdout_to_stderr
from ..execution.results import RESULTS, made_here
from ..execution.writing import check_folder, check_writable
from ..schemas.runs import Tolerance, Verification
from ..studies import BUILT_IN, TOLERANCES, StudyBroken, get_study, study_names
from .output import write_output

if TYPE_CHECKING:
    from ..execution.plan import Study

Quick = Annotated[bool, typer.Option("--quick", help="Run a small version, which takes minutes.")]
Output = Annotated[
    str | None,
    typer.Option(
        metavar="DIR",
        help="Folder for the result (DIR/NAME), its page (DIR/NAME.html) and the runs from which an interrupted study "
        "resumes. Default: NAME-study.",
    ),
]
Engines = Annotated[
    list[str] | None,
    typer.Option(
        "--engine",
        help="Engine to run; may be repeated. If DIR/NAME holds a result, only this engine's file is written anew, "
        "except in studies that compare CPU times. Default: all that the study needs.",
    ),
]
Workers = Annotated[int | None, typer.Option(min=1, help="Number of worker processes. Default: one per core.")]
Scheduler = Annotated[
    str | None,
    typer.Option(
        metavar="ADDRESS",
        help="Dask scheduler that distributes the runs: HOST:PORT, or local:N. Timed runs stay on this machine.",
    ),
]
EVERY = "all"
Replot = Annotated[
    str | None, typer.Option(metavar="RESULT", help="Run nothing; write the page of the result in this folder again.")
]

Check = Annotated[
    int | None,
    typer.Option(
        metavar="N",
        min=1,
        help="Rerun N randomly chosen stored runs and report how many agree. They are those of the shipped result, or "
        "with --output of the result in DIR. Status 1: not all agree.",
    ),
]
Write = Annotated[
    bool, typer.Option("--write", help="With --check: write the date, commit and outcome of the check into the result.")
]
Seed = Annotated[
    int | None,
    typer.Option(min=0, max=2**63, help="Seed of the random choice of --check. Default: a new one each time."),
]


def command_of(study: Study) -> Callable[..., None]:
    """Return the function from which Typer makes the study's command."""
    plan_options = study.options()

    def command(
        context: typer.Context,
        quick: Quick = False,
        output: Output = None,
        engine: Engines = None,
        workers: Workers = None,
        scheduler: Scheduler = None,
        replot: Replot = None,
        check: Check = None,
        write: Write = False,
        seed: Seed = None,
        **options: Any,
    ) -> None:
        if check is not None:
            if quick or engine or scheduler or replot:
                raise SettingError(
                    "--check: takes a result as it is; leave --quick, --engine, --scheduler, --replot out"
                )
            return _check(study.name, output, check, seed, write, workers)
        if write:
            raise SettingError("--write: belongs to --check")
        if "seed" in plan_options:
            options["seed"] = seed
        elif seed is not None:
            raise SettingError(f"--seed {seed}: belongs to --check; this study draws nothing by a seed")
        folder = f"{study.name}-study" if output is None else output
        check_folder(folder)
        if replot is not None:
            return _replot(study, replot, output)
        if scheduler is not None and workers is not None:
            raise SettingError("--workers: a scheduler has its own workers; give --workers or --scheduler")
        _compute(study, folder, engine or None, quick, workers, scheduler, _given(context, options))

    shared = dict(inspect.signature(command, eval_str=True).parameters)
    for name in ("options", *({"seed"} & plan_options.keys())):  # one option for the seed of the plan and of --check
        del shared[name]
    parameters = [*shared.values(), *plan_options.values()]
    command.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]  # Typer reads it there
    command.__annotations__ = {parameter.name: parameter.annotation for parameter in parameters}
    command.__doc__ = f"{study.question}\n\nExample: rocking study {study.name} --quick"
    return command


def _replot(study, result, output):
    """Write the page of a stored result again."""
    from ..report.detail import write_study

    print(write_study(study, result, output)[0])


def _compute(study, folder, engines, quick, workers, scheduler, options):
    """Compute the results of a study and write their pages; status 1 if the study finds problems."""
    from ..execution.runner import compute
    from ..report.detail import write_study
    from ..studies.rows import read_study

    problems = []
    for path in compute(study, folder, engines=engines, quick=quick, workers=workers, scheduler=scheduler, **options):
        with spinner(f"{path.name}: page"):
            file, page = write_study(study, path)
        print(path, file, sep="\n")
        print(page.title, *page.text, sep="\n", file=sys.stderr)
        problems += study.problems(read_study(path))
    if problems:
        print(*problems, sep="\n")
        raise typer.Exit(1)


def _given(context, options):
    """The plan's options that the user gives. Defaults are left out: they must not contradict a stored result."""
    return {name: value for name, value in options.items() if context.get_parameter_source(name).name != "DEFAULT"}


def _check(name, output, number, seed, write, workers):
    """Run stored runs of a study again and print whether they agree; status 1 if one differs."""
    from ..execution.runner import check_all

    with stdout_to_stderr():  # engines print on import
        seed = secrets.randbelow(2**32) if seed is None else seed
        checks = check_all(name, RESULTS if output is None else output, number, seed, record=write, workers=workers)
    for check in checks:
        print(check.words(), *(f"  does not hold: {words}" for words in check.differences), sep="\n")
    if any(check.differences for check in checks):
        raise typer.Exit(1)


def every(
    output: Annotated[
        str,
        typer.Option(
            metavar="DIR", help="Folder for the results and the runs from which an interrupted study resumes."
        ),
    ] = "studies",
    quick: Quick = False,
    engine: Engines = None,
    workers: Workers = None,
) -> None:
    """Compute all studies of this project one after the other.

    Runs are stored: after an interruption the same command resumes, and a second call computes only new runs. rocking
    report --studies DIR shows the results.

    Example: rocking study all --output studies
    """
    from ..execution.runner import compute

    check_folder(output)
    for name in BUILT_IN:
        began = time.monotonic()
        log(f"study {name}")
        print(*compute(get_study(name), output, engines=engine or None, quick=quick, workers=workers), sep="\n")
        log(f"study {name}: {(time.monotonic() - began) / 60:.1f} minutes")


class _Studies(TyperGroup):
    def list_commands(self, ctx):
        return [*study_names(), EVERY]

    def get_command(self, ctx, name):
        try:
            function = every if name == EVERY else command_of(get_study(name))
        except KeyError:
            return None
        except StudyBroken as error:
            function = _broken(error)
        app = typer.Typer(add_completion=False, rich_markup_mode=None)
        app.command(name)(function)
        return typer.main.get_command(app)


def _broken(error):
    def command():
        raise error

    command.__doc__ = f"Cannot be used. {error}"
    return command


app = typer.Typer(cls=_Studies, add_completion=False, rich_markup_mode=None, no_args_is_help=True)


@app.callback()
def _about():
    """Compute a study's result and write its page.

    After an interruption the same command resumes.

    Example: rocking study restitution --quick
    """


def verify(
    engine: EngineNames = None,
    variant: Annotated[
        str | None, typer.Option(help="Variant of the engine, if one is named. Default: all that state tolerances.")
    ] = None,
    output: Annotated[
        str | None,
        typer.Option(
            metavar="DIR", help="Also write the rows into DIR/tolerances; rocking report --studies DIR shows them."
        ),
    ] = None,
    json_file: JsonFile = None,
    time_limit: Annotated[
        float, typer.Option(metavar="SECONDS", help="End an engine that takes longer; it counts as failed.")
    ] = TIME_LIMIT,
) -> None:
    """Check the installed engines against their tolerances.

    An engine of another package may state no tolerances; its rows then give the measured values only. Status 1: a
    tolerance is exceeded or could not be measured.

    Tests of another project can use comparisons.metrics.agreement.rows("exudyn") and call `check()` of each row.

    Example: rocking verify --engine exudyn
    """
    from ..metrics.agreement import rows

    check_time_limit(time_limit)
    check_writable([json_file])
    if output is not None:
        check_folder(output)
    if variant is not None and len(engine or ()) != 1:
        raise SettingError(f"--variant {variant}: belongs to one engine; name it with --engine")
    results: list[dict[str, Any]] = []
    for name in named_engines(engine or installed_engines()):
        for each in [variant] if variant else get_engine(name).tolerance_rows() or [None]:
            results += _verified(name, rows(name, each), time_limit)
    if output is not None:
        _write(Path(output), results, alone=bool(engine))
    versions = {name: get_engine(name).versions() for name in dict.fromkeys(row["engine"] for row in results)}
    form = Verification(versions=versions, rows=[Tolerance(**row) for row in results])
    write_output({json_file: form}, lambda: _show(results))
    if not results or any(row["failure"] or row["holds"] is False for row in results):
        raise typer.Exit(1)


def _verified(name, table, time_limit):
    """The rows of an engine, measured in a separate process. If that fails, each row gives the reason."""
    from ..metrics.agreement import measure_all

    compile_kernels(vertical=True)
    measured, failure = guard.run_apart(
        measure_all, table, time_limit=time_limit, meanwhile=spinner(f"{name}: {len(table)} tolerances")
    )
    if failure is None:
        return measured
    say(f"{name}: {failure.reason}. {failure.message.partition(chr(10))[0]}")
    return [row.result(None, failure.reason) for row in table]


def _write(folder, results, alone):
    """Write the rows as a result beside those of the studies.

    alone: write only the files of these engines, and keep the files of other engines.
    """
    from ..metrics.agreement import measure_all

    engines = list(dict.fromkeys(row["engine"] for row in results))
    bounds = [f"{ENGINES[name].tolerances}:TOLERANCES" for name in engines if ENGINES[name].tolerances]
    plan, place = name_of(measure_all), folder / TOLERANCES
    result = made_here(TOLERANCES, {}, [{"part": "tolerance", **row} for row in results], modules=[plan])
    only = alone and (place / f"{MODEL}.json").exists()
    save_parts(place, result, plan, engines, dict.fromkeys((*engines, *bounds), 0), only)


def _show(results):
    from ..plotting.terminal import echo

    for solver in dict.fromkeys((row["engine"], row["variant"]) for row in results):
        echo(_table(solver, [row for row in results if (row["engine"], row["variant"]) == solver]))
    failures = [f"{row['engine']}, {row['quantity']}: {row['failure']}" for row in results if row["failure"]]
    bounded = [row["holds"] for row in results if row["holds"] is not None]
    held = [f"{sum(bounded)} of {len(bounded)} tolerances hold."] if bounded else []
    echo(*failures, *_unbounded(results), *held)


def _unbounded(results):
    """Yield a sentence on each engine without tolerances."""
    for name in dict.fromkeys(row["engine"] for row in results if row["bound"] is None):
        measured = [row["found"] is not None for row in results if row["engine"] == name]
        count = f"{sum(measured)} of {len(measured)} quantities measured"
        yield f"{name}: no bound stated, so nothing holds or fails; {count}."


def _table(solver, rows):
    from rich.text import Text

    from ..plotting.terminal import digits, grid

    heads = ["", "quantity and scenes", "found", "tolerated", "unit"]
    cells = [
        [
            "" if row["holds"] is None else "holds" if row["holds"] else Text("FAILS", style="bold red"),
            f"{row['quantity']}\n{row['scenes']}",
            digits(row["found"], ".3g"),
            "no bound stated" if row["bound"] is None else f"{row['bound']:.2g}",
            row["unit"],
        ]
        for row in rows
    ]
    return grid(heads, cells, left=["quantity and scenes", "unit"], wraps=heads, title=", ".join(solver))
