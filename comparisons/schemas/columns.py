"""Columns of rows (field, type, unit, meaning, look), and how numbers are written for readers.

A study declares the columns of its rows once, in its ``study.py``. The check of stored rows, the reference of columns,
tables and the axes of figures read that declaration. To change a unit, a name or the number of digits everywhere,
change its line; a unit shown for the first time also needs a line of `UNITS_SHOWN`. Sentences of a page are its own.

    COLUMNS = declared(
        number_of("rms", "error, rms", "of restitution by swing energies, over impacts"),
        number_of("cpu_seconds", "CPU time", "of one run: median over the processes", "s", shown="ms"),
    )
    table("Restitution", rows, NAME, COLUMNS["rms"], COLUMNS["cpu_seconds"].called("CPU time of a run"))
"""

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from engines import ENGINES

Row = Mapping[str, Any]
Key = str | Callable[[Any], Any]


# An engine's name, unless it is an argument of a command, a part of a longer name or of a list without blanks.
TYPED = r"(?<!engine )(?<!engines )(?<!script )(?<!package )(?<!['\w/=.,;\[-])(?:{})(?!['&\w/=\]-]|[.,]\w)"
CODE = re.compile(r"(<(?:script|style|code|pre)\b.*?</(?:script|style|code|pre)>)", re.DOTALL)  # of a page
READ = re.compile(r'>[^<>]+<|(?:aria-label|alt|data-says)="[^"]*"')  # what is read of it
MINUS_DIGITS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
UNIT = re.compile(r"(?<=[\d⁰¹²³⁴⁵⁶⁷⁸⁹]) (?=(?:ms|s|m|N/m|kg|rad|deg|Hz|g|of)\b|[%×])|(?<=\bof) (?=\d)")


def number(value: float | None, digits: int = 3) -> str:
    """A number with so many significant digits; a dash for None, powers of ten where digits would not do."""
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return "–"
    if value == 0:
        return "0"
    mantissa, power = f"{value:.{digits - 1}e}".split("e")  # rounded first: 0.0996 has two digits as 0.10
    if -3 <= int(power) < 5:
        return f"{value:.{max(digits - 1 - int(power), 0)}f}".replace("-", "−")
    times = "" if mantissa == "1" else f"{mantissa}·"
    return f"{times}10{str(int(power)).translate(MINUS_DIGITS)}".replace("-", "−")


def short(value: float | None) -> str:
    """A number that was chosen, in three digits at most: 0.3, 10, 2·10¹¹, 10⁻⁴."""
    digits, point, power = number(value).partition("·")
    digits = digits.rstrip("0").rstrip(".") if "." in digits else digits
    return power if point and digits == "1" else digits + point + power


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


def typeset(text: str) -> str:
    """A sentence made for a terminal as a page writes it: powers of ten in place of "1e-05"."""
    return re.sub(r"(?<![\w.])(\d(?:\.\d+)?)e([-+]?\d+)", lambda found: short(float(found[0])), text)


def unbroken(text: str) -> str:
    """The text with no line break between a number and its unit, or the count that it is of."""
    return UNIT.sub("\u00a0", text)


def spelled(text: str) -> str:
    """The text with engines called as their makers write them, but in commands and lists of names to be typed."""
    titles = {name: engine.title for name, engine in ENGINES.items() if engine.title}
    names = "|".join(map(re.escape, titles))
    return re.sub(TYPED.format(names), lambda name: titles[name[0]], text) if titles else text


def spelled_page(html: str) -> str:
    """HTML, or SVG, whose words are `spelled`; code, scripts and what scripts read stay."""
    parts = CODE.split(html)
    parts[::2] = (READ.sub(lambda words: spelled(words[0]), part) for part in parts[::2])
    return "".join(parts)


def power_of_ten(value: float) -> str:
    """A power of ten in plain letters."""
    return f"10{str(round(math.log10(value))).translate(MINUS_DIGITS)}" if value > 0 else "0"


def value_of(row: Row, key: Key) -> Any:
    """What a function makes of a row, or its value in the column of that name.

    Raises
    ------
    KeyError
        The row has no such column.
    """
    return key(row) if callable(key) else row[key]


