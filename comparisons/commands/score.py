"""``rocking score``: answers to the problem sheet, held against the exact ones."""

from typing import Annotated

import typer


def command(
    file: Annotated[str, typer.Argument(help="Answers as CSV: scene,quantity,value; see rocking sheet.")],
    json_file: Annotated[
        str | None, typer.Option("--json", metavar="FILE", help="Write the scores; - prints them.")
    ] = None,
) -> None:
    """Score answers to the problem sheet: the first that is wrong, errors, rank beside the engines, probable causes.

    First is meant in time of the run, over all scenes: before it the solver is right. A cause is named where the very
    answers follow from it and from nothing else that is known. Status 1: an answer is off by more than 1e-3 of its
    scale. Example: rocking score answers.csv
    """
    from ..running.files import check_writable, write_text
    from ..running.solving import spinner
    from ..sheet.answers import read_answers
    from ..sheet.score import score

    check_writable([json_file], inputs=[file])
    given = read_answers(file)
    with spinner("the sheet's scenes") as tell:
        found = score(given, tell)
    if json_file:
        write_text(json_file, found.text())
    if json_file != "-":
        _show(found)
    if not found.passed:
        raise typer.Exit(1)


def _show(found):
    from rich import box
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    console = Console(highlight=False)
    if first := found.first_wrong:
        when = "" if first.time is None else f" (at {first.time:.4g} s)"
        console.print(
            f"First wrong answer: {first.scene}, {first.quantity}{when}: off by {first.error:.1e} of its scale.",
            soft_wrap=True,
            markup=False,
        )
    table = Table(box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0))
    for name in ("scene", "error", "worst answer", "rank", "what probably went wrong"):
        table.add_column(Text(name), justify="right" if name in ("error", "rank") else "left")
    for one in found.scenes:
        place = "-" if one.rank is None else f"{one.rank} of {one.of}"
        cause = "" if one.right else one.cause or "unknown"
        table.add_row(one.scene, f"{one.error:.1e}", one.worst, place, Text(cause))
    console.print(table)
    for cause, advice in dict.fromkeys((one.cause, one.advice) for one in found.scenes if one.cause):
        console.print(f"{cause}: {advice}.", soft_wrap=True, markup=False)
    for one in found.scenes:
        if one.missing:
            console.print(f"{one.scene}: not answered: {', '.join(one.missing)}.", soft_wrap=True, markup=False)
    if found.unanswered:
        console.print(f"Scenes not answered: {', '.join(found.unanswered)}.", soft_wrap=True)
    console.print(f"Rank: beside {found.stored}.", soft_wrap=True, markup=False)
    right = sum(one.right for one in found.scenes)
    console.print(f"{right} of {len(found.scenes)} scenes answered within 1e-3 of the scales.")
