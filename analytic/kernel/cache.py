"""Where numba keeps the compiled model: each entry by the code of all that it runs, whatever file that stands in.

Numba itself looks only at the file of the entry: after a change in taylor.py it would use a stale kernel, and after one
beside the kernel it would compile a good one again.
"""

from __future__ import annotations

import builtins
import dis
import hashlib
import inspect
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import CodeType
from typing import Any

import numba
import numpy as np
from numba.core.caching import UserProvidedCacheLocator

HERE, PACKAGE = Path(__file__).parent, __name__.partition(".")[0]
# the first that can be written
PLACES = (HERE / "__pycache__", Path.home() / ".cache" / "rocking", Path(tempfile.gettempdir()))


class Locator(UserProvidedCacheLocator):
    """Place and state of an entry's compiled form, as numba asks for them."""

    def __init__(self, function: Any, place: Path) -> None:
        self._stamp, self._cache_path = digest(function), str(place / "numba")

    def get_source_stamp(self) -> str:
        """Of what it was compiled from."""
        return self._stamp

    def get_disambiguator(self) -> str:
        """Part of the file's name: forms of several states of the code stand side by side."""
        return self._stamp[:16]

    @classmethod
    def from_function(cls, py_func: Any, py_file: str) -> Locator | None:
        """The locator in the first of `PLACES` that can be written; none where there is none."""
        for place in PLACES:
            locator = cls(py_func, place)
            try:
                locator.ensure_cache_path()
                return locator
            except OSError:
                continue
        return None


@contextmanager
def kernel_cache() -> Iterator[None]:
    """Functions decorated inside are cached by `Locator`; NUMBA_CACHE_DIR, if set, wins."""
    config: Any = numba.config
    before = config.CACHE_LOCATOR_CLASSES
    if not config.CACHE_DIR:
        config.CACHE_LOCATOR_CLASSES = f"{__name__}.{Locator.__name__}"
    try:
        yield
    finally:
        config.CACHE_LOCATOR_CLASSES = before


def digest(function: Any) -> str:
    """Of the code of a function and of all that it reads: constants, and functions with what those read."""
    content = [(HERE / "compiled.py").read_text(encoding="utf-8"), *_read(function, set())]
    return hashlib.sha256("\n".join(content).encode()).hexdigest()


def _read(one: Any, known: set[int]) -> Iterator[str]:
    """Texts that differ where what `one` says differs. known: functions that were met, by id."""
    function = getattr(one, "py_func", one)  # of a compiled one
    if not _own(function):
        yield repr(one.tolist() if isinstance(one, np.ndarray) else getattr(one, "__name__", one))
    elif not inspect.isfunction(function):
        yield f"{_module(function)} {_source(function)}"  # types are kept by the name of their module
    elif id(function) not in known:
        known.add(id(function))
        yield f"{_module(function)} {_plain(function.__code__, function.__doc__)} {function.__defaults__}"
        around = inspect.getclosurevars(function).nonlocals
        for name in sorted({*_global(function.__code__), *around}):
            yield name
            for scope in (around, function.__globals__, vars(builtins)):
                if name in scope:
                    yield from _read(scope[name], known)
                    break
            else:
                words = f"{name}, read by {function.__qualname__}, stands below the entry: move the entry down"
                raise NameError(words)  # else a change in what it calls would leave a stale kernel


def _own(one):
    """Whether it is a module, class or function of the model."""
    return (_module(one) if inspect.ismodule(one) or callable(one) else "").partition(".")[0] == PACKAGE


def _module(one: Any) -> str:
    """Name of a module, or of that of a class or function."""
    return (one.__name__ if inspect.ismodule(one) else getattr(one, "__module__", None)) or ""


def _source(one: Any) -> str:
    try:
        return inspect.getsource(one)
    except OSError:  # a class that was made by a call
        return inspect.getsource(sys.modules[one.__module__])


def _global(code):
    """Names that a code object reads from its module."""
    inner = (_global(one) for one in code.co_consts if isinstance(one, CodeType))
    return {one.argval for one in dis.get_instructions(code) if one.opname == "LOAD_GLOBAL"}.union(*inner)


def _plain(code, doc=None):
    """What a code object does, without lines, names of files and its docstring."""
    consts = [_plain(one) if isinstance(one, CodeType) else one for one in code.co_consts if one is None or one != doc]
    return code.co_code.hex(), consts, code.co_names, code.co_varnames
