"""The block at the start turns about its lower corner, which is where a standing block has it."""

import math

import pytest

from analytic import Base, Block, Scene, Start
from engines.placement import placement


@pytest.mark.parametrize("tilt, rate", [(0.1, 0.3), (-0.1, 0.3), (0.0, -0.2), (0.0, 0.0)])
def test_the_corner_stays_on_the_base(tilt, rate):
    block = Block(mass=10.0, radius=1.5, slenderness=0.3)
    scene = Scene(
        block=block,
        base=Base(mass=5.0),
        duration=1.0,
        start=Start(tilt=tilt, tilt_rate=rate, base_displacement=0.2, base_velocity=-0.4),
    )
    x, z, vx, vz = placement(scene)
    b, h = math.copysign(1.0, tilt or rate) * block.half_width, block.half_height
    # The corner from the centre, turned by the tilt toward +x: (b, -h).
    across, up = b * math.cos(tilt) - h * math.sin(tilt), -h * math.cos(tilt) - b * math.sin(tilt)
    assert x + across == pytest.approx(0.2 + b, abs=1e-14) and z + h + up == pytest.approx(0.0, abs=1e-14)
    assert vx + rate * up == pytest.approx(-0.4, abs=1e-14) and vz - rate * across == pytest.approx(0.0, abs=1e-14)
