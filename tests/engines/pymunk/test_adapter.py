"""pymunk, beside what every engine must fulfil: the order of its calls, its iterations, what goes wrong surfaces."""

import numpy as np
import pytest

pytest.importorskip("pymunk", reason="pymunk is not installed: see README.md")

from engine_cases import impact_errors, scene  # noqa: E402

from analytic import PulseMotion, Start  # noqa: E402
from analytic import simulate as exact  # noqa: E402
from engines import get_engine  # noqa: E402
from engines.contract import Mismatch  # noqa: E402
from engines.pymunk import scene as built  # noqa: E402

simulate = get_engine("pymunk").simulate


def test_where_bodies_will_be_is_where_chipmunk_then_moves_them():
    """The adapter reads a step ahead: what it said is, to round-off, what the next call begins with."""
    given = scene(0.2, 212.0, 1.0, start=Start(tilt=0.15, tilt_rate=0.1, base_displacement=0.01, base_velocity=0.02))
    bodies, moved = built.ChipmunkBodies(given, 1e-4, plain=False), []
    advance = bodies.space.step

    class Watched:
        def __setattr__(self, name, value):
            setattr(bodies.__dict__["real"], name, value)

        def step(self, length):
            advance(length)
            moved.append((-bodies.block.angle, bodies.block.position.x, bodies.slab.position.x))

    bodies.real, bodies.space = bodies.space, Watched()
    told, before = [(0.15, exact(given).history.tilt[0], 0.01)], 0.0
    for k in range(400):
        length = 1e-4 * (1 + k % 3)
        tilt, _, x, _, _, _, base, _ = bodies.step(length, before, 0.0, -9.81 * 0.5 * (length + before), 0.0)
        told.append((tilt, x, base))
        before = length
    np.testing.assert_allclose(moved[1:], told[1:-1], rtol=0, atol=1e-12)
    assert moved[0][0] == pytest.approx(0.15, abs=1e-12) and moved[0][2] == pytest.approx(0.01, abs=1e-12)


def test_a_light_base_needs_iterations_by_the_ratio_of_the_masses(monkeypatch):
    assert built.iterations(scene(0.2)) == built.ITERATIONS < built.iterations(scene(0.2, 212.0))
    usual = impact_errors(simulate, 0.3, 212.0, 2, 2.0)[0]
    monkeypatch.setattr(built, "LIGHT", 0)
    assert impact_errors(simulate, 0.3, 212.0, 2, 2.0)[0] > 10 * usual


def test_a_block_that_overturns_pivots_all_the_way():
    """With a friction of 5 Chipmunk's iterations jam, and it sinks."""
    given = scene(0.2, duration=6.0, motion=PulseMotion("one-sine", 3.0, 6.0))
    response, trace = get_engine("pymunk").traced(given)
    assert response.outcome == exact(given).outcome == "overturns"
    corner = 1.0884 * np.cos(0.2 - np.abs(trace.tilt))
    assert np.abs(trace.centre[:, 1] + scene(0.2).block.half_height - corner).max() < 1e-4


@pytest.mark.parametrize(
    "name, words", [("damping", "damping is 0.9"), ("collision_slop", "slop is 0.9"), ("collision_bias", "bias is 0.9")]
)
def test_what_chipmunk_does_not_hold_as_asked_is_refused(monkeypatch, name, words):
    class Forgetful(built.pymunk.Space):
        def __init__(self):
            super().__init__()
            self.damping = 0.9

        def __setattr__(self, key, value):
            super().__setattr__(key, 0.9 if key == name else 1.0 if key == "damping" else value)

    monkeypatch.setattr(built.pymunk, "Space", Forgetful)
    response = simulate(scene(0.2, start=Start(tilt=0.1)))
    assert response.outcome == "failed"
    with pytest.raises(Mismatch, match=words):
        built.ChipmunkBodies(scene(0.2), 1e-6, plain=False)
