"""What every engine and each of its variants must fulfil; an engine is covered by its folder in `engines`.

They are found by name, here and in other packages; an absent one is told from a broken one, which is named. Each way
that an engine's process can end badly is provoked; the test module is what that process imports.

What their blocks do is in `test_physics`.
"""

import faulthandler
import itertools
import json
import math
import os
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, fields, is_dataclass, replace
from importlib import metadata

import numpy as np
import pytest
from engine_cases import ACCURATE, PULSE, VARIANTS, default_variant, every_variant, scene, shaking, simulate
from installed_package import FAKE_ENGINE, install, install_fake_engine

import engines
from analytic import SceneError, SettingError, Start, load_scene
from analytic import simulate as exact
from analytic.errors import EngineBroken, EngineNotInstalled
from analytic.response import History
from analytic.rocking import momentum_restitution
from analytic.scene import BEARINGS
from engines import ENGINES, get_engine, guard
from engines.contract import KINDS, Engine, find_engines
from engines.guard import OUT_OF_TIME, check_time_limit, raised, run_apart, without
from engines.simulating import Simulator

# What an engine's record holds, and what it refuses.


@default_variant
def test_record_holds_what_the_contract_names(engine, variant):
    record = get_engine(engine)
    assert record is ENGINES[engine] and record.installed and engines.available_engines([engine]) == ((engine,), {})
    # those that tests are drawn from
    assert set(VARIANTS[engine]) == set(record.variants) and variant == record.default_variant
    assert tuple(VARIANTS) == engines.BUILT_IN
    for name, choice in record.variants.items():
        assert choice.kind == ("defaults" if name in ("first-script", "native-contact") else "tuned")
    assert (engine in ACCURATE) == (record.variants[variant].kind == "tuned")
    for choice in record.variants.values():
        assert is_dataclass(choice.settings) and choice.settings.__dataclass_params__.frozen
        assert fields(choice.settings) and all(0 < value < math.inf for value in asdict(choice.settings).values())
        assert choice.kind in KINDS and choice.computes and choice.imposes and (choice.calls or not record.subject)
        down = sorted(choice.levels, reverse=True)  # from coarse to fine; of a stiffness the finer is the larger
        assert (
            list(choice.levels) == (down[::-1] if choice.accuracy_parameter == "stiffness" else down)
            and len(choice.levels) > 1
        )
    # A package that is one compiled module stands in no list before Python 3.12; it has the distribution's name.
    (distribution, *_) = metadata.packages_distributions().get(record.package, [record.package])
    assert record.versions()[record.package] == metadata.version(distribution)


SUBJECTS = tuple(name for name, engine in ENGINES.items() if engine.subject)
OTHERS = tuple(name for name in ENGINES if name not in SUBJECTS)
IMPORTED = """
import sys
from engines import ENGINES, get_engine
for name in NAMES:
    record = ENGINES[name]
    assert record.package not in sys.modules and record.adapter not in sys.modules
    if record.installed:
        get_engine(name)
        assert sys.modules[record.package] is not sys.modules["engines." + name]
        assert "engines" not in (sys.modules[record.package].__file__ or "")
"""


@pytest.mark.parametrize("names", [SUBJECTS, OTHERS], ids="-".join)
def test_records_are_light_and_shadow_no_package_and_importing_an_engine_prints_nothing(names):
    """The folder of an engine here has the name of the package it uses."""
    program = IMPORTED.replace("NAMES", repr(names))
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=120)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


@every_variant
def test_unknown_variants_and_settings_are_refused_and_the_known_ones_are_named(engine, variant):
    record = get_engine(engine)
    with pytest.raises(SettingError, match=f"'best'.*: choose one of {', '.join(record.variants)}$"):
        simulate(engine, "best", scene(0.2))
    known = [field.name for field in fields(record.variants[variant].settings)]
    with pytest.raises(SettingError, match=f"{engine} {variant}.* 'steep'.*: .* {', '.join(known)}$"):
        simulate(engine, variant, scene(0.2), steep=1e-3)
    for name, value in itertools.product(known, [0.0, -1.0, math.nan, math.inf, True, "1", None]):
        with pytest.raises(SettingError, match=f"{name} = {value!r} .*positive number"):
            simulate(engine, variant, scene(0.2), **{name: value})


