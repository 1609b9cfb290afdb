"""``rocking bench``: what the solvers cost at what error."""

from typing import Annotated

import typer

app = typer.Typer(
    add_completion=False,
    rich_markup_mode=None,
    no_args_is_help=True,
    help="Measure what the solvers cost at what error.\n\nExample: rocking bench analytic --quick",
)


@app.callback()
def _about():
    """Measure what the solvers cost at what error."""


@app.command()
def analytic(
    quick: Annotated[bool, typer.Option(help="Fewer settings and rounds: under a minute.")] = False,
    random: Annotated[int, typer.Option(min=0, max=10**6, help="Random valid scenes to run through the kernel.")] = 0,
    record: Annotated[
        str | None,
        typer.Option(metavar="FILE", help="Record for the isolated Caryatid; without it the shipped synthetic motion."),
    ] = None,
    output: Annotated[str, typer.Option(metavar="DIR", help="Where the results go.")] = "bench-analytic",
) -> None:
    """Kernel against scipy and other solvers, and the figures it promises. Status 1: a random scene failed.

    Example: rocking bench analytic --quick
    """
    from rich.console import Console

    from ..bench.analytic_bench import bench_analytic
    from ..bench.tables import figure_table, solver_table
    from ..running.files import check_folder

    check_folder(output)
    notes = Console(stderr=True)
    with notes.status("problems") as status:
        found, rows, faulty = bench_analytic(
            output, quick=quick, random_scenes=random, record=record, advance=status.update
        )
    console = Console()
    console.print(solver_table(rows))
    console.print(figure_table(found))
    console.print(f"{output}/bench-analytic.json, {output}/bench-analytic.png", markup=False)
    if faulty:
        console.print(f"{len(faulty)} of {random} random scenes failed: {output}/random-scenes.json", markup=False)
        raise typer.Exit(1)
