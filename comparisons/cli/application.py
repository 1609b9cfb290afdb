"""The commands of ``rocking`` as a Typer application; each is imported only when it is asked for."""

import importlib
import pkgutil

import typer
from typer.core import TyperGroup

from .. import commands

SHORT = 66  # characters of a command's line


class _LazyGroup(TyperGroup):
    """A command ``rocking NAME`` is the module ``commands/NAME.py`` with a function ``command`` or a Typer ``app``."""

    def list_commands(self, ctx):
        return sorted(module.name for module in pkgutil.iter_modules(commands.__path__))

    def format_commands(self, ctx, formatter):
        """The commands in their groups."""
        for title, names in commands.GROUPS.items():
            with formatter.section(title):
                found = [(name, self.get_command(ctx, name)) for name in names]
                formatter.write_dl([(name, one.get_short_help_str(SHORT)) for name, one in found])

    def get_command(self, ctx, name):
        if name not in self.list_commands(ctx):
            return None
        module = importlib.import_module(f"{commands.__name__}.{name}")
        app = getattr(module, "app", None)
        if app is None:
            app = typer.Typer(add_completion=False, rich_markup_mode=None)
            app.command(name)(module.command)
        command = typer.main.get_command(app)
        command.name = name
        return command


app = typer.Typer(
    cls=_LazyGroup, add_completion=False, rich_markup_mode=None, no_args_is_help=True, pretty_exceptions_enable=False
)


@app.callback()
def _about():
    """How far a multibody engine can be trusted with a rocking block on lead-rubber bearings, and at what cost."""
