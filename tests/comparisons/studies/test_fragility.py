"""The fragility study on a solver of which it is known how far it differs: the analytic model at other intensities."""

import dataclasses
import math

import numpy as np
import pytest
from answered import answered

from analytic import simulate
from analytic.linear_oscillator import displacement_spectrum
from comparisons.measuring.statistics import wilson
from comparisons.running.provenance import read_result, write_result
from comparisons.running.study import Ask
from comparisons.running.sweep import Row
from comparisons.studies.fragility import STUDY, effects, fits
from comparisons.studies.fragility.cases import FULL, NEAR, plan
from comparisons.studies.fragility.cloud import PERIOD, SCENES, cloud
from comparisons.studies.fragility.page import section

FREE = {"free-standing": SCENES["free-standing"]}
RUNS = (300, 110, 10)
ENGINES = Ask(("exudyn", "pybullet"))

pytestmark = pytest.mark.xdist_group("fragility")  # its runs are made once


class Scaled:
    """In place of the engines: the analytic model under `factor` times the motion, failing for some seeds."""

    def __init__(self, factor, failing=()):
        self.factor, self.failing = factor, failing

    def __call__(self, batch):
        return [self._row(batch, case) for case in batch.cases]

    def _row(self, batch, case):
        scene, failure = case.scene, None
        if case.solver != "analytic":
            scene = scene.with_(motion=scene.motion.scaled(self.factor))
            if case.tag["seed"] in self.failing:
                failure = {"kind": "crash", "reason": "the worker process ended", "message": "raw evidence"}
        values = batch.measure(case, simulate(scene, history=False))
        return Row(case, {"outcome": "failed"} if failure else values, failure, {"cpu_seconds": 0.25}, False)


def study(folder, work, scenes=FREE, runs=RUNS):
    found = answered(plan(ENGINES, scenes=scenes, runs=runs), work)[-1]
    settings = {**found.settings, "changed_while_running": []}
    return read_result(
        write_result(folder / "f.json", "fragility", settings, found.rows, found.arrays, modules=["analytic"])
    )


@pytest.fixture(autouse=True, scope="module")
def few_draws():
    """Bootstrap of fewer samples than the study's: `tests/comparisons/measuring/test_fragility.py` tests it."""
    with pytest.MonkeyPatch.context() as patch:
        for module in (fits, effects):
            patch.setattr(module, "DRAWS", 60)
        yield


@pytest.fixture(scope="module")
def weaker(tmp_path_factory):
    return study(tmp_path_factory.mktemp("weaker"), Scaled(0.8))


@pytest.fixture(scope="module")
def equal(tmp_path_factory):
    """The model in the engines' place, but for two runs that fail."""
    near = cloud(*FREE["free-standing"], RUNS[0]).near(*NEAR)
    return study(tmp_path_factory.mktemp("equal"), Scaled(1.0, failing=near[[3, 7]].tolist()))


def rows_of(result, part, **wanted):
    return [row for row in result.rows if row["part"] == part and all(row[key] == wanted[key] for key in wanted)]


def test_the_full_study_is_as_large_as_it_must_be():
    assert FULL[0] >= 1000 and FULL[1] >= 60 and len(SCENES) == 2


def test_measures_are_those_of_the_motions_and_blocks():
    drawn = cloud("caryatid-isolated", (0.1, 0.25), 5)
    assert pytest.approx(2.0, abs=1e-3) == PERIOD  # s, Table 1(a) of the paper
    for k, scene in enumerate(drawn.scenes):
        motion, block = scene.motion, scene.block
        times = np.linspace(0, motion.end, 40 * (len(motion.samples) - 1) + 1)
        acceleration = motion.acceleration(times)
        speed = np.abs(np.cumsum(acceleration) * times[1]).max()
        frequency = math.sqrt(block.mass * 9.81 * block.radius / block.inertia)
        uplift = 9.81 * math.tan(block.slenderness)
        assert drawn.measures["PGA"][k] == pytest.approx(np.abs(motion.samples).max() / 9.81)
        assert drawn.measures["PGV"][k] == pytest.approx(speed, rel=2e-3)
        assert drawn.measures["ω_r PGV/(g tan γ)"][k] == pytest.approx(frequency * speed / uplift, rel=2e-3)
        moved = displacement_spectrum(motion, [PERIOD], [0.05])[0, 0]
        assert drawn.measures["Sa/(g tan γ)"][k] == pytest.approx(moved * (2 * np.pi / PERIOD) ** 2 / uplift)
    assert len({scene.motion.dt for scene in drawn.scenes}) == 5  # each slower or faster than the next
    again = cloud("caryatid-isolated", (0.1, 0.25), 5)
    assert [scene.digest() for scene in again.scenes] == [scene.digest() for scene in drawn.scenes]


