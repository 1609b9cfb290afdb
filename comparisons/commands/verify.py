"""``rocking verify``: whether the engines installed here meet the tolerances."""

from pathlib import Path
from typing import Annotated, Any

import typer

from analytic.errors import SettingError

from ..cli.output import write_output
from ..running.progress import compile_kernels, say, spinner
from ..running.solving import TIME_LIMIT, check_time_limit, named_engines


def command(
    engine: Annotated[
        list[str] | None, typer.Option(help="An engine to verify; may be repeated. Default: all that are installed.")
    ] = None,
    variant: Annotated[
        str | None, typer.Option(help="Variant of the one engine. Default: all that state tolerances.")
    ] = None,
    output: Annotated[
        str | None,
        typer.Option(
            metavar="DIR", help="Write the rows into DIR/tolerances, too, which rocking report --studies DIR shows."
        ),
    ] = None,
    json_file: Annotated[
        str | None, typer.Option("--json", metavar="FILE", help="Write the rows; - prints them.")
    ] = None,
    time_limit: Annotated[
        float, typer.Option(metavar="SECONDS", help="An engine that takes longer has failed.")
    ] = TIME_LIMIT,
) -> None:
    """Check the engines installed on this machine against the table of tolerances.

    For an engine of another package without tolerances, the rows give the measured values. Status 1: a tolerance is
    exceeded, or could not be measured.
    From the tests of another project: comparisons.measuring.tolerances.rows("exudyn"), each with `check()`.
    Example: rocking verify --engine exudyn
    """
    from engines import get_engine, installed_engines

    from ..measuring.tolerances import rows
    from ..running.files import check_folder, check_writable
    from ..schemas.runs import Tolerance, Verification

    check_time_limit(time_limit)
    check_writable([json_file])
    if output is not None:
        check_folder(output)
    if variant is not None and len(engine or ()) != 1:
        raise SettingError(f"--variant {variant}: belongs to one engine; name it with --engine")
    results: list[dict[str, Any]] = []
    for name in named_engines(engine or installed_engines()):
        for one in [variant] if variant else get_engine(name).tolerance_rows() or [None]:
            results += _verified(name, rows(name, one), time_limit)
    if output is not None:
        _write(Path(output), results, alone=bool(engine))
    versions = {name: get_engine(name).versions() for name in dict.fromkeys(row["engine"] for row in results)}
    form = Verification(versions=versions, rows=[Tolerance(**row) for row in results])
    write_output({json_file: form}, lambda: _show(results))
    if not results or any(row["failure"] or row["holds"] is False for row in results):
        raise typer.Exit(1)


def _verified(name, table, time_limit):
    """The rows of an engine, measured in a process of their own; if it fails, each row says so."""
    from engines.guard import run_apart

    from ..measuring.tolerances import measure_all

    compile_kernels(vertical=True)
    found, failure = run_apart(
        measure_all, table, time_limit=time_limit, meanwhile=spinner(f"{name}: {len(table)} tolerances")
    )
    if failure is None:
        return found
    say(f"{name}: {failure.reason}. {failure.message.partition(chr(10))[0]}")
    return [row.result(None, failure.reason) for row in table]


def _write(folder, results, alone):
    """The rows as a result beside those of the studies; alone: the engines' files, beside those of others."""
    from engines import ENGINES

    from ..measuring.tolerances import measure_all
    from ..running.by_solver import MODEL, save_parts
    from ..running.cases import name_of
    from ..running.provenance import made_here
    from ..studies import TOLERANCES

    engines = list(dict.fromkeys(row["engine"] for row in results))
    bounds = [f"{ENGINES[name].tolerances}:TOLERANCES" for name in engines if ENGINES[name].tolerances]
    plan, place = name_of(measure_all), folder / TOLERANCES
    result = made_here(TOLERANCES, {}, [{"part": "tolerance", **row} for row in results], modules=[plan])
    only = alone and (place / f"{MODEL}.json").exists()
    save_parts(place, result, plan, engines, dict.fromkeys((*engines, *bounds), 0), only)


def _show(results):
    from ..showing.terminal import echo

    for solver in dict.fromkeys((row["engine"], row["variant"]) for row in results):
        echo(_table(solver, [row for row in results if (row["engine"], row["variant"]) == solver]))
    failures = [f"{row['engine']}, {row['quantity']}: {row['failure']}" for row in results if row["failure"]]
    bounded = [row["holds"] for row in results if row["holds"] is not None]
    held = [f"{sum(bounded)} of {len(bounded)} tolerances hold."] if bounded else []
    echo(*failures, *_unbounded(results), *held)


def _unbounded(results):
    """A sentence on each engine without tolerances."""
    for name in dict.fromkeys(row["engine"] for row in results if row["bound"] is None):
        found = [row["found"] is not None for row in results if row["engine"] == name]
        yield f"{name}: no bound stated, so nothing holds or fails; {sum(found)} of {len(found)} quantities measured."


def _table(solver, rows):
    from rich.text import Text

    from ..showing.terminal import digits, grid

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
