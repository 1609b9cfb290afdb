"""The sampling interval: stated by a header with its unit of time, or found from a column of printed times."""

import datetime
import re
from collections.abc import Sequence
from decimal import Decimal

import numpy as np

from ..errors import SceneError
from .numbers import NUMBER, number

_SECONDS = "s sec secs second seconds seg segundo segundos sek sekunde sekunden seconde secondes sn saniye"
_MILLISECONDS = (
    "ms msec msecs millisec millisecs millisecond milliseconds milisegundo milisegundos millisekunde millisekunden"
    " milliseconde millisecondes milisaniye"
)
PER_SECOND = dict.fromkeys(("", *_SECONDS.split()), 1) | dict.fromkeys(_MILLISECONDS.split(), 1000)
OTHER_TIMES = set("us µs usec ns min mins minute minutes h hr hrs hour hours day days samples".split())
USABLE = (1e-7, 1e3)  # s: range of the step of a ground motion
SAME = 1e-6  # of a step: two that differ by less are one, printed twice
JITTER = 0.01  # of the step: clocks and single precision
_STEP = re.compile(rf"({NUMBER})([A-Za-zµ]*)")
# A time stamp, 2030-01-02T03:04:15.020; a comma is a decimal sign unless it separates the fields.
_DATE = r"([0-9]{4})([-/])([0-9]{1,2})\2([0-9]{1,2})(?:T| +)"
_CLOCK = r"([0-9]{1,2}):([0-9]{2}):([0-9]{2})(\.[0-9]{1,9}|,[0-9]{1,9}(?=[;\s]))?"
_STAMP = re.compile(rf"(?<![^\s;,])(?:{_DATE})?{_CLOCK}(?:Z|[+-][0-9]{{2}}:?[0-9]{{2}})?(?=[\s;,]|$)")
_DATED = re.compile(r"[0-9]{1,4}([-/.])[0-9]{1,2}\1[0-9]{1,4}(?=[T\s;,])|[0-9]{1,2}:[0-9]{2}")


def interval(where: str, token: str, unit: str = "") -> float:
    """Sampling interval [s] from a token (".02", "10ms") and a word for its unit, "" for seconds.

    Raises
    ------
    SceneError
        Not a number, not above 0, or a unit of time that is not known; names `where`.
    """
    digits, own = match.groups() if (match := _STEP.fullmatch(token)) else (token, None)
    value, unit = number(where, digits), own or unit
    if unit.lower() not in PER_SECOND:
        raise SceneError(
            where,
            f"{token} {unit}" if unit not in token else token,
            "not a time in s or ms",
            "write the step in SEC or MSEC",
        )
    return usable(where, value / PER_SECOND[unit.lower()])


def in_seconds(where: str, row: str) -> str:
    """A row with the seconds since the day 0 in place of its first time stamp, of date and clock or of clock alone.

    Raises
    ------
    SceneError
        It begins with a date or a clock of another form; names `where`.
    """
    found = _STAMP.search(row)
    if _DATED.match(row) and not _STAMP.match(row):
        raise SceneError(where, row, "its time is a date or a clock of no known form", "write the times in seconds")
    if not found:
        return row
    year, _, month, day, *clock, decimals = found.groups()
    try:
        days = datetime.date(int(year), int(month), int(day)).toordinal() if year else 0
    except ValueError as error:
        raise SceneError(where, found[0], f"not a date ({error})", "write the times in seconds") from None
    hours, minutes, seconds = map(int, clock)
    whole = str(86_400 * days + 3600 * hours + 60 * minutes + seconds)
    return row[: found.start()] + whole + (decimals or "") + row[found.end() :]


def usable(where: str, dt: float) -> float:
    """The interval dt [s], refused outside the range of records."""
    if dt <= 0:
        raise SceneError(where, dt, "not a sampling interval", "give a step above 0 s")
    if not USABLE[0] <= dt <= USABLE[1]:
        raise SceneError(where, dt, "not a sampling interval of a ground motion", "give the step in seconds")
    return dt


def resolved_step(stated: float | None, given: float | None) -> float:
    """The interval [s] from the record's own words (or None) and from the user (or None).

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
    """The interval of equally spaced times [as printed], which rounding to the printed digits may have moved.

    The printed times are a uniform series if one line passes within half a unit of the last printed digit of all of
    them; the step returned is that of a whole frequency, or else the roundest, that such a line has: times of 256 Hz
    printed to 3 decimals give 1/256.

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
            if unit.max() <= 0.5 * step and (found := _fit(times, unit, step)):
                return found
    usual = float(np.median(steps))
    worst = int(np.abs(steps - usual).argmax()) + 1
    raise SceneError(
        f"sample {worst + 1}, time",
        float(exact(tokens[worst])),
        f"the sampling is not uniform: this step is {steps[worst - 1]:.6g} s, most are {usual:.6g} s",
        "resample the record at equal intervals",
    )


def exact(token: str) -> Decimal:
    """The number that a token prints."""
    return Decimal(token.replace("D", "E").replace("d", "e"))


def _printed_unit(tokens: Sequence[str]) -> np.ndarray:
    """Unit of the last printed digit of each time, shape (n,): all have as many decimals, or as many digits."""
    numbers = [exact(token).as_tuple() for token in tokens]
    digits, exponents = np.array([(len(number.digits), number.exponent) for number in numbers]).T
    return 10.0 ** np.maximum(exponents.min(), exponents + digits - digits.max())


def _fit(times: np.ndarray, unit: np.ndarray, step: float) -> float | None:
    """The roundest step of a line that passes within unit/2 of all times; None without such a line."""
    count = np.arange(len(times))

    def excess(h):
        """By how much a line of slope h misses the intervals time +- unit/2; convex in h."""
        off = times - h * count
        return (off - unit / 2).max() - (off + unit / 2).min()

    from scipy.optimize import minimize_scalar  # half a second at every start, for this alone

    reach = 2 * unit.max() / (len(times) - 1)
    best = minimize_scalar(
        excess, bounds=(step - reach, step + reach), method="bounded", options={"xatol": 1e-4 * reach}
    ).x
    allowed = 1e-3 * unit.max()
    whole = max(round(1 / best), 1)  # most instruments sample at a whole frequency
    round_steps = (
        step for digits in range(1, 13) for step in (float(f"{best:.{digits}g}"), 1 / float(f"{1 / best:.{digits}g}"))
    )
    # Where times lie half a unit off, as those of 800 Hz in six digits, one line alone passes: best comes near to it.
    return next((step for step in (1 / whole, *round_steps, best) if excess(step) <= allowed), None)
