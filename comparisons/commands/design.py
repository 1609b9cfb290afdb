"""``rocking design``: bearings from target period, damping and displacement."""

import typer


def command(
    period: float = typer.Option(..., help="secant period at x_max [s]"),
    damping: float = typer.Option(..., help="share of critical damping at x_max, e.g. 0.30"),
    xmax: float = typer.Option(..., help="design displacement [m]"),
    mass: float = typer.Option(3384.05, help="block and base together [kg]; the Caryatid's by default"),
    count: int = typer.Option(4, help="number of bearings"),
    ratio: float = typer.Option(10.0, help="ka/kb; Table 1(b) of the paper has 10"),
    definition: str = typer.Option("paper", help="paper: W_D/(2 pi E_s); equivalent: W_D/(4 pi E_s)"),
    json: str = typer.Option(None, help="write the design as JSON to this file, or - for standard output"),
):
    """Bearing constants for a target period, damping and displacement: Table 1(a) to Table 1(b), and back."""
    import dataclasses
    import json as json_module
    from pathlib import Path

    from rich.console import Console

    from analytic.design import design_bearings, properties

    bearings = design_bearings(mass, period, damping, xmax, count=count, stiffness_ratio=ratio, definition=definition)
    back = properties(bearings, mass, xmax)
    if json:
        text = json_module.dumps({"bearings": bearings.model_dump(), "properties": dataclasses.asdict(back)}, indent=2)
        if json == "-":
            print(text)
            return
        Path(json).write_text(text + "\n")
    console = Console(highlight=False, soft_wrap=True)
    console.print(f"[bold]ka[/bold] = {bearings.ka:.5g} N/m   [bold]kb[/bold] = {bearings.kb:.5g} N/m   "
                  f"[bold]alpha[/bold] = {bearings.alpha:.4f}   for each of {count} bearings")
    console.print(f"back: secant period {back.period:.5g} s at {xmax:g} m ({back.period_kb:.4g} s with kb alone); "
                  f"damping {back.damping_paper:.2%} as W_D/(2 pi E_s), "
                  f"{back.damping_equivalent:.2%} as W_D/(4 pi E_s); "
                  f"loss {back.cycle_loss:.5g} J a cycle and bearing")
