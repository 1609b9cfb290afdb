"""Engines are found by name; an absent one is told from a broken one."""

import pytest
from engine_cases import ACCURATE, VARIANTS

import engines
from analytic.errors import EngineNotInstalled
from engines.contract import Engine


@pytest.fixture
def declared(monkeypatch, tmp_path):
    """Two engines: of "absent" the package cannot be imported, of "broken" what its adapter imports."""
    (tmp_path / "broken_adapter.py").write_text("import no_such_package")
    monkeypatch.syspath_prepend(tmp_path)
    for name, package in (("absent", "no_such_package"), ("broken", "math")):
        record = Engine(name, package, "pip install it", "#000000", "o", "broken_adapter")
        monkeypatch.setitem(engines.ENGINES, name, record)


def test_unknown_engine_is_told_with_the_known_ones():
    with pytest.raises(
        KeyError, match="unknown engine 'simbody': choose one of exudyn, pybullet, dart, drake, mujoco, pymunk"
    ):
        engines.get_engine("simbody")


def test_absent_engine_says_how_to_install_it(declared):
    words = "engine 'absent' needs the package no_such_package: pip install it"
    with pytest.raises(EngineNotInstalled, match=words):
        engines.get_engine("absent")
    # only those asked for are looked at
    assert engines.available_engines(["absent"]) == ((), {"absent": words})


def test_broken_adapter_does_not_pass_for_absent(declared):
    for find in (engines.available_engines, engines.installed_engines):
        with pytest.raises(ModuleNotFoundError, match="no_such_package") as raised:
            find()
        assert not isinstance(raised.value, EngineNotInstalled)


@pytest.mark.parametrize("name", engines.BUILT_IN)
def test_variants_are_those_that_tests_are_drawn_from(name):
    engine = engines.get_engine(name)
    main = engine.default_variant
    assert (
        set(VARIANTS[name]) == set(engine.variants)
        and VARIANTS[name][0] == main
        and tuple(VARIANTS) == engines.BUILT_IN
    )
    assert (name in ACCURATE) == (engine.variants[main].kind == "tuned")
