"""Causes named from the trace of runs that are misconfigured in one way, at three sizes, and of clean ones."""

import itertools

import pytest
from engine_cases import released
from fixed_steps import fixed_steps
from sampled_traces import BASE

from analytic import simulate
from comparisons.ensembles.statues import random_scene
from comparisons.measuring.autopsy import CAUSES, LEAST, cause_of, contact_of, diagnosis
from engines import get_engine

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
GROUNDS = [pytest.param(None, id="rigid ground"), pytest.param(BASE, id="sliding base", marks=pytest.mark.long)]


def falling(base):
    """A block on its way to the impact, as fast as if released: what is spoilt there is seen soon."""
    return released(base, tilt=0.1, rate=-0.4)


def contact(engine, variant, scene, which=0, **settings):
    return contact_of(scene, get_engine(engine).traced(scene, variant=variant, history=False, **settings)[1], which)


def named(found, cause):
    """Whether the cause, and no other, is named from the size on at which it matters."""
    matters = max(abs(found.error), abs(found.parts["flight"])) >= LEAST
    assert cause_of(found) == (cause if matters else None), (found.error, found.parts, found.steps)
    return matters


# Iterations on a base: on rigid ground two of them throw the corner up within a step, as a restitution does.
@pytest.mark.parametrize(
    "cause, base",
    [pytest.param("iterations", BASE, id="iterations-sliding base")]
    + [
        pytest.param(*(cause, *base.values), id=f"{cause}-{base.id}", marks=base.marks)
        for cause in SPOILT
        if cause != "iterations"
        for base in GROUNDS
    ],
)
def test_a_spoilt_script_is_seen_through(cause, base):
    spoil, sizes = SPOILT[cause]
    scene = released(base) if cause == "damping" else falling(base)
    matters = [named(contact_of(scene, fixed_steps(scene, FINE, spoil(size))), cause) for size in sizes]
    assert matters[0]


@pytest.mark.parametrize("base", GROUNDS)
def test_a_coarse_step_is_seen_through(base):
    runs = [contact_of(falling(base), fixed_steps(falling(base), step)) for step in (8e-3, 4e-3, FINE)]
    assert [named(run, "step") for run in runs][0]


@pytest.mark.parametrize("base", GROUNDS)
@pytest.mark.parametrize("cause", SET)
def test_a_wrong_setting_is_seen_through(cause, base):
    engine, variant, settings, sizes = SET[cause]
    scene = released(base) if cause == "compliance" else falling(base)  # it has to settle
    matters = [named(contact(engine, variant, scene, **settings(size)), cause) for size in sizes]
    assert matters[0]


@pytest.mark.parametrize("step", [2e-3, 1e-3, 5e-4])
def test_a_soft_contact_is_not_taken_for_a_coarse_step(step):
    """Even where only the tilt is known: the strike lasts, however many steps that takes."""
    found = contact("mujoco", "first-script", released(BASE), step=step)
    assert not found.placed and named(found, "compliance")


@pytest.mark.parametrize("base, coefficients", [(None, (0.1, 0.13, 0.3)), (BASE, (0.02, 0.025, 0.1))])
@pytest.mark.parametrize(
    "engine, variant, settings", [("pymunk", "impact-aware", {}), ("exudyn", "compliant-corners", {})]
)
def test_too_small_a_friction_is_seen_through(engine, variant, settings, base, coefficients):
    runs = (contact(engine, variant, falling(base).with_(friction=mu), **settings) for mu in coefficients)
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
            found = contact(engine, variant, scene, which)
            assert cause_of(found) is None, (scene, found.error, found.parts)


def test_diagnosis_is_ready_for_a_page_or_says_why_not():
    told = diagnosis("mujoco", "fixed-step", released(None), step=4e-3)
    assert (told["tier"], told["best"], told["cause"], told["words"]) == ("tuned", False, "step", CAUSES["step"])
    assert told["steps"] == 2 and told["deepest"] < 1e-3 and set(told["frames"]) >= {"straddle", "energy"}
    blind = diagnosis("pymunk", "first-script", released(BASE))
    assert not blind["placed"] and blind["words"] in CAUSES.values() and "deepest" not in blind
    assert (
        "has 0 between two swings" in diagnosis("pymunk", "impact-aware", released(None).with_(duration=0.1))["why_not"]
    )
