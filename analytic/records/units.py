"""Spellings of units of acceleration, and the unit of a record from the file and the scene file."""

import re
from dataclasses import dataclass

from ..errors import SceneError

G = 9.81  # m/s2: the g of a record in g is the g of the default scene
UNITS = {"m/s2": 1.0, "cm/s2": 0.01, "g": G, "gal": 0.01, "mm/s2": 1e-3, "%g": 1e-2 * G}  # -> m/s2

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
OF_G = {"g": G, "g's": G, "mg": 1e-3 * G, "%g": 1e-2 * G}
WORDS = {
    **OF_G,
    "gal": 1e-2,
    "mgal": 1e-5,
    **{
        f"{length}{power}": factor
        for length, factor in LENGTHS.items()
        for power in ("/s2", "/s/s", "/ss", "/s.s", ".s-2", "s-2", ".s-1.s-1")
    },
}  # -> m/s2, as `plain` writes them
NOT_ACCELERATIONS = {f"{length}{rate}" for length in LENGTHS for rate in ("", "/s", ".s-1", "s-1")}

# Signs of full width and plain words of units in other scripts.
_SIGNS = str.maketrans(
    dict(zip("（）［］【】／：，", "()[][]/:,", strict=True)) | {"㎨": "m/s2", "㎝": "cm", "㎜": "mm"}
)
_SCRIPTS = {
    **{"см": "cm", "мм": "mm", "м": "m", "мс": "ms", "с": "s", "сек": "s", "гал": "gal"},
    **{"厘米": "cm", "毫米": "mm", "米": "m", "毫秒": "ms", "秒": "s", "伽": "gal", "ガル": "gal"},
}
# A word begins and ends where no letter of any alphabet is.
START, END = r"(?<![^\W\d_])", r"(?![^\W\d_])"
_OF_SCRIPTS = re.compile(rf"{START}(?<![^\W\d_]-)(?:{'|'.join(_SCRIPTS)})(?:(?=²)|{END}(?!-[^\W\d_]))", re.I)


@dataclass(frozen=True)
class Unit:
    """A unit as a file states it: its word, the factor to m/s2, and where it stands."""

    word: str
    factor: float
    where: str

    @property
    def of_g(self) -> bool:
        """Whether it is g or a part of it."""
        return self.factor in OF_G.values()


def factor_of(word: str) -> float | None:
    """Factor from a unit to m/s2, of "gal(cm/s/s)" too; None if the word is no acceleration."""
    head, bracket, inside = word.rpartition("(")
    if bracket and inside.endswith(")") and factor_of(head) is not None:
        return factor_of(head) if factor_of(head) == factor_of(inside[:-1]) else None
    return WORDS.get(plain(word))


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


def in_latin(line: str) -> str:
    """A line of a header with plain words of units in Latin letters: "(см/с²)" is "(cm/s²)", "（ガル）" is "(gal)"."""
    if line.isascii():
        return line
    return _OF_SCRIPTS.sub(lambda word: _SCRIPTS[word[0].lower()], line.translate(_SIGNS))


def plain(word: str) -> str:
    """A unit in one spelling: "CM/SEC**2", "cm/(s²)" and "cm/s^2" are all "cm/s2".

    A power without its base or number, or an open bracket, stays: such a word is damaged, and no unit.
    """
    word = word.lower().strip(" .'\"").replace("²", "2").replace("⁻", "-").replace("−", "-").replace("·", ".")
    for pattern, short in LONG_NAMES:
        word = re.sub(rf"{START}(?:{pattern}){END}", short, word)
    word = re.sub(r"(?<![({])(?:\^|\*\*)(?=[-({]*[0-9])", "", word).replace("*", ".")
    if word.count("(") == word.count(")") and word.count("{") == word.count("}"):
        word = re.sub(r"[(){}]", "", word)
    return word.replace("% ", "%").replace(" ", ".")
