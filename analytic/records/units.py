"""The unit of a record: what its own words state, in the ways headers say it, and what the scene file says."""

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from ..errors import SceneError

G = 9.81  # m/s2: the g of a record in g is the g of the default scene
UNITS = {"m/s2": 1.0, "cm/s2": 0.01, "g": G}  # -> m/s2

LENGTHS = {"mm": 1e-3, "cm": 1e-2, "m": 1.0, "in": 0.0254, "ft": 0.3048}  # -> m
LONG_NAMES = (
    ("milli[ -]?g", "mg"),
    ("millimet(?:er|re)s?", "mm"),
    ("centimet(?:er|re)s?", "cm"),
    ("met(?:er|re)s?", "m"),
    ("inch(?:es)?", "in"),
    ("feet|foot", "ft"),
    ("seconds?|sec", "s"),
    ("gals?", "gal"),
    ("gravity", "g"),
)
WORDS = {
    "g": G,
    "g's": G,
    "mg": 1e-3 * G,
    "%g": 1e-2 * G,
    "gal": 1e-2,
    "mgal": 1e-5,
    **{
        f"{length}{power}": factor
        for length, factor in LENGTHS.items()
        for power in ("/s2", "/s/s", "/ss", "/s.s", ".s-2", "s-2", ".s-1.s-1")
    },
}  # -> m/s2, as `_plain` writes them
NOT_ACCELERATIONS = {f"{length}{rate}" for length in LENGTHS for rate in ("", "/s", ".s-1", "s-1")}

# A word begins and ends where no letter of any alphabet is.
START, _END = r"(?<![^\W\d_])", r"(?![^\W\d_])"

_TIMES = {"s", "ms", "us", "min", "h"}

_LENGTH = "(?:mm|cm|m|in|ft|inch(?:es)?|feet|foot|(?:milli|centi)?met(?:er|re)s?)"
# A length by a time is a unit wherever it stands, except after a number ("Vs30 = 360 m/s" is a value).
_BY = r"(?:/|[ .*·](?=s(?:ec)?(?:\^|\*\*)?[-−⁻(])|(?=s-2))"  # "cm/s2", "cm s^-2", "cms-2"
# What may stand before it is listed: behind other signs, or a letter of any alphabet, it is the rest of a damaged word.
_APART = r"""(?:(?<![^\s,;:=(\[{<'"|])|(?<=^[#!])|(?<=[^\W_][_-]))"""
_QUOTIENT = re.compile(rf"{_APART}({_LENGTH}{_BY}[^\s,;:\]=]+)", re.I)
_AFTER_NUMBER = re.compile(r"[0-9.] ?$")
# Short words are units only where a header introduces one.
_INTRODUCED = re.compile(r"\bunits?\b(?: (?:of|in|is|are)(?=[ :=(\[]))?[ :=]*[(\[]?((?:% ?)?[a-z][^\s,;:\]=]*)", re.I)
_SUGGESTED = re.compile(r"(?:\bin |[(\[] ?|\b(?:acceleration|accel|acc)\.? (?!in ))((?:% ?)?[a-z][^\s,;:\]=]*)", re.I)
_ACCELERATION = re.compile(rf"{START}acc(?:el|elerations?|elerograms?)?{_END}", re.I)
# Behind a damaged sign these still refuse a record.
_OTHER = re.compile(r"(?<![a-z])(?:velocit(?:y|ies)|veloc|vel|displacements?|displ|disp)(?![a-z])", re.I)


@dataclass(frozen=True)
class Unit:
    """A unit as a file states it: its word, the factor to m/s2, and where it stands."""

    word: str
    factor: float
    where: str


def factor_of(word: str) -> float | None:
    """Factor from a unit to m/s2; None if the word is no acceleration."""
    return WORDS.get(_plain(word))


