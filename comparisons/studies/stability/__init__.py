"""``rocking study stability``: which solver survives which hard case, with evidence and cures."""

from pathlib import Path
from typing import Annotated

import typer

from .page import section

__all__ = ["command", "run", "section"]

QUICK_LIMIT, TIME_LIMIT = 60.0, 900.0  # s, of one run; the longest takes 75 s of CPU time
LONG = 60.0  # s; in longer scenes cures are tried on the engines' default variants only, to save time


def command(
    quick: Annotated[bool, typer.Option("--quick", help="A part of the cases, cures of default variants only: under "
                                                        "two minutes.")] = False,
    output: Annotated[str, typer.Option(metavar="DIR", help="Folder for the result file, the figure and the runs from "
                                                            "which an interrupted study resumes.")]
    = "stability-study",
    workers: Annotated[int | None, typer.Option(min=1, help="Worker processes; one per core without it.")] = None,
):
    """Named hard cases, every solver and variant: right, degraded or failed, with measures, evidence and cures."""
    from ...running.files import check_folder

    check_folder(output)
    for file in run(output, quick=quick, workers=workers):
        print(file)


def run(folder, *, quick=False, workers=None, progress=True, names=None, columns=None):
    """Compute the study; returns the paths of its result file and figure in `folder`.

    Parameters
    ----------
    folder : path
        Made if it does not exist. Runs already found there are not repeated.
    quick : bool
        The quick cases only, and cures of the engines' default variants only.
    workers : int or None
        Worker processes; None: one per core.
    progress : bool
        Show it on standard error.
    names : iterable of str or None
        Only these cases.
    columns : sequence of Solver or None
        None: `stability_verdicts.solvers()`.
    """
    from ...running.cases import module_of
    from ...running.provenance import read_result, write_result
    from ...running.solving import stdout_to_stderr
    from ...showing.plots import save
    from .cases import hard_cases
    from .page import draw
    from .verdicts import solvers

    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    cases = [case for case in hard_cases().values() if (case.quick or not quick) and (not names or case.name in names)]
    with stdout_to_stderr():  # engines greet on standard output
        columns = solvers() if columns is None else columns
        rows = _rows(cases, columns, folder / "runs.jsonl", workers, progress, quick)
    settings = settings_of(cases, columns, quick)
    modules = ["comparisons.studies.stability.verdicts", "comparisons.studies.stability.measure",
               *dict.fromkeys(module_of(column.name) for column in columns)]
    path = write_result(folder / "stability.json", "stability", settings, rows, modules=modules)
    figure = path.with_suffix(".png")
    save(draw(read_result(path)), figure)
    return path, figure


def _rows(cases, columns, store, workers, progress, quick):
    """Result rows of all cells, then of the cures tried in turn where the verdict was not "right"."""
    from ...running.executors import Processes
    from ...running.store import Store
    from ...running.sweep import run_sweep
    from .measure import measure
    from .verdicts import RIGHT, entry

    limit = QUICK_LIMIT if quick else TIME_LIMIT
    cells = [(case, column) for case in cases for column in columns]
    found = []
    with Store(store) as rows, Processes(workers, [column.name for column in columns]) as executor:
        def runs(cells, cure, label):
            sweep = run_sweep([column.case(case, cure) for case, column in cells], store=rows, executor=executor,
                              reduce=measure, time_limit=limit, progress=progress, label=label)
            found.extend(entry(case, column, row) for (case, column), row in zip(cells, sweep, strict=True))
            return [cell for cell, content in zip(cells, found[-len(cells):], strict=True)
                    if content["verdict"] != RIGHT]

        ill, cure = runs(cells, None, "hard cases"), 0
        while ill := [(case, column) for case, column in ill
                      if cure < len(column.cures)
                      and (column.default or not (quick or case.scene.duration > LONG))]:
            ill, cure = runs(ill, cure, f"cures, round {cure + 1}"), cure + 1
    return found


def settings_of(cases, columns, quick):
    """What the study was asked, as its result file keeps it: cases, oracles, tolerances and their reasons, solvers."""
    from .verdicts import MEASURES, TOLERANCES

    return {
        "quick": quick, "time_limit": QUICK_LIMIT if quick else TIME_LIMIT,
        "cases": {case.name: {"title": case.title, "oracle": case.oracle, "duration": case.scene.duration,
                              "twin_until": case.twin_until, "tolerances": case.tolerances} for case in cases},
        "measures": MEASURES, "tolerances": TOLERANCES,
        "solvers": {column.label: {"kind": column.kind, "default_variant": column.default, "settings": defaults(column),
                                   "cures": column.cures} for column in columns}}


def defaults(column):
    """Settings of a column where nothing is changed."""
    import dataclasses

    from engines import ENGINES, get_engine

    if column.name not in ENGINES:
        return column.settings
    return {**dataclasses.asdict(get_engine(column.name).variants[column.variant].settings), **column.settings}
