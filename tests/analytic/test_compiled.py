"""Inner functions are compiled as `analytic.compiled` says: numba has no public option for one part of it."""

import gc

import numpy as np
import pytest
from from_python import from_python
from numba import njit
from numba.core.registry import cpu_target

from analytic import kernel
from analytic._cache import digest
from analytic.compiled import compiling, entry, inner
from analytic.layout import ROWS, TOTALS


def native(function):
    """Machine code of a compiled function itself, without its wrappers."""
    (text,) = function.inspect_llvm().values()
    bodies = [part.partition("\n}")[0] for part in text.split("\ndefine ")[1:]]
    return "".join(
        body for body in bodies if not any(word in body.split("(")[0] for word in ("cpython", "cfunc", "NRT_"))
    )


def test_no_reference_is_counted_in_what_is_compiled_without():
    """Where an array is handed on and kept, numba counts a reference, an atomic operation; not here."""

    def hand_on(array, other, first):
        kept = array if first else other
        for _ in range(int(kept[0])):
            kept = other if kept[1] > 0 else array
        return kept[0]

    found = {}
    for name, decorate in (("counted", njit), ("entry", entry)):
        function = decorate(hand_on)
        function(np.ones(3), np.ones(3), True)
        found[name] = "NRT_incref" in native(function) or "atomicrmw" in native(function)
    assert found == {"counted": True, "entry": False}


def test_an_inner_function_makes_no_array_and_is_not_called_from_python():
    @inner
    def makes():
        return np.zeros(3)

    with pytest.raises(Exception, match="Only accept returning of array passed into the function"):
        from_python(makes)()


@pytest.mark.parametrize("switch, enabled", [(gc.enable, True), (gc.disable, False)])
def test_the_collector_is_as_before_after_compiling(switch, enabled):
    switch()
    try:
        with compiling():
            assert not gc.isenabled()
        assert gc.isenabled() == enabled
    finally:
        gc.enable()


def test_an_inner_function_is_no_machine_code_but_in_its_entry():
    """numba would optimise and emit it at every level of calls, for some half of the time."""

    @inner
    def twice(x):
        return 2 * x

    @inner
    def four_times(x):
        return twice(twice(x))

    @njit
    def called(x):
        return four_times(x) + 1

    assert called(2.0) == 9.0
    linked = [next(iter(function.overloads.values())) for function in (twice, four_times)]
    engine = cpu_target.target_context.codegen()._engine
    assert [engine.is_symbol_defined(one.fndesc.mangled_name) for one in linked] == [False, False]
    (whole,) = called.overloads.values()
    assert engine.is_symbol_defined(whole.fndesc.mangled_name)


def test_the_kernel_keeps_to_the_arrays_it_is_given():
    arrays = kernel.arrays(np.empty((1, TOTALS)), capacity=2, outputs=3)
    assert arrays.P.shape[0] == ROWS and [len(rows) for rows in arrays[2:6]] == [2, 2, 2, 3]


# The key of a compiled function is what it does: what it reads counts, and nothing else.
PLAIN = """
LIMIT = 2.0
def inner(x):
    return x * LIMIT
def make(step):
    def outer(x, least=0.5):
        '''What it does.'''
        return max(inner(x), least) + step + sum([k for k in (1, 2)])
    return outer
outer = make(3)
"""


def key(text, without=None):
    scope = {"__name__": "analytic.made"}  # followed as the model's own
    exec(text, scope)
    scope.pop(without, None)
    return digest(scope["outer"])


def test_an_entry_stands_below_what_it_calls():
    """Its key is taken where it stands: what comes later would not count, and a stale kernel would run."""
    with pytest.raises(NameError, match="inner, read by .*outer, stands below the entry: move the entry down"):
        key(PLAIN, without="inner")
    assert kernel._run_rows._cache._impl.locator.get_source_stamp() == digest(kernel._run_rows)


@pytest.mark.parametrize(
    "before, after",
    [("LIMIT = 2.0", "\nLIMIT = 2.0  # so far"), ("What it does.", "Another sentence."), ("\ndef", "\nOTHER = 1\ndef")],
)
def test_words_lines_and_what_is_not_read_do_not_count(before, after):
    assert key(PLAIN.replace(before, after, 1)) == key(PLAIN)


@pytest.mark.parametrize(
    "before, after",
    [
        ("2.0", "2.5"),
        ("x * LIMIT", "x / LIMIT"),
        ("0.5", "0.6"),
        ("max", "min"),
        ("make(3)", "make(4)"),
        ("1, 2", "1, 3"),
    ],
)
def test_constants_operations_defaults_closures_and_what_is_called_count(before, after):
    assert key(PLAIN.replace(before, after)) != key(PLAIN)