def test_a_solver_that_sees_weaker_motions_is_found_out(weaker):
    """Its medians are those of the model over .8, and its dispersions the model's."""
    rows = rows_of(weaker, "effect", solver="pybullet")
    assert [row["state"] for row in rows] == ["|φ|/γ > 0.1", "|φ|/γ > 0.5", "|φ|/γ > 1", "overturning"]
    for row in rows:
        assert row["only_a"] > row["only_b"] and row["p_holm"] >= row["p_value"]
    known = [row for row in rows if row["median_interval"]]  # else too few runs lie where the curve rises
    assert len(known) >= 2
    for row in known:
        low, high = row["median_interval"]
        assert low < 1 / 0.8 < high and row["median_shift"] > 1
    assert min(row["p_holm"] for row in rows) < 0.05
    page = section(weaker)
    assert "free-standing, pybullet: they differ" in " ".join(page.text)
    assert all(len(row) == len(table.columns) for table in page.tables for row in table.rows)


def test_a_solver_that_is_the_model_does_not_differ_and_says_what_would_have_been_found(equal):
    for row in rows_of(equal, "effect", solver="exudyn"):
        assert row["only_a"] + row["only_b"] == 0 and row["p_holm"] == 1.0
        assert row["median_shift"] == pytest.approx(1.0) and row["median_interval"] is None  # no certainty
        assert row["detectable_shift"] > 1.01
    page = section(equal)
    text = " ".join(page.text)
    assert "exudyn: no difference found" in text and "would have been found" in text
    assert any("exudyn: no difference found" in text for text in page.text)
    failed = len(rows_of(equal, "failure"))
    assert f"Runs of others that failed: {failed}" in text and failed >= 4
    assert f"exudyn: no difference found; of {RUNS[1] - 2} runs (2 more failed) these differ: 0 for" in text
    assert len(page.evidence) == failed and "raw evidence" in page.evidence[0][1]


def test_counts_and_points_are_those_of_single_simulations(weaker):
    drawn = cloud(*FREE["free-standing"], RUNS[0])
    fallen = np.array([simulate(scene, history=False).outcome == "overturns" for scene in drawn.scenes])
    assert (np.isinf(weaker.arrays["free-standing/analytic/tilt"]) == fallen).all()
    for row in rows_of(weaker, "fit", state="overturning"):
        assert row["exceeded"] == fallen.sum() and sum(point["size"] for point in row["points"]) == len(fallen)
        order = np.argsort(drawn.measures[row["measure"]])
        first = fallen[order][: row["points"][0]["size"]]
        assert row["points"][0]["share"] == first.mean()
        assert (row["points"][0]["low"], row["points"][0]["high"]) == wilson(int(first.sum()), len(first))
    ratio = drawn.measures["PGA/(g tan γ)"][weaker.arrays["free-standing/near"]]
    assert len(ratio) == RUNS[1] and NEAR[0] <= ratio.min() and ratio.max() <= NEAR[1]
    (check,) = rows_of(weaker, "check")
    assert check["undecided"] == check["failed"] == 0


def test_uplift_hangs_on_the_peak_over_the_uplift_acceleration(weaker):
    """A free-standing block lifts at PGA = g tan γ, whatever the motion: no measure tells more of small tilts."""
    rows = rows_of(weaker, "fit", state="|φ|/γ > 0.1")
    (best,) = [row for row in rows if row["best"]]
    assert best["measure"] == "PGA/(g tan γ)" and 1.0 < best["median"] < 2.0
    usual = next(row for row in rows if row["measure"] == "PGA")
    assert usual["dispersion"] > 2 * best["dispersion"]


def test_failed_runs_are_left_out_in_pairs(equal):
    for row in rows_of(equal, "effect", solver="exudyn"):
        assert row["left_out"] == 2 and row["both_stand"] + row["both_overturn"] == RUNS[1] - 2
    assert np.isnan(equal.arrays["free-standing/exudyn/tilt"]).nonzero()[0].tolist() == [3, 7]


def test_a_curve_is_drawn_only_where_it_fits(weaker):
    rows = list(weaker.rows)
    for k, row in enumerate(rows):
        if row["part"] == "fit":
            rows[k] = {**row, "p_value": 0.5 if row["state"] == "overturning" else 0.01}
    pictures = STUDY.figures(dataclasses.replace(weaker, rows=rows))
    lines = {
        axis.get_title(): len([line for line in axis.lines if len(line.get_xdata()) == 200])
        for axis in pictures[""].axes
    }
    assert lines == {
        "free-standing\n|φ|/γ > 0.1": 0,
        "free-standing\n|φ|/γ > 0.5": 0,
        "free-standing\n|φ|/γ > 1": 0,
        "free-standing\noverturning": 1,
    }
    assert all(len(axis.containers) == 1 for axis in pictures[""].axes)  # the points always
    assert all(len(axis.containers) == 6 for axis in pictures["measures"].axes)
    assert len(pictures["solvers"].axes) == 1
