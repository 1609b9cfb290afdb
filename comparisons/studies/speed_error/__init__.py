"""Speed against error: what each solver costs at what error, on five scenes; and how the cost grows."""

from pathlib import Path
from typing import Annotated

import typer

from .page import section

__all__ = ["command", "section"]


def command(
    quick: Annotated[bool, typer.Option("--quick", help="Short ladders: under two minutes.")] = False,
    output: Annotated[str, typer.Option(metavar="DIR", help="Folder for result and figures.")] = "rocking-speed-error",
    repeats: Annotated[int | None, typer.Option(min=1, help="Fresh processes in turn. Default 5, quick 3.")] = None,
    x: Annotated[str, typer.Option(help="Horizontal axis of the figure.")] = "cpu",
    y: Annotated[str, typer.Option(help="Vertical axis; 'error' is each scene's principal measure.")] = "error",
    replot: Annotated[str | None, typer.Option(metavar="FILE", help="Only draw, from this result file.")] = None,
):
    """Error and CPU time of the same runs: kernel, scipy, time stepping, Bouc-Wen, engines and variants, peers."""
    from ...running.files import check_folder
    from ...running.provenance import ResultError, read_result
    from ...showing.plots import save
    from .compute import run_study
    from .figures import check_axes, draw_growth, draw_pareto

    check_axes(x, y)
    folder = Path(output)
    check_folder(output)
    if replot:
        try:
            result = read_result(replot)
        except ResultError as error:
            raise typer.BadParameter(str(error), param_hint="--replot") from error
        folder.mkdir(parents=True, exist_ok=True)
        path = folder / f"speed-error-{x}-{y}.png"
        save(draw_pareto(result, x, y), path)
        print(path)
        return
    path = run_study(folder, quick=quick, repeats=repeats)
    result = read_result(path)
    save(draw_pareto(result, x, y), path.with_suffix(".png"))
    save(draw_pareto(result, "step", y), path.with_name("speed-error-step.png"))
    save(draw_growth(result), path.with_name("speed-error-growth.png"))
    for paragraph in section(result).text:
        typer.echo(paragraph, err=True)
    print(path)
