"""``rocking lessons``: teaching material."""

from pathlib import Path
from typing import Annotated

import typer

app = typer.Typer(
    add_completion=False,
    rich_markup_mode=None,
    help="Teaching material: eight lessons as notebooks, and as pages that need no network.\n\n"
    "Example: rocking lessons open corner",
)


@app.callback(invoke_without_command=True)
def _listed(context: typer.Context) -> None:
    """Eight lessons on the rocking block; without a command they are listed."""
    if context.invoked_subcommand is not None:
        return
    from ..lessons.topics import lessons
    from ..showing.terminal import echo, grid

    heads = ["name", "lesson", "minutes", "needs"]
    rows = [[one.name, f"{one.number}. {one.title}", str(one.minutes), one.needs] for one in lessons()]
    echo(grid(heads, rows, left=heads, wraps=heads))
    echo("rocking lessons open NAME: as a notebook;  rocking lessons export: pages to open by double click")


@app.command(name="open")
def open_(
    name: Annotated[str, typer.Argument(help="Lesson: see rocking lessons.")],
    to: Annotated[
        str | None, typer.Option(metavar="FOLDER", help="Folder in which the notebook, with your work, is kept.")
    ] = None,
) -> None:
    """Open a lesson as a notebook in the browser, a copy whose code can be changed. Ctrl-C ends it."""
    from ..lessons.notebook import open_notebook
    from ..running.files import check_folder

    if to is not None:
        check_folder(to, "--to")
    raise typer.Exit(open_notebook(name, to))


@app.command()
def export(output: Annotated[str, typer.Option(metavar="DIR", help="Folder for the pages.")] = "lessons") -> None:
    """Write the pages: playground, lessons, derivation, teacher's page with figures. They open by double click."""
    from ..lessons.export import export_pages
    from ..lessons.topics import NAMES
    from ..running.files import check_folder
    from ..running.progress import bar, stdout_to_stderr

    check_folder(output)
    with stdout_to_stderr(), bar(f"{len(NAMES)} lessons") as progress:  # engines print on import
        paths = export_pages(Path(output), progress=progress)
    print(next(path for path in paths if path.name == "index.html"))
