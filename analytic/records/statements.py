"""Statements in the header of a record, its printed numbers, and its times: step, count and units.

A step is stated by its key, a sign and a number with a point or a comma, its unit in front of the sign or behind the
number: "Sampling rate: 100 Hz", "INTERVALO DE MUESTREO (s): 0,01", "dt [ms] = 5". A rate without a unit is in Hz, an
interval in seconds. Nothing is taken from sentences: where one speaks of sampling, a warning or the refusal says so.
Without such a statement the step is found from a column of printed times.

Units of acceleration are read in many spellings; the unit of a record comes from the file or from the scene file.
Printed numbers are read strictly: an ambiguous one is refused, never corrected.
"""

import datetime
import math
import re
import unicodedata
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal

import numpy as np

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
        """Return whether the unit is g or a part of it."""
        return self.factor in OF_G.values()


def factor_of(word: str) -> float | None:
    """Return the factor from a unit to m/s2, of "gal(cm/s/s)" too; None if the word is no acceleration."""
    head, bracket, inside = word.rpartition("(")
    if bracket and inside.endswith(")") and factor_of(head) is not None:
        return factor_of(head) if factor_of(head) == factor_of(inside[:-1]) else None
    return WORDS.get(plain(word))


def resolve(unit: Unit | None, given: str | None, no_unit: str) -> Unit:
    """Return the `Unit` of a record from what the file and the scene file state.

    unit : of the file, or None. given : a key of `UNITS`, or None.

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
    """Return a line of a header with plain words of units in Latin letters.

    "(см/с²)" becomes "(cm/s²)", "（ガル）" becomes "(gal)".
    """
    if line.isascii():
        return line
    return _OF_SCRIPTS.sub(lambda word: _SCRIPTS[word[0].lower()], line.translate(_SIGNS))


def plain(word: str) -> str:
    """Return a unit in one spelling: "CM/SEC**2", "cm/(s²)" and "cm/s^2" are all "cm/s2".

    A power without its base or number, or an open bracket, stays: such a word is damaged, and no unit.
    """
    word = word.lower().strip(" .'\"").replace("²", "2").replace("⁻", "-").replace("−", "-").replace("·", ".")
    for pattern, short in LONG_NAMES:
        word = re.sub(rf"{START}(?:{pattern}){END}", short, word)
    word = re.sub(r"(?<![({])(?:\^|\*\*)(?=[-({]*[0-9])", "", word).replace("*", ".")
    if word.count("(") == word.count(")") and word.count("{") == word.count("}"):
        word = re.sub(r"[(){}]", "", word)
    return word.replace("% ", "%").replace(" ", ".")


REMEDY = "mend or remove it"
LONGEST = 100  # characters of a number

# As C, Fortran and spreadsheets print: ".1E-02", "1D-3", "5.0E-003". Digits of ASCII only, no underscore. Every
# repetition is possessive (++, *+), so that no text takes more than one pass.
NUMBER = r"[+-]?(?:[0-9]++(?:\.[0-9]*+)?+|\.[0-9]++)(?:[EeDd][+-]?[0-9]{1,3}+)?+"
_NUMBER = re.compile(NUMBER)
# Digits before and after the point, digits of the exponent.
_DIGITS = re.compile(r"[+-]?([0-9]*+)\.([0-9]*+)(?:[EeDd][+-]?([0-9]{1,3}+))?+")
_NOT_FINITE = re.compile(r"[+-]?(?:nan|inf|infinity)", re.I)


def number(where: str, token: str) -> float:
    """Return the number in `token`.

    Raises
    ------
    SceneError
        It is not one, or not finite; names `where`.
    """
    value = value_of(token)
    if not math.isfinite(value):
        problem = "not finite" if math.isinf(value) or _NOT_FINITE.fullmatch(token) else "not a number"
        raise SceneError(where, token, problem, REMEDY)
    return value


def value_of(token: str) -> float:
    """Return the number in `token`, nan where it is none."""
    readable = len(token) <= LONGEST and _NUMBER.fullmatch(token)
    return float(token.replace("D", "E").replace("d", "e")) if readable else math.nan


def numbers_in(token: str) -> int:
    """Return how many numbers a token holds, which may touch each other."""
    return len(_NUMBER.findall(token))


def fortran_values(lines: Sequence[str], begin: int) -> np.ndarray:
    """Return all numbers from the line of index `begin` on, shape (n,), which one Fortran format printed.

    Raises
    ------
    SceneError
        A token that is not a number, or a number of another form, or in a line of another width, than all others.
    """
    rows = [(f"line {at}", line.rstrip()) for at, line in enumerate(lines[begin:], begin + 1) if line.strip()]
    tokens = [(where, token) for where, line in rows for part in line.split() for token in _parted(where, part)]
    values = np.array([number(where, token) for where, token in tokens])
    # The last line may be shorter; a line of one number is as long as the number.
    widths = Counter(len(line) for _, line in rows[:-1] if len(line.split()) > 1)
    ((usual, _),) = Counter(form_of(token) for _, token in tokens).most_common(1) or [(None, 0)]
    for where, token in tokens:
        if not printed_as(usual, token):
            raise SceneError(where, token, "not printed as the other numbers are: a damaged number", REMEDY)
    if len(widths) == 2 and min(widths.values()) == 1 < max(widths.values()):
        where, line = next((where, line) for where, line in rows if widths[len(line)] == 1)
        raise SceneError(where, line, "not as long as all other lines: a damaged number", REMEDY)
    return values


def check_last(where: str, table: Sequence[Sequence[str]]) -> None:
    """Refuse the last number of a file that is cut: the file ends without the end of a line.

    The number is cut if all others of its column share a form that it has not. `table`: the fields of all lines.
    """
    *rows, last = table
    place = len(last) - 1
    forms = {form_of(row[place]) for row in rows if place < len(row)}
    if len(rows) > 1 and len(forms) == 1 and form_of(last[place]) not in forms:
        raise SceneError(where, last[place], "the last number is cut", "fetch the file again, or end its last line")


def _parted(where: str, text: str) -> list[str]:
    """Return the numbers of a text that blanks do not separate, because signs fill the columns: "-.1230E+00-.4560E+00".

    "-.10-100" may be an exponent without its letter: numbers in a row have points.
    """
    parts = _NUMBER.findall(text)
    if len(parts) < 2 or "".join(parts) != text:
        return [text]
    if any(part[0] not in "+-" or "." not in part for part in parts[1:]):
        raise SceneError(where, text, "numbers without a blank between them", "part or mend them")
    return parts


def form_of(token: str) -> tuple[int, int, bool] | None:
    """Return the form of a printed number, None without a point.

    It is (digits after the point, digits of the exponent, whether several stand before the point of a number with an
    exponent).
    """
    match = _DIGITS.fullmatch(token)
    return match and (len(match[2]), len(match[3] or ""), bool(match[3]) and len(match[1]) > 1)


def printed_as(usual: tuple[int, int, bool] | None, token: str) -> bool:
    """Return whether a number has the usual form, but for the three digits of a tiny one's exponent: "1.2E-105"."""
    form = form_of(token)
    if form == usual or form is None or usual is None or (form[1], usual[1]) != (3, 2):
        return form == usual
    return (form[0], form[2]) == (usual[0], usual[2]) and token[-3] != "0" and token[-4] == "-"


