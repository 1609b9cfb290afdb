"""Each refinement level of each variant is right, or the comparison says that it is not."""

import numpy as np
import pytest
from engine_cases import every_variant, scene

from analytic import Start, simulate
from comparisons.measuring.errors import impact_errors
from engines import get_engine
from engines.comparison import RESTITUTION, compare

SCENES = {"rigid ground": (0.2, None), "sliding base": (0.3, 400.0)}


def released(slenderness, base):
    """A block released, up to the third peak of its tilt."""
    given = scene(slenderness, base, 10.0, start=Start(tilt=0.6 * slenderness))
    times = [impact.time for impact in simulate(given, history=False).impacts[:3]]
    return given.with_(duration=0.3 * times[1] + 0.7 * times[2])


def worst(given, response):
    """Largest error of the restitution of two impacts, by the energies of swings; inf where one is lost."""
    errors = impact_errors(given, response, 2)["swing"]
    return np.abs(errors).max() if len(errors) == 2 else np.inf


@every_variant
@pytest.mark.parametrize("ground", SCENES)
def test_a_level_is_right_or_told(engine, variant, ground):
    record, given = get_engine(engine), released(*SCENES[ground])
    kind = record.variants[variant]
    for value in kind.levels:
        response, _ = record.traced(given, variant=variant, **{kind.accuracy_parameter: value})
        told = response.failure or compare(given, response).differences
        # what flight takes between two impacts is no part of their restitution: first scripts' damping
        limit = RESTITUTION if kind.flight_damping is None else 0.02
        assert told or worst(given, response) < limit, value
