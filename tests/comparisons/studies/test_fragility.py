"""The fragility study on an engine of which it is known how far it differs: the analytic model at other intensities."""

import math

import numpy as np
import pytest
from answered import answered, by_model, stored

from analytic import simulate
from analytic.advice.bearing_scan import displacement_spectrum
from analytic.response import COMPARED
from comparisons.execution.plan import Request
from comparisons.execution.results import Result
from comparisons.metrics.statistics import fit_fragility
from comparisons.plotting.parts import where
from comparisons.studies import get_study
from comparisons.studies.fragility import study as fits
from comparisons.studies.fragility.study import NEAR, PERIOD, SCENES, cloud, plan

STUDY = get_study("fragility")

FREE = {"free-standing": SCENES["free-standing"]}
RUNS = (150, 50, 10)
ENGINES = Request(("exudyn", "pybullet"))

pytestmark = pytest.mark.xdist_group("fragility")  # its runs are made once


CRASH = {"kind": "crash", "reason": "the worker process ended", "message": "raw evidence"}


def scaled(factor, failing=()):
    """Answers batches by, in the engines' place, the model under `factor` times the motion, failing for some seeds."""
    shares = {"analytic": 1.0}
    return by_model(
        lambda case: case.scene.with_(motion=case.scene.motion.scaled(shares.get(case.solver, factor))),
        lambda case: CRASH if case.solver != "analytic" and case.tag["seed"] in failing else None,
    )


def study(folder, work, scenes=FREE, runs=RUNS):
    return stored(folder, "fragility", answered(plan(ENGINES, scenes=scenes, runs=runs), work)[-1])


@pytest.fixture(autouse=True, scope="module")
def few_draws():
    """Bootstrap of fewer samples than the study's: `tests/comparisons/metrics/test_statistics.py` tests it."""
    with pytest.MonkeyPatch.context() as patch:
        for name in ("DRAWS", "PAIRED_DRAWS"):
            patch.setattr(fits, name, 60)
        yield


@pytest.fixture(scope="module")
def weaker(tmp_path_factory):
    return study(tmp_path_factory.mktemp("weaker"), scaled(0.7))


@pytest.fixture(scope="module")
def equal(tmp_path_factory):
    """The model in the engines' place, but for two runs that fail."""
    near = cloud(*FREE["free-standing"], RUNS[0]).near(*NEAR)
    return study(tmp_path_factory.mktemp("equal"), scaled(1.0, failing=near[[3, 7]].tolist()))


def test_measures_are_those_of_the_motions_and_blocks():
    drawn = cloud("caryatid-isolated", (0.1, 0.25), 5)
    assert pytest.approx(2.0, abs=1e-3) == PERIOD  # s, Table 1(a) of the paper
    for k, scene in enumerate(drawn.scenes):
        motion, block = scene.motion, scene.block
        times = np.linspace(0, motion.end, 40 * (len(motion.samples) - 1) + 1)
        speed = np.abs(np.cumsum(motion.acceleration(times)) * times[1]).max()
        frequency = math.sqrt(block.mass * 9.81 * block.radius / block.inertia)
        uplift = 9.81 * math.tan(block.slenderness)
        moved = displacement_spectrum(motion, [PERIOD], [0.05])[0, 0]
        own = {name: values[k] for name, values in drawn.measures.items()}
        expected = [np.abs(motion.samples).max() / uplift, moved * (2 * np.pi / PERIOD) ** 2 / uplift]
        assert [own["PGA/(g tan γ)"], own["Sa/(g tan γ)"]] == pytest.approx(expected)
        assert [own["PGV"], own["ω_r PGV/(g tan γ)"]] == pytest.approx([speed, frequency * speed / uplift], rel=2e-3)
    assert len({scene.motion.dt for scene in drawn.scenes}) == 5  # each slower or faster than the next
    again = cloud("caryatid-isolated", (0.1, 0.25), 5)
    assert [scene.digest() for scene in again.scenes] == [scene.digest() for scene in drawn.scenes]


@pytest.mark.parametrize(
    "differing, failed, runs, level", [(0, 0, 107, "good"), (1, 1, 107, "fair"), (2, 0, 49, "part"), (0, 2, 10, "bad")]
)
def test_a_verdict_is_that_of_wilsons_limit_of_the_share_that_differs_or_fails(differing, failed, runs, level):
    classes = ["differs"] * differing + ["failed"] * failed + ["right"] * (runs - differing - failed)
    known = {"part": "run", "engine": "e", "variant": "v", "comparable": COMPARED, "model_overturns": True}
    rows = [{**known, "seed": k, "class": each, "overturns": True, "quantities": []} for k, each in enumerate(classes)]
    variants = [{"engine": "e", "variant": "v", "tier": "tuned"}]
    mark = STUDY.judgements(Result("fragility", {"variants": variants}, rows, {}))[0].marks["e", "v"]
    share, z = (differing + failed) / runs, 1.959964
    spread = z * math.sqrt(share * (1 - share) / runs + (z / runs) ** 2 / 4)
    most = 100 * (share + z**2 / runs / 2 + spread) / (1 + z**2 / runs)
    assert mark.level == level and mark.words == f"{differing + failed} of {runs} (at most {most:.2g} %)"


