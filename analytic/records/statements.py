"""Statements in the header of a record: its step, its number of samples and its unit.

A step is stated by its key, a sign and a number with a point or a comma, its unit in front of the sign or behind the
number: "Sampling rate: 100 Hz", "INTERVALO DE MUESTREO (s): 0,01", "dt [ms] = 5". A rate without a unit is in Hz, an
interval in seconds. Nothing is taken from sentences: where one speaks of sampling, a warning or the refusal says so.

The unit of a record comes from the file or from the scene file.
"""

import re
import unicodedata
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from ..errors import SceneError
from .notation import (
    END,
    NOT_ACCELERATIONS,
    NUMBER,
    OTHER_TIMES,
    PER_SECOND,
    SAME,
    START,
    UNITS,
    WORDS,
    Unit,
    exact,
    factor_of,
    number,
    plain,
    usable,
)

TIMES = "time|t|zeit|tiempo|temps|zaman"  # words for it, folded
# Keys of a step, as formats, networks and programs write them.
_RATE = (
    r"(?:sampl(?:e|ing)|digiti[sz]ation|acquisition) ?-?(?:rate|freq(?:uency)?)|samprate|fs"
    r"|(?:tasa|frecuencia) de muestreo|muestreo(?= ?\(muestras/s\))"
)
_INTERVAL = (
    r"dt|(?:delta|[δ∆]) ?-?t|(?:sampl(?:e|ing)|data) ?-?(?:interval|period|step)|intervals? of"
    r"|time ?-?(?:step|interval|increment)|intervalo de muestreo|paso de tiempo"
)
_HERTZ = "hz|hertz|sps|(?:sample|muestra)s?(?:/| per | por )s(?:ec(?:ond)?|egundo)?"
_PRINTED = rf"(?:{NUMBER}|[0-9]+,[0-9]+(?!e[+-]?[0-9]))(?![0-9]|[.,][0-9])"
_STEP = re.compile(
    rf"{START}(?:(?P<rate>{_RATE})|{_INTERVAL}){END} ?[(\[]? ?(?P<before>(?:{_HERTZ}|[a-zµ]+){END})? ?[)\]]? ?[:=] ?"
    rf"(?:(?P<value>{_PRINTED})"
    rf"(?: ?[(\[]? ?(?P<behind>{_HERTZ}|[a-zµ]+){END}(?! ?[:=])| ?(?=$|[,;|)\]])| (?=[a-z]+ ?[:=])))?"
)
# What speaks of sampling, and is not read.
_SPOKEN = re.compile(
    rf"{START}(?:{_RATE}|{_INTERVAL}|sampl(?:ed|ing)|samples? per|intervals?|equally.spaced|delta|time base|sps"
    r"|step(?= ?[(:=])|abtast[a-z]*|zeit(?:schritt|intervall|abstand)|pas de temps|(?:d.)?echantillonnage|paso temporal"
    rf"|incremento de tiempo|ornekleme|zaman (?:araligi|adimi))(?![a-z])|{NUMBER} ?-?k?(?:{_HERTZ}){END}"
)
_COUNT = re.compile(
    rf"{START}(?:"
    r"(?:no\.?|nr\.?|num\.?|number) ?(?:of )?(?:data |sample |acceleration )?(?:points|samples|data|values)"
    r"|(?:numero|num\.?|total|cantidad) (?:total )?de (?:muestras|datos|puntos|valores)"
    r"|(?:an)?zahl (?:der )?(?:werte|punkte|daten|messwerte|abtastwerte|datenpunkte)"
    r"|nombre (?:de |d.?)(?:points|valeurs|donnees|mesures|echantillons)"
    r"|(?:veri|ornek|nokta) sayisi|npts|ndata|(?<!between )samples(?= ?[:=])"
    rf"){END} ?[:=]? ?([0-9]{{1,9}})(?![0-9]|[.,][0-9])"
)
_FACTOR = re.compile(
    r"(?:fact(?:or|eur)|faktor|multipl(?:y|ier)(?: by)?|scal(?:e|ing)(?= ?[:=])) ?(?:[:=]|of|is)? ?"
    rf"(?P<factor>{NUMBER})"
)
_TIME = re.compile(
    rf"{START}(?<!-)(?:{TIMES})"
    r"(?=[ ,:=/(\[]+(?:in |units?[ :=]+)?[(\[]?(µs|[a-z]+)(?![a-z0-9]))"
)

