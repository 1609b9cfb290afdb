"""What a user says of a record that the file itself does not, the same in every command."""

from typing import Annotated

import typer

Units = Annotated[str | None, typer.Option(help="Of a record that does not say: m/s2, cm/s2 or g.")]
Step = Annotated[float | None, typer.Option(metavar="SECONDS", help="Sampling interval of a record that states none.")]
Column = Annotated[
    int | None, typer.Option(metavar="NUMBER", help="Of several columns: the accelerations', from 1 on.")
]
Channel = Annotated[str | None, typer.Option(help="Of several channels: its number or direction, 3 or Up.")]