@pytest.mark.slow
def test_an_engine_that_sees_weaker_motions_is_found_out(weaker):
    """Its medians are those of the model over .7, and its dispersions the model's."""
    rows = where(weaker.rows, part="effect", engine="pybullet", variant="impact-aware")
    assert [row["state"] for row in rows] == ["|φ|/γ > 0.1", "|φ|/γ > 0.5", "|φ|/γ > 1", "overturning"]
    assert all(row["only_a"] > row["only_b"] and row["p_holm"] >= row["p_value"] for row in rows)
    known = [row for row in rows if row["median_interval"]]  # else too few runs lie where the curve rises
    assert len(known) >= 2 and min(row["p_holm"] for row in rows) < 0.05
    for row in known:
        low, high = row["median_interval"]
        assert low < 1 / 0.7 < high and row["median_shift"] > 1
    assert STUDY.judgements(weaker)[0].marks["pybullet", "impact-aware"].level == "bad"


@pytest.mark.slow
def test_an_engine_that_is_the_model_does_not_differ_and_the_page_says_what_would_have_been_found(equal):
    rows = where(equal.rows, part="effect", engine="exudyn", variant="compliant-corners")
    for row in rows:
        assert row["only_a"] + row["only_b"] == 0 and row["p_holm"] == 1.0
        assert row["median_shift"] == pytest.approx(1.0) and row["median_interval"] is None  # no certainty
        assert row["detectable_shift"] > 1.01
        assert row["left_out"] == 2 and row["both_stand"] + row["both_overturn"] == RUNS[1] - 2
    assert np.isnan(equal.arrays["free-standing/exudyn, compliant-corners/tilt"]).nonzero()[0].tolist() == [3, 7]
    mark = STUDY.judgements(equal)[0].marks["exudyn", "compliant-corners"]
    assert mark.words.startswith("2 of 49 ") and "2 failed; left out: 1 near an outcome" in mark.note


@pytest.mark.slow
def test_counts_and_points_are_those_of_single_simulations(weaker):
    drawn = cloud(*FREE["free-standing"], RUNS[0])
    fallen = np.array([simulate(scene, history=False).outcome == "overturns" for scene in drawn.scenes])
    assert (np.isinf(weaker.arrays["free-standing/analytic/tilt"]) == fallen).all()
    for row in where(weaker.rows, part="fit", state="overturning"):
        assert row["exceeded"] == fallen.sum() and sum(point["size"] for point in row["points"]) == len(fallen)
        order, point = np.argsort(drawn.measures[row["measure"]]), row["points"][0]
        assert point["share"] == fallen[order][: point["size"]].mean()
    ratio = drawn.measures["PGA/(g tan γ)"][weaker.arrays["free-standing/near"]]
    assert len(ratio) == RUNS[1] and NEAR[0] <= ratio.min() and ratio.max() <= NEAR[1]
    (check,) = where(weaker.rows, part="check")
    assert check["undecided"] == check["failed"] == 0


@pytest.mark.slow
def test_uplift_hangs_on_the_peak_over_the_uplift_acceleration(weaker):
    """A free-standing block lifts at PGA = g tan γ, whatever the motion."""
    uplift, *others = where(weaker.rows, part="fit")
    assert (uplift["state"], uplift["measure"]) == ("|φ|/γ > 0.1", "PGA/(g tan γ)") and 1.0 < uplift["median"] < 2.0
    assert {row["measure"] for row in others} == {"ω_r PGV/(g tan γ)"}
    assert all(row["dispersion"] > 2 * uplift["dispersion"] for row in others)


@pytest.mark.slow
def test_a_detectable_shift_changes_the_share_by_the_detectable_difference(equal):
    """Of the runs compared: how their probabilities fall where the median grows, by the curve itself."""
    drawn = cloud(*FREE["free-standing"], RUNS[0])
    near = equal.arrays["free-standing/near"]
    rows = where(equal.rows, part="effect", engine="exudyn", variant="compliant-corners")
    assert len(rows) == 4
    for row in rows:
        x = drawn.measures[row["measure"]][near]
        states = np.delete(np.arange(len(near)), [3, 7])  # those that fail
        exceeded = tilts(equal, near, row["state"])
        curve = fit_fragility(x[states], exceeded[states])
        less = curve.probability(x[states]) - curve.probability(x[states] / row["detectable_shift"] ** 1e-4)
        assert less.mean() == pytest.approx(1e-4 * row["detectable_difference"], rel=1e-3)  # to first order


def tilts(result, near, state):
    tilt = result.arrays["free-standing/analytic/tilt"][near]
    return np.isinf(tilt) if state == "overturning" else tilt > float(state.rpartition(" ")[2])
