"""Digests of definitions: what a number reads by name counts, wherever it stands; words and types do not."""

import importlib
import os
import sys
import time

import pytest

from comparisons.execution import code_digests
from comparisons.execution.code_digests import changes, computes, digests_of_all, kept_digests, source_digests

FILES = {
    "__init__": "from .b import f as shown\n",
    "a": """
from math import pi
from . import c, unread
from .b import f, Kind, deco, made
LIMIT = 2
TABLE = {"one": 1, "two": c.x}
UNREAD = 5

@deco
def run(y, by=LIMIT):
    z = 0
    for z in range(3):
        y += pi
    return f(y) * Kind.SIZE + TABLE["one"]

def other():
    from .late import inner
    return inner() + made
""",
    "b": """
STEP = 0.1

def f(y):
    '''Words.'''
    return y * STEP

def deco(function):
    return function

class Kind:
    SIZE = 3

    def grow(self):
        return g()

def g():
    return [late for late in range(2)]

made = [k for k in range(3)]
""",
    "c": "x = 1\ny = 2\n",
    "late": "def inner():\n    return 7\n",
    "unread": "late = 3\n",
}
ROOT = "some_package.a:run"


@pytest.fixture
def package(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(tmp_path))
    folder = tmp_path / "some_package"
    folder.mkdir()

    def write(name, text):
        (folder / f"{name}.py").write_text(text)
        os.utime(folder / f"{name}.py", ns=(time.time_ns(), time.time_ns()))  # finer than the system's clock of files

    for name, text in FILES.items():
        write(name, text)
    importlib.invalidate_caches()
    yield write
    for name in [name for name in sys.modules if name.partition(".")[0] == "some_package"]:
        del sys.modules[name]  # the next test's is another one


def names(*roots):
    return {name.removeprefix("some_package.") for name in source_digests(roots)}


def test_what_is_read_by_name_is_reached_inside_functions_too_and_nothing_else(package):
    run = {"a.run", "a.LIMIT", "a.TABLE", "b.f", "b.STEP", "b.deco", "b.Kind", "b.g", "c.x"}
    assert names(ROOT) == run
    assert names("some_package.a:other") == {"a.other", "late.inner", "b.made"}
    assert names("some_package.a") == run | {"a.other", "late.inner", "b.made", "a.UNREAD"}
    assert names("some_package:shown") == {"b.f", "b.STEP"}


@pytest.mark.parametrize(
    "module, old, new, changed",
    [
        ("b", "y * STEP", "y / STEP", "b.f"),  # a function's body
        ("b", "STEP = 0.1", "STEP = 0.2", "b.STEP"),  # a constant
        ("a", "by=LIMIT", "by=LIMIT + 1", "a.run"),  # a default
        ("a", "LIMIT = 2", "LIMIT = 3", "a.LIMIT"),  # what a default reads
        ("a", "@deco\n", "", "a.run"),  # a decorator
        ("b", "return function", "return print", "b.deco"),  # what a decorator does
        ("b", "SIZE = 3", "SIZE = 4", "b.Kind"),  # an attribute of a class
        ("b", "return g()", "return 2 * g()", "b.Kind"),  # a method of it
        ("b", "range(2)", "range(4)", "b.g"),  # what a method calls
        ("a", '"one": 1', '"one": 2', "a.TABLE"),  # a table
        ("c", "x = 1", "x = 9", "c.x"),  # what a table holds
        ("c", "x = 1", "x = 1\nx += 1", "c.x"),  # what is done to it: two statements make it
        ("c", "x = 1", "x = 1.0", "c.x"),
        ("a", "from math import pi", "from cmath import pi", "a.run"),  # another package's, by another name
        ("a", "import c, unread", "import b as c, unread", "a.TABLE"),  # the same name, of another module
        ("b", "y * STEP", "y * STEP  # why", None),
        ("b", "'''Words.'''", "'''Others.'''", None),
        ("b", "def f(y):", "def f(y: int) -> 'float':", None),
        ("a", "UNREAD = 5", "UNREAD = 6", None),
        ("a", "UNREAD = 5", "from cmath import phase\nUNREAD = 5", None),
        ("c", "y = 2", "y = 3", None),
        ("late", "return 7", "return 8", None),  # of a function that `run` does not call
        ("a", "z = 0", "z = 1", "a.run"),
        ("unread", "late = 3", "late = 4", None),  # a name that is local where it is read
        ("b", "STEP = 0.1", "if TYPE_CHECKING:\n    from .c import y\nSTEP = 0.1", None),
        ("b", "STEP = 0.1", "if TYPE_CHECKING:\n    STEP = 1.0\nelse:\n    STEP = 0.1", None),
        ("b", "STEP = 0.1", "if TYPE_CHECKING:\n    STEP = 0.1\nelse:\n    STEP = 0.2", "b.STEP"),
        ("b", "STEP = 0.1", "STEP = 0.1\nprint()", "b.statement 1"),  # what runs where a module is imported
        ("b", "SIZE = 3", "SIZE: int = 3", "b.Kind"),  # types of fields, which pydantic reads
    ],
)
def test_a_change_ages_what_reaches_it_and_is_named(package, module, old, new, changed):
    kept = kept_digests([ROOT])
    assert not changes(kept) and FILES[module].count(old) == 1
    package(module, FILES[module].replace(old, new))
    assert [change.removeprefix("some_package.") for change in changes(kept)] == ([changed] if changed else [])


