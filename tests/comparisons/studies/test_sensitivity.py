"""What changes the outcome: each change is of the size its name says; counted are other outcomes of one motion."""

import numpy as np
import pytest
from answered import answered, by_runs
from scipy.stats import norm

from analytic import load_scene, simulate, synthetic_motion
from analytic.rocking import BearingLaw, RockingModel
from comparisons.ensembles import with_vertical
from comparisons.execution.plan import Request
from comparisons.plotting.parts import where
from comparisons.studies import get_study
from comparisons.studies.sensitivity.study import FASTER, RATIOS, SPREAD, changes

STUDY = get_study("sensitivity")
SCENES = {"isolated": ("caryatid-isolated", (0.15,))}
USUAL = load_scene("caryatid-isolated").with_(motion=None, duration=None, block={"slenderness": 0.15})
COUNT = 8

pytestmark = pytest.mark.xdist_group("sensitivity")  # its runs are made once


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sensitivity")
    return answered(STUDY.plan(Request(()), SCENES, (COUNT, 0, 0)), by_runs(folder))[-1]


def fallen(*scenes):
    """Whether each of the scenes overturns."""
    return np.array([simulate(scene, history=False).outcome == "overturns" for scene in scenes])


def scenes_of(found):
    """The scenes as they are, one a seed; half of them overturn about the factor that is said."""
    half = found.settings["scenes"]["isolated"]["half"][0]
    usual = [USUAL.with_(motion=synthetic_motion(seed=seed)) for seed in range(COUNT)]
    low, high = (fallen(*(one.with_(motion=one.motion.scaled(by * half)) for one in usual)) for by in (0.9, 1.1))
    assert low.mean() <= 0.5 <= high.mean()
    order = np.random.Generator(np.random.PCG64(7)).permutation(COUNT)
    factors = half * np.exp(SPREAD * norm.ppf((order + 0.5) / COUNT))
    assert np.log(factors / half).mean() == pytest.approx(0.0, abs=1e-12)
    return [one.with_(motion=one.motion.scaled(float(factor))) for one, factor in zip(usual, factors, strict=True)]


def test_changes_are_of_the_size_their_names_say():
    scene = load_scene("caryatid-isolated").with_(motion=synthetic_motion(seed=3).scaled(0.8), duration=None)
    peak, law, restitution = scene.motion.peak, BearingLaw.of(scene.bearings), RockingModel.of(scene).restitution
    by_name = {}
    for name, changed in changes(scene, 3):
        by_name.setdefault(name, []).append(changed)

    samples, across = scene.motion.samples, np.cos(np.pi / 6) * scene.motion.samples  # the other as strong
    for name, value, expected in (
        ("slenderness ±1 %", lambda one: one.block.slenderness / scene.block.slenderness, [0.99, 1.01]),
        ("restitution ±5 %", lambda one: RockingModel.of(one).restitution / restitution, [0.95, 1.05]),
        ("scale of the motion ±1 %", lambda one: one.motion.peak / peak, [0.99, 1.01]),
        ("bearing stiffness kb ±10 %", lambda one: one.bearings.kb / scene.bearings.kb, [0.9, 1.1]),
        ("bilinear bearings", lambda one: BearingLaw.of(one.bearings).f0 / law.f0, [1]),
        ("Bouc-Wen bearings", lambda one: one.bearings.law == "bouc-wen", [True]),
        *((f"vertical motion, V/H {s:.2f}", lambda one: one.motion.vertical.peak / peak, [s]) for s in (2 / 3, 4 / 3)),
        ("vertical motion, V/H 0.67", lambda one: np.abs(one.motion.samples - samples).max(), [0]),
        ("direction turned by 30°", lambda one: np.abs(one.motion.samples - across).max() / peak, [0.5]),
        ("record's time step 0.02 s", lambda one: one.motion.dt, [0.02]),
        ("record's time step 0.02 s", lambda one: one.motion.acceleration(3.0), [scene.motion.acceleration(3.0)]),
        ("baseline off 0.1 % of peak", lambda one: np.ptp(one.motion.samples - samples), [0, 0]),
        ("baseline off 0.1 % of peak", lambda one: (one.motion.samples - samples)[0] / peak, [-1e-3, 1e-3]),
    ):
        assert [value(one) for one in by_name[name]] == pytest.approx(expected, abs=1e-12), name
    (short,) = by_name["cut off at 95 % intensity"]
    assert 0.95 <= (short.motion.samples**2).sum() / (samples**2).sum() < 0.96
    free = dict(changes(load_scene("caryatid-rigid").with_(motion=scene.motion), 3))
    assert not any("bearing" in name for name in free) and len(free) == len(by_name) - 5


def test_changed_outcomes_are_those_of_single_runs(found):
    rows = {row["change"]: row for row in where(found.rows, part="change")}
    scenes = scenes_of(found)
    before, after = fallen(*scenes), fallen(*(scene.with_(bearings={"law": "bouc-wen"}) for scene in scenes))
    row = rows["Bouc-Wen bearings"]
    assert (row["runs"], row["failed"], row["variant"]) == (COUNT, 0, "")
    assert (row["outcomes_changed"], row["to_overturning"]) == ((before != after).sum(), (after & ~before).sum())
    for change, row in rows.items():
        assert row["runs"] == (2 * COUNT if "±" in change or "baseline" in change else COUNT)
    # a tenth of a per mille of restitution moves less than five per cent of it
    assert rows["restitution ±0.01 %"]["tilt"] < rows["restitution ±5 %"]["tilt"]


def test_a_vertical_motion_is_as_strong_and_as_fast_as_asked_for():
    motion = synthetic_motion(seed=5).scaled(0.7)
    usual, fast = (with_vertical(motion, 5, 0.5, faster).vertical for faster in (1, 4))
    for up in (usual, fast):
        assert up.peak == pytest.approx(0.5 * motion.peak) and len(up.samples) == len(motion.samples)
    assert fast.peak_time == pytest.approx(usual.peak_time, abs=motion.dt)

    def frequency(up):  # mean, of the spectrum
        power = np.abs(np.fft.rfft(up.samples)) ** 2
        return np.average(np.fft.rfftfreq(len(up.samples), up.dt), weights=power)

    assert frequency(fast) == pytest.approx(4 * frequency(usual), rel=0.03)


def test_outcomes_changed_by_vertical_motions_and_lost_contacts_are_those_of_single_runs(found):
    rows = where(found.rows, part="vertical")
    assert [(row["faster"], row["ratio"]) for row in rows] == [(1, 0.0), *((f, r) for f in FASTER for r in RATIOS)]
    scenes = scenes_of(found)[: COUNT // 3]
    level = [simulate(scene) for scene in scenes]
    raised = [
        simulate(scene.with_(motion=with_vertical(scene.motion, seed, 1.5, 2))) for seed, scene in enumerate(scenes)
    ]
    (last,) = where(rows, faster=2, ratio=1.5)
    for row, runs in ((rows[0], level), (last, raised)):
        changed = sum(
            before.outcome != after.outcome and "overturns" in (before.outcome, after.outcome)
            for before, after in zip(level, runs, strict=True)
        )
        lifting = sum(run.min_normal_ratio <= 0 for run in runs)
        assert (row["runs"], row["outcomes_changed"], row["lifts_off"]) == (len(runs), changed, lifting)