def stated_unit(header: Iterable[tuple[int, str]], titles: int | None = None) -> Unit | None:
    """The unit that the lines of a header state, or None.

    Parameters
    ----------
    header : iterable of (int, str)
        Line numbers and lines.
    titles : int, optional
        The line that names the columns: there "(g)" is a unit; elsewhere only beside the word acceleration.

    Raises
    ------
    SceneError
        Two units, a velocity, a displacement, or a unit that is not known.
    """
    found = acceleration = other = None
    for number, line in header:
        line = _spaced(line)
        names = _ACCELERATION.search(line), _OTHER.search(line)
        acceleration = acceleration or names[0]
        other = other or names[1] and (number, names[1][0])
        for key, word in _units_in(line, number == titles or any(names)):
            factor = factor_of(word)
            if factor is None:
                raise SceneError(
                    f"line {number}, {key}",
                    word,
                    "not an acceleration in g",
                    "give the acceleration file (.AT2) of this record, in g, cm/s2 or m/s2",
                )
            if found and found.factor != factor:
                raise SceneError(
                    f"line {number}, {key}", word, f"but {found.where} says {found.word}", "correct the wrong one"
                )
            found = found or Unit(word, factor, f"line {number}")
    if other and not acceleration:
        raise SceneError(
            f"line {other[0]}",
            other[1],
            "not an acceleration",
            "give the acceleration file of this record; if it is one, let its header say so",
        )
    return found


def resolve(unit: Unit | None, given: str | None, no_unit: str) -> Unit:
    """The `Unit` of a record from its own words (or None) and from the scene file (a key of `UNITS`, or None).

    Raises
    ------
    SceneError
        Neither states one, or they contradict each other.
    """
    if given is not None and given not in UNITS:
        raise SceneError("motion.units", given, "not a known unit", "choose one of " + ", ".join(UNITS))
    if unit is None:
        if given is None:
            raise SceneError("motion.units", None, f"missing; {no_unit}", "add units, one of " + ", ".join(UNITS))
        return Unit(given, UNITS[given], "units")
    if given is not None and UNITS[given] != unit.factor:
        raise SceneError(
            "motion.units",
            given,
            f"but the record carries its own unit, {unit.word} ({unit.where})",
            "remove units, or correct the record",
        )
    return unit


def _units_in(line: str, suggest: bool) -> Iterator[tuple[str, str]]:
    """(key, word) of every unit stated in a line as `_spaced` writes it."""
    quotients = {
        match.start(1): _word(match)
        for match in _QUOTIENT.finditer(line)
        if not _AFTER_NUMBER.search(line[: match.start()])
    }
    for match in _INTRODUCED.finditer(line):
        word = quotients.pop(match.start(1), _word(match))
        if _plain(word) not in _TIMES:
            yield "UNITS OF", word
    for word in quotients.values():
        yield "unit", word
    for match in _SUGGESTED.finditer(line) if suggest else ():
        if _plain(_word(match)) in {*WORDS, *NOT_ACCELERATIONS} and match.start(1) not in quotients:
            yield "unit", _word(match)


def _word(match: re.Match[str]) -> str:
    """The unit matched, without what a sentence or a bracket put behind it."""
    word = match[1]
    if word.count(")") > word.count("("):
        word = word[: word.rindex(")")] if word.count("(") else word[: word.index(")")]
    return word.rstrip(".'\"")


def _spaced(line: str) -> str:
    """The line with single blanks, none of them beside a sign of division or power."""
    line = " ".join(line.split())
    line = re.sub(r" ?\bper ", "/", line, flags=re.I)
    line = re.sub(r" squared\b| square\b", "2", line, flags=re.I)
    return re.sub(r" ?(/|\^|\*\*) ?", r"\1", line)


def _plain(word: str) -> str:
    """A unit in one spelling: "CM/SEC**2", "cm/(s²)" and "cm/s^2" are all "cm/s2".

    A power without its base or number, or an open bracket, stays: such a word is damaged, and no unit.
    """
    word = word.lower().strip(" .'\"").replace("²", "2").replace("⁻", "-").replace("−", "-").replace("·", ".")
    for pattern, short in LONG_NAMES:
        word = re.sub(rf"{START}(?:{pattern}){_END}", short, word)
    word = re.sub(r"(?<![({])(?:\^|\*\*)(?=[-({]*[0-9])", "", word).replace("*", ".")
    if word.count("(") == word.count(")") and word.count("{") == word.count("}"):
        word = re.sub(r"[(){}]", "", word)
    return word.replace("% ", "%").replace(" ", ".")