def odd_peak(stated: float | None, unit: str, values: Sequence[float] | np.ndarray) -> tuple[str, ...]:
    """Return a sentence if the largest value is off by more than 1 % from the peak that the header states [unit]."""
    peak = float(np.abs(values).max()) if len(values) else 0.0
    if stated is None or not peak or abs(abs(stated) - peak) <= 0.01 * peak:
        return ()
    return (f"the header states a peak of {stated:.6g} {unit}, the data have {peak:.6g}: check that the file is whole",)


def count(where: str, token: str) -> int:
    """Return a number of samples.

    Raises
    ------
    SceneError
        Not a whole number below 1e9; names `where`.
    """
    if not re.fullmatch(r"[0-9]{1,9}", token):
        raise SceneError(where, token, "not a number of samples", "give a whole number")
    return int(token)


def check_count(where: str, stated: int, samples: Sequence[float] | np.ndarray) -> None:
    """Refuse a file that holds another number of samples than its header states."""
    if stated != len(samples):
        raise SceneError(
            where, stated, f"but {len(samples)} samples follow", "the file is cut or damaged: fetch it again"
        )


_SECONDS = "s sec secs second seconds seg segundo segundos sek sekunde sekunden seconde secondes sn saniye"
_MILLISECONDS = (
    "ms msec msecs millisec millisecs millisecond milliseconds milisegundo milisegundos millisekunde millisekunden"
    " milliseconde millisecondes milisaniye"
)
PER_SECOND = dict.fromkeys(("", *_SECONDS.split()), 1) | dict.fromkeys(_MILLISECONDS.split(), 1000)
OTHER_TIMES = set("us µs usec ns min mins minute minutes h hr hrs hour hours day days samples".split())
USABLE = (1e-7, 1e3)  # s: range of the step of a ground motion
SAME = 1e-6  # relative difference of two steps below which they are one step, printed twice
JITTER = 0.01  # of the step: clocks and single precision
_WRITTEN_STEP = re.compile(rf"({NUMBER})([A-Za-zµ]*)")
# A time stamp, 2030-01-02T03:04:15.020; a comma is a decimal sign unless it separates the fields.
_DATE = r"([0-9]{4})([-/])([0-9]{1,2})\2([0-9]{1,2})(?:T| +)"
_CLOCK = r"([0-9]{1,2}):([0-9]{2}):([0-9]{2})(\.[0-9]{1,9}|,[0-9]{1,9}(?=[;\s]))?"
_STAMP = re.compile(rf"(?<![^\s;,])(?:{_DATE})?{_CLOCK}(?:Z|[+-][0-9]{{2}}:?[0-9]{{2}})?(?=[\s;,]|$)")
_DATED = re.compile(r"[0-9]{1,4}([-/.])[0-9]{1,2}\1[0-9]{1,4}(?=[T\s;,])|[0-9]{1,2}:[0-9]{2}")


