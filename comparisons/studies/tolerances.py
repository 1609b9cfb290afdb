"""``rocking study tolerances``: the table of agreement tolerances, every row measured anew."""

from pathlib import Path
from typing import Annotated

import typer


def command(
    quick: Annotated[bool, typer.Option(help="Default variants only.")] = False,
    output: Annotated[str, typer.Option(metavar="DIR", help="Folder for the result file.")] = "tolerances-study",
):
    """How far each engine is from the analytic model, beside what it is held to. Status 1: a row does not hold."""
    from engines import ENGINES, get_engine, installed_engines

    from ..measuring.tolerances import TABLE, measure_all
    from ..running.files import check_folder
    from ..running.provenance import write_result
    from ..running.solving import spinner, stdout_to_stderr

    check_folder(output)
    results = []
    with stdout_to_stderr(), spinner("tolerances"):  # engines greet on standard output
        engines = installed_engines()
        for engine in engines:
            default = get_engine(engine).default_variant
            results += measure_all([row for row in TABLE if row.engine == engine
                                    and (row.variant == default or not quick)])
    modules = ["comparisons.measuring.tolerances", *(ENGINES[name].adapter for name in engines),
               *(ENGINES[name].tolerances for name in engines if ENGINES[name].tolerances)]
    path = write_result(Path(output) / "tolerances.json", "tolerances", {"engines": engines, "quick": quick}, results,
                        modules=modules)
    print(path)
    for row in results:
        if not row["holds"]:
            print(f"does not hold: {row['quantity']}, {row['engine']}, {row['variant']}, {row['scenes']}: "
                  f"{row['failure'] or row['found']}, tolerated {row['least']:g} to {row['bound']:g} {row['unit']}")
    if not all(row["holds"] for row in results):
        raise typer.Exit(1)


def section(result):
    """The table as a section of the report."""
    from ..showing.parts import Section, Table, number

    broken = [row for row in result.rows if not row["holds"]]
    text = (f"{len(result.rows)} tolerances, each the assertion of a test; a bound is at most twice the worst measured "
            "when it was set, but for round-off. First scripts are held to a band: their errors are known, and must "
            "not vanish unnoticed.",
            "All of them hold." if not broken else f"{len(broken)} of them do not hold.")
    rows = [[f"{row['engine']}, {row['variant']}: {row['quantity']}", row["scenes"],
             f"{number(row['least'], 2)} to {number(row['bound'], 2)}" if row["least"] else number(row["bound"], 2),
             number(row["measured"], 3), row["failure"] or number(row["found"], 3), row["unit"],
             "yes" if row["holds"] else "no", row["source"]] for row in result.rows]
    return Section("Agreement tolerances", text, (Table("Tolerances and what is measured", (
        "engine, variant: quantity", "scenes", "tolerance", "measured when set", "measured now", "unit", "holds",
        "where the error comes from"), rows),))
