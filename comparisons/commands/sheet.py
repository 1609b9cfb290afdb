"""``rocking sheet``: problems for codes that are not ours."""

from typing import Annotated

import typer


def command(output: Annotated[str, typer.Option(metavar="DIR", help="Folder for the pages.")] = "sheet") -> None:
    """Write the problem sheet: eight scenes as equations and numbers, a page each in HTML and Markdown.

    With them go the input record and answers.csv, to be filled in and handed to rocking score.
    Example: rocking sheet --output problems
    """
    from ..running.files import check_folder, make_folder
    from ..sheet.pages import write_sheet

    check_folder(output)
    for path in write_sheet(make_folder(output)):
        print(path)
