"""Engines are found by name, here and in other packages; an absent one is told from a broken one, which is named."""

import json
import os
import subprocess
import sys
import threading

import pytest
from installed_package import FAKE_ENGINE, install, install_fake_engine

import engines
from analytic import load_scene
from analytic.errors import EngineBroken, EngineNotInstalled
from analytic.rocking import momentum_restitution
from engines.contract import Engine
from engines.greeting import without
from engines.guard import raised
from engines.plugins import find_engines
from engines.simulating import Simulator

BY = "declared as {} by the distribution {} 0.1: "
RIGID = "free-rocking-rigid"


def test_an_unknown_engine_is_told_with_the_known_ones():
    words = "unknown engine 'simbody': choose one of exudyn, pybullet, dart, drake, mujoco, pymunk"
    with pytest.raises(KeyError, match=words):
        engines.get_engine("simbody")


def test_an_absent_engine_says_how_to_install_it_and_a_broken_adapter_does_not_pass_for_absent(monkeypatch, tmp_path):
    (tmp_path / "broken_adapter.py").write_text("import no_such_package")
    monkeypatch.syspath_prepend(tmp_path)
    for name, package in (("absent", "no_such_package"), ("broken", "math")):
        record = Engine(name, package, "pip install it", "#000000", "o", "broken_adapter")
        monkeypatch.setitem(engines.ENGINES, name, record)
    words = "engine 'absent' needs the package no_such_package: pip install it"
    with pytest.raises(EngineNotInstalled, match=words):
        engines.get_engine("absent")
    # only those asked for are looked at
    assert engines.available_engines(["absent"]) == ((), {"absent": words})
    monkeypatch.setattr(engines, "BUILT_IN", ("absent", "broken"))
    with pytest.raises(ModuleNotFoundError, match="no_such_package") as raised:
        engines.available_engines(["absent", "broken"])
    assert not isinstance(raised.value, EngineNotInstalled)


# What an engine prints on import is kept back, and nothing else.


def test_what_else_is_printed_comes_whole_also_where_an_error_is_raised(capfd):
    def speak():
        for number in range(500):
            os.write(2, b"line %d\n" % number)

    speaker = threading.Thread(target=speak)
    with pytest.raises(ImportError), without(b"hello "):
        speaker.start()
        os.write(2, b"hello world\nhelp\n")
        speaker.join()
        print("from Python", file=sys.stderr, flush=True)
        raise ImportError
    out, err = capfd.readouterr()
    lines = [f"line {number}" for number in range(500)]
    assert out == "" and sorted(err.splitlines()) == sorted(["help", "from Python", *lines])


def test_without_a_standard_error_it_is_as_usual():
    program = "import os\nfrom engines.greeting import without\nos.close(2)\nwith without(b'x'):\n    y = 1\nassert y"
    assert subprocess.run([sys.executable, "-c", program], capture_output=True, timeout=60).returncode == 0


# Engines of other packages.


def python(folder, *arguments):
    """The process that ran Python with `folder` among the places of packages."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(folder), os.environ["PYTHONPATH"]])}
    command = [sys.executable, *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=300, env=environment)


def rocking(folder, *arguments):
    return python(folder, "-m", "comparisons", *arguments)


@pytest.fixture(autouse=True)
def unloaded():
    """No test finds what another one has imported."""
    yield
    for name in [name for name in sys.modules if name.startswith("crude_")]:
        del sys.modules[name]


PROGRAM = """
from pathlib import Path
from analytic import Block, Scene, Start, simulate
from comparisons.running.cases import Case
from comparisons.running.executors import Processes
from comparisons.running.sweep import run_sweep
from first import impact
from engines import BROKEN, BUILT_IN, ENGINES, get_engine, installed_engines

