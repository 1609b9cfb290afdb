"""``rocking study restitution``: how far off are restitution and the base velocity jump, where, why, at what cost?"""

import sys
from pathlib import Path
from typing import Annotated

import typer


def command(
    quick: Annotated[bool, typer.Option(help="A coarse grid: some two minutes.")] = False,
    output: Annotated[str, typer.Option(metavar="DIR", help="Folder for the result file, the figures and the runs "
                                                            "from which an interrupted study resumes.")]
    = "restitution-study",
    workers: Annotated[int | None, typer.Option(min=1, help="Worker processes; one per core without it.")] = None,
):
    """Error of restitution and base velocity jump over slenderness, base mass and accuracy setting, with its cost."""
    from ...running.files import check_folder
    from .cases import FULL, QUICK

    check_folder(output)
    path, figures = run(output, QUICK if quick else FULL, workers=workers)
    for file in (path, *figures):
        print(file)


def run(folder, grid, *, workers=None, progress=True, engines=None):
    """Compute the study; returns the paths of its result file and figures in `folder`.

    Parameters
    ----------
    folder : path
        Made if it does not exist. Runs already found there are not repeated.
    grid : Grid
        What to cover (restitution_cases.py).
    workers : int or None
        Worker processes; None: one per core.
    progress : bool
        Show it on standard error.
    engines : sequence of str or None
        None: those installed.
    """
    from engines import ENGINES, installed_engines

    from ...running.provenance import read_result, write_result
    from ...running.solving import stdout_to_stderr
    from ...running.sweep import run_sweep
    from ...showing.plots import save
    from .cases import experiment_cases, grid_cases
    from .figures import figures
    from .measure import kept
    from .summary import result_of

    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    with stdout_to_stderr():  # engines greet on standard output
        engines = installed_engines() if engines is None else engines
        cases = grid_cases(grid, engines) + experiment_cases(grid, engines)
        rows = run_sweep(cases, store=folder / "runs.jsonl", workers=workers, time_limit=60.0, reduce=kept,
                         progress=progress, label="restitution")
    settings, entries, arrays = result_of(grid, rows)
    modules = ["comparisons.studies.restitution.summary", *(ENGINES[name].adapter for name in engines)]
    path = write_result(folder / "restitution.json", "restitution", settings, entries, arrays, modules=modules)
    drawn = []
    for name, figure in figures(read_result(path)).items():
        drawn.append(folder / f"restitution-{name}.png")
        save(figure, drawn[-1])
    print(f"{sum(not row.reused for row in rows)} runs done, {sum(row.reused for row in rows)} found",
          file=sys.stderr)
    return path, drawn


def section(result):
    """The study's section of the report, from its `Result`."""
    from .page import section_of

    return section_of(result)