_LENGTH = "(?:mm|cm|m|in|ft|inch(?:es)?|feet|foot|(?:milli|centi)?met(?:er|re)s?)"
_BY = r"(?:/|[ .*·](?=s(?:ec)?(?:\^|\*\*)?[-−⁻(])|(?=s-2))"  # "cm/s2", "cm s^-2", "cms-2"
# What may stand before it is listed: behind other signs, or a letter of any alphabet, it is the rest of a damaged word.
_APART = r"""(?:(?<![^\s,;:=(\[{<'"|])|(?<=^[#!])|(?<=[^\W_][_-]))"""
_WORD = r"((?:% ?)?[^\W\d_][^\s,;:\]=]*)"
_UNIT = (
    rf"(?:[a-z]*unit(?:s|es|[eé]s?)?|unit[aà]|unidad(?:es?)?|einheit(?:en)?|birimi?"
    rf"|единиц[аы](?: измерения)?|单位|單位|単位|μονάδ(?:α|ες)){END}"
    r"(?: (?:of|in|is|are|de los datos)(?=[ :=(\[]))?[ :=]*[(\[]?"
)
_SUGGESTED = re.compile(rf"(?:\bin |[(\[] ?|\b(?:acceleration|accel|acc)\.?,? (?!in )){_WORD}", re.I)
_GALS = re.compile(r"[(\[] ?(gals?) ?[)\]]", re.I)  # nothing else is called so
_SUFFIX = re.compile(rf"(?<=[^\W_])_({'|'.join(word for word in WORDS if word.isalpha())})(?![^\W_])", re.I)
_QUOTIENT = rf"{_LENGTH}{_BY}[^\s,;:\]=]+"
# Whatever a line is about. A length by a time is a unit, except after a number ("Vs30 = 360 m/s" is a value).
_ANYWHERE = [
    re.compile(pattern, re.I)
    for pattern in (
        rf"{_UNIT}({NUMBER} ?[*x]? ?(?:{'|'.join(map(re.escape, WORDS))}))(?![^\s,;:)\]])",  # "0.01 gal"
        rf"{_UNIT}(?:(?:{'|'.join(word for word in PER_SECOND if word)})(?:[,;]| and| y| und| et| ve) )?"
        rf"({_QUOTIENT}|{_WORD[1:]}",
        rf"(?<![0-9.])(?<![0-9.] ){_APART}({_QUOTIENT})",
    )
]
_UNKNOWN = re.compile(
    # of another length, or damaged: "km/s2"
    rf"(?<![^\s,;:=(\[])(?<![0-9.] )((?![-+]?\.?[0-9])[^\s,;:=(\[]*?{_LENGTH}/s(?:ec)?(?:/s|(?:\^|\*\*)?[-{{(]*[2²])"
    # in letters of another script, signs that are not Latin: "εκ/δ²"
    r"|(?=[^/]{0,12}/?[^/]{0,12}?[\u0370-\u1dff\u2e80-\ud7ff\uf900-\uffff])"
    r"[^\s,;:=()\[\]/]{1,12}/[^\s,;:=()\[\]/]{1,12}?(?:/[^\W\d_]|\.?(?:\^|\*\*)?[-−⁻{(]*[2²]))",
    re.I,
)
ACCELERATION = (
    "acc(?:el|elerations?|elerograms?)?|pga|aceleracion(?:es)?|beschleunigung(?:en)?|ivme"
    "|accelerazion[ei]|ускорени[ея]|加速度|επιταχυνσ(?:η|εις)"
)
OTHER = (
    "velocit(?:y|ies)|veloc|vel|displacements?|displ|disp|velocidad(?:es)?|desplazamientos?"
    "|geschwindigkeit(?:en)?|verschiebung(?:en)?|vitesses?|deplacements?"
)
_ACCELERATION = re.compile(rf"{START}(?:{ACCELERATION}){END}")
# Behind a damaged sign these still refuse a record.
_OTHER = re.compile(rf"(?<![a-z])(?:{OTHER})(?![a-z])")


