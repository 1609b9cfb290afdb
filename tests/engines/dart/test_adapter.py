"""DART, beside what every engine must fulfil: accuracy of its variants, the limits of its solvers, what is refused."""

import numpy as np
import pytest

dartpy = pytest.importorskip("dartpy", reason="dartpy is not installed: see README.md")

from released import impact_errors, scene  # noqa: E402

from analytic import Base, Bearings, Block, Start  # noqa: E402
from analytic import Scene as AnyScene  # noqa: E402
from engines import get_engine  # noqa: E402
from engines.contract import Mismatch  # noqa: E402
from engines.dart import scene as built  # noqa: E402

simulate = get_engine("dart").simulate
BEARINGS = Bearings(count=4, ka=6.22e4, kb=6.22e3, alpha=44.69)


@pytest.mark.parametrize("slenderness, base", [(0.1, None), (0.2, 212.0)])
def test_accuracy_knob_means_error_of_restitution_and_is_of_first_order(slenderness, base):
    coarse, fine = (impact_errors(simulate, slenderness, base, 4, 2.5, accuracy=knob)[0] for knob in (1e-3, 1e-5))
    assert 1e-4 < coarse < 2e-3
    assert 50 < coarse / fine < 200
    assert fine < 1e-4


@pytest.mark.slow
@pytest.mark.parametrize("variant", ["expert", "first-script"])
def test_scripts_are_of_first_order(variant):
    errors = [impact_errors(simulate, 0.2, None, 4, 3.0, variant=variant, step=step)[0] for step in (1e-3, 2e-4)]
    assert errors[1] < 1e-3
    assert 2.5 < errors[0] / errors[1] < 10  # 5 but for the phase of the steps


@pytest.mark.parametrize("slenderness", [0.05, 0.15, 0.45])
@pytest.mark.parametrize("base", [None, 0.07, 30.0])
def test_a_block_that_nobody_pushes_is_not_turned(slenderness, base):
    """With the default iterations of DART's second solver by .001 to .03 g/R where it is slender."""
    given = AnyScene(
        block=Block(mass=1.0, radius=1.0, slenderness=slenderness), base=Base(mass=base) if base else None, duration=1.0
    )
    assembly, step = built.build(given), 1e-3
    assembly.world.setTimeStep(step)
    assembly.block.setForces((-given.gravity, 0.0, 0.0))
    assembly.world.step()
    assert np.abs(assembly.block.getVelocities()).max() < 2e-5 * given.gravity * step


def test_too_few_iterations_for_two_corners_are_seen(monkeypatch):
    monkeypatch.setattr(built, "SWEEPS", 0.5)
    test = test_a_block_that_nobody_pushes_is_not_turned
    with pytest.raises(AssertionError):
        test(0.15, None)


def forgetful_friction(monkeypatch):
    add = built.add_shape
    monkeypatch.setattr(built, "add_shape", lambda body, shape, place, friction: add(body, shape, place, 0.9))


def forgetful_mass(monkeypatch):
    inertia = dartpy.dynamics.Inertia
    monkeypatch.setattr(dartpy.dynamics, "Inertia", lambda mass, *rest: inertia(0.9 * mass, *rest))


@pytest.mark.parametrize(
    "forgets, words", [(forgetful_friction, "friction is 0.9, not 5"), (forgetful_mass, "block: mass is 2854.8")]
)
def test_what_dart_does_not_hold_as_asked_is_refused(monkeypatch, forgets, words):
    forgets(monkeypatch)
    response = simulate(scene(0.2, start=Start(tilt=0.1)))
    assert response.outcome == "failed"
    with pytest.raises(Mismatch, match=words):
        built.build(scene(0.2))


def test_warnings_name_what_is_outside():
    assert simulate(scene(0.25, 212.0, 0.5, start=Start(tilt=0.1))).warnings == ()
    (told,) = simulate(scene(0.25, 212.0, 0.1, start=Start(tilt=0.1)), variant="first-script").warnings
    assert "verified in no range" in told
