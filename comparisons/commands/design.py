"""``rocking design``: bearings from target period, damping and displacement."""

import dataclasses
from typing import Annotated

import typer

from ..running.options import DEFINITION, OPTIONS, RATIO, told_by_options


def command(
    period: Annotated[float, typer.Option(help="Secant period at x_max [s].")],
    damping: Annotated[float, typer.Option(help="Share of critical damping at x_max, e.g. 0.30.")],
    xmax: Annotated[float, typer.Option(help="Design displacement [m].")],
    mass: Annotated[float, typer.Option(help="Block and base together [kg].")],
    count: Annotated[int, typer.Option(help="Number of bearings.")] = 4,
    ratio: Annotated[float, typer.Option(help=RATIO)] = 10.0,
    definition: Annotated[str, typer.Option(help=DEFINITION)] = "equivalent",
    json_file: Annotated[
        str | None, typer.Option("--json", metavar="FILE", help="Write the design; - prints it.")
    ] = None,
) -> None:
    """Bearing constants for a target period, damping and displacement: Table 1(a) to Table 1(b), and back.

    Example: rocking design --period 2 --damping 0.30 --definition paper --xmax 0.30 --mass 3384.05
    """
    from rich.console import Console

    from analytic.design import design_bearings, properties

    from ..running.files import check_writable, write_text
    from ..schemas.advice import Constants, Design, Properties

    check_writable([json_file])
    with told_by_options(OPTIONS):
        bearings = design_bearings(
            mass, period, damping, xmax, count=count, stiffness_ratio=ratio, definition=definition
        )
    back = properties(bearings, mass, xmax)
    if json_file:
        constants, given = Constants(**bearings.model_dump()), Properties(**dataclasses.asdict(back))
        write_text(json_file, Design(bearings=constants, properties=given).text())
    if json_file == "-":
        return
    console = Console(highlight=False, soft_wrap=True)
    console.print(
        f"[bold]ka[/bold] = {bearings.ka:.5g} N/m   [bold]kb[/bold] = {bearings.kb:.5g} N/m   "
        f"[bold]alpha[/bold] = {bearings.alpha:.4f}   for each of {count} bearings"
    )
    console.print(
        f"back: secant period {back.period:.5g} s at {xmax:g} m ({back.period_kb:.4g} s with kb alone); "
        f"damping {back.damping_paper:.2%} as W_D/(2 pi E_s), "
        f"{back.damping_equivalent:.2%} as W_D/(4 pi E_s); "
        f"loss {back.cycle_loss:.5g} J a cycle and bearing"
    )
