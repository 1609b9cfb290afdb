"""Parts of a page, templates, and tables of a study's rows: choose rows, group them, name columns.

    default = where(result.rows, part="summary", scope="all")
    table("Restitution", default, NAME, Column("error, rms [-]", "rms"), Column("failed", "{failed} of {runs}"))

The same `Column` is an axis of a figure (`comparisons.plotting.figures`).
"""

import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from markupsafe import Markup

from ..schemas.columns import Column, Key, Row, short, value_of

if TYPE_CHECKING:
    from jinja2 import Environment


@dataclass(frozen=True)
class Table:
    """A table. columns: heads with units. rows: lists of cells, str; the first cell of a row names it."""

    caption: str
    columns: tuple
    rows: list


@dataclass(frozen=True)
class Figure:
    """A figure. svg: the picture. alt: its content, for those who cannot see it. caption: what to look at.

    solvers: those in the legend, whose lines a reader can hide. keys: {solver: picture of its line}, where that is not
    as in all charts. broad: whether it takes the whole width of a page; it then has a second form for a phone.
    """

    svg: bytes
    alt: str
    caption: str
    solvers: tuple = ()
    keys: dict = field(default_factory=dict)
    broad: bool = False

    @property
    def element(self) -> Markup:
        """The picture as an element."""
        return Markup(self.svg.decode())

    @property
    def panels(self) -> int:
        """Number of charts."""
        return max(1, self.svg.count(b'<svg class="chart"'))


# {level of a `Mark`: (its sign, meaning)}. The sign tells the level apart without colour.
SIGNS = {
    "good": ("✓", "good"),
    "fair": ("~", "fair"),
    "bad": ("✗", "bad"),
    "part": ("?", "inconclusive: too little was tested"),
    "none": ("○", "not rated"),
}


@dataclass(frozen=True)
class Mark:
    """A study's finding about one solver, in words and as a level.

    level: "good", "fair" or "bad"; "part", if too little was tested to tell; "none": not rated. note: number of runs or
    scenes, and what else the words leave out. value: the number itself.
    """

    words: str
    level: str
    note: str = ""
    value: float | None = None

    @property
    def sign(self) -> str:
        return SIGNS[self.level][0]


RESTITUTION, COST = "restitution", "cost"  # keys of judgements whose numbers stand on the report's first screen


@dataclass(frozen=True)
class Judgement:
    """A row of the report's first table.

    heading: with unit. marks: {(engine, variant): `Mark`}; variant "" is the main variant. key: by which the first
    screen finds it, see `RESTITUTION`.
    """

    heading: str
    marks: dict
    key: str = ""

    @property
    def rates(self) -> bool:
        """Whether it counts in the rating of variants: it rates at least one solver."""
        return any(mark.level != "none" for mark in self.marks.values())


@dataclass(frozen=True)
class Section:
    """A section of a page.

    title: heading. text: paragraphs, plain text. age: None, or in what the result is older than the code. evidence:
    (heading, text) pairs, folded: messages of failed runs. measured: paragraphs, folded: how numbers were obtained.
    parts: figures, tables, paragraphs and `Head`s in their order; without them figures stand above tables.
    """

    title: str
    text: tuple = ()
    tables: tuple = ()
    figures: tuple = ()
    age: str | None = None
    evidence: tuple = ()
    measured: tuple = ()
    parts: tuple = ()

    @property
    def shown(self) -> tuple:
        """Parts below the text, in order."""
        return self.parts or (*self.figures, *self.tables)


@dataclass(frozen=True)
class Head:
    """A heading between the parts of a page. id: anchor for links of other pages."""

    words: str
    id: str = field(default="", repr=False)  # no words of the page


@dataclass(frozen=True)
class Page:
    """A study's page: `opening` is its section on the report's first page, `whole` the study's own page.

    title: "subject: finding", without a full stop. lead: one or two short paragraphs. first: the figure and the table
    of the answer; without them the study is not on the report's first page. more: further figures, tables, `Head`s, and
    paragraphs (str), in order. None and tables without rows are left out. how: paragraphs, folded: what was run and how
    it was measured. evidence: (heading, text) pairs, folded: messages of runs that failed.
    """

    title: str
    lead: tuple[str, ...]
    first: tuple = ()
    more: tuple = ()
    how: tuple[str, ...] = ()
    evidence: tuple[tuple[str, str], ...] = ()

    def opening(self) -> Section | None:
        """Return the `Section` of the report's first page."""
        return self._section(self.first) if self.first else None

    def whole(self) -> Section:
        """Return the `Section` of the study's own page."""
        return replace(self._section((*self.first, *self.more)), evidence=self.evidence)

    def _section(self, parts):
        parts = tuple(part for part in parts if part is not None and not (isinstance(part, Table) and not part.rows))
        tables = tuple(part for part in parts if isinstance(part, Table))
        figures = tuple(part for part in parts if isinstance(part, Figure))
        return Section(self.title, self.lead, tables, figures, measured=self.how, parts=parts)


