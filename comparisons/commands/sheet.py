"""``rocking sheet``: problems for other codes."""

from pathlib import Path
from typing import Annotated

import typer

from ..cli.output import write_output


def command(
    output: Annotated[str, typer.Option(metavar="DIR", help="Folder for the pages.")] = "sheet",
    json_file: Annotated[
        str | None, typer.Option("--json", metavar="FILE", help="Write the answers; - prints them.")
    ] = None,
) -> None:
    """Write the problem sheet: eight scenes as equations and numbers, with reference answers and tolerances.

    A scene is a page in HTML and Markdown. The folder also holds the input record, and all answers in reference.csv.
    Example: rocking sheet --output problems
    """
    from ..running.files import check_folder, check_writable
    from ..running.progress import compile_kernels
    from ..schemas.runs import Asked, Problem, Sheet
    from ..sheet.pages import write_sheet
    from ..sheet.problems import PROBLEMS, UNITS, VERSION

    check_folder(output)
    check_writable([json_file])
    compile_kernels()
    paths = write_sheet(Path(output))
    problems = []
    for problem in PROBLEMS:
        asked = [
            Asked(
                quantity=one.name,
                unit=UNITS[one.kind],
                meaning=one.words,
                answer=problem.answers[one.name],
                tolerance=problem.tolerance(one),
            )
            for one in problem.quantities
        ]
        problems.append(Problem(scene=problem.name, title=problem.title, quantities=asked))
    form = Sheet(sheet=VERSION, files=[str(path) for path in paths], problems=problems)
    write_output({json_file: form}, lambda: print(*paths, sep="\n"))
