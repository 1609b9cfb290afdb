"""Overturning: where do the solvers' boundaries lie, over pulse frequency and amplitude?"""

from pathlib import Path
from typing import Annotated

import typer

from .page import section

__all__ = ["command", "section"]


def command(
    quick: Annotated[bool, typer.Option("--quick", help="A small study, to see it work.")] = False,
    output: Annotated[str, typer.Option(metavar="DIR", help="Folder for result and figures.")] = "rocking-overturning",
    workers: Annotated[int | None, typer.Option(help="Worker processes; default: one per core.")] = None,
):
    """Overturning boundaries under pulses, on rigid ground and isolated: analytic model, exudyn, PyBullet."""
    from ...running.provenance import read_result, write_result
    from ...showing.plots import save
    from ..workshop import code_of, say, workshop
    from .cases import ENGINES, compute
    from .figures import draw_knobs, draw_maps, draw_shifts

    solvers = ["time-stepping", *(solver for solver, _ in ENGINES)]
    path = Path(output) / "overturning.json"
    with workshop(output, solvers, workers) as work:
        for settings, rows, arrays in compute(work, quick):  # each a complete result, the last with all settings
            write_result(path, "overturning", settings, rows, arrays,
                         modules=code_of("comparisons.studies.overturning.cases", solvers))
            say(f"written: {path.name}, {len(rows)} rows")
    result = read_result(path)
    for name, draw in (("maps", draw_maps), ("shifts", draw_shifts), ("knobs", draw_knobs)):
        save(draw(result), path.with_name(f"overturning-{name}.png"))
    for paragraph in section(result).text:
        say(paragraph)
    print(path)
