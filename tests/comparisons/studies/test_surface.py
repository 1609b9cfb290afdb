"""The fragility surface: every count is one of single runs, by batches and by engines, and shown."""

import numpy as np
import pytest
from answered import answered, by_runs, stored
from page_numbers import number_in

from analytic import load_scene, simulate, synthetic_motion
from analytic.synthetic import PEAK, G
from comparisons.running.plan import Request
from comparisons.studies import get_study
from comparisons.studies.surface.study import crossing

STUDY = get_study("surface")
GRID = np.array([0.12, 0.3]), np.array([0.15, 0.4, 1.2]), 2


pytestmark = pytest.mark.xdist_group("surface")  # its runs are made once


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    folder = tmp_path_factory.mktemp("surface")

    # the second implementation in the place of an engine: a run at a time
    return answered(STUDY.plan(Request(("twin",)), GRID), by_runs(folder))[-1]


def test_counts_are_those_of_single_runs(found):
    slendernesses, intensities, count = GRID
    scene = load_scene("caryatid-rigid").with_(duration=None)
    for i, slenderness in enumerate(slendernesses):
        for j, intensity in enumerate(intensities):
            motions = [synthetic_motion(seed=seed).scaled(intensity * G / PEAK) for seed in range(count)]
            runs = [simulate(scene.with_(block={"slenderness": slenderness}, motion=motion)) for motion in motions]
            fallen = [run.outcome for run in runs].count("overturns")
            for engine in ("analytic", "twin"):
                counts = [found.arrays[f"{engine}/{name}"][i, j] for name in ("overturned", "sound")]
                assert counts == [fallen, count]
    assert 0 < found.arrays["analytic/overturned"].sum() < found.arrays["analytic/sound"].sum()
    assert found.settings["runs"] == 2 * 2 * 3 * 2 and found.settings["failed"] == found.settings["undecided"] == 0


def test_half_lies_where_the_share_crosses_it_and_is_shown(found, tmp_path):
    for row in found.rows:
        share = found.arrays[f"{row['engine']}/overturned"][list(GRID[0]).index(row["slenderness"])] / GRID[2]
        above = int(np.argmax(share >= 0.5))
        assert GRID[1][above - 1] <= row["half"] <= GRID[1][above]
        assert row["falls_by"] == pytest.approx(max(share[: k + 1].max() - share[k] for k in range(len(share))))
    whole = STUDY.page(stored(tmp_path, "surface", found)).whole()
    (table,), (figure,) = whole.tables, whole.figures
    assert [(row[0], number_in(row[2])) for row in table.rows] == [
        (row["engine"], pytest.approx(row["half"], rel=5e-3)) for row in found.rows
    ]
    assert whole.measured and figure.svg.count(b'class="chart"') == 2  # a panel for each engine


@pytest.mark.parametrize(
    "share, level, expected",
    [
        ([0.2, 0.8, 0.4], 0.5, 0.2),
        ([0.2, 0.8, 0.4], 0.65, 0.1 * 4**0.75),
        ([0.2, 0.3, 0.4], 0.5, None),
        ([0.6, 0.8, 0.9], 0.5, None),  # below all intensities
    ],
)
def test_a_share_is_crossed_between_intensities_by_their_logarithm(share, level, expected):
    assert crossing(np.array([0.1, 0.4, 1.6]), np.array(share), level) == pytest.approx(expected)
