"""Compilation of the model by numba, into machine code that runs without the interpreter and its lock.

A function that only compiled code calls is `inner`. It has no wrappers for Python and C, which take longer to compile
than most functions themselves, and no reference counts of arrays, an atomic operation at each call. It must therefore
not allocate an array. Numba would compile each such function by itself. Here its intermediate code is linked into the
calling `entry`, and the entry alone is optimised, as a whole. An entry is a function that Python calls. It is cached on
disk, see `cache`.
"""

import gc
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from numba import _dynfunc, njit  # type: ignore[attr-defined]  # _dynfunc is of C
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase, DefaultPassBuilder
from numba.core.compiler_machinery import register_pass
from numba.core.typed_passes import NativeLowering

from .cache import cached


class _Linked(JITCodeLibrary):
    """Intermediate code of one function and those it calls, to be linked into its callers; not machine code."""

    def finalize(self):
        for library in dict.fromkeys(self._linking_libraries):
            self._final_module.link_in(library._get_module_for_linking(), preserve=True)
        self._finalize_dynamic_globals()
        self._finalized = True


@register_pass(mutates_CFG=True, analysis_only=False)
class _Lowering(NativeLowering):
    """The last pass of numba's pipeline, without generation of machine code."""

    _name = "inner_lowering"

    def run_pass(self, state):
        state.flags.no_compile = True
        state["library"] = _Linked(state.targetctx.codegen(), state.func_id.func_qualname)
        super().run_pass(state)
        lowered = state["cr"]
        # as numba does with machine code; callers find the function by this key, which nothing calls
        where, name = lowered.fndesc.lookup_module(), lowered.fndesc.qualname
        key = _dynfunc.make_function(where, name, "", 0, lowered.env, (state["library"],))
        state.targetctx.insert_user_function(key, lowered.fndesc, [state["library"]])
        state["cr"] = lowered._replace(cfunc=key)
        return True


class _Inner(CompilerBase):
    """numba's pipeline for compiled code, with `_Lowering`."""

    def define_pipelines(self):
        manager = DefaultPassBuilder.define_nopython_pipeline(self.state)
        manager.passes = [(_Lowering if each is NativeLowering else each, words) for each, words in manager.passes]
        return [manager]


# Without reference counts; not a public option of numba, so that a test checks its effect.
_UNCOUNTED: dict[str, Any] = {"_nrt": False}
_BARE: dict[str, Any] = {**_UNCOUNTED, "no_cpython_wrapper": True, "no_cfunc_wrapper": True, "pipeline_class": _Inner}


def inner(function: Callable[..., Any]) -> Any:
    """Compile a function for calls from compiled code only."""
    return njit(**_BARE)(function)


def inlined(function: Callable[..., Any]) -> Any:
    """Compile as `inner` does, inlined into each caller by LLVM.

    That takes a fraction of the time of numba's own inlining.
    """
    return njit(**_BARE, forceinline=True)(function)


def entry(function: Callable[..., Any]) -> Any:
    """Compile a function for calls from Python and compiled code.

    It releases the lock, so that threads run and Ctrl-C works.
    """
    return cached(**_UNCOUNTED, nogil=True)(function)


def chosen(functions: Sequence[Callable[..., Any]]) -> Any:
    """Return the compiled function of (number, *arguments) that calls the function of that number.

    With functions as arguments, each caller would be compiled once for each of them.
    """
    *before, last = functions

    @inlined
    def choose(number, *arguments):
        return last(*arguments)

    for place, function in reversed(list(enumerate(before))):
        choose = _either(place, function, choose)
    return choose


def _either(place: int, function: Callable[..., Any], otherwise: Callable[..., Any]) -> Any:
    @inlined
    def choose(number, *arguments):
        if number == place:
            return function(*arguments)
        return otherwise(number, *arguments)

    return choose


@contextmanager
def compiling() -> Iterator[None]:
    """Run without the garbage collector, as the compiler's millions of objects live until its end."""
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()
