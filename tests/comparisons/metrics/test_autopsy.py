"""The story of one contact: its impulses are the momentum's, its parts add up to the error of e."""

import dataclasses
import itertools
import json

import numpy as np
import pytest
from engine_cases import released
from sampled_traces import BASE, SCENES, sampled

from analytic import simulate
from analytic.rocking import restitution
from comparisons.ensembles import random_scene
from comparisons.metrics.agreement import Unmeasurable
from comparisons.metrics.autopsy import (
    CAUSES,
    LEAST,
    PARTS,
    cause_of,
    contact_of,
    corner_impulses,
    corner_motion,
    diagnosis,
    frames,
)
from engines import get_engine
from engines.events import contact_measures
from engines.loads import size_scale
from engines.loop import FixedStep, run_of
from engines.swings import Trace
from engines.trace_checks import pivoting_centre

GROUNDS = {"rigid ground": None, "sliding base": BASE}


def fixed_steps(scene, step, change=None):
    """The trace of pymunk's tuned scene in equal steps [s]; change(space, block's body, scene) spoils its space."""
    from engines.pymunk.adapter import ChipmunkBodies

    def bodies(largest):
        made = ChipmunkBodies(scene, largest, plain=False)
        if change:
            change(made.space, made.block, scene)
        return made

    trace = run_of(scene, FixedStep(step / size_scale(scene)), bodies, lambda rows: None).trace
    if change is None:
        return trace
    # a spoilt corner is met after it has sunk: what a block passes in a step or two, so often of gamma a second
    return dataclasses.replace(trace, contact_tilt=10.0 * step * scene.block.slenderness)


def exact(name, mean_step=2e-3, **changes):
    scene = SCENES[name].with_(**changes)
    trace, _ = sampled(scene, mean_step)
    return scene, dataclasses.replace(trace, centre=pivoting_centre(scene, trace))


def run(engine, variant, scene, **settings):
    return contact_of(scene, get_engine(engine).traced(scene, variant=variant, history=False, **settings)[1])


@pytest.mark.parametrize("name", SCENES)
def test_exact_motion_has_no_part_wherever_the_steps_fall(name):
    """A step straddles each impact, by up to 5 ms: what it holds is told apart to a fiftieth of what it could be."""
    scene, trace = exact(name)
    for which in range(3):
        contact = contact_of(scene, trace, which)
        assert abs(contact.error) < 1e-8
        assert all(abs(contact.parts[part]) < 0.02 * contact.phase for part in (*PARTS, "shape")), contact.parts
        assert abs(contact.parts["flight"]) < 3e-4  # by the trapezoidal rule over the bearings' force


@pytest.mark.parametrize("name", ["rigid ground", "sliding base"])
def test_impulse_of_the_landing_corner_turns_the_fall_of_the_centre_into_a_rise(name):
    scene, trace = exact(name)
    contact = contact_of(scene, trace)
    # From b w downward to b e w upward.
    expected = scene.block.mass * scene.block.half_width * (1 + restitution(scene)) * abs(contact.before)
    bearing = scene.total_mass * 9.81 * np.diff(contact.time).max()
    window = slice(contact.first, contact.last)
    assert contact.impulse[window, 0].sum() == pytest.approx(expected, abs=2 * bearing)
    assert contact.strike.sum() == pytest.approx(1.0, abs=1e-12)
    assert contact.energy[contact.last] == pytest.approx(restitution(scene) ** 2, abs=2e-3)


@pytest.mark.parametrize("ground", GROUNDS)
@pytest.mark.parametrize(
    "engine, variant, settings",
    [
        ("exudyn", "compliant-corners", {"stiffness": 1e8}),
        ("mujoco", "impact-aware", {}),
        ("pymunk", "impact-aware", {}),
        ("dart", "impact-aware", {}),
    ],
)
def test_parts_add_up_to_the_error(ground, engine, variant, settings):
    contact = run(engine, variant, released(GROUNDS[ground]), **settings)
    parts = [contact.parts[name] for name in PARTS]
    # What is left is flight within the contact: a share of the parts, and of what gravity gains in a step.
    assert sum(parts) == pytest.approx(contact.error, abs=0.25 * max(map(abs, parts)) + 0.15 * contact.phase)


def test_a_sliding_corner_keeps_the_ratio_of_its_friction():
    contact = run("pymunk", "impact-aware", released(None).with_(friction=0.05))
    assert abs(contact.friction.sum() / contact.impulse.sum()) == pytest.approx(0.05, rel=0.05)


def test_frames_show_the_fall_the_step_that_is_struck_and_the_energy_that_is_lost():
    contact = contact_of(released(None), fixed_steps(released(None), 1e-4))
    content = json.loads(json.dumps(frames(contact), allow_nan=False))
    assert sorted(content) == ["energy", "penetration", "rebound", "straddle"]
    near, speed = content["straddle"], content["rebound"]["speed"]
    assert near["time"][0] < -2e-4 and near["time"][-1] > 2e-4 and near["landing"][0] > 0 and contact.deepest < 2e-5
    ends = [speed[0], speed[-1], content["energy"]["energy"][-1]]
    assert ends == pytest.approx([-1.0, 0.0, restitution(released(None)) ** 2], abs=2e-3)