@every_variant
def test_given_restitution_is_refused_or_kept_but_never_ignored(engine, variant):
    given = scene(0.2, duration=0.8, start=Start(tilt=0.12)).with_(block={"restitution": 0.7})
    record = get_engine(engine).variants[variant]
    if record.takes_restitution:
        first = simulate(engine, variant, given).impacts[0]
        assert first.rate_after / first.rate_before == pytest.approx(0.7, abs=2e-3)  # by a couple, see test_physics
    else:
        with pytest.raises(SceneError) as caught:
            simulate(engine, variant, given)
        assert caught.value.key == "block.restitution" and caught.value.value == 0.7


# What the response holds.


@every_variant
def test_response_says_what_ran_and_what_it_cost(engine, variant):
    record, given = get_engine(engine), scene(0.2, 212.0, 0.3, start=Start(tilt=0.12))
    clock = time.process_time()
    response = simulate(engine, variant, given)
    spent = time.process_time() - clock
    assert (response.engine, response.variant, response.scene) == (engine, variant, "contract")
    assert response.versions == record.versions() and response.settings == asdict(record.variants[variant].settings)
    assert 0 < response.cpu_seconds <= spent and response.steps > 1
    assert response.failure is None and response.to_json()["outcome"] == "rocks"
    np.testing.assert_allclose(response.history.time, np.linspace(0, 0.3, 2001), rtol=0, atol=1e-12)
    if variant == record.default_variant:
        again = record.simulate(given, history=False)
        assert again.history is None
        assert (again.end, again.impacts, again.peak_tilt) == (response.end, response.impacts, response.peak_tilt)


@every_variant
def test_every_setting_can_be_replaced_and_a_scenes_friction_comes_first(engine, variant):
    settings, given = get_engine(engine).variants[variant].settings, scene(0.2, duration=0.02, start=Start(tilt=0.12))
    for field in fields(settings):
        change = {field.name: 0.8 * getattr(settings, field.name)}
        assert simulate(engine, variant, given, **change).settings == asdict(replace(settings, **change))
        if field.name == "friction":
            assert simulate(engine, variant, given.with_(friction=0.7), **change).settings["friction"] == 0.7


# The error 0.1 s after a start in flight: tilt [rad], its rate [rad/s], base displacement [m]. The second is of
# variants that no accuracy is asked of; without its initial velocities a run would be 0.03 rad or 0.01 m off.
IN_FLIGHT, IN_FLIGHT_ROUGHLY = (8.8e-7, 1.5e-5, 1.4e-6), (1e-3, 1e-2, 1e-3)
# A block that begins where it touches, and has to sink 1 mm before it is carried.
IN_FLIGHT_SINKING = {("drake", "first-script"): (9e-3, 2e-2, 9e-3)}


@every_variant
def test_start_in_flight(engine, variant):
    start = Start(tilt=0.1, tilt_rate=0.3, base_displacement=0.02, base_velocity=-0.1)
    given = scene(0.3, 212.0, 0.1, bearings=BEARINGS, start=start)
    response, reference = simulate(engine, variant, given), exact(given)
    for name in History.COLUMNS:
        assert getattr(response.history, name)[0] == getattr(reference.history, name)[0], name
    accurate = ACCURATE.get(engine) == variant
    bounds = IN_FLIGHT if accurate else IN_FLIGHT_SINKING.get((engine, variant), IN_FLIGHT_ROUGHLY)
    for name, bound in zip(("tilt", "tilt_rate", "base_displacement"), bounds, strict=True):
        assert abs(getattr(response.end, name) - getattr(reference.end, name)) < bound, name


