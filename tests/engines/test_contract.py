"""What every engine and each of its variants must fulfil; an engine is covered by its folder in `engines`.

What their blocks do is in `test_physics`.
"""

import itertools
import json
import math
import os
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, fields, is_dataclass, replace
from importlib import metadata

import numpy as np
import pytest
from engine_cases import ACCURATE, PULSE, VARIANTS, default_variant, every_variant, scene, shaking, simulate
from installed_package import install_fake_engine

import engines
from analytic import SceneError, SettingError, Start
from analytic import simulate as exact
from analytic.caryatid import BEARINGS
from analytic.response import History
from engines import ENGINES, get_engine, guard
from engines.contract import KINDS

# What an engine's record holds, and what it refuses.


@default_variant
def test_record_holds_what_the_contract_names(engine, variant):
    record = get_engine(engine)
    assert record is ENGINES[engine] and record.installed and engines.available_engines([engine]) == ((engine,), {})
    # those that tests are drawn from
    assert set(VARIANTS[engine]) == set(record.variants) and variant == record.default_variant
    assert tuple(VARIANTS) == engines.BUILT_IN
    for name, own in record.variants.items():
        assert own.kind == ("defaults" if name in ("first-script", "native-contact") else "tuned")
    assert (engine in ACCURATE) == (record.variants[variant].kind == "tuned")
    for one in record.variants.values():
        assert is_dataclass(one.settings) and one.settings.__dataclass_params__.frozen
        assert fields(one.settings) and all(0 < value < math.inf for value in asdict(one.settings).values())
        assert one.kind in KINDS and one.computes and one.imposes and (one.calls or not record.subject)
        down = sorted(one.levels, reverse=True)  # from coarse to fine; of a stiffness the finer is the larger
        assert (
            list(one.levels) == (down[::-1] if one.accuracy_parameter == "stiffness" else down) and len(one.levels) > 1
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
    own = get_engine(engine).variants[variant]
    if own.takes_restitution:
        first = simulate(engine, variant, given).impacts[0]
        assert first.rate_after / first.rate_before == pytest.approx(0.7, abs=2e-3)  # by a couple, see test_couple
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
@pytest.mark.parametrize("start, base", [(0.1, None), (0.0, 212.0)])
def test_ground_motion_that_is_not_finite_fails_with_the_last_finite_state(
    engine, variant, start, base, monkeypatch, tmp_path
):
    """Behind the reader's back the record turns to NaN: what the engine makes of it must surface, and leave no log."""
    monkeypatch.chdir(tmp_path)
    motion = shaking(0.5)
    samples = motion.samples.copy()
    samples[50:] = math.nan
    object.__setattr__(motion, "samples", samples)
    given = scene(0.2, base, bearings=BEARINGS if base else None, start=Start(tilt=start), motion=motion)
    response = simulate(engine, variant, given)
    assert response.outcome == "failed"
    assert response.failure.reason and response.failure.message
    state = response.failure.last_state
    assert all(math.isfinite(value) for value in asdict(state).values())
    assert 0.48 < state.time < 0.5 and response.end == state
    assert all(np.isfinite(getattr(response.history, name)).all() for name in History.COLUMNS[:-1])
    assert response.settings and response.versions and response.cpu_seconds > 0
    assert list(tmp_path.iterdir()) == []  # no MUJOCO_LOG.TXT


@default_variant
def test_hang_ends_at_the_time_limit(engine, variant):
    endless = scene(0.2, duration=3e3, start=Start(tilt=0.12))
    _, failure = guard.run_apart(simulate, engine, variant, endless, time_limit=3.0)
    assert failure.reason == guard.OUT_OF_TIME


# Repeatable and symmetric.


def in_every_variant(engine, given):
    """What the guarded process runs."""
    return [simulate(engine, variant, given) for variant in get_engine(engine).variants]


@default_variant
def test_runs_repeat_bit_for_bit_also_in_other_processes(engine, variant):
    given = scene(0.15, 212.0, 0.6, bearings=BEARINGS, motion=PULSE)
    first, second = (in_every_variant(engine, given) for _ in range(2))
    with ThreadPoolExecutor(2) as two:  # two at once
        elsewhere = list(
            two.map(lambda _: guard.run_apart(in_every_variant, engine, given, time_limit=120.0), range(2))
        )
    for repeated in (second, *(runs for runs, _ in elsewhere)):
        for here, there in zip(first, repeated, strict=True):
            assert (here.variant, here.end, here.impacts) == (there.variant, there.end, there.impacts)
            assert all(
                np.array_equal(getattr(here.history, name), getattr(there.history, name)) for name in History.COLUMNS
            )


@pytest.mark.parametrize(
    "present", [pytest.param(("exudyn",), id="one"), pytest.param((), id="none", marks=pytest.mark.slow)]
)
def test_all_else_works_where_engines_are_not_installed(present):
    missing = [name for name in ENGINES if name not in present]
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
scenes = [
    Scene(block=block, base=Base(mass=212.0), start=Start(tilt=0.15), duration=0.7),
    Scene(block=block, base=Base(mass=900.0), bearings=bearings, motion=pulse, duration=0.7),
]
found = {}
for name in sys.argv[2:]:
    engine = get_engine(name)
    for variant, kind in engine.variants.items():
        digest = hashlib.sha256()
        for scene in scenes:
            trace = engine.run(scene, variant, kind.settings).trace
            for column in (*trace.COLUMNS, "centre"):
                values = getattr(trace, column)
                digest.update(b"" if values is None else values.tobytes())
        found[f"{name}, {variant}"] = kind.kind, digest.hexdigest()
print(json.dumps(found))
"""


@pytest.mark.parametrize("names", [SUBJECTS, OTHERS], ids="-".join)
def test_only_assisted_variants_use_the_formula_of_the_restitution(tmp_path, names):
    """Of the engines here none; the fake one does, which shows that its use is seen."""
    path = os.pathsep.join([str(install_fake_engine(tmp_path)), os.environ["PYTHONPATH"]])
    found = []
    for factor in ("1.0", "0.8"):
        command = [sys.executable, "-c", FORMULA, factor, "crude", *names]
        done = subprocess.run(
            command, capture_output=True, text=True, timeout=600, env={**os.environ, "PYTHONPATH": path}
        )
        assert done.returncode == 0, done.stderr
        found.append(json.loads(done.stdout.splitlines()[-1]))
    right, wrong = found
    assisted = {name for name, (kind, _) in right.items() if kind == "assisted"}
    assert {name for name in right if right[name] != wrong[name]} == assisted == {"crude, euler"}