def test_without_its_place_only_the_whole_is_told():
    scene = released(None)
    trace = fixed_steps(scene, 4e-3)
    seen, blind = contact_of(scene, trace), contact_of(scene, dataclasses.replace(trace, centre=None))
    assert seen.placed and not blind.placed and blind.error == seen.error
    assert list(blind.parts) == ["contact", "flight"]
    assert blind.parts["contact"] == pytest.approx(sum(seen.parts[name] for name in PARTS), rel=0.2)
    assert sorted(frames(blind)) == ["energy", "straddle"]


def test_what_cannot_be_told_is_said():
    """Of an impact that is not there, and of a block that turns in the air."""
    with pytest.raises(Unmeasurable, match=r"impact 99: the trace has \d+ between two swings"):
        contact_of(*exact("rigid ground"), 99)
    scene, time = SCENES["rigid ground"], np.linspace(0.0, 0.2, 201)
    rest, fall = np.zeros_like(time), 9.81 * time
    centre = np.column_stack([rest, 1.0 - 0.5 * fall * time, rest, -fall])
    trace = Trace(time, 0.05 - 0.5 * time, rest - 0.5, rest, rest, rest, 1e-3, centre=centre)
    with pytest.raises(Unmeasurable, match=r"no corner is struck while the tilt is below 0\.001"):
        contact_of(scene, trace)


# Both corners of a block: kinematics against differences, impulses against what the exact motion is borne by.


def first_swing(name, step=1e-3):
    """(scene, trace with the centre) of the exact motion, before its first impact."""
    scene = SCENES[name]
    history = simulate(scene, output_step=step).history
    count = int(np.argmax(history.tilt < 0.0))
    trace = Trace(*(getattr(history, column)[:count] for column in Trace.COLUMNS), contact_tilt=1e-6)
    return scene, dataclasses.replace(trace, centre=pivoting_centre(scene, trace))


@pytest.mark.parametrize("name", ["rigid ground", "isolated"])
def test_the_pivot_stands_on_its_base_and_the_other_corner_moves_as_its_speeds_say(name):
    scene, trace = first_swing(name)
    shown = corner_motion(scene, trace, 1.0)
    np.testing.assert_allclose([shown[part][:, 1] for part in ("height", "sinking", "slip")], 0.0, atol=1e-12)
    lifted = 2 * scene.block.half_width * np.sin(trace.tilt)
    np.testing.assert_allclose(shown["height"][:, 0], lifted, atol=1e-12)
    sunk = np.gradient(-lifted, trace.time)
    np.testing.assert_allclose(shown["sinking"][2:-2, 0], sunk[2:-2], atol=2e-5)


@pytest.mark.parametrize("name", ["rigid ground", "sliding base", "isolated"])
def test_a_pivoting_block_is_borne_by_its_pivot_alone(name):
    scene, trace = first_swing(name)
    shown, step = corner_impulses(scene, trace, 1.0), np.diff(trace.time)
    weight = scene.block.mass * scene.gravity * step
    assert np.abs(shown["impulse"][:, 0] / weight).max() < 1e-5
    demand, normal, _ = contact_measures(scene, trace)
    result = np.abs(shown["friction"]) / shown["impulse"][:, 1]
    assert result.max() == pytest.approx(demand, rel=1e-2)
    assert (shown["impulse"][:, 1] / weight).min() == pytest.approx(normal, rel=1e-2)


# Causes named from the trace of runs that are misconfigured in one way, at three sizes, and of clean ones.


FINE = 5e-5  # s, at which pymunk in equal steps is off by less than LEAST


def of_space(name):
    """A setting of Chipmunk's space is changed."""
    return lambda size: lambda space, body, scene: setattr(space, name, size)


def elastic(size):
    def change(space, body, scene):
        for shape in space.shapes:
            shape.elasticity = size

    return change


def box(narrower=0.0, longer=0.0):
    """The contact's box is narrower than the block by a share, or its left bottom corner longer [m]."""

    def change(space, body, scene):
        import pymunk

        (old,) = (shape for shape in space.shapes if shape.body is body)
        b, h = scene.block.half_width * (1.0 - narrower), scene.block.half_height
        new = pymunk.Poly(body, [(-b, -h - longer), (b, -h), (b, h), (-b, h)])
        new.friction = old.friction
        space.remove(old)
        space.add(new)

    return change


# cause: (what makes pymunk in equal steps go wrong at a size, three sizes). The last ones do not matter yet.
SPOILT = {
    "damping": (of_space("damping"), (0.5, 0.9, 0.9999)),
    "iterations": (of_space("iterations"), (1, 2, 10)),
    "rebound": (elastic, (0.5, 0.3, 0.05)),
    "shape": (lambda size: box(narrower=size), (0.05, 0.02, 0.001)),
    "gap": (lambda size: box(longer=size), (4e-5, 3e-5, 5e-6)),
}
# cause: (engine, variant, settings at a size, three sizes)
SET = {
    "compliance": ("exudyn", "compliant-corners", lambda size: {"stiffness": size}, (1e7, 1e8, 1e10)),
    "adhesion": ("exudyn", "native-contact", lambda size: {"damping": size}, (4.0, 2.0, 1.0)),
}
ON = [pytest.param(None, id="rigid ground"), pytest.param(BASE, id="sliding base", marks=pytest.mark.long)]


