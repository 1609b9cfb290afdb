"""``rocking score``: answers to the problem sheet, compared with the exact ones."""

from typing import Annotated

import typer

from ..cli.output import write_output


def command(
    file: Annotated[str, typer.Argument(help="Answers as CSV: scene,quantity,value; see rocking sheet.")],
    json_file: Annotated[
        str | None, typer.Option("--json", metavar="FILE", help="Write the scores; - prints them.")
    ] = None,
) -> None:
    """Score answers to the problem sheet: first wrong answer, errors, rank among the engines, probable causes.

    The first wrong answer is the earliest in time of the run, over all scenes. A cause is named if it reproduces the
    answers and no other known cause does. Status 1: an answer is off by more than 1e-3 of its scale.
    Example: rocking score answers.csv
    """
    from ..running.files import check_writable
    from ..running.progress import spinner
    from ..sheet.score import read_answers, score

    check_writable([json_file], inputs=[file])
    given = read_answers(file)
    with spinner("the sheet's scenes") as tell:
        found = score(given, tell)
    write_output({json_file: found}, lambda: _show(found))
    if not found.passed:
        raise typer.Exit(1)


def _show(found):
    from ..showing.terminal import echo, grid

    if first := found.first_wrong:
        when = "" if first.time is None else f" (at {first.time:.4g} s)"
        echo(f"First wrong answer: {first.scene}, {first.quantity}{when}: off by {first.error:.1e} of its scale.")
    heads = ["scene", "error", "worst answer", "rank", "what probably went wrong"]
    rows = [
        [
            one.scene,
            f"{one.error:.1e}",
            one.worst,
            "-" if one.rank is None else f"{one.rank} of {one.of}",
            "" if one.right else one.cause or "unknown",
        ]
        for one in found.scenes
    ]
    echo(grid(heads, rows, left=["worst answer", heads[-1]], wraps=heads))
    causes = dict.fromkeys(f"{one.cause}: {one.advice}." for one in found.scenes if one.cause)
    missing = [f"{one.scene}: not answered: {', '.join(one.missing)}." for one in found.scenes if one.missing]
    unanswered = [f"Scenes not answered: {', '.join(found.unanswered)}."] if found.unanswered else []
    right = sum(one.right for one in found.scenes)
    passed = f"{right} of {len(found.scenes)} scenes answered within 1e-3 of the scales."
    echo(*causes, *missing, *unanswered, f"Rank: beside {found.stored}.", passed)
