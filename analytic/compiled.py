"""How the model is compiled: by numba, into machine code that runs without the interpreter and its lock.

A function that compiled code alone calls is `inner`: without wrappers for Python and C, which take longer to compile
than most functions themselves, and without counts of references to arrays, an atomic operation wherever one is passed
on. So it may not make an array. One that Python calls is `entry`: kept on disk, see `_cache`.
"""

import gc
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from numba import njit

# Without counts of references; no public option of numba, so a test sees to it that it is obeyed.
_UNCOUNTED: dict[str, Any] = {"_nrt": False}
_BARE: dict[str, Any] = {**_UNCOUNTED, "no_cpython_wrapper": True, "no_cfunc_wrapper": True}


def inner(function: Callable[..., Any]) -> Any:
    """Compiled for compiled code alone."""
    return njit(**_BARE)(function)


def inlined(function: Callable[..., Any]) -> Any:
    """As `inner`, and made part of each caller: by LLVM, in a fraction of the time that numba's inlining takes."""
    return njit(**_BARE, forceinline=True)(function)


def entry(function: Callable[..., Any]) -> Any:
    """Compiled for Python and for compiled code. It holds no lock, so that threads run and Ctrl-C is heard."""
    return njit(**_UNCOUNTED, nogil=True, cache=True)(function)


def chosen(functions: Sequence[Callable[..., Any]]) -> Any:
    """Compiled function of (number, *arguments): the function of that number.

    Functions as arguments would compile whoever takes them once for each.
    """
    *before, last = functions

    @inlined
    def choose(number, *arguments):
        return last(*arguments)

    for place, own in reversed(list(enumerate(before))):
        choose = _either(place, own, choose)
    return choose


def _either(place: int, own: Callable[..., Any], others: Callable[..., Any]) -> Any:
    @inlined
    def choose(number, *arguments):
        if number == place:
            return own(*arguments)
        return others(number, *arguments)

    return choose


@contextmanager
def compiling() -> Iterator[None]:
    """Without the garbage collector: the compiler's millions of objects live until its end."""
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()
