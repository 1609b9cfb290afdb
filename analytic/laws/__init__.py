"""The bearing laws, one file each; a new one is its file and a name in the first import. See `Law` for what it offers.

Compiled code knows a law by its number, its place in `LAWS`, and picks its functions by that number: functions as
arguments would compile the whole kernel once for each law.
"""

from collections.abc import Callable
from types import ModuleType
from typing import Any

from numba import njit

from . import algebraic, bilinear, bouc_wen, linear  # noqa: F401 a new law joins this line, and is in LAWS by it
from .law import Law

__all__ = ["LAWS", "NUMBERS", "Law", "chosen", "chosen_term"]

LAWS = tuple(file.LAW for file in list(globals().values()) if isinstance(file, ModuleType) and hasattr(file, "LAW"))
NUMBERS = {law.name: number for number, law in enumerate(LAWS)}


def chosen(name: str) -> Callable[..., Any]:
    """Compiled function of (law's number, *arguments): the law's function `name`."""
    *before, last = (getattr(law, name) for law in LAWS)

    @njit(forceinline=True)
    def choose(law, *arguments):
        return last(*arguments)

    return _nested(_either, before, choose)


def _nested(either: Callable[..., Any], before: list[Callable[..., Any]], last: Any) -> Any:
    """`last`, behind a choice for each of the laws before it."""
    for number, own in reversed(list(enumerate(before))):
        last = either(number, own, last)
    return last


def _either(number: int, own: Callable[..., Any], others: Callable[..., Any]) -> Callable[..., Any]:
    @njit(forceinline=True)
    def choose(law, *arguments):
        if law == number:
            return own(*arguments)
        return others(law, *arguments)

    return choose


def chosen_term() -> Callable[..., float]:
    """`chosen` for the Taylor term, the innermost loop: inlined by numba, which needs the arguments by name."""
    *before, last = (law.term for law in LAWS)

    @njit(inline="always")
    def choose(law, k, factors, x, v, q):
        return last(k, factors, x, v, q)

    return _nested(_either_term, before, choose)


def _either_term(number: int, own: Callable[..., float], others: Callable[..., float]) -> Callable[..., float]:
    @njit(inline="always")
    def choose(law, k, factors, x, v, q):
        if law == number:
            z = own(k, factors, x, v, q)
        else:
            z = others(law, k, factors, x, v, q)
        return z

    return choose
