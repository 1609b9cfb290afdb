"""Units, numbers and times as records write them.

Units of acceleration are read in many spellings. Printed numbers are read strictly: an ambiguous one is refused, never
corrected. A step is a number with its unit of time, or is found from a column of printed times.
"""

import datetime
import math
import re
from collections import Counter
from collections.abc import Sequence
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
