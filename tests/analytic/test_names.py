"""What `analytic` offers is imported when it is first used, and is what its module defines."""

import ast
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest

import analytic
from analytic.checks import time_stepping
from analytic.kernel.cache import Locator, digest

TREE = ast.parse(Path(analytic.__file__).read_text(encoding="utf-8"))
# {name: module}, of the imports for a type checker
TYPED = {
    alias.name: f"analytic.{node.module}"
    for block in TREE.body
    if isinstance(block, ast.If)
    for node in block.body
    for alias in node.names
}


def said(code):
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True).stdout


@pytest.mark.parametrize("name", analytic.__all__)
def test_a_name_is_that_of_its_module(name):
    assert getattr(analytic, name) is getattr(import_module(TYPED[name]), name)


def test_a_type_checker_sees_the_names_that_there_are():
    assert sorted(TYPED) == sorted(analytic._MODULES) == sorted(analytic.__all__)
    assert set(analytic.__all__) < set(dir(analytic)) and "__doc__" in dir(analytic)
    with pytest.raises(AttributeError, match="module 'analytic' has no attribute 'simulated'"):
        analytic.simulated  # noqa: B018
    with pytest.raises(ImportError, match="simulated"):
        from analytic import simulated  # noqa: F401


@pytest.mark.parametrize("name, loads", [("SceneError", False), ("PulseMotion", True)])
def test_the_compiler_is_loaded_with_what_needs_it(name, loads):
    code = (
        f"import sys, analytic; dir(analytic); analytic.{name}; print('numba' in sys.modules, 'numpy' in sys.modules)"
    )
    assert said(code).split() == [str(loads)] * 2


def test_compiled_forms_stand_in_the_cache_of_the_model_whatever_is_imported_first():
    code = "from analytic.kernel.decision import will_not_overturn as f; print(type(f._cache._impl.locator).__name__)"
    assert said(code).split() == [Locator.__name__]
    for function in (time_stepping._march, time_stepping._slide):
        locator = function._cache._impl.locator
        assert isinstance(locator, Locator) and locator.get_source_stamp() == digest(function)