@every_variant
def test_ground_motion_that_is_not_finite_fails_with_the_last_finite_state(engine, variant, monkeypatch, tmp_path):
    """Behind the reader's back the record turns to NaN: what the engine makes of it must surface, and leave no log."""
    monkeypatch.chdir(tmp_path)
    motion = shaking(0.5)
    samples = motion.samples.copy()
    samples[50:] = math.nan
    object.__setattr__(motion, "samples", samples)
    given = scene(0.2, 212.0, bearings=BEARINGS, motion=motion)
    response = simulate(engine, variant, given)
    assert response.outcome == "failed"
    assert response.failure.reason and response.failure.message
    state = response.failure.last_state
    assert all(math.isfinite(value) for value in asdict(state).values())
    assert 0.48 < state.time < 0.5 and response.end == state
    assert all(np.isfinite(getattr(response.history, name)).all() for name in History.COLUMNS[:-1])
    assert response.settings and response.versions and response.cpu_seconds > 0
    assert list(tmp_path.iterdir()) == []  # no MUJOCO_LOG.TXT


# Repeatable and symmetric.


@default_variant
def test_runs_repeat_bit_for_bit_also_in_other_processes(engine, variant):
    given = scene(0.15, 212.0, 0.6, bearings=BEARINGS, motion=PULSE)
    first, second = (simulate(engine, variant, given) for _ in range(2))
    with ThreadPoolExecutor(2) as two:  # two at once
        apart = list(two.map(lambda _: guard.run_apart(simulate, engine, variant, given, time_limit=120.0), range(2)))
    for there in (second, *(run for run, _ in apart)):
        assert (first.end, first.impacts) == (there.end, there.impacts)
        assert all(
            np.array_equal(getattr(first.history, column), getattr(there.history, column)) for column in History.COLUMNS
        )


def test_all_else_works_where_no_engine_is_installed():
    missing = list(ENGINES)
    program = f"""
import sys
missing = {missing!r}
from engines import ENGINES, available_engines
for name in missing:
    sys.modules[ENGINES[name].package] = None  # what Python does for a package that cannot be imported
present, why = available_engines()
assert not set(missing) & set(present) and all(ENGINES[name].install in why[name] for name in missing), why
from comparisons.cli import main
main(["compare", "free-rocking-isolated"])
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    assert "analytic" in done.stdout and not any(name in done.stdout for name in missing)


# What the kind and the record of a variant say of it.


FORMULA = """
import hashlib, json, sys
import analytic.rocking

factor, right, impact = float(sys.argv[1]), analytic.rocking.momentum_restitution, analytic.rocking.RockingModel.impact
# before an adapter is imported
analytic.rocking.momentum_restitution = lambda scene: factor * right(scene)
analytic.rocking.RockingModel.impact = lambda self, *rates: tuple(factor * value for value in impact(self, *rates))

from analytic import Base, Bearings, Block, PulseMotion, Scene, Start
from engines import get_engine

block = Block(mass=3172.05, radius=1.0884, slenderness=0.3)
bearings = Bearings(count=4, ka=6.22e4, kb=6.22e3, alpha=44.69, damping=300.0)
pulse = PulseMotion("one-sine", 6.0, 6.0)
start = Start(tilt=0.1)
scene = Scene(block=block, base=Base(mass=900.0), bearings=bearings, motion=pulse, start=start, duration=0.6)
found = {}
for name in sys.argv[2:]:
    engine = get_engine(name)
    for variant, kind in engine.variants.items():
        digest = hashlib.sha256()
        trace = engine.run(scene, variant, kind.settings).trace
        for column in (*trace.COLUMNS, "centre"):
            values = getattr(trace, column)
            digest.update(b"" if values is None else values.tobytes())
        found[f"{name}, {variant}"] = kind.kind, digest.hexdigest()