def interval(where: str, token: str, unit: str = "") -> float:
    """Return the sampling interval [s] from a token (".02", "10ms") and a word for its unit, "" for seconds.

    Raises
    ------
    SceneError
        Not a number, not above 0, or a unit of time that is not known; names `where`.
    """
    digits, attached = match.groups() if (match := _WRITTEN_STEP.fullmatch(token)) else (token, None)
    value, unit = number(where, digits), attached or unit
    if unit.lower() not in PER_SECOND:
        raise SceneError(
            where,
            f"{token} {unit}" if unit not in token else token,
            "not a time in s or ms",
            "write the step in SEC or MSEC",
        )
    return usable(where, value / PER_SECOND[unit.lower()])


def in_seconds(where: str, row: str) -> str:
    """Return a row with the seconds since the day 0 in place of its first time stamp.

    A time stamp is a date and a clock, or a clock alone.

    Raises
    ------
    SceneError
        It begins with a date or a clock of another form; names `where`.
    """
    stamp = _STAMP.search(row)
    if _DATED.match(row) and not _STAMP.match(row):
        raise SceneError(where, row, "its time is a date or a clock of no known form", "write the times in seconds")
    if not stamp:
        return row
    year, _, month, day, *clock, decimals = stamp.groups()
    try:
        days = datetime.date(int(year), int(month), int(day)).toordinal() if year else 0
    except ValueError as error:
        raise SceneError(where, stamp[0], f"not a date ({error})", "write the times in seconds") from None
    hours, minutes, seconds = map(int, clock)
    total = str(86_400 * days + 3600 * hours + 60 * minutes + seconds)
    return row[: stamp.start()] + total + (decimals or "") + row[stamp.end() :]


