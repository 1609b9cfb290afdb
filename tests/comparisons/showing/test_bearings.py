"""The bearings that a scene needs, in words."""

import numpy as np
import pytest

from analytic import load_scene
from analytic.bearing_scan import BearingScan
from analytic.design import design_bearings
from comparisons.commands.design import _chosen
from comparisons.running.options import read_row
from comparisons.showing.margins import print_bearings

SCENE = load_scene("caryatid-isolated")


@pytest.mark.parametrize("held, words", [(2, "0.10 %"), (700, "35 %"), (1999, "99.95 %"), (2000, "100 %")])
def test_the_share_that_holds_is_0_and_100_per_cent_only_where_none_and_all_do(capsys, held, words):
    periods, dampings = np.geomspace(0.3, 5.0, 200), np.linspace(0.02, 0.2, 10)
    demand = np.where(np.arange(2000) < held, 0.9, 1.1).reshape(10, 200)
    designs = [design_bearings(SCENE.total_mass, 1.0, float(damping), 0.25) for damping in dampings]
    scan = BearingScan(periods, dampings, demand, np.full((10, 200), 0.2), designs)
    chosen = {"least-stroke": _chosen(SCENE, scan, scan.least_stroke, {"own": [SCENE.motion]})}
    print_bearings(SCENE, scan, 0.25, 0.0, [read_row("own", SCENE.motion)], chosen)
    assert f", {words} hold." in " ".join(capsys.readouterr().out.split())