print(json.dumps(found))
"""


@pytest.mark.slow
@pytest.mark.parametrize("names", [SUBJECTS, OTHERS], ids="-".join)
def test_only_assisted_variants_use_the_formula_of_the_restitution(tmp_path, names):
    """Of the engines here none; the fake one does, which shows that its use is seen."""
    path = os.pathsep.join([str(install_fake_engine(tmp_path)), os.environ["PYTHONPATH"]])
    results = []
    for factor in ("1.0", "0.8"):
        command = [sys.executable, "-c", FORMULA, factor, "crude", *names]
        done = subprocess.run(
            command, capture_output=True, text=True, timeout=600, env={**os.environ, "PYTHONPATH": path}
        )
        assert done.returncode == 0, done.stderr
        results.append(json.loads(done.stdout.splitlines()[-1]))
    right, wrong = results
    assisted = {name for name, (kind, _) in right.items() if kind == "assisted"}
    assert {name for name in right if right[name] != wrong[name]} == assisted == {"crude, euler"}


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
    lines = "help\n" + "line\n" * 20_000  # more than a pipe holds
    with pytest.raises(ImportError), without(b"hello "):
        os.write(2, b"hello world\n" + lines.encode())
        print("from Python", file=sys.stderr, flush=True)
        raise ImportError
    out, err = capfd.readouterr()
    assert out == "" and sorted(err.splitlines()) == sorted([*lines.splitlines(), "from Python"])


def test_without_a_standard_error_it_is_as_usual():
    program = "import os\nfrom engines.guard import without\nos.close(2)\nwith without(b'x'):\n    y = 1\nassert y"
    assert subprocess.run([sys.executable, "-c", program], capture_output=True, timeout=60).returncode == 0


# Engines of other packages.


def python(folder, *arguments):
    """The process that ran Python with `folder` among the places of packages."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(folder), os.environ["PYTHONPATH"]])}
    command = [sys.executable, *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=300, env=environment)


@pytest.fixture(autouse=True)
def unloaded():
    """No test finds what another one has imported."""
    yield
    for name in [name for name in sys.modules if name.startswith("crude_")]:
        del sys.modules[name]


PROGRAM = """
from pathlib import Path
from analytic import Block, Scene, Start, simulate
from comparisons.execution.cases import Case
from comparisons.execution.sweep import Processes
from comparisons.execution.sweep import run_sweep
from first import impact
from engines import BROKEN, BUILT_IN, ENGINES, get_engine, installed_engines

if __name__ == "__main__":
    scene = Scene(block=Block(mass=10.0, radius=1.0, slenderness=0.2), start=Start(tilt=0.1), duration=1.5)
    with Processes(1, ["crude", "pybullet"]) as pool:
        rows = run_sweep([Case(scene, solver) for solver in ("analytic", "crude", "pybullet")], measure=impact,
                         executor=pool, store=Path(__file__).with_name("runs.jsonl"), progress=False)
    here = get_engine("crude").simulate(scene)
    assert list(ENGINES) == [*BUILT_IN, "crude"] and installed_engines()[-1] == "crude" and not BROKEN
    assert here.variant == "euler" and "crude is a fake" in map(str, here.warnings)
    assert abs(here.impacts[0].time - simulate(scene).impacts[0].time) < 2e-3
    assert [row.failure for row in rows] == [None, None, None]
    assert rows[1].case.solver == "crude" and rows[1].values["time"] == here.impacts[0].time
"""


@pytest.mark.slow
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
    usable, broken = find_engines(engines.BUILT_IN)
    assert usable == {} and list(broken) == [key]
    assert str(broken[key]).startswith(f"engine {name!r}, " + BY.format(value, "crude-engine") + words)


