"""``rocking study caryatid``."""

import sys
from typing import Annotated

import typer


def command(
    record: Annotated[str | None, typer.Option(metavar="FILE", help="The Duzce record, or another: PEER AT2, ESM/DYNA "
                                               "1.2 or two columns. Default: the shipped synthetic motion.")] = None,
    units: Annotated[str | None, typer.Option(help="Of a record in two columns: m/s2, cm/s2 or g.")] = None,
    quick: Annotated[bool, typer.Option(help="Fewer points: under a minute.")] = False,
    output: Annotated[str, typer.Option(metavar="DIR", help="Folder for results and figures.")] = "study-caryatid",
):
    """The Caryatid paper: every equation, figure and table reproduced or corrected, and what it leaves out."""
    from pathlib import Path

    from analytic import SettingError, synthetic_motion
    from analytic.records import read_record

    from ...solving import stdout_to_stderr
    from .figures import draw
    from .study import make_results

    if units and not record:
        raise SettingError(f"--units {units}: belongs to a record; give --record FILE")
    if Path(output).exists() and not Path(output).is_dir():
        raise SettingError(f"--output {output}: is a file; give a folder")
    motion = read_record(record, units) if record else synthetic_motion()

    def say(text):
        print(text, file=sys.stderr, flush=True)

    say(f"ground motion: {motion.label}")
    with stdout_to_stderr():  # engines greet on standard output
        files = make_results(output, motion, quick=quick, say=say)
    draw(files)
    for file in files:
        print(file)
