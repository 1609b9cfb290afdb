"""Numbers as records print them, read strictly: what is not surely a number is refused, never mended."""

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
_PRINTED = re.compile(r"[+-]?[0-9]*+\.([0-9]*+)(?:[EeDd][+-]?([0-9]{1,3}+))?+")  # decimals, digits of the exponent
_LONG_EXPONENT = re.compile(r"[EeDd][+-]?([0-9])[0-9]{2}")
_SHORT_EXPONENT = re.compile(r"[EeDd][+-]?[0-9]{1,2}(?![0-9])")
_NOT_FINITE = re.compile(r"[+-]?(?:nan|inf|infinity)", re.I)


def number(where: str, token: str) -> float:
    """The number in `token`.

    Raises
    ------
    SceneError
        It is not one, or not finite; names `where`.
    """
    if len(token) <= LONGEST and _NUMBER.fullmatch(token):
        value = float(token.replace("D", "E").replace("d", "e"))
        if math.isfinite(value):
            return value
        raise SceneError(where, token, "not finite", REMEDY)
    raise SceneError(where, token, "not finite" if _NOT_FINITE.fullmatch(token) else "not a number", REMEDY)


def numbers(where: str, line: str) -> list[float]:
    """All numbers of a line in Fortran's columns, shape (n,): parted by blanks, or stuck together by their signs."""
    values = []
    for token in line.split():
        if len(token) <= LONGEST and _NUMBER.fullmatch(token):
            values.append(number(where, token))
        else:
            values += _stuck(where, token)
    return values


def fortran_values(lines: Sequence[str], begin: int) -> np.ndarray:
    """All numbers from the line of index `begin` on, shape (n,).

    Raises
    ------
    SceneError
        What is not a number, and an exponent of three digits where the others have two and it is no tiny number in a
        line of the usual width: a digit slipped in, or two numbers ran together.
    """
    values = [value for at, line in enumerate(lines[begin:], begin + 1) for value in numbers(f"line {at}", line)]
    long = [(at, line.rstrip()) for at, line in enumerate(lines[begin:], begin + 1) if _LONG_EXPONENT.search(line)]
    if long and any(_SHORT_EXPONENT.search(line) for line in lines[begin:]):
        usual = Counter(len(line.rstrip()) for line in lines[begin:] if line.strip()).most_common(1)[0][0]
        for at, line in long:
            if len(line) != usual or _LONG_EXPONENT.search(line)[1] == "0":  # type: ignore[index]  # the lines with one
                raise SceneError(f"line {at}", line, "an exponent of three digits among others of two", REMEDY)
    return np.array(values)


def _stuck(where: str, token: str) -> list[float]:
    """Numbers without blanks, where a sign fills the column: "-.1230E+00-.4560E+00".

    One Fortran format printed them, so all have a point, as many decimals, and exponents of as many digits; else a
    blank or a digit was lost ("-.10-100" may be an exponent without its letter) and they are refused.
    """
    parts = _NUMBER.findall(token)
    if len(parts) < 2 or "".join(parts) != token or any(part[0] not in "+-" for part in parts[1:]):
        number(where, token)  # refuses, and knows why
    if len({_form(part) for part in parts}) != 1 or "." not in parts[0]:
        raise SceneError(where, token, "numbers of unlike form without a blank between them", "part or mend them")
    return [number(where, part) for part in parts]


def _form(part: str) -> tuple[int, int] | None:
    """Digits after the point and of the exponent; None without a point."""
    match = _PRINTED.fullmatch(part)
    return match and (len(match[1]), len(match[2] or ""))


def odd_peak(stated: float, unit: str, values: Sequence[float] | np.ndarray) -> tuple[str, ...]:
    """A sentence if the largest of the values is off by more than 1 % from the peak that the header states [unit]."""
    peak = float(np.abs(values).max()) if len(values) else 0.0
    if not peak or abs(abs(stated) - peak) <= 0.01 * peak:
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
