"""The playground's equations in JavaScript give the compiled kernel's numbers."""

import dataclasses

import numpy as np
import pytest
from javascript import evaluate

from analytic import Base, Bearings, Block, PulseMotion, Scene, Start, overturning_map, simulate, synthetic_motion
from analytic.checks.time_stepping import simulate_time_stepping
from analytic.scene import MASS, RADIUS
from comparisons.lessons.export import sources

BEARINGS = {
    "rigid": None,
    "caryatid": {"mass": 212.0, "count": 4, "ka": 6.22e4, "kb": 6.22e3, "alpha": 44.69},
    "heavy": {"mass": 800.0, "count": 4, "ka": 1.2e5, "kb": 2e4, "alpha": 10.0},
}
DURATIONS = {  # [s] by (kind, amplitude [m/s2], period [s]), (kind, scale), None: released
    ("pulse", 3.0, 0.5): 6.0,
    ("pulse", 5.0, 0.8): 6.0,
    ("pulse", 8.0, 1.2): 6.0,
    ("pulse", 12.0, 0.4): 6.0,
    ("synthetic", 1.0): 25.0,
    None: 6.0,
}
MOTIONS = list(DURATIONS)
GRID = [(gamma, base, motion) for gamma in (0.15, 0.28, 0.4) for base in BEARINGS for motion in MOTIONS]
AGREEMENT = 1e-9  # of every number, in units of its largest
OUTPUT_STEP = 0.05  # s

TO_SCENE = """
const given = (c) => Scene.parameters({ slenderness: c.slenderness, radius: c.radius, mass: c.mass, base: c.base,
  restitution: null, start: c.start });
const shaken = (m) => !m ? Scene.quiet() : m[0] === "pulse" ? Scene.pulse(m[1], m[2])
  : Scene.sampled(DATA.samples, DATA.dt, m[1]);
"""


def case_of(gamma, base, motion):
    start = 0.0 if motion else 0.6 * gamma
    return dict(slenderness=gamma, radius=RADIUS, mass=MASS, base=BEARINGS[base], motion=motion, start=start)


def scene_of(gamma, base, motion, duration):
    rubber = dict(BEARINGS[base] or {})
    mass, shaking = rubber.pop("mass", None), motion and synthetic_motion()
    if motion and motion[0] == "pulse":
        shaking = PulseMotion("one-sine", motion[1], 2 * np.pi / motion[2])
    return Scene(
        block=Block(mass=MASS, radius=RADIUS, slenderness=gamma),
        base=mass and Base(mass=mass),
        bearings=Bearings(**rubber) if rubber else None,
        motion=shaking,
        start=Start(tilt=0.0 if motion else 0.6 * gamma),
        duration=duration,
    )


def data(**more):
    motion = synthetic_motion()
    return {"samples": motion.samples.tolist(), "dt": motion.dt, **more}


@pytest.fixture(scope="module")
def runs():
    cases = [{**case_of(*case), "duration": DURATIONS[case[2]]} for case in GRID]
    results = evaluate(
        sources() + TO_SCENE,
        f"DATA.cases.map((c) => Model.simulate(given(c), shaken(c.motion), "
        f"{{ duration: c.duration, outputStep: {OUTPUT_STEP} }}))",
        data(cases=cases),
    )
    return dict(zip(GRID, results, strict=True))


@pytest.mark.parametrize("gamma", [0.15, 0.28, 0.4])
@pytest.mark.parametrize("base", BEARINGS)
def test_a_run_is_the_kernels(runs, gamma, base):
    for motion in MOTIONS:
        run, scene = runs[gamma, base, motion], scene_of(gamma, base, motion, DURATIONS[motion])
        response = simulate(scene, output_step=OUTPUT_STEP)
        history = response.history
        states = np.column_stack([getattr(history, name) for name in history.COLUMNS[:-1]])
        rows = np.array(run["rows"])  # the kernel's end with the last state
        size = np.maximum(np.abs(states).max(0), [1, gamma, 1, 1e-3, 1e-2, 1])
        np.testing.assert_allclose(rows / size, states[: len(rows)] / size, rtol=0, atol=AGREEMENT)
        assert len(states) - len(rows) <= 1
        assert run["outcome"] == response.outcome
        known = {
            "peakTilt": response.peak_tilt,
            "peakX": response.peak_base_displacement,
            "impacts": [dataclasses.astuple(impact) for impact in response.impacts],
            "uplifts": response.uplifts,
            "rests": response.rests,
        }
        for name, values in known.items():
            np.testing.assert_allclose(run[name], values, rtol=0, atol=AGREEMENT, err_msg=name)


