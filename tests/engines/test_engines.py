"""Engines are found by name; an absent one is told from a broken one."""

import sys

import pytest

import engines
from analytic.errors import EngineNotInstalled
from engines.contract import Engine


def record(name, adapter, package):
    return Engine(name, package, "pip install it", "#000000", "o", adapter)


@pytest.fixture
def absent(monkeypatch):
    """An engine whose package cannot be imported here: its name."""
    monkeypatch.setitem(engines.ENGINES, "absent", record("absent", "engines.no_such_adapter", "no_such_package"))
    return "absent"


@pytest.fixture
def broken(monkeypatch, tmp_path):
    """An engine whose package is there, but whose adapter imports what is not: its name."""
    (tmp_path / "broken_adapter.py").write_text("import no_such_package")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setitem(engines.ENGINES, "broken", record("broken", "broken_adapter", "math"))
    return "broken"


def test_unknown_engine_is_told_with_the_known_ones():
    with pytest.raises(
        KeyError, match="unknown engine 'simbody': choose one of exudyn, pybullet, dart, drake, mujoco, pymunk"
    ):
        engines.get_engine("simbody")


def test_absent_engine_says_how_to_install_it(absent):
    with pytest.raises(EngineNotInstalled, match="'absent' needs the package no_such_package: pip install it"):
        engines.get_engine(absent)
    present, missing = engines.available_engines()
    assert missing[absent] == "engine 'absent' needs the package no_such_package: pip install it"
    assert absent not in present and absent not in engines.installed_engines()
    assert {*present, *missing} == {*engines.ENGINES}


@pytest.mark.parametrize("name", [*engines.ENGINES])
def test_engine_is_missing_once_its_package_is(monkeypatch, name):
    package = engines.ENGINES[name].package
    monkeypatch.setitem(sys.modules, package, None)  # what Python does for a package that cannot be imported
    assert engines.available_engines([name])[0] == ()
    assert name not in engines.installed_engines()


def test_only_the_engines_asked_for_are_looked_at(absent, broken):
    present, missing = engines.available_engines([absent])
    assert present == () and list(missing) == [absent]


def test_broken_adapter_does_not_pass_for_absent(broken):
    for find in (engines.available_engines, engines.installed_engines):
        with pytest.raises(ModuleNotFoundError, match="no_such_package") as raised:
            find()
        assert not isinstance(raised.value, EngineNotInstalled)
