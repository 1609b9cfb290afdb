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


@app.command()
def engines(
    engine: Annotated[str, typer.Option(help="Engine, in its default variant.")],
    scenes: Annotated[int, typer.Option(min=1, max=10**6, help="Scenes of the wide box.")] = 2000,
    seed: Annotated[int, typer.Option(min=0, max=2**63, help="Of the ensemble.")] = 1,
    workers: Annotated[int | None, typer.Option(min=1, help="Processes; without it one per core.")] = None,
    time_limit: Annotated[float, typer.Option(min=0.1, help="Of an engine's run [s].")] = 60.0,
    index: Annotated[int | None, typer.Option(min=0, max=10**9, help="Run this scene alone and print it.")] = None,
    output: Annotated[str, typer.Option(metavar="DIR", help="Where runs and results go.")] = "bench-engines",
) -> None:
    """An engine against the analytic model on random scenes of a wide box. Status 1: a run was off in silence.

    Example: rocking bench engines --engine exudyn --scenes 200
    """
    import json

    from rich.console import Console

    from ..bench.engines.run import bench_engines, examine
    from ..bench.engines.tables import cause_table, class_table, off_table
    from ..bench.random_scenes import describe
    from ..running.provenance import json_ready
    from ..running.solving import check_time_limit, named_engines

    named_engines([engine])
    check_time_limit(time_limit)
    console = Console()
    if index is not None:
        scene, model, run, row = examine(engine, index, seed=seed, time_limit=time_limit)
        for title, content in (("scene", describe(scene)), ("analytic", model), (engine, run)):
            curves = {"tilts", "displacements"}
            print(title, json.dumps({k: v for k, v in content.items() if k not in curves}))
        print("verdict", json.dumps(json_ready(row), indent=1))
        raise typer.Exit(row["class"] == "off and silent")
    rows = bench_engines(engine, output, scenes=scenes, seed=seed, workers=workers, time_limit=time_limit)
    from ..bench.engines.figure import draw  # matplotlib takes its time

    draw(rows, f"{engine}: {scenes} random scenes", f"{output}/bench-engines-{engine}.png")
    console.print(class_table(rows, f"{engine}, {scenes} random scenes, seed {seed}"))
    console.print(cause_table(rows))
    if any(row["class"] == "off and silent" for row in rows):
        console.print(off_table(rows))
    console.print(f"{output}/bench-engines-{engine}.json, {output}/bench-engines-{engine}.png")
    raise typer.Exit(any(row["class"] == "off and silent" for row in rows))
