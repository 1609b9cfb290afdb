"""Each refinement level of each variant is right, or the comparison says that it is not."""

import numpy as np
import pytest
from engine_cases import every_variant, scene

from analytic import Start, simulate
from analytic.rocking import restitution
from engines import get_engine
from engines.comparison import RESTITUTION, compare

SCENES = {"rigid ground": (0.2, None), "sliding base": (0.3, 400.0)}


def released(slenderness, base):
    """A block let go, up to the third peak of its tilt."""
    given = scene(slenderness, base, 10.0, start=Start(tilt=0.6 * slenderness))
    times = [impact.time for impact in simulate(given, history=False).impacts[:3]]
    return given.with_(duration=0.3 * times[1] + 0.7 * times[2])


def swing_errors(given, trace):
    """Of the restitution, by the energies at the peaks of the tilt before and after an impact; inf of a lost one."""
    gamma, tilt = given.block.slenderness, trace.tilt
    swings = np.split(np.abs(tilt), np.flatnonzero(np.diff(np.sign(tilt)) != 0) + 1)
    peaks = np.array([swing.max() for swing in swings if swing.max() > 1e-2 * gamma])
    energy = np.cos(gamma - peaks) - np.cos(gamma)
    found = np.sqrt(energy[1:] / energy[:-1])[:2]
    return np.abs(found - restitution(given)) if len(found) == 2 else np.array([np.inf])


@every_variant
@pytest.mark.parametrize("ground", SCENES)
def test_a_level_is_right_or_told(engine, variant, ground):
    record, given = get_engine(engine), released(*SCENES[ground])
    kind = record.variants[variant]
    for value in kind.ladder:
        response, trace = record.traced(given, variant=variant, history=False, **{kind.knob: value})
        told = response.failure or compare(given, response).differences
        # what flight takes between two impacts is no part of their restitution: first scripts' damping
        limit = RESTITUTION if kind.flight_damping is None else 0.02
        assert told or swing_errors(given, trace).max() < limit, (value, swing_errors(given, trace))
