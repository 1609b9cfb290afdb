"""Tables of every command in a narrow terminal: text is broken, columns are left out by name, numbers are whole."""

import io
import re
from collections import Counter

import pytest
from own_scenes import BRONZE, BUST, CLIFF
from record_files import pairs
from rich.console import Console

from comparisons.metrics import agreement as tolerances
from comparisons.plotting import terminal
from comparisons.plotting.terminal import Grid, grid

NUMBER = re.compile(r"(?<![\w.])[-+−]?\d[\d.]*(?:e[-+]?\d+)?")
MORE = re.compile(r"A terminal of (\d+) columns \(or COLUMNS=\1\) shows more: (.*)\.$")
COMMANDS = {
    "run": ("run", "bust.toml", "--records", "records", "--json", "run.json"),
    "compare": ("compare", "bronze.toml", "--engine", "exudyn", "--engine", "pybullet"),
    "run, sliding": ("run", "slides.toml"),
    "compare, sliding": ("compare", "slides.toml", "--engine", "exudyn", "--engine", "pybullet"),
    "margin": ("margin", "bronze.toml", "--records", "records"),
    "risk": ("risk", "bust.toml", "--records", "records", "--draws", "2"),
    "design": ("design", "bust.toml", "--stroke", "0.25"),
    "choose": ("choose", "bronze.toml", "--engine", "exudyn", "--all"),
    "engines": ("engines",),
    "lessons": ("lessons",),
    "record": ("record", "records/made0_E.csv"),
    "verify": ("verify", "--engine", "exudyn"),
    "new": ("new", "new.toml", "--height", "1.9", "--width", "0.55", "--mass", "1000"),
}
DEAR = {
    "compare": "slow",
    "margin": "long",
    **dict.fromkeys(("compare, sliding", "design", "choose", "verify"), "long"),
}
SLIDES = """friction = 0.4
[block]
mass = 3172.05
radius = 1.86
slenderness = 0.348
[motion]
pulse = "half-sine"
amplitude = 9.38
frequency = 6.34
[run]
duration = 6.0
"""
BEARINGS = "[bearings]\nka = 22950.5\nkb = 2295.05\nalpha = 66.6021\ncount = 4\nx_max = 0.2\n"


@pytest.fixture
def place(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "bust.toml").write_text(BUST.format(bearings=BEARINGS))
    (tmp_path / "bronze.toml").write_text(BRONZE.format(scale=CLIFF))
    (tmp_path / "slides.toml").write_text(SLIDES)
    (tmp_path / "records").mkdir()
    pairs(tmp_path / "records", 1)
    monkeypatch.setattr(tolerances, "TABLE", [row for row in tolerances.TABLE if row.engine == "exudyn"][:2])
    return tmp_path


def printed(table, width):
    """The lines of a table in a terminal of this width, and (columns needed, heads left out) or None."""
    console = Console(file=io.StringIO(), width=width, highlight=False)
    console.print(table)
    text, _, more = console.file.getvalue().partition("A terminal of")
    result = MORE.match(" ".join(f"A terminal of{more}".split())) if more else None
    assert bool(result) == bool(more)
    return text.splitlines(), result and (int(result[1]), result[2].split(", "))


@pytest.mark.parametrize(
    "command", [pytest.param(each, marks=getattr(pytest.mark, DEAR[each]) if each in DEAR else ()) for each in COMMANDS]
)
def test_numbers_are_whole_and_what_is_left_out_is_named(rocking, place, monkeypatch, command):
    shown = []

    class Seen(Console):
        def print(self, *parts, **how):
            shown.extend(part for part in parts if isinstance(part, Grid))

    monkeypatch.setattr(terminal, "Console", Seen)
    status, _, err = rocking(*COMMANDS[command])
    assert status in (0, 1) and "Error" not in err and shown, err
    for table in shown:
        everything, none = printed(table, 200)
        assert none is None
        for width in (40, 60, 80):
            lines, more = printed(table, width)
            assert max(map(len, lines)) <= width
            kept = len(table.heads) - (len(more[1]) if more else 0)
            part = Grid(table.heads[:kept], [row[:kept] for row in table.rows], table.sides, table.first, table.look)
            assert numbers(lines) == numbers(printed(part, 200)[0])
            if more:
                assert printed(table, more[0])[1] is None and printed(table, more[0] - 1)[1] is not None
        assert numbers(everything)


def numbers(lines):
    return Counter(NUMBER.findall(" ".join(lines)))


def test_what_a_table_leaves_out_and_where_it_breaks():
    table = grid(["name", "peak\n[g]", "im-\npacts", "why"], [["a b", "0.123456", "12", "it is so"]], wraps=["why"])
    wide, none = printed(table, 80)
    assert none is None and wide[-2].split() == ["a", "b", "0.123456", "12", "it", "is", "so"]
    lines, none = printed(table, 32)  # of two texts the one that wraps first
    assert none is None and [line.split() for line in lines[-3:-1]] == [
        ["a", "b", "0.123456", "12", "it", "is"],
        ["so"],
    ]
    lines, more = printed(table, 18)
    assert more == (29, ["impacts", "why"]) and " 0.123456 " in " ".join(lines)
    assert printed(table, 29)[1] is None


@pytest.mark.parametrize("wraps, widths", [(["b"], [13, 7]), ([], [10, 10]), (["a"], [6, 14])])
def test_a_column_that_wraps_is_broken_before_others_and_the_widest_of_several_first(wraps, widths):
    table = grid(["a", "b"], [["one two three", "five six seven"]], wraps=wraps)
    assert table._widths(2, 20) == widths and table._widths(2, 9) is None


def test_a_name_longer_than_any_number_is_broken_and_not_lost():
    lines, none = printed(grid(["motion", "g"], [["a_very_long_name_of_a_record.AT2", "0.5"]]), 30)
    assert none is None and "0.5" in lines[-3] + lines[-2]
    assert "".join(line.split()[0] for line in lines[-3:-1]) == "a_very_long_name_of_a_record.AT2"
