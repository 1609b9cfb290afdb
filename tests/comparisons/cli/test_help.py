"""Help: every command in one group, with a line and an example."""

import pytest
import typer

from comparisons import commands
from comparisons.cli.application import app

GROUP = typer.main.get_command(app)
NAMES = GROUP.list_commands(None)


def test_every_command_stands_in_one_group():
    grouped = [name for names in commands.GROUPS.values() for name in names]
    assert sorted(grouped) == NAMES


@pytest.mark.parametrize("name", NAMES)
def test_help_has_a_line_and_an_example(rocking, name):
    status, out, _ = rocking(name, "--help")
    assert status == 0 and f"Example: rocking {name}" in " ".join(out.split())
    assert len(GROUP.get_command(None, name).get_short_help_str(200).split()) >= 2


def test_help_shows_the_groups_in_order(rocking):
    _, out, _ = rocking("--help")
    places = [out.index(f"{title}:") for title in commands.GROUPS]
    assert places == sorted(places)