if __name__ == "__main__":
    scene = Scene(block=Block(mass=10.0, radius=1.0, slenderness=0.2), start=Start(tilt=0.1), duration=1.5)
    with Processes(2, ["crude", "pybullet"]) as pool:
        rows = run_sweep([Case(scene, solver) for solver in ("analytic", "crude", "pybullet")], measure=impact,
                         executor=pool, store=Path(__file__).with_name("runs.jsonl"), progress=False)
    here = get_engine("crude").simulate(scene)
    assert list(ENGINES) == [*BUILT_IN, "crude"] and installed_engines()[-1] == "crude" and not BROKEN
    assert here.variant == "euler" and "crude is a fake" in map(str, here.warnings)
    assert abs(here.impacts[0].time - simulate(scene).impacts[0].time) < 2e-3
    assert [row.failure for row in rows] == [None, None, None]
    assert rows[1].case.solver == "crude" and rows[1].values["time"] == here.impacts[0].time
"""


def test_an_engine_from_outside_is_one_of_the_engines_here_and_in_workers_which_greet_nobody(tmp_path):
    program = install_fake_engine(tmp_path) / "program.py"
    (tmp_path / "first.py").write_text("def impact(case, response):\n    return {'time': response.impacts[0].time}\n")
    program.write_text(PROGRAM)
    done = python(tmp_path, program)
    assert done.returncode == 0, done.stderr
    assert "build time" not in done.stdout + done.stderr


def test_an_assisted_variant_takes_a_restitution_that_no_couple_reaches(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(install_fake_engine(tmp_path))
    engine = Simulator.of(find_engines(engines.BUILT_IN)[0]["crude"])
    scene = load_scene(RIGID).with_(duration=2.0)
    for given in (0.5 * momentum_restitution(scene), 0.5 + 0.5 * momentum_restitution(scene)):
        first = engine.simulate(scene.with_(block={"restitution": given})).impacts[0]
        assert first.rate_after / first.rate_before == pytest.approx(given, abs=1e-3)


@pytest.mark.slow
def test_the_commands_know_it(tmp_path):
    folder = install_fake_engine(tmp_path)
    listed = rocking(folder, "engines", "crude")
    assert listed.returncode == 0 and " euler " in listed.stdout
    asked = "--engine", "crude", "--json", "-", "--set"
    ran = rocking(folder, "run", RIGID, *asked, "step=1e-3")
    assert ran.returncode == 0, ran.stderr
    found = json.loads(ran.stdout)
    assert (found["engine"], found["outcome"], found["settings"]) == ("crude", "rocks", {"step": 1e-3})
    wrong = rocking(folder, "run", RIGID, *asked, "stop=1")
    assert wrong.returncode == 2 and "crude euler has no setting 'stop'" in wrong.stderr


def changed(old, new):
    assert FAKE_ENGINE.count(old) == 1
    return FAKE_ENGINE.replace(old, new)


ENTRY = "crude_engine:ENGINE"
# what: (entry, its value, source of crude_engine, words, name under which it is kept)
BAD_ENTRIES = {
    "it raises": ("crude", ENTRY, "1 / 0", "it cannot be imported (ZeroDivisionError: ", "crude"),
    "no such attribute": ("crude", "crude_engine:ENGIN", FAKE_ENGINE, "it cannot be imported (AttributeError", "crude"),
    "no engine": ("crude", "crude_engine", FAKE_ENGINE, "it is a module, no engines.contract.Engine", "crude"),
    "another name": ("rude", ENTRY, FAKE_ENGINE, "it calls itself 'crude'", "rude"),
    "a name of ours": (
        "exudyn",
        ENTRY,
        changed('name="crude"', 'name="exudyn"'),
        "that name is taken",
        "exudyn of crude-engine 0.1",
    ),
    "the model's": (
        "analytic",
        ENTRY,
        changed('name="crude"', 'name="analytic"'),
        "that name is taken",
        "analytic of crude-engine 0.1",
    ),
    "no default among levels": (
        "crude",
        ENTRY,
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
    install(tmp_path, "z-engine", {"crude": ENTRY})
    monkeypatch.syspath_prepend(install_fake_engine(tmp_path))
    found, broken = find_engines(engines.BUILT_IN)
    assert list(found) == ["crude"] and "crude-engine 0.1" in found["crude"].origin
    assert list(broken) == ["crude of z-engine 0.1"] and "that name is taken" in str(broken["crude of z-engine 0.1"])


RECORD = """
from engines.contract import Engine
ENGINE = Engine("crude", {package!r}, "pip install it", "#D55E00", "v", "crude_adapter")
"""
NOT_THERE = "'crude' needs the package no_such_package: pip install it"


@pytest.mark.parametrize(
    "package, adapter, error, words",
    [
        ("math", "import no_such_package", EngineBroken, "its module crude_adapter cannot be imported (ModuleNotF"),
        ("math", "VARIANTS = {'euler': 1}", EngineBroken, "crude_adapter.VARIANTS is no dict of engines.contract.Va"),
        (
            "math",
            "from crude_engine import VARIANTS",
            EngineBroken,
            "crude_adapter has no function versions and no run",
        ),
        ("no_such_package", "", EngineNotInstalled, NOT_THERE),
    ],
)
def test_a_broken_or_absent_adapter_from_outside_costs_no_other_engine(
    monkeypatch, tmp_path, package, adapter, error, words
):
    modules = dict(crude_engine=FAKE_ENGINE, crude_record=RECORD.format(package=package), crude_adapter=adapter)
    monkeypatch.syspath_prepend(install(tmp_path, "crude-engine", {"crude": "crude_record:ENGINE"}, **modules))
    found, broken = find_engines(engines.BUILT_IN)
    monkeypatch.setitem(engines.ENGINES, "crude", found["crude"])
    assert broken == {} and "crude" not in engines.available_engines(["crude"])[0]
    with pytest.raises(error) as caught:
        engines.get_engine("crude")
    assert words in str(caught.value)
    declared = "engine 'crude', " + BY.format("crude_record:ENGINE", "crude-engine")
    assert error is EngineNotInstalled or str(caught.value).startswith(declared + words)


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
    packages = install(tmp_path, "crude-engine", {"crude": ENTRY}, crude_engine=source)
    monkeypatch.syspath_prepend(packages)
    engine = Simulator.of(find_engines(engines.BUILT_IN)[0]["crude"])
    with pytest.raises(TypeError) as caught:
        engine.simulate(load_scene(RIGID))
    line = next(number for number, text in enumerate(source.split("\n"), 1) if place in text)
    told, place = raised(caught.value), f"(in crude_engine, line {line})"
    assert told.startswith(words) and told.endswith(place)
    if source is HELPED:
        ran = rocking(packages, "run", RIGID, "--engine", "crude", "--json", "-")
        assert ran.returncode == 1 and f"crude failed: the run raised an error. {words}" in ran.stderr
        assert place in ran.stderr and str(packages) not in ran.stderr


@pytest.mark.slow  # all engines are loaded to be listed
@pytest.mark.parametrize(
    "old, new, words",
    [
        ('{"crude-engine": "0.1"}', "1 / 0", "crude_engine.versions fails"),
        ('{"crude-engine": "0.1"}', "'0.1'", "crude_engine.versions fails"),
        ("import math", "import no_such_package", BY.format(ENTRY, "crude-engine") + "it cannot be imported"),
    ],
)
def test_the_commands_name_a_broken_one_in_one_message(tmp_path, old, new, words):
    packages = install(tmp_path, "crude-engine", {"crude": ENTRY}, crude_engine=changed(old, new))
    asked = rocking(packages, "run", RIGID, "--engine", "crude")
    assert asked.returncode == 2 and "Traceback" not in asked.stderr
    assert asked.stderr.startswith("Error: engine 'crude'") and words in asked.stderr
    listed = rocking(packages, "engines", *["crude"] * ("versions" in words))
    assert words in listed.stdout + listed.stderr
    assert "versions" in words or all(name in listed.stdout for name in engines.BUILT_IN)
