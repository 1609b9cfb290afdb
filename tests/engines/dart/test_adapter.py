"""DART, beside what every engine must fulfil: what its settings bring, that the block stays in its plane, readback."""

import numpy as np
import pytest

dartpy = pytest.importorskip("dartpy", reason="dartpy is not installed: see README.md")

from engine_cases import impact_errors, scene  # noqa: E402

from analytic import Start  # noqa: E402
from engines import get_engine  # noqa: E402
from engines.contract import Mismatch  # noqa: E402
from engines.dart import scene as built  # noqa: E402

simulate = get_engine("dart").simulate


@pytest.mark.slow
def test_the_first_script_is_of_first_order():
    errors = [impact_errors(simulate, 0.2, None, 4, 3.0, variant="first-script", step=step)[0] for step in (1e-3, 2e-4)]
    assert errors[1] < 1e-3
    assert 2.5 < errors[0] / errors[1] < 10  # 5 but for the phase of the steps


def test_without_split_impulses_what_has_sunk_is_thrown_out(monkeypatch):
    usual = impact_errors(simulate, 0.3, None, 2, 2.5)[0]
    kind = built.DartBodies
    monkeypatch.setattr("engines.dart.adapter.DartBodies", lambda scene, plain: kind(scene, True))
    assert impact_errors(simulate, 0.3, None, 2, 2.5)[0] > 10 * usual


def test_a_free_box_stays_in_its_plane():
    given = scene(0.25, 212.0, 3.0, start=Start(tilt=0.15))
    bodies = built.DartBodies(given, plain=False)
    for _ in range(3000):
        bodies.step(1e-3, 1e-3, 0.0, -9.81e-3, 0.0)
    rotation_x, tilt, rotation_z, _, y, _ = bodies.block.getPositions()
    assert max(abs(rotation_x), abs(rotation_z), abs(y)) < 1e-9
    assert np.abs(bodies.block.getVelocities()[[0, 2, 4]]).max() < 1e-9 and abs(tilt) < 0.25


def forgetful_friction(monkeypatch):
    touch = built._touch
    monkeypatch.setattr(built, "_touch", lambda body, size, place, friction: touch(body, size, place, 0.9))


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
        built.DartBodies(scene(0.2), plain=False)
