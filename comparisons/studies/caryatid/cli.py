"""``rocking study caryatid``."""

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
    from ...running.files import check_folder
    from ...running.solving import ground_motion, say, stdout_to_stderr
    from .figures import draw
    from .study import make_results

    check_folder(output)
    motion = ground_motion(record, units)
    say(f"ground motion: {motion.label}")
    with stdout_to_stderr():  # engines greet on standard output
        files = make_results(output, motion, quick=quick, say=say)
    draw(files)
    for file in files:
        print(file)