@dataclass(frozen=True)
class Column:
    """One quantity of rows, as a column of a table or as an axis.

    Parameters
    ----------
    head : str
        What stands above it, with its unit: "error, rms [-]".
    value : str or function
        Field of the rows; a pattern of several, as "{failed} of {runs}"; or a function of a row.
    digits : int or None
        Significant digits of numbers that are not whole; None: those of a number that was chosen, as 0.3.
    percent : bool
        A fraction, written in per cent.
    within : str or function or None
        The interval [low, high] of the value, written behind it; the rows may have None.
    declaration : Declaration or None
        Of a field that a study declares: its unit, type and meaning.
    """

    head: str
    value: Key
    digits: int | None = 2
    percent: bool = False
    within: Key | None = None
    declaration: "Declaration | None" = None

    def of(self, row: Row) -> Any:
        """The value as shown; of a pattern the text. A declared field that the row lacks is None."""
        if isinstance(self.value, str) and "{" in self.value:
            return re.sub(r"{(\w+)}", lambda found: self.words(row[found[1]]), self.value)
        return self._shown(row.get(str(self.value)) if self.declaration else value_of(row, self.value))

    def ends(self, row: Row) -> tuple[Any, ...]:
        """Low and high end of the value's interval; empty where there is none."""
        return tuple(map(self._shown, (value_of(row, self.within) if self.within else None) or ()))

    def text(self, row: Row) -> str:
        """The cell of a row: text as it is, whole numbers as they are, others to `digits`, a dash for None."""
        ends = " to ".join(map(self.words, self.ends(row)))
        return self.words(self.of(row)) + (f" ({ends})" if ends else "")

    def words(self, value: Any) -> str:
        """A value of this column as its cells have it."""
        if isinstance(value, str):
            return value
        if isinstance(value, list | tuple):
            return ", ".join(map(self.words, value)) or "–"
        if self.digits is None or isinstance(value, int):
            return short(value) if self.digits is None else str(value).replace("-", "−")
        return percent(value, self.digits) if self.percent else number(value, self.digits)

    def called(self, name: str, **shown: Any) -> "Column":
        """The same declared field under another name, in the same unit. shown: digits, percent or within otherwise."""
        assert self.declaration
        column = replace(self, **shown)
        return replace(column, head=self.declaration.head(name, column.percent))

    def _shown(self, value):
        factor = self.declaration.factor if self.declaration else 1
        if factor == 1 or value is None or isinstance(value, str):
            return value
        return [self._shown(item) for item in value] if isinstance(value, list | tuple) else value / factor


@dataclass(frozen=True)
class Declaration:
    """What a field of a study's rows is.

    Parameters
    ----------
    meaning : str
        What the value is, in words.
    unit : str
        Of the stored value; "-": a number without one, a word, or a part with units of its own; "": no quantity.
    type : str
        Of `TYPES`, or several, as "number or word".
    shown : str
        The unit in which pages show it, of `UNITS_SHOWN`; "": the stored one.
    """

    meaning: str
    unit: str = "-"
    type: str = "number"
    shown: str = ""

    def __post_init__(self) -> None:
        if self.shown and (self.unit, self.shown) not in UNITS_SHOWN:
            raise ValueError(f"shown = {self.shown!r} of a column in {self.unit!r}: add it to UNITS_SHOWN")

    @property
    def factor(self) -> float:
        """One unit shown, in units stored."""
        return UNITS_SHOWN[self.unit, self.shown] if self.shown else 1

    def holds(self, value: object) -> bool:
        """Whether a value, other than null, is of this type."""
        return any(type(value) in TYPES[name] for name in self.type.split(" or "))

    def head(self, name: str, percent: bool) -> str:
        """The name with the unit behind it, where it is a number; what is written in per cent says so itself."""
        unit, kind = self.shown or self.unit, self.type.partition(" or ")[0]
        measured = kind in ("number", "whole number") or (kind == "list" and unit != "-")
        return f"{name} [{unit}]" if measured and not percent and name and unit and " " not in unit else name


TYPES = {
    "number": (int, float),
    "whole number": (int,),
    "word": (str,),
    "flag": (bool,),
    "list": (list,),
    "table": (dict,),
}  # of JSON
UNITS_SHOWN = {  # {(unit stored, unit shown): one of the unit shown, in units stored}: 1 mm = 1e-3 m
    ("s", "ms"): 1e-3,
    ("s", "µs"): 1e-6,
    ("m", "mm"): 1e-3,
    ("m", "µm"): 1e-6,
    ("rad", "deg"): math.pi / 180,
}


def number_of(
    field: str, name: str, meaning: str, unit: str = "-", *, type: str = "number", shown: str = "", **look: Any
) -> Column:
    """A declared column. field: of the rows. name: what stands above it. look: digits, percent, within of
    `Column`."""
    declaration = Declaration(meaning, unit, type, shown)
    return Column(declaration.head(name, look.get("percent", False)), field, **look, declaration=declaration)


whole_of, word_of, flag_of, list_of, table_of = (
    partial(number_of, type=name) for name in ("whole number", "word", "flag", "list", "table")
)


def declared(*columns: Column) -> dict[str, Column]:
    """{field: its column}, in order; each field once."""
    fields = {str(column.value): column for column in columns}
    assert len(fields) == len(columns), "a field is declared twice"
    return fields


# a solver without variants says "variant": "", and its engine's name stands alone
NAME = Column("engine, variant", lambda row: ", ".join(filter(None, (row["engine"], row["variant"]))))
