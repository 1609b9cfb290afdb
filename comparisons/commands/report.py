"""``rocking report``: the main job."""

import sys
from typing import Annotated

import typer


def command(
    record: Annotated[str | None, typer.Option(metavar="FILE", help="Recorded ground motion: PEER AT2, ESM/DYNA 1.2 "
                                               "or two columns. Default: the shipped synthetic motion.")] = None,
    units: Annotated[str | None, typer.Option(help="Of a record in two columns: m/s2, cm/s2 or g.")] = None,
    output: Annotated[str, typer.Option(metavar="DIR", help="Folder for the page and its "
                                                            "result files.")] = "report",
):
    """All solvers on the Caryatid, free-standing and isolated: one HTML page and the result files it is made from."""
    from pathlib import Path

    from analytic import SettingError, synthetic_motion
    from analytic.records import read_record

    from ..report.runs import make_results
    from ..report.write import write_page
    from ..solving import stdout_to_stderr

    if units and not record:
        raise SettingError(f"--units {units}: belongs to a record; give --record FILE")
    if Path(output).exists() and not Path(output).is_dir():
        raise SettingError(f"--output {output}: is a file; give a folder")
    motion = read_record(record, units) if record else synthetic_motion()

    def say(text):
        print(text, file=sys.stderr, flush=True)

    say(f"ground motion: {motion.label}")
    with stdout_to_stderr():  # engines greet on standard output
        make_results(output, motion, say=say)
    say("the page")
    print(write_page(output))
