"""``rocking study NAME``: the studies. Each is a module of ``comparisons.studies`` with a function ``command``."""

import importlib
import importlib.util

import typer
from typer.core import TyperGroup

# name on the command line: module in comparisons.studies
STUDIES = {
    "restitution": "restitution",
    "overturning": "overturning",
    "fragility": "fragility",
    "speed-error": "speed_error",
    "stability": "stability",
    "caryatid": "caryatid",
    "tolerances": "tolerances",
}
PACKAGE = "comparisons.studies"


class _LazyStudies(TyperGroup):
    def list_commands(self, ctx):
        return [name for name, module in STUDIES.items() if importlib.util.find_spec(f"{PACKAGE}.{module}")]

    def get_command(self, ctx, name):
        if name not in self.list_commands(ctx):
            return None
        study = typer.Typer(add_completion=False, rich_markup_mode=None)
        study.command(name)(importlib.import_module(f"{PACKAGE}.{STUDIES[name]}").command)
        command = typer.main.get_command(study)
        command.name = name
        return command


app = typer.Typer(cls=_LazyStudies, add_completion=False, rich_markup_mode=None, no_args_is_help=True)


@app.callback()
def _about():
    """Compute one study's result file and figures; interrupted, it resumes where it stopped."""
