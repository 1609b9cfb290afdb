"""Parts of a section of the report, and the format of its numbers."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field, replace

from markupsafe import Markup

MINUS_DIGITS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


@dataclass(frozen=True)
class Table:
    """columns: heads with units. rows: lists of cells, str; the first cell of a row names it."""

    caption: str
    columns: tuple
    rows: list


@dataclass(frozen=True)
class Figure:
    """svg: the picture. alt: what it shows, for those who cannot see it. caption: what to look at.

    solvers: those whose lines can be told apart and hidden; keys: {one of them: the picture of its line}, where it is
    not as everywhere.
    """

    svg: bytes
    alt: str
    caption: str
    solvers: tuple = ()
    keys: dict = field(default_factory=dict)

    @property
    def element(self) -> Markup:
        """The picture as a part of a page."""
        return Markup(self.svg.decode())


@dataclass(frozen=True)
class Mark:
    """What a study says of one solver: in words, and as "good", "fair" or "bad"; "part" where so little was tested that
    it cannot be said; or "none", which is of no rating: a row of such alone has no say.

    note: the number of runs or scenes behind it, and what else the words leave out. value: the number itself. short:
    the words as they stand in a sentence, where they are shorter there.
    """

    words: str
    level: str
    note: str = ""
    value: float | None = None
    short: str = ""


RESTITUTION, COST = "restitution", "cost"  # keys of judgements that the report's first screen takes numbers of


@dataclass(frozen=True)
class Judgement:
    """A row of the report's first table. heading: with unit. marks: {(engine, variant): `Mark`}; variant "" is the
    default one.

    key: by which others find it. says: how a mark's words stand in a sentence, with {} in their place; "": in none.
    """

    heading: str
    marks: dict
    key: str = ""
    says: str = ""

    @property
    def rates(self) -> bool:
        """Whether it counts in the one rating of a variant: it says something of trust, of one solver at least."""
        return any(mark.level != "none" for mark in self.marks.values())


@dataclass(frozen=True)
class Section:
    """title: heading. text: paragraphs, plain text. age: None, or how the result is older than the code.

    evidence: (heading, text) pairs, folded away: raw messages of runs that failed. measured: paragraphs, folded: how
    the figures were obtained. parts: figures, tables, paragraphs and `Head`s in their order, in place of all figures
    above all tables.
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
        """What stands below the text, in order."""
        return self.parts or (*self.figures, *self.tables)


@dataclass(frozen=True)
class Head:
    """A heading between the parts of a page."""

    words: str


@dataclass(frozen=True)
class Page:
    """What a study shows of its result, told once: `opening` for the report's first page, `whole` for its own page.

    title: "subject: what was found", without a full stop. lead: one or two short paragraphs. first: the figure and the
    table of the answer; none: the study is not on the report's first page. more: what else there is, in order: figures,
    tables, `Head`s, and str, a paragraph. What is None, and a table without rows, is left out. how: paragraphs, folded:
    what was run and how it was measured. evidence: (heading, text) pairs, folded: messages of runs that failed.
    """

    title: str
    lead: tuple[str, ...]
    first: tuple = ()
    more: tuple = ()
    how: tuple[str, ...] = ()
    evidence: tuple[tuple[str, str], ...] = ()

    def opening(self) -> Section | None:
        """The `Section` of the report's first page."""
        return self._section(self.first) if self.first else None

    def whole(self) -> Section:
        """The `Section` of the study's own page."""
        return replace(self._section((*self.first, *self.more)), evidence=self.evidence)

    def _section(self, parts):
        parts = tuple(part for part in parts if part is not None and not (isinstance(part, Table) and not part.rows))
        tables = tuple(part for part in parts if isinstance(part, Table))
        figures = tuple(part for part in parts if isinstance(part, Figure))
        return Section(self.title, self.lead, tables, figures, measured=self.how, parts=parts)


def power_of_ten(value: float) -> str:
    """A power of ten in plain letters."""
    return f"10{str(round(math.log10(value))).translate(MINUS_DIGITS)}" if value > 0 else "0"


def element_of(text: str, attributes: str) -> str:
    """An SVG file of matplotlib as an element with these attributes: no header, nothing finer than is seen."""
    text = re.sub(r"<metadata>.*?</metadata>\s*", "", text[text.index("<svg") :], flags=re.DOTALL)
    opening = r'<svg [^>]*?viewBox="([^"]+)"[^>]*>'
    text = re.sub(opening, lambda found: f'<svg {attributes} viewBox="{found[1]}">', text, count=1)
    text = re.sub(r"(\d+\.\d{2})\d+", r"\1", text)  # a hundredth of a point is enough
    return re.sub(r"\s*\n\s*", " ", text)


def number(value: float | None, digits: int = 3) -> str:
    """A number with so many significant digits; a dash for None, powers of ten where digits would not do."""
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return "–"
    if value == 0:
        return "0"
    exponent = math.floor(math.log10(abs(value)))
    if -3 <= exponent < 5:
        return f"{value:.{max(digits - 1 - exponent, 0)}f}".replace("-", "−")
    mantissa, power = f"{value:.{digits - 1}e}".split("e")
    times = "" if mantissa == "1" else f"{mantissa}·"
    return f"{times}10{str(int(power)).translate(MINUS_DIGITS)}".replace("-", "−")


def short(value: float | None) -> str:
    """A number that was chosen, in three digits at most: 0.3, 10, 2·10¹¹, 10⁻⁴."""
    digits, point, power = number(value).partition("·")
    digits = digits.rstrip("0").rstrip(".") if "." in digits else digits
    return power if point and digits == "1" else digits + point + power


def typeset(text: str) -> str:
    """A sentence made for a terminal as a page writes it: powers of ten in place of "1e-05"."""
    return re.sub(r"(?<![\w.])(\d(?:\.\d+)?)e([-+]?\d+)", lambda found: short(float(found[0])), text)


def percent(fraction: float | None, digits: int = 2) -> str:
    """A fraction in per cent; what is not all is not 100 %, as none but 0 is 0 %."""
    if fraction is None:
        return "–"
    while fraction < 1 and float(f"{100 * fraction:.{digits}g}") == 100:
        digits += 1
    return f"{number(100 * fraction, digits)} %"


def signed(change: float) -> str:
    """A relative change in words."""
    return "as it is" if change == 0 else f"{'+' if change > 0 else '−'}{number(abs(100 * change), 3)} %"