@dataclass(frozen=True)
class Statements:
    """Statements of a header.

    Sampling interval [s], None if not stated; units of its times per second; sentences on words about sampling that are
    not understood; and its lines without the words read, for `stated_unit`.
    """

    step: float | None
    per_second: int
    unread: tuple[str, ...]
    rest: list[tuple[int, str]]


def read_statements(header: Iterable[tuple[int, str]]) -> Statements:
    """Return the `Statements` of the lines of a header, (line number, line).

    Raises
    ------
    SceneError
        Two steps, a step that is no number or in a unit that is not known, or two units of time.
    """
    steps: dict[str, tuple[float, float]] = {}
    unread, rest = [], []
    for at, line in header:
        line = unicodedata.normalize("NFC", " ".join(line.split()))
        text = taken = folded(line)
        for match in _STEP.finditer(text):
            where = f"line {at}, step"
            steps[where] = _agreed(where, _step(where, line, match), steps)
        for match in (*_STEP.finditer(text), *_COUNT.finditer(text)):
            blank = " " * len(match[0])
            line, taken = (part[: match.start()] + blank + part[match.end() :] for part in (line, taken))
        if _SPOKEN.search(taken):
            unread.append(f"line {at} speaks of sampling in words that are not understood: {line[:60].strip()}")
        rest.append((at, line))
    stated = min(steps.values(), key=lambda step: step[1], default=(None,))[0]  # the one that rounds least
    return Statements(stated, _per_second(rest), tuple(unread), rest)


def stated_count(header: Iterable[tuple[int, str]]) -> int | None:
    """Return the number of samples that the lines of a header state; None where they state none, or several."""
    counts = {int(count) for _, line in header for count in _COUNT.findall(folded(" ".join(line.split())))}
    return counts.pop() if len(counts) == 1 else None


def unused_factors(header: Iterable[tuple[int, str]]) -> tuple[str, ...]:
    """Return sentences on factors other than 1 that the header names: the values stay as they are printed."""
    searched = ((at, line, _FACTOR.search(folded(line))) for at, line in header)
    return tuple(
        f"line {at} names a factor, and the numbers are taken without it: {line[:60]}"
        for at, line, match in searched
        if match and exact(match["factor"]) != 1
    )


def folded(line: str) -> str:
    """Return a line in lower case without accents, as long as the line itself; underscores part words."""
    plain = "".join("i" if sign == "ı" else unicodedata.normalize("NFD", sign)[0] for sign in line)
    return "".join(sign.lower() if len(sign.lower()) == 1 else sign for sign in plain).replace("_", " ")


def _step(where: str, line: str, match: re.Match[str]) -> tuple[float, float]:
    """Return the step that a match states and the half of its last printed digit, 0 for a rate, both [s]."""
    token = match["value"]
    if token is None:
        raise SceneError(where, line, "its sampling interval or rate is no number", "write dt = .01 s")
    if re.fullmatch(r"[+-]?[1-9][0-9]*,[0-9]{3}", token):
        raise SceneError(where, token, "its comma may part thousands or be a decimal sign", "write a decimal point")
    value = number(where, token.replace(",", "."))
    if value <= 0:
        raise SceneError(where, value, "not a sampling interval or rate", "give one above 0")
    words = [word for word in (match["behind"], match["before"]) if word]
    recognised = [word for word in words if word in PER_SECOND or re.fullmatch(_HERTZ, word)]
    if words and not recognised:
        raise SceneError(where, f"{token} {words[0]}", "not a time in s or ms, nor a rate in Hz", "write dt = .01 s")
    if not recognised and match["rate"] and value < 1:
        raise SceneError(where, line, "a rate below 1, without a unit", "write a rate in Hz, or dt = .01 s")
    unit = recognised[0] if recognised else "hz" if match["rate"] else ""
    if unit not in PER_SECOND:
        return usable(where, 1 / value), 0.0
    last_digit = 10.0 ** int(exact(token.replace(",", ".")).as_tuple().exponent)
    return usable(where, value / PER_SECOND[unit]), last_digit / 2 / PER_SECOND[unit]


