"""``rocking report``: the main job."""

from typing import Annotated

import typer

from ..running.record_options import Channel, Column, Step, Units


def command(
    record: Annotated[
        str | None,
        typer.Option(
            metavar="FILE",
            help="Recorded ground motion: see rocking record --help. Default: the shipped synthetic motion.",
        ),
    ] = None,
    units: Units = None,
    dt: Step = None,
    column: Column = None,
    channel: Channel = None,
    output: Annotated[str, typer.Option(metavar="DIR", help="Folder for the page and its result files.")] = "report",
) -> None:
    """All solvers on the Caryatid, free-standing and isolated: one HTML page and the result files it is made from."""
    from ..report.study import make_results
    from ..report.write import write_page
    from ..running.files import check_folder
    from ..running.solving import ground_motion, say, stdout_to_stderr

    check_folder(output)
    motion = ground_motion(record, units=units, dt=dt, column=column, channel=channel)
    say(f"ground motion: {motion.label}")
    with stdout_to_stderr():  # engines greet on standard output
        make_results(output, motion)
    say("the page")
    print(write_page(output))
