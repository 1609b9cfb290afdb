"""The commands ``rocking lessons`` (teaching material) and ``rocking sheet`` (problems for other codes)."""

from pathlib import Path
from typing import Annotated

import typer

from ..execution.command_runs import JsonFile
from ..execution.progress import bar, compile_kernels, stdout_to_stderr
from ..execution.writing import check_folder, check_writable
from ..schemas.runs import Asked, Problem, Sheet
from .output import write_output

app = typer.Typer(add_completion=False, rich_markup_mode=None)


@app.callback(invoke_without_command=True)
def _about(context: typer.Context) -> None:
    """List, open or export the eight lessons.

    A lesson opens as a notebook, or as a page that needs no network. Without a command the lessons are listed.

    Example: rocking lessons open corner
    """
    if context.invoked_subcommand is not None:
        return
    from ..lessons.topics import lessons
    from ..plotting.terminal import echo, grid

    heads = ["name", "lesson", "minutes", "needs"]
    rows = [
        [lesson.name, f"{lesson.number}. {lesson.title}", str(lesson.minutes), lesson.needs] for lesson in lessons()
    ]
    echo(grid(heads, rows, left=heads, wraps=heads))
    echo("rocking lessons open NAME: as a notebook;  rocking lessons export: pages to open by double click")


@app.command(name="open")
def open_(
    name: Annotated[str, typer.Argument(help="Name of the lesson (`rocking lessons` lists them).")],
    to: Annotated[
        str | None, typer.Option(metavar="FOLDER", help="Folder in which the notebook and your work are kept.")
    ] = None,
) -> None:
    """Open a lesson as a notebook in the browser.

    It is a copy whose code can be changed. Ctrl-C ends it.
    """
    from ..lessons.notebook import open_notebook

    if to is not None:
        check_folder(to, "--to")
    raise typer.Exit(open_notebook(name, to))


@app.command()
def export(output: Annotated[str, typer.Option(metavar="DIR", help="Folder for the pages.")] = "lessons") -> None:
    """Write the lessons as web pages.

    The pages are the playground, the lessons, the derivation and a teacher's page with figures. They open by double
    click.
    """
    from ..lessons.export import export_pages
    from ..lessons.topics import NAMES

    check_folder(output)
    with stdout_to_stderr(), bar(f"{len(NAMES)} lessons") as progress:  # engines print on import
        paths = export_pages(Path(output), progress=progress)
    print(next(path for path in paths if path.name == "index.html"))


def sheet(
    output: Annotated[str, typer.Option(metavar="DIR", help="Folder for the pages.")] = "sheet",
    json_file: JsonFile = None,
) -> None:
    """Write eight test problems with reference answers.

    Each problem is a scene in equations and numbers, with tolerances, as a page in HTML and Markdown. The folder also
    holds the input record, and all answers in reference.csv.

    Example: rocking sheet --output problems
    """
    from ..sheet.pages import PROBLEMS, UNITS, VERSION, write_sheet

    check_folder(output)
    check_writable([json_file])
    compile_kernels()
    paths = write_sheet(Path(output))
    problems = []
    for problem in PROBLEMS:
        quantities = [
            Asked(
                quantity=quantity.name,
                unit=UNITS[quantity.kind],
                meaning=quantity.words,
                answer=problem.answers[quantity.name],
                tolerance=problem.tolerance(quantity),
            )
            for quantity in problem.quantities
        ]
        problems.append(Problem(scene=problem.name, title=problem.title, quantities=quantities))
    form = Sheet(sheet=VERSION, files=[str(path) for path in paths], problems=problems)
    write_output({json_file: form}, lambda: print(*paths, sep="\n"))
