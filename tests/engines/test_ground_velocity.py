"""The ground's velocity in a pulse is the integral of its acceleration."""

import numpy as np
import pytest

from analytic import PulseMotion
from analytic.pulses import PULSES
from engines.ground_velocity import ground_velocity

PHASES = [("one-sine", 0.8), ("half-sine", 0.8), ("one-cosine", 0.8)]


@pytest.mark.parametrize("shape, phase", [*((shape, 0.0) for shape in PULSES), *PHASES])
def test_velocity_is_the_integral_of_the_acceleration(shape, phase):
    pulse = PulseMotion(shape, 2.0, 5.0, start=0.3, phase=phase)
    velocity, time = ground_velocity(pulse), np.linspace(pulse.start, pulse.end, 200_001)
    gained = np.cumsum(pulse.acceleration(0.5 * (time[1:] + time[:-1]))) * (time[1] - time[0])
    assert velocity(pulse.end + 1.0) == pytest.approx(gained[-1], abs=1e-8)
    np.testing.assert_allclose([velocity(t) for t in time[4000::4000].tolist()], gained[3999::4000], rtol=0, atol=1e-8)
