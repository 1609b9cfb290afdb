"""Options for what a record file does not state, the same in every command."""

from typing import Annotated

import typer

Units = Annotated[str | None, typer.Option(help="Unit, if the file states none: m/s2, cm/s2, gal, mm/s2, g or %g.")]
Step = Annotated[float | None, typer.Option(metavar="SECONDS", help="Sampling interval, if the file states none.")]
Column = Annotated[
    str | None, typer.Option(help="Of several columns: the accelerations', its number from 1 on or its title.")
]
Channel = Annotated[str | None, typer.Option(help="Of several channels: its number or direction, 3 or Up.")]
