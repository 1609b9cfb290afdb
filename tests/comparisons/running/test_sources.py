"""Source digests: imports are followed, words do not count, code does."""

import importlib
import os
import sys
import time

import pytest

from comparisons.running.sources import computes, source_digests


@pytest.fixture
def package(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(tmp_path))
    folder = tmp_path / "some_package"
    folder.mkdir()
    files = {
        "__init__": "",
        "a": "import math\nfrom .b import f\n",
        "c": "x = 1\n",
        "alone": "y = 1\n",
        "b": "def f():\n    from . import c\n    return c\n",
    }

    def write(name, text):
        (folder / f"{name}.py").write_text(text)
        os.utime(folder / f"{name}.py", ns=(time.time_ns(), time.time_ns()))  # finer than the system's clock of files

    for name, text in files.items():
        write(name, text)
    importlib.invalidate_caches()
    yield write
    for name in [name for name in sys.modules if name.partition(".")[0] == "some_package"]:
        del sys.modules[name]  # the next test's is another one


def test_imports_are_followed_within_the_package_inside_functions_too(package):
    assert list(source_digests(["some_package.a"])) == [
        "some_package",
        "some_package.a",
        "some_package.b",
        "some_package.c",
    ]
    assert list(source_digests(["some_package.alone"])) == ["some_package.alone"]  # not the package that holds it


TYPED = "class A:\n    x: {}\n\n    def f(self, y{}){}:\n        {}return y\n"
BARE = TYPED.format("int", "", "", "")


@pytest.mark.parametrize(
    "old, new, same",
    [
        ("x = 1\n", "# why\nx   =  1\n", True),
        ("x = 1\n", '"""What."""\nx = 1\n', True),
        ("x = 1\n", "if TYPE_CHECKING:\n    from .alone import y\nx = 1\n", True),
        ("x = 1\n", "if TYPE_CHECKING:\n    from .alone import y\nelse:\n    y = 2\nx = 1\n", False),
        ("x = 1\n", "from math import pi\nx = 1\n", False),
        ("x = 1\n", "x = 2\n", False),
        ("x = 1\n", "x = 1.0\n", False),
        ("x = 1\n", "x = 1\nx += 1\n", False),
        ("x = 1\n", "x = '1'\n", False),
        ("x = 1\n", "y = 1\n", False),
        (BARE, TYPED.format("int", ": int", " -> int", '"""What."""\n        '), True),  # types of functions
        (BARE, TYPED.format("float", "", "", ""), False),  # types of fields, which pydantic reads
    ],
)
def test_code_counts_and_words_do_not(package, old, new, same):
    package("c", old)
    before = source_digests(["some_package.a"])
    package("c", new)
    after = source_digests(["some_package.a"])
    assert {name for name in before if before[name] != after[name]} == (set() if same else {"some_package.c"})
    assert before.keys() == after.keys()


def test_the_reference_does_not_depend_on_engines_nor_studies():
    assert {name.partition(".")[0] for name in source_digests(["analytic"])} == {"analytic"}


def test_what_carries_runs_out_ages_nothing_and_what_measures_them_does():
    """A progress bar, the store or a schema may change; the measure, the study and what a case runs may not."""
    found = source_digests(["comparisons.studies.restitution.study", "comparisons.running.cases"])
    assert {"comparisons.measuring.errors", "comparisons.running.cases", "analytic.kernel"} <= found.keys()
    carrying = [name for name in found if name.startswith(("comparisons.running", "comparisons.schemas"))]
    assert carrying == ["comparisons.running.cases"]
    assert not any(map(computes, ("comparisons.running", "comparisons.running.progress", "comparisons.schemas.runs")))
    assert all(map(computes, ("comparisons.running_mate", "comparisons.measuring.errors", "analytic")))


def test_an_unknown_module_is_an_error():
    with pytest.raises(ModuleNotFoundError, match="no source file for module 'analytic.nothing'"):
        source_digests(["analytic.nothing"])
