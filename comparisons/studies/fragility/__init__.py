"""Fragility: how likely is overturning at an intensity, and does the answer depend on the solver?"""

from pathlib import Path
from typing import Annotated

import typer

from .page import section

__all__ = ["command", "section"]


def command(
    quick: Annotated[bool, typer.Option("--quick", help="A small study, to see it work.")] = False,
    output: Annotated[str, typer.Option(metavar="DIR", help="Folder for result and figures.")] = "rocking-fragility",
    workers: Annotated[int | None, typer.Option(help="Worker processes; default: one per core.")] = None,
):
    """Probability of overturning over the intensity of synthetic motions: analytic model, exudyn, PyBullet."""
    from ...running.provenance import read_result, write_result
    from ...showing.plots import save
    from ..workshop import DEFAULTS, code_of, say, workshop
    from .cases import compute
    from .page import draw

    solvers = [solver for solver, _ in DEFAULTS]
    path = Path(output) / "fragility.json"
    with workshop(output, solvers, workers) as work:
        for settings, rows, arrays in compute(work, quick):  # each a complete result, the last with all scenes
            write_result(path, "fragility", settings, rows, arrays,
                         modules=code_of("comparisons.studies.fragility.cases", solvers), seed=settings["seeds"])
            say(f"written: {path.name}, {len(rows)} rows")
    result = read_result(path)
    save(draw(result), path.with_suffix(".png"))
    for paragraph in section(result).text:
        say(paragraph)
    print(path)
