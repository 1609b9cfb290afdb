"""How the model is compiled: by numba, into machine code that runs without the interpreter and its lock.

A function that compiled code alone calls is `inner`: without wrappers for Python and C, which take longer to compile
than most functions themselves, and without counts of references to arrays, an atomic operation wherever one is passed
on. So it may not make an array. One that Python calls is `entry`: kept on disk, see `_cache`.
"""

import gc
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial

from numba import njit

# _nrt is no public option of numba: a test sees to it that the functions are compiled as is said here.
inner = partial(njit, _nrt=False, no_cpython_wrapper=True, no_cfunc_wrapper=True)
inlined = partial(inner, forceinline=True)  # by LLVM, which takes a fraction of the time numba's own inlining takes
entry = partial(njit, _nrt=False, nogil=True, cache=True)  # nogil: threads, and Ctrl-C is heard


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