def test_the_grid_holds_every_outcome(runs):
    assert {run["outcome"] for run in runs.values()} == {"stands", "rocks", "overturns"}
    # of one that falls on a base, the playground leaves out what the fall adds to the displacement, as the kernel does
    falls = [run for (_, base, _), run in runs.items() if base != "rigid" and run["outcome"] == "overturns"]
    assert any(max(abs(row[3]) for row in run["rows"]) > 1.01 * run["peakX"] for run in falls)


@pytest.mark.parametrize("base", ["rigid", "caryatid"])
def test_the_map_is_the_kernels(base):
    periods, amplitudes, gamma = np.linspace(0.3, 1.7, 8), np.linspace(1.0, 15.0, 8), 0.28
    axes = [  # cells, with these values in their middle
        {"key": "period", "low": 0.2, "high": 1.8, "unit": 1},
        {"key": "amplitude", "low": 0.0, "high": 16.0, "unit": 1},
    ]
    job = {
        "kind": "band",
        "scene": {**case_of(gamma, base, MOTIONS[0]), "restitution": None},
        "motion": {"kind": "pulse", "amplitude": 1.0, "period": 1.0},
        "axes": axes,
        **{"nx": 8, "ny": 8, "from": 0, "to": 8},
    }
    cells = evaluate(sources(), "Array.from(Jobs.run(DATA).cells)", job)
    scene = scene_of(gamma, base, None, None).with_(start=Start())
    frequencies = 2 * np.pi / periods / scene.rocking_frequency
    outcomes = overturning_map(scene, "one-sine", frequencies, amplitudes / scene.gravity / np.tan(gamma), workers=1)
    kinds = np.where(outcomes.overturns, np.where(outcomes.impacts > 0, 3, 2), np.where(outcomes.lifted, 1, 0))
    assert np.array(cells).reshape(8, 8).tolist() == kinds.tolist()
    assert len(np.unique(kinds)) >= 3


@pytest.mark.parametrize("base", ["rigid", "caryatid"])
@pytest.mark.parametrize("motion", [MOTIONS[1], None])
def test_long_steps_are_those_of_the_time_stepping(base, motion):
    run = evaluate(
        sources() + TO_SCENE,
        "Engines.straddling(given(DATA.case), shaken(DATA.case.motion), { step: 5e-3, duration: 3 })",
        data(case=case_of(0.28, base, motion)),
    )
    history = simulate_time_stepping(scene_of(0.28, base, motion, 3.0), step=5e-3).history
    known = np.column_stack([1e3 * history.time, history.tilt, history.base_displacement])
    rows = np.array(run["rows"])[:, [0, 1, 3]] * [1e3, 1, 1]
    np.testing.assert_allclose(rows, known, rtol=0, atol=AGREEMENT)


@pytest.mark.parametrize("base", ["rigid", "caryatid"])
def test_soft_corners_tend_to_the_model(base):
    """No restitution is given: the second swing tells what came out. The error is of the first order in the sink."""
    sinks = [4e-4, 2e-4, 1e-4]
    tops = evaluate(
        sources() + TO_SCENE,
        """((par, ground) => [
              ...DATA.sinks.map((sink) => Engines.soft(par, ground, { sink, duration: 1.6, every: 2e-3 })),
              Model.simulate(par, ground, { duration: 1.6, outputStep: 2e-3 }),
            ].map((run) => Math.max(...run.rows.map((row) => -row[1]))))(given(DATA.case), Scene.quiet())""",
        data(case=case_of(0.28, base, None), sinks=sinks),
    )
    errors = 1 - np.array(tops[:-1]) / tops[-1]
    assert (errors > 0).all()
    assert errors[2] < 0.02
    np.testing.assert_allclose(errors[:-1] / errors[1:], 2.0, rtol=0.25)