def _agreed(where: str, step: tuple[float, float], stated: Mapping[str, tuple[float, float]]) -> tuple[float, float]:
    """Return the step; refuse it if another is stated. An interval may be that of a rate, rounded as printed."""
    for place, stated_step in stated.items():
        rounding = 0.0 if step[1] and stated_step[1] else step[1] + stated_step[1]
        if abs(step[0] - stated_step[0]) > rounding + SAME * stated_step[0]:
            problem = f"but {place.removesuffix(', step')} states a step of {stated_step[0]:.9g} s"
            raise SceneError(where, step[0], problem, "correct the wrong one")
    return step if where not in stated else min(step, stated[where], key=lambda step_and_rounding: step_and_rounding[1])


def _per_second(header: Iterable[tuple[int, str]]) -> int:
    """Return the units of time in a second, from the words of the header."""
    lines_by_unit = {}
    for at, line in header:
        for match in _TIME.finditer(folded(line)):
            word = match[1]
            if word in OTHER_TIMES:
                raise SceneError(f"line {at}", match[0], "not a time in s or ms", "write the times in seconds")
            if word in PER_SECOND:
                lines_by_unit[PER_SECOND[word]] = at
    if len(lines_by_unit) > 1:
        last = f"line {max(lines_by_unit.values())}"
        raise SceneError(last, None, "times in s and in ms", "correct the wrong unit of time")
    return next(iter(lines_by_unit), 1)


def stated_unit(header: Iterable[tuple[int, str]], titles: int | None = None) -> Unit | None:
    """Return the unit that the lines of a header state, or None.

    Parameters
    ----------
    header : iterable of (int, str)
        Line numbers and lines, without their statements of the step (`Statements.rest`).
    titles : int, optional
        The line that names the columns: there "(g)" and "NS_g" hold units; elsewhere only beside the word acceleration.

    Raises
    ------
    SceneError
        Two units, a velocity, a displacement, or a unit that is not known.
    """
    unit = acceleration = other_quantity = None
    for at, line in header:
        line = _spaced(line)
        names = _ACCELERATION.search(folded(line)), _OTHER.search(folded(line))
        acceleration = acceleration or names[0]
        other_quantity = other_quantity or names[1] and (f"line {at}", names[1][0])
        for word, factor in _units_in(line, at == titles, any(names)):
            where = f"line {at}, unit"
            if factor is None:
                problem, units = "not an acceleration in a unit that is known", ", ".join(UNITS)
                raise SceneError(where, word, problem, f"write one of {units} in its place, if it is one")
            if unit and unit.factor != factor:
                raise SceneError(where, word, f"but {unit.where} says {unit.word}", "correct the wrong one")
            unit = unit or Unit(word, factor, f"line {at}")
    if other_quantity and not acceleration:
        remedy = "give the acceleration file of this record; if it is one, let its header say so"
        raise SceneError(*other_quantity, "not an acceleration", remedy)
    return unit


def _units_in(line: str, titles: bool, named: bool) -> Iterator[tuple[str, float | None]]:
    """Return (word, its factor) of each unit in a line as `_spaced` writes it; the factor may be None.

    It is None where the unit is not known. named: whether an acceleration or the like is named.
    """
    read: list[tuple[int, int]] = []
    for pattern in (*_ANYWHERE, _UNKNOWN, _SUGGESTED if titles or named else _GALS, *([_SUFFIX] if titles else [])):
        for match in pattern.finditer(line):
            word, apart = _word(match), not any(match.start() < end and match.end() > begin for begin, end in read)
            if apart and (pattern in _ANYWHERE or pattern is _UNKNOWN or plain(word) in {*WORDS, *NOT_ACCELERATIONS}):
                read.append(match.span(1))
                if plain(word) not in PER_SECOND:
                    yield word, None if pattern is _UNKNOWN else factor_of(word)


def _word(match: re.Match[str]) -> str:
    """Return the unit matched, without what a sentence or a bracket put behind it."""
    word = match[1]
    if word.count(")") > word.count("("):
        word = word[: word.rindex(")")] if word.count("(") else word[: word.index(")")]
    return word.rstrip(".'\"")


def _spaced(line: str) -> str:
    """Return the line with single blanks, none of them beside a sign of division or power."""
    line = " ".join(line.split())
    line = re.sub(r" ?\bper ", "/", line, flags=re.I)
    line = re.sub(r" squared\b| square\b", "2", line, flags=re.I)
    return re.sub(r" ?(/|\^|\*\*) ?", r"\1", line)
