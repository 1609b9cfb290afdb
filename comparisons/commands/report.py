"""``rocking report``: the main job."""

from typing import Annotated

import typer


def command(
    record: Annotated[
        str | None,
        typer.Option(
            metavar="FILE",
            help="Recorded ground motion: PEER AT2, ESM/DYNA 1.2 "
            "or two columns. Default: the shipped synthetic motion.",
        ),
    ] = None,
    units: Annotated[str | None, typer.Option(help="Of a record in two columns: m/s2, cm/s2 or g.")] = None,
    output: Annotated[str, typer.Option(metavar="DIR", help="Folder for the page and its result files.")] = "report",
) -> None:
    """All solvers on the Caryatid, free-standing and isolated: one HTML page and the result files it is made from."""
    from ..report.study import make_results
    from ..report.write import write_page
    from ..running.files import check_folder
    from ..running.solving import ground_motion, say, stdout_to_stderr

    check_folder(output)
    motion = ground_motion(record, units)
    say(f"ground motion: {motion.label}")
    with stdout_to_stderr():  # engines greet on standard output
        make_results(output, motion)
    say("the page")
    print(write_page(output))
