"""Engines of other packages: found by their entry point, used like the built-in ones; a broken one is named."""

import json
import os
import subprocess
import sys

import pytest
from installed_package import FAKE_ENGINE, install, install_fake_engine

import engines
from analytic import load_scene
from analytic.errors import EngineBroken, EngineNotInstalled
from analytic.rocking import momentum_restitution
from engines.guard import raised
from engines.plugins import find_engines
from engines.simulating import Simulator

BY = "declared as {} by the distribution {} 0.1: "


def python(folder, *arguments):
    """The process that ran Python with `folder` among the places of packages."""
    path = os.pathsep.join([str(folder), *filter(None, [os.environ.get("PYTHONPATH")])])
    return subprocess.run(
        [sys.executable, *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=300,
        env={**os.environ, "PYTHONPATH": path},
    )


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Where the fake engine is installed."""
    return install_fake_engine(tmp_path_factory.mktemp("packages"))


@pytest.fixture(autouse=True)
def unloaded():
    """No test finds what another one has imported."""
    yield
    for name in [name for name in sys.modules if name.startswith("crude_")]:
        del sys.modules[name]


def test_an_engine_from_outside_is_one_of_the_engines_here_and_in_workers(folder, tmp_path):
    program = tmp_path / "program.py"
    (tmp_path / "first.py").write_text("def impact(case, response):\n    return {'time': response.impacts[0].time}\n")
    program.write_text("""
import json
from pathlib import Path
from analytic import Block, Scene, Start, simulate
from comparisons.running.cases import Case
from comparisons.running.executors import Processes
from comparisons.running.sweep import run_sweep
from first import impact
from engines import BROKEN, BUILT_IN, ENGINES, get_engine, installed_engines

if __name__ == "__main__":
    scene = Scene(block=Block(mass=10.0, radius=1.0, slenderness=0.2), start=Start(tilt=0.1), duration=1.5)
    with Processes(2) as pool:
        rows = run_sweep([Case(scene, solver) for solver in ("analytic", "crude")], measure=impact, executor=pool,
                         store=Path(__file__).with_name("runs.jsonl"), progress=False)
    here = get_engine("crude").simulate(scene)
    assert list(ENGINES) == [*BUILT_IN, "crude"] and installed_engines()[-1] == "crude" and not BROKEN
    assert here.variant == "euler" and "crude is a fake" in map(str, here.warnings)
    assert abs(here.impacts[0].time - simulate(scene).impacts[0].time) < 2e-3
    assert [row.failure for row in rows] == [None, None]
    assert rows[1].case.solver == "crude" and rows[1].values["time"] == here.impacts[0].time
""")
    done = python(folder, program)
    assert done.returncode == 0, done.stderr


def test_an_assisted_variant_takes_a_restitution_that_no_couple_reaches(folder, monkeypatch):
    monkeypatch.syspath_prepend(folder)
    engine = Simulator.of(find_engines(engines.BUILT_IN)[0]["crude"])
    scene = load_scene("free-rocking-rigid").with_(duration=2.0)
    for given in (0.5 * momentum_restitution(scene), 0.5 + 0.5 * momentum_restitution(scene)):
        first = engine.simulate(scene.with_(block={"restitution": given})).impacts[0]
        assert first.rate_after / first.rate_before == pytest.approx(given, abs=1e-3)


def test_the_commands_know_it(folder):
    listed = python(folder, "-m", "comparisons", "engines")
    assert listed.returncode == 0 and " euler " in listed.stdout
    run = ("-m", "comparisons", "run", "free-rocking-rigid", "--engine", "crude", "--set")
    ran = python(folder, *run, "step=1e-3", "--json", "-")
    assert ran.returncode == 0, ran.stderr
    found = json.loads(ran.stdout)
    assert (found["engine"], found["outcome"], found["settings"]) == ("crude", "rocks", {"step": 1e-3})
    wrong = python(folder, *run, "stop=1")
    assert wrong.returncode == 2 and "crude euler has no setting 'stop'" in wrong.stderr
    compared = python(folder, "-m", "comparisons", "compare", "free-rocking-isolated", "--json", "-")
    assert compared.returncode == 0, compared.stderr
    names = [response["engine"] for response in json.loads(compared.stdout)["responses"]]
    assert names[-1] == "crude" and len(names) == len(set(names)) > 1


def changed(old, new):
    assert FAKE_ENGINE.count(old) == 1
    return FAKE_ENGINE.replace(old, new)


RENAMED = changed('name="crude"', 'name="exudyn"')
# what: (entry, its value, source of crude_engine, words, name under which it is kept)
BAD_ENTRIES = {
    "it raises": ("crude", "crude_engine:ENGINE", "1 / 0", "it cannot be imported (ZeroDivisionError: ", "crude"),
    "no such module": ("crude", "rude_engine:ENGINE", "", "it cannot be imported (ModuleNotFoundError: ", "crude"),
    "no such attribute": ("crude", "crude_engine:ENGIN", FAKE_ENGINE, "it cannot be imported (AttributeError", "crude"),
    "no engine": ("crude", "crude_engine", FAKE_ENGINE, "it is a module, no engines.contract.Engine", "crude"),
    "another name": ("rude", "crude_engine:ENGINE", FAKE_ENGINE, "it calls itself 'crude'", "rude"),
    "a name of ours": ("exudyn", "crude_engine:ENGINE", RENAMED, "that name is taken", "exudyn of crude-engine 0.1"),
    "the model's": (
        "analytic",
        "crude_engine:ENGINE",
        changed('name="crude"', 'name="analytic"'),
        "that name is taken",
        "analytic of crude-engine 0.1",
    ),
    "a levels without the default": (
        "crude",
        "crude_engine:ENGINE",
        changed("(2e-3, 5e-4)", "(2e-3,)"),
        "it cannot be imported (ValueError: levels = (0.002,): it lacks",
        "crude",
    ),
}


@pytest.mark.parametrize("what", BAD_ENTRIES)
def test_a_broken_entry_is_named_and_no_engine(monkeypatch, tmp_path, what):
    name, value, source, words, key = BAD_ENTRIES[what]
    monkeypatch.syspath_prepend(install(tmp_path, "crude-engine", {name: value}, crude_engine=source))
    found, broken = find_engines(engines.BUILT_IN)
    assert found == {} and list(broken) == [key]
    assert str(broken[key]).startswith(f"engine {name!r}, " + BY.format(value, "crude-engine") + words)


def test_two_packages_with_one_name_keep_the_first(monkeypatch, tmp_path):
    install(tmp_path, "z-engine", {"crude": "crude_engine:ENGINE"})
    monkeypatch.syspath_prepend(install_fake_engine(tmp_path))
    found, broken = find_engines(engines.BUILT_IN)
    assert list(found) == ["crude"] and "crude-engine 0.1" in found["crude"].origin
    assert list(broken) == ["crude of z-engine 0.1"] and "that name is taken" in str(broken["crude of z-engine 0.1"])


RECORD = """
from engines.contract import Engine
ENGINE = Engine("crude", {package!r}, "pip install it", "#D55E00", "v", "crude_adapter")
"""


@pytest.mark.parametrize(
    "adapter, words",
    [
        ("import no_such_package", "its module crude_adapter cannot be imported (ModuleNotFoundError: "),
        ("VARIANTS = {'euler': 1}", "crude_adapter.VARIANTS is no dict of engines.contract.Variant"),
        ("from crude_engine import VARIANTS", "crude_adapter has no function versions and no run"),
    ],
)
def test_a_broken_adapter_from_outside_costs_no_other_engine(monkeypatch, tmp_path, adapter, words):
    monkeypatch.syspath_prepend(
        install(
            tmp_path,
            "crude-engine",
            {"crude": "crude_record:ENGINE"},
            crude_engine=FAKE_ENGINE,
            crude_record=RECORD.format(package="math"),
            crude_adapter=adapter,
        )
    )
    found, broken = find_engines(engines.BUILT_IN)
    monkeypatch.setitem(engines.ENGINES, "crude", found["crude"])
    assert broken == {} and "crude" not in engines.installed_engines()
    with pytest.raises(EngineBroken) as caught:
        engines.get_engine("crude")
    assert str(caught.value).startswith("engine 'crude', " + BY.format("crude_record:ENGINE", "crude-engine") + words)


def line_of(source, words):
    return next(number for number, line in enumerate(source.split("\n"), 1) if words in line)


HELPED = changed("    return Run(", "    return helped(") + "\n\ndef helped(*_):\n    return None + 1\n"
# what: (source of crude_engine, what it raises, the line that is named)
RAISING = {
    "in a helper": (HELPED, "TypeError: unsupported operand", "return None + 1"),
    "in what it calls": (changed("np.array(rows).T", "np.array(rows, 'no')"), "TypeError: ", "np.array(rows, 'no')"),
    "another signature": (changed("variant, settings):", "variant):"), "TypeError: run() takes 2", "def run("),
    "no run": (changed("    return Run(", "    ("), "TypeError: crude_engine.run returned a NoneType", "def run("),
}


@pytest.mark.parametrize("source, words, place", RAISING.values(), ids=RAISING)
def test_what_an_adapter_raises_names_its_line(monkeypatch, tmp_path, source, words, place):
    packages = install(tmp_path, "crude-engine", {"crude": "crude_engine:ENGINE"}, crude_engine=source)
    monkeypatch.syspath_prepend(packages)
    engine = Simulator.of(find_engines(engines.BUILT_IN)[0]["crude"])
    with pytest.raises(TypeError) as caught:
        engine.simulate(load_scene("free-rocking-rigid"))
    told, place = raised(caught.value), f"(in crude_engine, line {line_of(source, place)})"
    assert told.startswith(words) and told.endswith(place)
    if source is HELPED:
        ran = python(packages, "-m", "comparisons", "run", "free-rocking-rigid", "--engine", "crude", "--json", "-")
        assert ran.returncode == 1 and f"crude failed: the run raised an error. {words}" in ran.stderr
        assert place in ran.stderr and str(packages) not in ran.stderr


@pytest.mark.parametrize("versions", ["1 / 0", "'0.1'"])
def test_versions_that_an_adapter_cannot_say_are_one_message(tmp_path, versions):
    source = changed('{"crude-engine": "0.1"}', versions)
    packages = install(tmp_path, "crude-engine", {"crude": "crude_engine:ENGINE"}, crude_engine=source)
    for command in (("engines",), ("run", "free-rocking-rigid", "--engine")):
        asked = python(packages, "-m", "comparisons", *command, "crude")
        assert asked.returncode == 2 and "crude_engine.versions fails" in asked.stderr
        assert asked.stderr.startswith("Error: engine 'crude'") and "Traceback" not in asked.stderr


def test_an_engine_from_outside_may_be_absent_like_any_other(monkeypatch, tmp_path):
    record = RECORD.format(package="no_such_package")
    monkeypatch.syspath_prepend(
        install(tmp_path, "crude-engine", {"crude": "crude_record:ENGINE"}, crude_record=record)
    )
    with pytest.raises(EngineNotInstalled, match="'crude' needs the package no_such_package: pip install it"):
        find_engines(engines.BUILT_IN)[0]["crude"].load()


def test_the_commands_name_a_broken_one_and_use_the_others(tmp_path):
    install(tmp_path, "crude-engine", {"crude": "crude_engine:ENGINE"}, crude_engine="import no_such_package")
    words = "engine 'crude', " + BY.format("crude_engine:ENGINE", "crude-engine") + "it cannot be imported"
    listed = python(tmp_path, "-m", "comparisons", "engines")
    assert listed.returncode == 0 and f"crude: cannot be used. {words}" in listed.stdout
    assert all(name in listed.stdout for name in engines.installed_engines())
    for command in ("run", "compare"):
        asked = python(tmp_path, "-m", "comparisons", command, "free-rocking-rigid", "--engine", "crude")
        assert asked.returncode == 2 and f"Error: {words}" in asked.stderr and "Traceback" not in asked.stderr
    ran = python(tmp_path, "-m", "comparisons", "run", "free-rocking-rigid", "--json", "-")
    assert ran.returncode == 0 and json.loads(ran.stdout)["outcome"] == "rocks"
