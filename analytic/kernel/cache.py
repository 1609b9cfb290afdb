"""The cache of compiled functions: an entry is found by the code of all that it runs.

Numba itself looks only at the file of the entry. So it would keep a stale kernel after a change in `steps`, and compile
a good one again after an unrelated change in the entry's file.
"""

from __future__ import annotations

import builtins
import dis
import functools
import hashlib
import inspect
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from types import CodeType
from typing import Any

import numba
import numpy as np
from numba.core.caching import UserProvidedCacheLocator

HERE = Path(__file__).parent
USER = Path.home() / ".cache" / "rocking"
# Folders of the cache; the first one that can be written is used.
PLACES = (HERE / "__pycache__", USER, Path(tempfile.gettempdir()))


class Locator(UserProvidedCacheLocator):
    """Place of an entry's compiled form, and stamp of the code that it was compiled from, as numba asks for them."""

    def __init__(self, function: Any, place: Path) -> None:
        self._stamp, self._cache_path = digest(function), str(place / "numba")

    def get_source_stamp(self) -> str:
        """Return the digest of the code that the entry was compiled from."""
        return self._stamp

    def get_disambiguator(self) -> str:
        """Return a part of the file's name, so that compiled forms of several versions stand side by side."""
        return self._stamp[:16]

    @classmethod
    def from_function(cls, py_func: Any, py_file: str) -> Locator | None:
        """Return the locator in the first of `PLACES` that can be written, or None."""
        for place in PLACES:
            locator = cls(py_func, place)
            try:
                locator.ensure_cache_path()
                return locator
            except OSError:
                continue
        return None


def cached(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    """Return a decorator that compiles by numba with these options and keeps the compiled form by `Locator`.

    It stands in files of its own for each version of the source. NUMBA_CACHE_DIR, if set, wins.
    """

    def compiled(function):
        config: Any = numba.config
        before = config.CACHE_LOCATOR_CLASSES
        if not config.CACHE_DIR:
            config.CACHE_LOCATOR_CLASSES = f"{__name__}.{Locator.__name__}"
        try:  # numba asks for the place here
            return numba.njit(**options, cache=True)(function)
        finally:
            config.CACHE_LOCATOR_CLASSES = before

    return compiled


def digest(function: Any) -> str:
    """Return the digest of a function's code and of all that it reads: constants, and functions with what they read."""
    content = [(HERE / "compiled.py").read_text(encoding="utf-8"), *_read(function, set())]
    return hashlib.sha256("\n".join(content).encode()).hexdigest()


def _read(item: Any, seen: set[int]) -> Iterator[str]:
    """Yield texts that differ where the item, or anything that it reads, differs. seen: ids of functions already read.

    They name the modules of the project's items, too, as a stored form finds these by their modules.
    """
    function = getattr(item, "py_func", item)  # of a compiled function
    module = _module_of(function)
    if module.partition(".")[0] != __package__.partition(".")[0]:
        yield repr(item.tolist() if isinstance(item, np.ndarray) else getattr(item, "__name__", item))
    elif not inspect.isfunction(function):
        yield f"{module} {_source(function)}"
    elif id(function) not in seen:
        seen.add(id(function))
        yield f"{module} {_plain(function.__code__, function.__doc__)} {function.__defaults__}"
        around = inspect.getclosurevars(function).nonlocals
        for name in sorted({*_global(function.__code__), *around}):
            yield name
            for scope in (around, function.__globals__, vars(builtins)):
                if name in scope:
                    yield from _read(scope[name], seen)
                    break
            else:
                # Otherwise a change in what it calls would leave a stale kernel.
                raise NameError(f"{name}, read by {function.__qualname__}, stands below the entry: move the entry down")


def _module_of(item):
    """Return the name of the module that an item is, or that a class or function stands in; "" for others."""
    if inspect.ismodule(item):
        return item.__name__
    return (getattr(item, "__module__", None) if callable(item) else None) or ""


@functools.cache
def _source(kind: Any) -> str:
    try:
        return inspect.getsource(kind)
    except OSError:  # a class made by a call, as a namedtuple
        return inspect.getsource(sys.modules[kind.__module__])


@functools.cache  # entries share most of what they call
def _global(code):
    """Return the names that a code object reads from its module."""
    inner = (_global(constant) for constant in code.co_consts if isinstance(constant, CodeType))
    return {step.argval for step in dis.get_instructions(code) if step.opname == "LOAD_GLOBAL"}.union(*inner)


def _plain(code, doc=None):
    """Return what a code object does, without line numbers, file names and its docstring."""
    constants = [each for each in code.co_consts if each is None or each != doc]
    plain = [_plain(each) if isinstance(each, CodeType) else each for each in constants]
    return code.co_code.hex(), plain, code.co_names, code.co_varnames