def usable(where: str, dt: float) -> float:
    """Return the interval dt [s]; refuse one outside the range of records."""
    if dt <= 0:
        raise SceneError(where, dt, "not a sampling interval", "give a step above 0 s")
    if not USABLE[0] <= dt <= USABLE[1]:
        raise SceneError(where, dt, "not a sampling interval of a ground motion", "give the step in seconds")
    return dt


def resolved_step(stated: float | None, given: float | None) -> float:
    """Return the interval [s] from the file (None: it states none) and from the user (or None).

    Raises
    ------
    SceneError
        Neither states one, or they contradict each other.
    """
    if given is not None:
        given = usable("motion.dt", given)
    if stated is None:
        if given is None:
            raise SceneError(
                "motion.dt", None, "missing; the record states no sampling interval", "add dt, the step in s"
            )
        return given
    if given is not None and abs(given - stated) > SAME * stated:
        raise SceneError(
            "motion.dt",
            given,
            f"but the step of the record itself is {stated:.9g} s",
            "remove dt, or correct the record",
        )
    return stated


def uniform_step(tokens: Sequence[str]) -> float:
    """Return the interval of equally spaced times [as printed], which rounding to the printed digits may have moved.

    The printed times are a uniform series if one line passes within half a unit of the last printed digit of all of
    them. The step is that of a whole frequency, or else the roundest, that such a line has: times of 256 Hz printed to
    3 decimals give 1/256.

    Parameters
    ----------
    tokens : sequence of str
        Times, with decimal points, n >= 2.

    Raises
    ------
    SceneError
        A gap, a repetition or a drift; names the sample.
    """
    first = exact(tokens[0])
    times = np.fromiter((float(exact(token) - first) for token in tokens), float, len(tokens))  # epochs lose nothing
    step = times[-1] / (len(times) - 1)
    steps = np.diff(times)
    if (steps > 0).all():
        if np.ptp(steps) <= 1e-6 * step:
            return float(f"{step:.12g}")
        for unit in (_printed_unit(tokens), np.full(len(times), JITTER * step)):
            if unit.max() <= 0.5 * step and (fitted := _fit(times, unit, step)):
                return fitted
    usual = float(np.median(steps))
    worst = int(np.abs(steps - usual).argmax()) + 1
    raise SceneError(
        f"sample {worst + 1}, time",
        float(exact(tokens[worst])),
        f"the sampling is not uniform: this step is {steps[worst - 1]:.6g} s, most are {usual:.6g} s",
        "resample the record at equal intervals",
    )


def exact(token: str) -> Decimal:
    """Return the number that a token prints."""
    return Decimal(token.replace("D", "E").replace("d", "e"))


def _printed_unit(tokens: Sequence[str]) -> np.ndarray:
    """Return the unit of the last printed digit of each time, shape (n,).

    All times have as many decimals, or as many digits.
    """
    numbers = [exact(token).as_tuple() for token in tokens]
    digits, exponents = np.array([(len(number.digits), number.exponent) for number in numbers]).T
    return 10.0 ** np.maximum(exponents.min(), exponents + digits - digits.max())


def _fit(times: np.ndarray, unit: np.ndarray, step: float) -> float | None:
    """Return the roundest step of a line that passes within unit/2 of all times; None without such a line."""
    count = np.arange(len(times))

    def excess(h):
        """Return by how much a line of slope h misses the intervals time +- unit/2; convex in h."""
        off = times - h * count
        return (off - unit / 2).max() - (off + unit / 2).min()

    from scipy.optimize import minimize_scalar

    reach = 2 * unit.max() / (len(times) - 1)
    best = minimize_scalar(
        excess, bounds=(step - reach, step + reach), method="bounded", options={"xatol": 1e-4 * reach}
    ).x
    allowed = 1e-3 * unit.max()
    frequency = max(round(1 / best), 1)  # most instruments sample at a whole frequency
    round_steps = (
        step for digits in range(1, 13) for step in (float(f"{best:.{digits}g}"), 1 / float(f"{1 / best:.{digits}g}"))
    )
    # Where times lie half a unit off, as those of 800 Hz in six digits, only one line passes, and best is near it.
    return next((step for step in (1 / frequency, *round_steps, best) if excess(step) <= allowed), None)


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