ON_DEMAND = """
if TYPE_CHECKING:
    from .b import f as shown

def __getattr__(name):
    return getattr(import_module(".b", __name__), "f")
"""


def test_what_a_package_imports_on_demand_is_reached_by_its_name(package):
    """`analytic` names for a type checker what it imports when it is first used; a number depends on it, too."""
    package("user", "from . import shown\n\ndef use():\n    return shown(1)\n")
    root = "some_package.user:use"
    at_once = names(root)
    package("__init__", ON_DEMAND)
    assert names(root) == at_once and "b.f" in at_once
    assert {"analytic.solver.simulate", "analytic.kernel.march._run_rows"} <= set(source_digests(["analytic:simulate"]))


MOVED = "def g():\n    return [late for late in range(2)]\n"
OTHER = "\n\ndef h():\n    return STEP\n"


@pytest.mark.parametrize(
    "steps, changed",
    [
        ({"b": (MOVED, "from .late import g\n"), "late": ("", MOVED + "late = 1\n")}, []),  # moved
        ({"b": (MOVED, "from .c import g\n"), "c": ("", MOVED.replace("2", "5"))}, ["some_package.c.g"]),
        ({"b": ("STEP = 0.1\n", "from .c import STEP\n"), "c": ("", "STEP = 0.1\n")}, []),
    ],
)
def test_moving_a_definition_ages_nothing_and_one_in_its_place_does(package, steps, changed):
    kept = kept_digests([ROOT])
    for name, (old, new) in steps.items():
        package(name, FILES[name].replace(old, new) if old else FILES[name] + new)
    assert changes(kept) == changed


def test_one_definition_in_place_of_another_that_is_there_too_is_a_change(package):
    """Files joined in silence: two constants of one name become one."""
    package("c", FILES["c"] + "STEP = 0.3" + OTHER)
    package("a", FILES["a"].replace("import c, unread", "import c").replace('"two": c.x', '"two": c.h()'))
    kept = kept_digests([ROOT])
    package("c", FILES["c"] + "from .b import STEP" + OTHER)
    assert changes(kept) == ["some_package.c.h"]


def test_a_root_that_was_moved_has_an_alias_and_one_that_is_gone_is_named(package, monkeypatch):
    kept = kept_digests([ROOT, "some_package.late"])
    package("d", FILES["a"])
    (path,) = (path for path in sys.path if os.path.exists(f"{path}/some_package/a.py"))
    os.remove(f"{path}/some_package/a.py")
    assert changes(kept) == [ROOT]
    monkeypatch.setitem(code_digests.ALIASES, ROOT, "some_package.d:run")
    assert not changes(kept)


def test_a_root_has_what_those_before_it_have_not(package):
    kept = kept_digests([ROOT, "some_package.a:other", "some_package.b"])
    assert [len(text) // code_digests.DIGITS for text in kept.values()] == [9, 3, 0]
    assert {*source_digests([ROOT]).values()} <= digests_of_all(["some_package"])


def test_the_reference_does_not_depend_on_engines_nor_studies():
    assert {name.partition(".")[0] for name in source_digests(["analytic"])} == {"analytic"}


def test_what_carries_runs_out_ages_nothing_and_what_measures_them_does():
    """A progress bar, the store or a schema may change; the measure, the study and what a case runs may not."""
    result = source_digests(["comparisons.studies.restitution.study:plan"])
    assert {"comparisons.metrics.errors.impact_errors", "comparisons.execution.cases.Case"} <= result.keys()
    modules = {name.rpartition(".")[0] for name in result}
    assert {module for module in modules if not module.startswith(("analytic", "engines", "comparisons.metrics"))} == {
        "comparisons.execution.cases",
        "comparisons.studies.restitution.study",
    }
    none = (
        "comparisons.execution",
        "comparisons.execution.progress",
        "comparisons.schemas.runs",
        "analytic.kernel.cache",
    )
    assert not any(map(computes, none)) and computes("analytic.kernel.compiled")
    assert all(map(computes, ("comparisons.running_mate", "comparisons.metrics.errors", "analytic")))


@pytest.mark.parametrize("root", ["analytic.nothing", "analytic:nothing"])
def test_an_unknown_root_is_an_error(root):
    with pytest.raises(ModuleNotFoundError, match=f"no source for '{root}'"):
        source_digests([root])
