"""What matters: every change is of the size its name says, and a flip is another verdict on the same motion."""

import numpy as np
import pytest
from answered import answered, by_runs
from scipy.stats import norm

from analytic import load_scene, simulate, synthetic_motion
from analytic.bearing import BearingLaw
from analytic.rocking import RockingModel
from comparisons.running.study import Ask
from comparisons.studies import get_study
from comparisons.studies.matters.cases import SPREAD
from comparisons.studies.matters.changes import changes

STUDY = get_study("matters")
SCENES = {"isolated": ("caryatid-isolated", (0.15,))}
COUNT = 8


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    folder = tmp_path_factory.mktemp("matters")

    return answered(STUDY.plan(Ask(()), SCENES, (COUNT, 0)), by_runs(folder))[-1]


def test_changes_are_of_the_size_their_names_say():
    scene = load_scene("caryatid-isolated").with_(motion=synthetic_motion(seed=3).scaled(0.8), duration=None)
    peak, law = scene.motion.peak, BearingLaw.of(scene.bearings)
    by_name = {}
    for name, changed in changes(scene, 3):
        by_name.setdefault(name, []).append(changed)

    def ratios(name, value):
        return [value(changed) / value(scene) for changed in by_name[name]]

    assert ratios("slenderness ±1 %", lambda s: s.block.slenderness) == pytest.approx([0.99, 1.01])
    assert ratios("restitution ±5 %", lambda s: RockingModel.of(s).restitution) == pytest.approx([0.95, 1.05])
    assert ratios("scale of the motion ±1 %", lambda s: s.motion.peak) == pytest.approx([0.99, 1.01])
    assert ratios("bearing stiffness kb ±10 %", lambda s: s.bearings.kb) == pytest.approx([0.9, 1.1])
    (bilinear,), (bouc_wen,) = by_name["bilinear bearings"], by_name["Bouc-Wen bearings"]
    assert BearingLaw.of(bilinear.bearings).f0 == pytest.approx(law.f0) and bouc_wen.bearings.law == "bouc-wen"
    for share in (2 / 3, 4 / 3):
        (changed,) = by_name[f"vertical motion, {share:.2f} of the horizontal"]
        assert changed.motion.vertical.peak == pytest.approx(share * peak)
        np.testing.assert_array_equal(changed.motion.samples, scene.motion.samples)
    (turned,) = by_name["direction turned by 30°"]
    rest = turned.motion.samples - np.cos(np.pi / 6) * scene.motion.samples  # of a component as strong
    assert np.abs(rest).max() == pytest.approx(0.5 * peak)
    (coarse,) = by_name["time step of the record 0.02 s"]
    assert coarse.motion.dt == 0.02 and coarse.motion.acceleration(3.0) == scene.motion.acceleration(3.0)
    (short,) = by_name["tail cut off after 95 % of its intensity"]
    kept = (short.motion.samples**2).sum() / (scene.motion.samples**2).sum()
    assert 0.95 <= kept < 0.96
    low, high = by_name["baseline off by 0.1 % of the peak"]
    np.testing.assert_allclose((high.motion.samples - low.motion.samples) / peak, 2e-3, rtol=1e-9)
    free = dict(changes(load_scene("caryatid-rigid").with_(motion=scene.motion), 3))
    assert not any("bearing" in name for name in free) and len(free) == len(by_name) - 5


def test_flips_are_those_of_single_runs(found):
    half = found.settings["scenes"]["isolated"]["half"][0]
    usual = load_scene("caryatid-isolated").with_(motion=None, duration=None, block={"slenderness": 0.15})
    rows = {row["change"]: row for row in found.rows}
    order = np.random.Generator(np.random.PCG64(7)).permutation(COUNT)
    factors, flips = [], 0
    for seed in range(COUNT):
        factors.append(half * np.exp(SPREAD * norm.ppf((order[seed] + 0.5) / COUNT)))
        scene = usual.with_(motion=synthetic_motion(seed=seed).scaled(float(factors[-1])))
        outcomes = [simulate(one).outcome == "overturns" for one in (scene, scene.with_(bearings={"law": "bouc-wen"}))]
        flips += outcomes[0] != outcomes[1]
    row = rows["Bouc-Wen bearings"]
    assert (row["flips"], row["runs"], row["failed"]) == (flips, COUNT, 0)
    assert np.log(np.array(factors) / half).mean() == pytest.approx(0.0, abs=1e-12)
    for change, row in rows.items():
        assert row["runs"] == (2 * COUNT if "±" in change or "baseline" in change else COUNT)
    # a tenth of a per mille of restitution moves less than five per cent of it
    assert rows["restitution ±0.01 %"]["tilt"] < rows["restitution ±5 %"]["tilt"]


def test_half_of_the_motions_overturn_at_the_factor_that_is_said(found):
    half = found.settings["scenes"]["isolated"]["half"][0]
    usual = load_scene("caryatid-isolated").with_(motion=None, duration=None, block={"slenderness": 0.15})

    def share(factor):
        scenes = [usual.with_(motion=synthetic_motion(seed=seed).scaled(factor)) for seed in range(COUNT)]
        return np.mean([simulate(scene).outcome == "overturns" for scene in scenes])

    assert share(0.9 * half) <= 0.5 <= share(1.1 * half)
