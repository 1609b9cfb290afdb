"""Random valid scenes: the kernel ends, stays finite, keeps the energy ledger and the mirror."""

import math

import numpy as np
from bearing_laws import NAMES, to_law
from hypothesis import given, settings
from hypothesis import strategies as st

from analytic import Base, Bearings, Block, PulseMotion, SampledMotion, Scene, Start, simulate
from analytic.motion import PULSES


def log_uniform(low, high):
    return st.floats(math.log10(low), math.log10(high)).map(lambda power: 10.0**power)


@st.composite
def motions(draw):
    kind = draw(st.sampled_from(["none", "pulse", "samples"]))
    if kind == "none":
        return None
    if kind == "pulse":
        return PulseMotion(
            draw(st.sampled_from(PULSES)), draw(st.floats(-30, 30)), draw(log_uniform(0.5, 60)), draw(st.floats(0, 1))
        )
    values = draw(st.lists(st.floats(-15, 15), min_size=2, max_size=60))
    return SampledMotion(draw(log_uniform(1e-3, 0.1)), np.array(values))


@st.composite
def bearings(draw):
    law = draw(st.sampled_from(["none", *NAMES]))
    if law == "none":
        return None
    kb = draw(log_uniform(1e2, 1e6))
    ka = kb * (1 + draw(log_uniform(1e-4, 1e2)))
    keys = {"ka": ka, "kb": kb, "alpha": draw(st.floats(1.05, 200)), **to_law(law, ka, kb, draw(log_uniform(1, 1e5)))}
    return Bearings(**keys, count=draw(st.integers(1, 8)), damping=draw(st.sampled_from([0.0, 500.0])))


@st.composite
def scenes(draw):
    slenderness = draw(st.floats(0.03, 1.4))
    block = Block(
        mass=draw(log_uniform(1, 1e5)),
        radius=draw(log_uniform(0.1, 10)),
        slenderness=slenderness,
        restitution=draw(st.sampled_from([None, None, 0.0, 0.5, 0.95])),
    )
    tilt = draw(st.sampled_from([0.0, 0.3, -0.9, 1.05])) * slenderness
    on_base = draw(st.booleans())
    base = Base(mass=block.mass * draw(log_uniform(1e-4, 1e3))) if on_base else None
    start = Start(
        tilt=tilt,
        tilt_rate=draw(st.sampled_from([0.0, 0.5, -1e-6])),
        base_displacement=draw(st.sampled_from([0.0, 0.1])) if on_base else 0.0,
        base_velocity=draw(st.sampled_from([0.0, -0.4])) if on_base else 0.0,
    )
    return Scene(
        block=block,
        base=base,
        bearings=draw(bearings()) if on_base else None,
        motion=draw(motions()),
        start=start,
        duration=draw(st.floats(0.1, 8)),
    )


def mirrored(scene):
    start = Start(**{name: -value for name, value in scene.start.model_dump().items()})
    return scene.with_(start=start, motion=scene.motion.scaled(-1.0) if scene.motion else None)


@settings(max_examples=150, deadline=None)
@given(scenes())
def test_any_valid_scene_ends_sound_and_mirrors_bit_for_bit(scene):
    response = simulate(scene)
    assert response.outcome != "failed", response.failure
    end = [response.end.tilt, response.end.tilt_rate, response.end.base_displacement, response.end.base_velocity]
    assert np.isfinite(end).all()
    energy = response.energy
    turnover = max(
        abs(energy.input),
        abs(energy.kinetic),
        abs(energy.potential),
        abs(energy.hysteretic),
        energy.impact_loss,
        energy.viscous,
        1e-9 * scene.block.mass,
        0.5 * scene.total_mass * float(np.square(response.history.base_velocity).max()),
    )
    assert abs(energy.imbalance) <= 1e-6 * turnover
    assert energy.impact_loss >= -1e-12 * turnover
    other = simulate(mirrored(scene), history=False)
    assert [other.end.tilt, other.end.tilt_rate, other.end.base_displacement, other.end.base_velocity] == [
        -value for value in end
    ]
    assert [impact.time for impact in other.impacts] == [impact.time for impact in response.impacts]