def falling(base):
    """A block on its way to the impact, as fast as if released: what is spoilt there is seen soon."""
    return released(base, tilt=0.1, rate=-0.4)


def traced(engine, variant, scene, which=0, **settings):
    return contact_of(scene, get_engine(engine).traced(scene, variant=variant, history=False, **settings)[1], which)


def named(result, cause):
    """Whether the cause, and no other, is named from the size on at which it matters."""
    matters = max(abs(result.error), abs(result.parts["flight"])) >= LEAST
    assert cause_of(result) == (cause if matters else None), (result.error, result.parts, result.steps)
    return matters


# Iterations on a base: on rigid ground two of them throw the corner up within a step, as a restitution does.
@pytest.mark.parametrize(
    "cause, base",
    [pytest.param("iterations", BASE, id="iterations-sliding base")]
    + [
        pytest.param(*(cause, *base.values), id=f"{cause}-{base.id}", marks=base.marks)
        for cause in SPOILT
        if cause != "iterations"
        for base in ON
    ],
)
def test_a_spoilt_script_is_seen_through(cause, base):
    spoil, sizes = SPOILT[cause]
    scene = released(base) if cause == "damping" else falling(base)
    matters = [named(contact_of(scene, fixed_steps(scene, FINE, spoil(size))), cause) for size in sizes]
    assert matters[0]


@pytest.mark.parametrize("base", ON)
def test_a_coarse_step_is_seen_through(base):
    runs = [contact_of(falling(base), fixed_steps(falling(base), step)) for step in (8e-3, 4e-3, FINE)]
    assert [named(run, "step") for run in runs][0]


@pytest.mark.parametrize("base", ON)
@pytest.mark.parametrize("cause", SET)
def test_a_wrong_setting_is_seen_through(cause, base):
    engine, variant, settings, sizes = SET[cause]
    scene = released(base) if cause == "compliance" else falling(base)  # it has to settle
    matters = [named(traced(engine, variant, scene, **settings(size)), cause) for size in sizes]
    assert matters[0]


@pytest.mark.parametrize("step", [2e-3, 1e-3, 5e-4])
def test_a_soft_contact_is_not_taken_for_a_coarse_step(step):
    """Even where only the tilt is known: the strike lasts, however many steps that takes."""
    result = traced("mujoco", "first-script", released(BASE), step=step)
    assert not result.placed and named(result, "compliance")


@pytest.mark.parametrize("base, coefficients", [(None, (0.1, 0.13, 0.3)), (BASE, (0.02, 0.025, 0.1))])
@pytest.mark.parametrize(
    "engine, variant, settings", [("pymunk", "impact-aware", {}), ("exudyn", "compliant-corners", {})]
)
def test_too_small_a_friction_is_seen_through(engine, variant, settings, base, coefficients):
    runs = (traced(engine, variant, falling(base).with_(friction=mu), **settings) for mu in coefficients)
    assert [named(run, "friction") for run in runs] == [True, True, False]


def random_scenes(count):
    """Statues that rock, released or under a pulse, on every ground, with three impacts."""
    scenes = (random_scene(15, index) for index in itertools.count())
    runs = ((scene, simulate(scene, history=False)) for scene in scenes)
    rocking = ((scene, run.impacts) for scene, run in runs if run.outcome == "rocks" and run.impact_count > 2)
    for scene, impacts in itertools.islice(rocking, count):
        yield scene.with_(duration=0.6 * impacts[1].time + 0.4 * impacts[2].time)


CLEAN = {"exudyn": "compliant-corners"} | dict.fromkeys(("mujoco", "pymunk", "dart"), "impact-aware")


@pytest.mark.parametrize("engine, variant", CLEAN.items())
@pytest.mark.parametrize("count", [2, pytest.param(20, marks=pytest.mark.long)])
def test_no_clean_run_is_accused(engine, variant, count):
    for scene in random_scenes(count):
        for which in (0, 1):
            result = traced(engine, variant, scene, which)
            assert cause_of(result) is None, (scene, result.error, result.parts)


def test_diagnosis_is_ready_for_a_page_or_says_why_not():
    shown = diagnosis("mujoco", "fixed-step", released(None), step=4e-3)
    assert (shown["tier"], shown["best"], shown["cause"], shown["words"]) == ("tuned", False, "step", CAUSES["step"])
    assert shown["steps"] == 2 and shown["deepest"] < 1e-3 and set(shown["frames"]) >= {"straddle", "energy"}
    blind = diagnosis("pymunk", "first-script", released(BASE))
    assert not blind["placed"] and blind["words"] in CAUSES.values() and "deepest" not in blind
    assert (
        "has 0 between two swings" in diagnosis("pymunk", "impact-aware", released(None).with_(duration=0.1))["why_not"]
    )
