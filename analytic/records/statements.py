"""Statements in the header of a record: sampling interval, number of samples, unit of its values, unit of its times.

A step is stated by a word for it, in English, Spanish, German, French or Turkish, with accents or without, then a
number with a point or a comma, its unit before or behind: "Sampling rate: 100 Hz", "INTERVALO DE MUESTREO (s): 0,01",
"Abtastrate 200", "dt [ms] = 5", "200 samples/s", "0.02 sec intervals". A rate without a unit is in Hz, an interval in
seconds; a mere "Step" or "Rate" begins its line and needs a unit.
"""

import re
import unicodedata
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from ..errors import SceneError
from .numbers import NUMBER, number
from .times import OTHER_TIMES, PER_SECOND, SAME, exact, usable
from .units import END, NOT_ACCELERATIONS, START, UNITS, WORDS, Unit, factor_of, plain

TIMES = "time|t|zeit|tiempo|temps|zaman"  # words for it, folded
_RATE = "|".join(
    (
        r"(?:sampl(?:e|ing)|digiti[sz](?:ing|ation)|data|acquisition|scan|record(?:ing)?) ?-?(?:rate|freq(?:uency)?)",
        r"fs|samprate|sampled at",
        r"(?:tasa|frecuencia|velocidad) de (?:muestreo|adquisicion)",
        r"(?:abtast|sampling) ?-?(?:rate|frequenz)",
        r"(?:frequence|taux|cadence) d.?echantillonnage",
        r"ornekleme (?:frekansi|hizi|orani)",
    )
)
_INTERVAL = "|".join(
    (
        r"dt|(?:delta|[δ∆]) ?-?t|delta(?= ?[:=])|equally ?-?spaced at|intervals? of|sampled every",
        r"(?:sampl(?:e|ing)|data|recording|digiti[sz](?:ing|ation)) ?-?(?:interval|period|step|time|spacing|increment)",
        r"time ?-?(?:step|interval|increment|spacing|base)(?: size)?(?: between (?:samples|points|values|readings))?",
        r"(?:intervalo|periodo|paso|incremento) de (?:muestreo|tiempo)|(?:paso|intervalo) temporal",
        r"(?:abtast|zeit) ?-?(?:intervall|periode|zeit|schritt|schrittweite|inkrement|abstand)",
        r"(?:pas|intervalle|periode) (?:de temps|d.?echantillonnage)",
        r"(?:ornekleme|zaman) (?:araligi|periyodu|adimi)",
    )
)
_SAMPLES = (
    "sps|(?:sample|muestra|abtastwert|wert|echantillon|ornek|point)(?:s|e)?(?:/| per | por | pro | par )"
    "(?:s|sec|second|segundo|sekunde|seconde|saniye)"
)
_HERTZ = f"hz|hertz|1/s(?:ec)?|{_SAMPLES}"
_PRINTED = rf"(?:{NUMBER}|[0-9]+,[0-9]+(?!e[+-]?[0-9]))(?![0-9]|[.,][0-9])"
_UNITS = f"(?:{_HERTZ}|{'|'.join(sorted(filter(None, PER_SECOND), key=len, reverse=True))}){END}"
# Mere words, where a line or a part of it begins, or behind a number and its unit.
_BEGINNING = "step|interval|spacing|rate|sampling|muestreo|schritt|abtastung|paso|pas|echantillonnage|adim|ornekleme"
_BEHIND = (
    "(?:time|sampl(?:e|ing)) ?-?(?:intervals?|steps?|spacing|increments?|rate|freq(?:uency)?)"
    "|intervals?|steps?|spacing|increments?|sampling"
)
_STEP = re.compile(
    rf"{START}(?P<key>(?P<rate>{_RATE}|(?:{_SAMPLES})(?= ?[:=]))|{_INTERVAL}){END}"
    rf" ?[(\[]? ?(?P<before>(?!(?:is|of|at){END})(?:{_HERTZ}|[a-zµ]+){END})? ?[)\]]?"
    rf" ?(?P<sign>[:=]|(?:is|of|at){END})? ?"
    rf"(?:(?P<value>{_PRINTED})"
    rf"(?: ?[(\[]? ?(?P<behind>{_HERTZ}|[a-zµ]+){END}(?! ?[:=])| ?(?=$|[,;|)\]])| (?=[a-z]+ ?[:=])))?"
    rf"|(?<![0-9.,])(?P<samples>{_PRINTED}) ?(?:{_SAMPLES}){END}"
    rf"|(?<![0-9.,])(?P<ahead>{_PRINTED}) ?-?(?P<ahead_unit>{_UNITS})\.? ?-?(?>{_BEHIND}){END}(?! ?[(\[:=0-9])"
    rf"|(?:(?<![^,;|#%!])|(?<=[,;|#%!] ))(?:{_BEGINNING}){END} ?(?:"
    rf"[(\[]? ?(?P<boxed_unit>{_UNITS}) ?(?:[)\]] ?[:=]?|[:=]) ?(?P<boxed>{_PRINTED})"
    rf"|[:=]? ?(?P<bare>{_PRINTED}) ?(?P<bare_unit>{_UNITS}))"
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
_FREQUENCY = re.compile(rf"{NUMBER} ?k?hz{END}")
_TIME = re.compile(
    rf"{START}(?<!-)(?:{TIMES})"
    r"(?=[ ,:=/(\[]+(?:in |units?[ :=]+)?[(\[]?(µs|[a-z]+)(?![a-z0-9]))"
)

_LENGTH = "(?:mm|cm|m|in|ft|inch(?:es)?|feet|foot|(?:milli|centi)?met(?:er|re)s?)"
# A length by a time is a unit wherever it stands, except after a number ("Vs30 = 360 m/s" is a value).
_BY = r"(?:/|[ .*·](?=s(?:ec)?(?:\^|\*\*)?[-−⁻(])|(?=s-2))"  # "cm/s2", "cm s^-2", "cms-2"
# What may stand before it is listed: behind other signs, or a letter of any alphabet, it is the rest of a damaged word.
_APART = r"""(?:(?<![^\s,;:=(\[{<'"|])|(?<=^[#!])|(?<=[^\W_][_-]))"""
_QUOTIENT = re.compile(rf"{_APART}({_LENGTH}{_BY}[^\s,;:\]=]+)", re.I)
# One that stands so is that of another length, or damaged: "km/s2".
_SQUARED = re.compile(rf"[^\s,;:=(\[]*?{_LENGTH}/s(?:ec)?(?:/s|(?:\^|\*\*)?[-{{(]*[2²])", re.I)
# One in letters of another script that stands so: "εκ/δ²".
_OF_ANOTHER_SCRIPT = re.compile(
    r"[^\s,;:=()\[\]/]{1,12}/[^\s,;:=()\[\]/]{1,12}?(?:/[^\W\d_]|\.?(?:\^|\*\*)?[-−⁻{(]*[2²])"
)
_ANOTHER_SCRIPT = re.compile("[\u0370-\u1dff\u2e80-\ud7ff\uf900-\uffff]")  # all signs but Latin ones
UNKNOWN = "unknown unit"
_AFTER_NUMBER = re.compile(r"[0-9.] ?$")
_WORD = r"((?:% ?)?[^\W\d_][^\s,;:\]=]*)"
# Short words are units only where a header introduces one.
_UNIT = (
    rf"(?:[a-z]*unit(?:s|es|[eé]s?)?|unit[aà]|unidad(?:es?)?|einheit(?:en)?|birimi?"
    rf"|единиц[аы](?: измерения)?|单位|單位|単位|μονάδ(?:α|ες)){END}"
    r"(?: (?:of|in|is|are|de los datos)(?=[ :=(\[]))?[ :=]*[(\[]?"
)
_SCALED = re.compile(
    rf"{_UNIT}({NUMBER} ?[*x]? ?({'|'.join(map(re.escape, WORDS))}))(?![^\s,;:)\]])", re.I
)  # "0.01 gal"
_INTRODUCED = re.compile(
    rf"{_UNIT}(?:(?:{'|'.join(word for word in PER_SECOND if word)})(?:[,;]| and| y| und| et| ve) )?{_WORD}", re.I
)
_SUGGESTED = re.compile(rf"(?:\bin |[(\[] ?|\b(?:acceleration|accel|acc)\.?,? (?!in )){_WORD}", re.I)
_GALS = re.compile(r"[(\[] ?(gals?) ?[)\]]", re.I)  # nothing else is called so
_SUFFIX = re.compile(rf"(?<=[^\W_])_({'|'.join(word for word in WORDS if word.isalpha())})(?![^\W_])", re.I)
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
    """Statements of a header: sampling interval [s], None if not stated; its units of time per second; sentences on
    words about sampling that are not understood; and its lines without the words read, for `stated_unit`."""

    step: float | None
    per_second: int
    unread: tuple[str, ...]
    rest: list[tuple[int, str]]


def read_statements(header: Iterable[tuple[int, str]]) -> Statements:
    """The `Statements` of the lines of a header, (line number, line).

    Raises
    ------
    SceneError
        Two steps, a step that is no number or in a unit that is not known, or two units of time.
    """
    steps: list[_Step] = []
    unread, rest = [], []
    for at, line in header:
        line = unicodedata.normalize("NFC", " ".join(line.split()))
        text, taken = folded(line), line
        match = _STEP.search(text)
        while match:
            step = _step(f"line {at}, step", line, match)
            if step is not None:
                steps.append(step)
                taken = taken[: match.start()] + " " * len(match[0]) + taken[match.end() :]
            else:
                unread.append(f"line {at} speaks of sampling in words that are not understood: {line[:60]}")
            match = _STEP.search(text, match.end() if step else match.end("key"))
        if _FREQUENCY.search(folded(taken)):
            unread.append(f"line {at} names a frequency that is not understood: {line[:60]}")
        for match in _COUNT.finditer(text):
            taken = taken[: match.start()] + " " * len(match[0]) + taken[match.end() :]
        rest.append((at, taken))
    return Statements(_only(steps), _per_second(rest), tuple(unread), rest)


def stated_count(header: Iterable[tuple[int, str]]) -> int | None:
    """The number of samples that the lines of a header state; None where they state none, or several."""
    counts = {int(count) for _, line in header for count in _COUNT.findall(folded(" ".join(line.split())))}
    return counts.pop() if len(counts) == 1 else None


def unused_factors(header: Iterable[tuple[int, str]]) -> tuple[str, ...]:
    """Sentences on factors other than 1 that the lines of a header name: the values stay as they are printed."""
    found = ((at, line, _FACTOR.search(folded(line))) for at, line in header)
    return tuple(
        f"line {at} names a factor, and the numbers are taken without it: {line[:60]}"
        for at, line, match in found
        if match and exact(match["factor"]) != 1
    )


def folded(line: str) -> str:
    """A line in lower case without accents, as long as the line itself; underscores part words."""
    plain = "".join("i" if sign == "ı" else unicodedata.normalize("NFD", sign)[0] for sign in line)
    return "".join(sign.lower() if len(sign.lower()) == 1 else sign for sign in plain).replace("_", " ")


@dataclass(frozen=True)
class _Step:
    """A step as stated: [s], where, and the half of its last printed digit [s], 0 of a rate."""

    seconds: float
    where: str
    half: float


def _step(where: str, line: str, match: re.Match[str]) -> _Step | None:
    """The step that a match states; None of a mere word, without a number."""
    if match["samples"]:
        return _of_unit(where, match["samples"], "sps")
    for form in ("ahead", "boxed", "bare"):
        if match[form]:
            return _of_unit(where, match[form], match[f"{form}_unit"])
    before, behind = match["before"] or "", match["behind"] or ""
    known = next((word for word in (behind, before) if _kind(word)), "")
    if match["value"] is None or not (known or not before or behind):
        if match["sign"] in (":", "="):
            raise SceneError(where, line, "its sampling interval or rate is no number", "write dt = .01 s")
        return None
    value = _positive(where, match["value"])
    if not known and behind:
        raise SceneError(
            where, f"{match['value']} {behind}", "not a time in s or ms, nor a rate in Hz", "write dt = .01 s"
        )
    if _kind(known) == "rate" or (not known and match["rate"]):
        if not known and value < 1:
            raise SceneError(where, line, "a rate below 1, without a unit", "write a rate in Hz, or dt = .01 s")
        return _of_unit(where, match["value"], "hz")
    return _of_unit(where, match["value"], known)


def _of_unit(where: str, token: str, unit: str) -> _Step:
    """The step of a rate or of an interval, as printed, in a unit that is known."""
    value = _positive(where, token)
    if _kind(unit) == "rate":
        return _Step(usable(where, 1 / value), where, 0.0)
    per_second = PER_SECOND[unit]
    last_digit = 10.0 ** int(exact(token.replace(",", ".")).as_tuple().exponent)
    return _Step(usable(where, value / per_second), where, last_digit / 2 / per_second)


def _kind(word: str) -> str:
    """Whether a word is a unit of a rate or of an interval; "" of another."""
    return "rate" if re.fullmatch(_HERTZ, word) else "interval" if word and word in PER_SECOND else ""


def _positive(where: str, token: str) -> float:
    """The number of a header, above 0; "1,000" is refused: its comma may stand for thousands."""
    if re.fullmatch(r"[+-]?[1-9][0-9]*,[0-9]{3}", token):
        raise SceneError(where, token, "its comma may part thousands or be a decimal sign", "write a decimal point")
    value = number(where, token.replace(",", "."))
    if value <= 0:
        raise SceneError(where, value, "not a sampling interval or rate", "give one above 0")
    return value


def _only(steps: Sequence[_Step]) -> float | None:
    """The one step [s] that all state; an interval may be that of a rate, rounded as printed."""
    if not steps:
        return None
    rate = next((step for step in steps if not step.half), steps[0])
    for step in steps:
        rounding = 0.0 if rate.half else step.half
        if abs(step.seconds - rate.seconds) > rounding + SAME * rate.seconds:
            raise SceneError(
                step.where,
                step.seconds,
                f"but {rate.where.removesuffix(', step')} states a step of {rate.seconds:.9g} s",
                "correct the wrong one",
            )
    return rate.seconds


def _per_second(header: Iterable[tuple[int, str]]) -> int:
    """Units of time in a second, from the words of the header."""
    found = {}
    for at, line in header:
        for match in _TIME.finditer(folded(line)):
            word = match[1]
            if word in OTHER_TIMES:
                raise SceneError(f"line {at}", match[0], "not a time in s or ms", "write the times in seconds")
            if word in PER_SECOND:
                found[PER_SECOND[word]] = at
    if len(found) > 1:
        raise SceneError(f"line {max(found.values())}", None, "times in s and in ms", "correct the wrong unit of time")
    return next(iter(found), 1)


def stated_unit(header: Iterable[tuple[int, str]], titles: int | None = None) -> Unit | None:
    """The unit that the lines of a header state, or None.

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
    found = acceleration = other = None
    for number_of_line, line in header:
        line = _spaced(line)
        names = _ACCELERATION.search(folded(line)), _OTHER.search(folded(line))
        acceleration = acceleration or names[0]
        other = other or names[1] and (number_of_line, names[1][0])
        for key, word in _units_in(line, number_of_line == titles, any(names)):
            factor = None if key == UNKNOWN else factor_of(word)
            if factor is None and _ANOTHER_SCRIPT.search(word):
                problem, remedy = (
                    "not an acceleration in a unit that is known",
                    f"write one of {', '.join(UNITS)} in its place",
                )
                raise SceneError(f"line {number_of_line}, {key}", word, problem, remedy)
            if factor is None:
                raise SceneError(
                    f"line {number_of_line}, {key}",
                    word,
                    "not an acceleration in g",
                    "give the acceleration file (.AT2) of this record, in g, cm/s2 or m/s2",
                )
            if found and found.factor != factor:
                raise SceneError(
                    f"line {number_of_line}, {key}",
                    word,
                    f"but {found.where} says {found.word}",
                    "correct the wrong one",
                )
            found = found or Unit(word, factor, f"line {number_of_line}")
    if other and not acceleration:
        raise SceneError(
            f"line {other[0]}",
            other[1],
            "not an acceleration",
            "give the acceleration file of this record; if it is one, let its header say so",
        )
    return found


def _units_in(line: str, titles: bool, named: bool) -> Iterator[tuple[str, str]]:
    """(key, word) of every unit in a line as `_spaced` writes it; named: an acceleration or the like is named."""
    quotients = {
        match.start(1): _word(match)
        for match in _QUOTIENT.finditer(line)
        if not _AFTER_NUMBER.search(line[: match.start()])
    }
    for match in _INTRODUCED.finditer(line):
        word = quotients.pop(match.start(1), _word(match))
        if plain(word) not in PER_SECOND:
            yield "UNITS OF", word
    for word in quotients.values():
        yield "unit", word
    for match in _SCALED.finditer(line):
        yield UNKNOWN, match[1]
    for match in _SQUARED.finditer(line):
        apart = any(match.start() <= found.start(1) < match.end() for found in _QUOTIENT.finditer(line))
        if not apart and not re.match(r"[-+]?\.?[0-9]", match[0]):
            yield UNKNOWN, match[0]
    for match in _OF_ANOTHER_SCRIPT.finditer(line):
        if _ANOTHER_SCRIPT.search(match[0]):
            yield UNKNOWN, match[0]
    suggested = _SUGGESTED if titles or named else _GALS
    for match in (*suggested.finditer(line), *(_SUFFIX.finditer(line) if titles else ())):
        if plain(_word(match)) in {*WORDS, *NOT_ACCELERATIONS} and match.start(1) not in quotients:
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
