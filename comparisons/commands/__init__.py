"""The commands of ``rocking`` as a Typer application.

The module of a command is imported only when the command is used. ``rocking --help`` imports none: it reads the
commands' docstrings.
"""

import ast
import importlib
from pathlib import Path
from typing import Annotated

import typer
from typer.core import TyperCommand, TyperGroup

# Groups of commands in the order of ``rocking --help``: {group: {command: its module}}.
GROUPS = {
    "To run and compare": {"run": "runs", "compare": "runs", "engines": "runs", "script": "runs"},
    "To read and learn": {"report": "report", "lessons": "lessons"},
    "For advice on a scene": {"choose": "advice", "margin": "advice", "risk": "risk", "design": "advice"},
    "For makers of engines and codes": {"verify": "study", "sheet": "lessons"},
    "For research": {"study": "study"},
    "Input": {"record": "new", "new": "new"},
}
MODULES = {name: module for group in GROUPS.values() for name, module in group.items()}

SHORT = 60  # characters of a command's line: none is cut in a terminal of 80 columns


class _LazyGroup(TyperGroup):
    """A command ``rocking NAME`` is the function NAME of its module, or the Typer ``app`` there."""

    def list_commands(self, ctx):
        return sorted(MODULES)

    def format_commands(self, ctx, formatter):
        """Write the commands in their groups."""
        for title, names in GROUPS.items():
            with formatter.section(title):
                formatter.write_dl([(name, _line(name)) for name in names])

    def get_command(self, ctx, name):
        if name not in MODULES:
            return None
        module = importlib.import_module(f"{__name__}.{MODULES[name]}")
        if function := getattr(module, name, None):
            app = typer.Typer(add_completion=False, rich_markup_mode=None)
            app.command(name)(function)
        else:
            app = module.app
        command = typer.main.get_command(app)
        command.name = name
        return command


def _line(name):
    """Return the first sentence on a command: of the function NAME of its module, or of the callback of its ``app``."""
    source = Path(__file__).with_name(f"{MODULES[name]}.py").read_text(encoding="utf-8")
    functions = {node.name: node for node in ast.parse(source).body if isinstance(node, ast.FunctionDef)}
    function = functions.get(name) or functions["_about"]
    return TyperCommand(name, help=ast.get_docstring(function)).get_short_help_str(SHORT)


app = typer.Typer(
    cls=_LazyGroup, add_completion=False, rich_markup_mode=None, no_args_is_help=True, pretty_exceptions_enable=False
)


def _print_version(asked: bool) -> None:
    if asked:
        from ..execution.code_digests import version_of  # needed here alone

        print(version_of("rocking") or "not installed")
        raise typer.Exit


@app.callback()
def _about(
    version: Annotated[
        bool, typer.Option("--version", help="Print the version and exit.", callback=_print_version, is_eager=True)
    ] = False,
) -> None:
    """How far a multibody engine can be trusted with a rocking block on lead-rubber bearings, and at what cost."""
