"""``rocking lessons``: teaching material."""

from typing import Annotated

import typer

app = typer.Typer(
    add_completion=False,
    rich_markup_mode=None,
    no_args_is_help=True,
    help="Teaching material: a page that lets one play with the rocking block.",
)


@app.callback()
def _about():
    """Teaching material: a page that lets one play with the rocking block."""


@app.command()
def export(output: Annotated[str, typer.Option(metavar="DIR", help="Folder for the pages.")] = "lessons") -> None:
    """Write pages that open by double click, without a network: the playground."""
    from ..lessons.export import export_pages
    from ..running.files import check_folder, make_folder

    check_folder(output)
    for path in export_pages(make_folder(output)):
        print(path)