def element_of(text: str, attributes: str) -> str:
    """Return an SVG file of matplotlib as an element with these attributes, without header and needless digits."""
    text = re.sub(r"<metadata>.*?</metadata>\s*", "", text[text.index("<svg") :], flags=re.DOTALL)
    opening = r'<svg [^>]*?viewBox="([^"]+)"[^>]*>'
    text = re.sub(opening, lambda match: f'<svg {attributes} viewBox="{match[1]}">', text, count=1)
    text = re.sub(r"(\d+\.\d{2})\d+", r"\1", text)  # a hundredth of a point is enough
    return re.sub(r"\s*\n\s*", " ", text)


UNITS = {"stiffness": "N/m", "step": "s", "largest_step": "s"}  # of accuracy parameters


def where(rows: Iterable[Row], **wanted: Any) -> list[Any]:
    """Return the rows with these values, in order; a set means any of its members. Rows without the column do not fit.

    >>> where([{"part": "a", "x": 1}, {"part": "b"}, {"part": "a", "x": 2}], part="a", x={2, 3})
    [{'part': 'a', 'x': 2}]
    """

    def chosen(row, key, value):
        return key in row and (row[key] in value if isinstance(value, set | frozenset) else row[key] == value)

    return [row for row in rows if all(chosen(row, key, value) for key, value in wanted.items())]


def grouped(rows: Iterable[Any], *keys: Key) -> dict[tuple[Any, ...], list[Any]]:
    """Return {values of the keys: their rows}, in the order of the rows; a key is a column or a function of a row.

    >>> grouped([{"x": 2, "y": 1}, {"x": 1, "y": 2}, {"x": 2, "y": 3}], "x")
    {(2,): [{'x': 2, 'y': 1}, {'x': 2, 'y': 3}], (1,): [{'x': 1, 'y': 2}]}
    """
    groups: dict[tuple[Any, ...], list[Any]] = {}
    for row in rows:
        groups.setdefault(tuple(value_of(row, key) for key in keys), []).append(row)
    return groups


def kept_from(rows: Sequence[Row], keeps: Callable[[Row], bool]) -> Sequence[Row]:
    """Return of rows from coarse to fine the last ones that all keep; a coarser row may keep by chance."""
    bad = [k for k, row in enumerate(rows) if not keeps(row)]
    return rows[bad[-1] + 1 :] if bad else rows


def cheapest(
    rows: Iterable[Row], name: Key, keeps: Callable[[Row], bool], cost: Callable[[Row], float]
) -> dict[Any, Row]:
    """Return {name: the cheapest of its rows that keep, see `kept_from`}, cheapest first."""
    kept = ((who, kept_from(members, keeps)) for (who,), members in grouped(rows, name).items())
    best = {who: min(keeping, key=cost) for who, keeping in kept if keeping}
    return dict(sorted(best.items(), key=lambda item: cost(item[1])))


def table(caption: str, rows: Iterable[Row], *columns: Column) -> Table:
    """Return the `Table` of these rows; the first column names them."""
    return Table(
        caption, tuple(column.head for column in columns), [[column.text(row) for column in columns] for row in rows]
    )


def across(caption: str, rows: Iterable[Row], name: Column, *columns: Column) -> Table:
    """Return the `Table` with a column for each of these rows, named by `name`, and a row for each of the `columns`."""
    rows = list(rows)
    cells = [[column.head, *map(column.text, rows)] for column in columns]
    return Table(caption, (name.head, *map(name.text, rows)), cells)


def setting_of(row: Row) -> str:
    """Return a row's accuracy parameter with its level and unit: step = 0.001 s."""
    return f"{row['parameter'].replace('_', ' ')} = {short(row['level'])} {UNITS.get(row['parameter'], '')}".rstrip()


def templates(folder: Path) -> "Environment":
    """Return the Jinja environment of the templates in a folder; undefined names are errors."""
    from jinja2 import Environment, FileSystemLoader, StrictUndefined, select_autoescape  # slow to load

    return Environment(
        loader=FileSystemLoader(folder),
        autoescape=select_autoescape(disabled_extensions=["jinja"], default=True),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
