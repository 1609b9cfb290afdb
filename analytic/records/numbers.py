"""Strict reading of printed numbers: an ambiguous one is refused, never corrected."""

import math
import re
from collections import Counter
from collections.abc import Sequence

import numpy as np

from ..errors import SceneError

REMEDY = "mend or remove it"
LONGEST = 100  # characters of a number

# As C, Fortran and spreadsheets print: ".1E-02", "1D-3", "5.0E-003". Digits of ASCII only, no underscore. Every
# repetition is possessive (++, *+), so that no text takes more than one pass.
NUMBER = r"[+-]?(?:[0-9]++(?:\.[0-9]*+)?+|\.[0-9]++)(?:[EeDd][+-]?[0-9]{1,3}+)?+"
_NUMBER = re.compile(NUMBER)
# Digits before and after the point, digits of the exponent.
_PRINTED = re.compile(r"[+-]?([0-9]*+)\.([0-9]*+)(?:[EeDd][+-]?([0-9]{1,3}+))?+")
_NOT_FINITE = re.compile(r"[+-]?(?:nan|inf|infinity)", re.I)


def number(where: str, token: str) -> float:
    """The number in `token`.

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
    """The number in `token`, nan where it is none."""
    known = len(token) <= LONGEST and _NUMBER.fullmatch(token)
    return float(token.replace("D", "E").replace("d", "e")) if known else math.nan


def numbers_in(token: str) -> int:
    """How many numbers a token holds, which may touch each other."""
    return len(_NUMBER.findall(token))


def fortran_values(lines: Sequence[str], begin: int) -> np.ndarray:
    """All numbers from the line of index `begin` on, shape (n,), which one Fortran format printed.

    Raises
    ------
    SceneError
        A token that is not a number, or a number of another form, or in a line of another width, than all others.
    """
    rows = [(f"line {at}", line.rstrip()) for at, line in enumerate(lines[begin:], begin + 1) if line.strip()]
    tokens = [(where, token) for where, line in rows for part in line.split() for token in _parted(where, part)]
    values = np.array([number(where, token) for where, token in tokens])
    # The last line may be shorter; lines of one number are as long as that is.
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
    """Refuse the last number of a file that ends without the end of a line, if all others of its column share a form
    that it has not: it is cut. `table`: the fields of all lines."""
    *others, last = table
    place = len(last) - 1
    forms = {form_of(row[place]) for row in others if place < len(row)}
    if len(others) > 1 and len(forms) == 1 and form_of(last[place]) not in forms:
        raise SceneError(where, last[place], "the last number is cut", "fetch the file again, or end its last line")


def _parted(where: str, text: str) -> list[str]:
    """Numbers that blanks do not separate, because a sign fills the column: "-.1230E+00-.4560E+00".

    "-.10-100" may be an exponent without its letter: numbers in a row have points.
    """
    parts = _NUMBER.findall(text)
    if len(parts) < 2 or "".join(parts) != text:
        return [text]
    if any(part[0] not in "+-" or "." not in part for part in parts[1:]):
        raise SceneError(where, text, "numbers without a blank between them", "part or mend them")
    return parts


def form_of(token: str) -> tuple[int, int, bool] | None:
    """Digits after the point and of the exponent, and whether several stand before the point of a number that has an
    exponent; None without a point."""
    match = _PRINTED.fullmatch(token)
    return match and (len(match[2]), len(match[3] or ""), bool(match[3]) and len(match[1]) > 1)


def printed_as(usual: tuple[int, int, bool] | None, token: str) -> bool:
    """Whether a number has the usual form, but for an exponent of three digits, as tiny ones have: "1.2E-105"."""
    form = form_of(token)
    if form == usual or form is None or usual is None or (form[1], usual[1]) != (3, 2):
        return form == usual
    return (form[0], form[2]) == (usual[0], usual[2]) and token[-3] != "0" and token[-4] == "-"


def odd_peak(stated: float | None, unit: str, values: Sequence[float] | np.ndarray) -> tuple[str, ...]:
    """A sentence if the largest of the values is off by more than 1 % from the peak that the header states [unit]."""
    peak = float(np.abs(values).max()) if len(values) else 0.0
    if stated is None or not peak or abs(abs(stated) - peak) <= 0.01 * peak:
        return ()
    return (f"the header states a peak of {stated:.6g} {unit}, the data have {peak:.6g}: check that the file is whole",)


def count(where: str, token: str) -> int:
    """A number of samples.

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
