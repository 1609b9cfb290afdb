"""What a section of the report is made of, and how numbers are written in it."""

from __future__ import annotations

import base64
import io
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import matplotlib

if TYPE_CHECKING:
    import matplotlib.figure

MINUS_DIGITS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
# Glyphs as paths: the page looks alike where fonts differ. The salt makes equal figures equal bytes.
SVG = {"svg.fonttype": "path", "svg.hashsalt": "rocking"}


@dataclass(frozen=True)
class Table:
    """columns: heads with units. rows: lists of cells, str; the first cell of a row names it."""

    caption: str
    columns: tuple
    rows: list


@dataclass(frozen=True)
class Figure:
    """svg: the picture. alt: what it shows, for those who cannot see it. caption: what to look at.

    wide: it takes the whole width of the page.
    """

    svg: bytes
    alt: str
    caption: str
    wide: bool = False

    @property
    def source(self) -> str:
        """The picture as a data URI."""
        return "data:image/svg+xml;base64," + base64.b64encode(self.svg).decode()


@dataclass(frozen=True)
class Section:
    """title: heading. text: paragraphs, plain text. age: None, or how the result is older than the code.

    evidence: (heading, text) pairs, folded away: raw messages of runs that failed. verdicts: sentences, may I trust
    it, for the top of the page.
    """

    title: str
    text: tuple = ()
    tables: tuple = ()
    figures: tuple = ()
    age: str | None = None
    evidence: tuple = ()
    verdicts: tuple = ()


# Width [inch] from which a figure would be unreadable in half of the page.
WIDE = 7.0


def figure_of(figure: matplotlib.figure.Figure, alt: str, caption: str) -> Figure:
    """The `Figure` of a matplotlib figure."""
    file = io.BytesIO()
    with matplotlib.rc_context(SVG):  # type: ignore[arg-type]  # a few keys of them
        figure.savefig(file, format="svg", metadata={"Date": None, "Creator": None})
    return Figure(file.getvalue(), alt, caption, wide=figure.get_size_inches()[0] > WIDE)


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
    return f"{mantissa}·10{str(int(power)).translate(MINUS_DIGITS)}".replace("-", "−")


def percent(fraction: float | None, digits: int = 2) -> str:
    """A fraction in per cent."""
    return "–" if fraction is None else f"{number(100 * fraction, digits)} %"