def test_two_packages_with_one_name_keep_the_first(monkeypatch, tmp_path):
    install(tmp_path, "z-engine", {"crude": ENTRY})
    monkeypatch.syspath_prepend(install_fake_engine(tmp_path))
    usable, broken = find_engines(engines.BUILT_IN)
    assert list(usable) == ["crude"] and "crude-engine 0.1" in usable["crude"].origin
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
    usable, broken = find_engines(engines.BUILT_IN)
    monkeypatch.setitem(engines.ENGINES, "crude", usable["crude"])
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
    monkeypatch.syspath_prepend(install(tmp_path, "crude-engine", {"crude": ENTRY}, crude_engine=source))
    engine = Simulator.of(find_engines(engines.BUILT_IN)[0]["crude"])
    with pytest.raises(TypeError) as caught:
        engine.simulate(load_scene(RIGID))
    line = next(number for number, text in enumerate(source.split("\n"), 1) if place in text)
    text = raised(caught.value)
    assert text.startswith(words) and text.endswith(f"(in crude_engine, line {line})")


@pytest.mark.slow  # all engines are loaded to be listed
@pytest.mark.parametrize(
    "old, new, words",
    [
        ('{"crude-engine": "0.1"}', "1 / 0", "crude_engine.versions fails"),
        pytest.param(
            "import math",
            "import no_such_package",
            BY.format(ENTRY, "crude-engine") + "it cannot be imported",
            marks=pytest.mark.long,
        ),
    ],
)
def test_the_commands_name_a_broken_one_in_one_message(tmp_path, old, new, words):
    packages = install(tmp_path, "crude-engine", {"crude": ENTRY}, crude_engine=changed(old, new))
    completed = python(packages, "-m", "comparisons", "run", RIGID, "--engine", "crude")
    assert completed.returncode == 2 and "Traceback" not in completed.stderr
    *_, message = completed.stderr.splitlines()  # a slow machine says before that the model is compiled
    assert message.startswith("Error: engine 'crude'") and words in message
    listed = python(packages, "-m", "comparisons", "engines", *["crude"] * ("versions" in words))
    assert words in listed.stdout + listed.stderr
    assert "versions" in words or all(name in listed.stdout for name in engines.BUILT_IN)


def hang():
    time.sleep(60.0)


def speak():
    os.write(1, b"engine: assertion failed in contact\n")
    os.abort()


def unsendable():
    return lambda: None


def interrupted():
    raise KeyboardInterrupt


def ignores_ctrl_c():
    signal.raise_signal(signal.SIGINT)
    return "went on"


def err():
    raise RuntimeError("Newton did not converge at 0.25 s")


def wrong_setting():
    raise SettingError("step = 0.001: unknown")


@pytest.mark.parametrize(
    "run, arguments, limit, evidence",
    [
        (hang, (), 1.0, "in hang"),  # where it hung
        (speak, (), 30.0, "assertion failed in contact"),
        (unsendable, (), 30.0, "pickle"),
        (interrupted, (), 30.0, "KeyboardInterrupt"),
        (faulthandler._sigsegv, (), 30.0, "SIGSEGV"),
        (os._exit, (3,), 30.0, "exit code 3"),
        (signal.raise_signal, (signal.SIGKILL,), 30.0, "SIGKILL"),
        (err, (), 30.0, "RuntimeError: Newton did not converge at 0.25 s"),
    ],
)
def test_a_run_that_ends_badly_is_a_failure_with_evidence(run, arguments, limit, evidence):
    began = time.monotonic()
    value, failure = run_apart(run, *arguments, time_limit=limit)
    assert time.monotonic() - began < limit + 5
    assert value is None and evidence in failure.message
    assert (failure.reason == OUT_OF_TIME) == (run is hang)


def test_ctrl_c_is_the_parents_to_handle_and_a_wrong_setting_the_callers_mistake():
    assert run_apart(ignores_ctrl_c, time_limit=60.0) == ("went on", None)
    with pytest.raises(SettingError, match="step"):
        run_apart(wrong_setting, time_limit=30.0)


@pytest.mark.parametrize("limit", [0.0, -1.0, float("nan"), 2e6])
def test_a_time_limit_that_no_timer_takes_is_refused(limit):
    with pytest.raises(ValueError, match="time_limit"):
        check_time_limit(limit)
