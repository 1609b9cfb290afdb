"""The fragility study on a solver of which it is known how far it differs: the analytic model at other intensities."""

import dataclasses

import numpy as np
import pytest
from answered import answered

from analytic import simulate
from comparisons.measuring.statistics import wilson
from comparisons.running.provenance import read_result, write_result
from comparisons.running.study import Ask, compute
from comparisons.running.sweep import Row
from comparisons.studies.fragility import STUDY
from comparisons.studies.fragility.cases import FULL, MOTIONS, plan
from comparisons.studies.fragility.page import draw, section

SCENES = {"free-standing": ("caryatid-rigid", {}, (0.9, 1.0, 1.3))}
COUNT = 24
ENGINES = Ask(("exudyn", "pybullet"))


class Scaled:
    """In place of the engines: the analytic model under `factor` times the motion, failing for some seeds."""

    def __init__(self, factor, failing=()):
        self.factor, self.failing = factor, failing

    def __call__(self, batch):
        rows = []
        for case in batch.cases:
            failure = None
            if case.tag["seed"] in self.failing:
                failure = {"kind": "crash", "reason": "the worker process ended", "message": "raw evidence"}
            response = simulate(case.scene.with_(motion=case.scene.motion.scaled(self.factor)), history=False)
            rows.append(
                Row(case, {"outcome": response.outcome}, failure, {} if failure else {"cpu_seconds": 0.25}, False)
            )
        return rows


def study(tmp_path, work):
    (found,) = answered(plan(ENGINES, scenes=SCENES, motions=COUNT), work)
    return read_result(
        write_result(
            tmp_path / "fragility.json",
            "fragility",
            found.settings,
            found.rows,
            found.arrays,
            modules=["analytic"],
            seed=found.seed,
        )
    )


def rows_of(result, part, solver):
    return [row for row in result.rows if row["part"] == part and row["solver"] == solver]


def test_the_full_study_is_as_large_as_it_must_be():
    assert MOTIONS >= 200
    assert all(len(factors) >= 6 for _, _, factors in FULL.values())


def test_a_solver_that_is_the_model_does_not_differ(tmp_path):
    result = study(tmp_path, Scaled(1.0))
    pairs = rows_of(result, "pair", "exudyn")
    assert [row["only_a"] + row["only_b"] for row in pairs] == [0, 0, 0]
    assert all(row["p_value"] == row["p_holm"] == 1.0 for row in pairs)
    curves, reference = rows_of(result, "curve", "exudyn"), rows_of(result, "curve", "analytic")
    assert [row["overturned"] for row in curves] == [row["overturned"] for row in reference]
    text = " ".join(section(result).text)
    assert "exudyn: no difference found at this sample size" in text and "they differ" not in text


def test_a_solver_that_sees_weaker_motions_is_found_out(tmp_path):
    result = study(tmp_path, Scaled(0.8))
    pairs = rows_of(result, "pair", "pybullet")
    assert min(row["p_holm"] for row in pairs) < 0.05
    assert all(row["p_holm"] >= row["p_value"] for row in pairs)
    assert sum(row["only_a"] for row in pairs) > sum(row["only_b"] for row in pairs)
    assert rows_of(result, "fit", "pybullet")[0]["median"] is None or (
        rows_of(result, "fit", "pybullet")[0]["median"] > rows_of(result, "fit", "analytic")[0]["median"]
    )
    text = " ".join(section(result).text)
    assert "pybullet: they differ" in text


def test_counts_are_those_of_single_simulations(tmp_path):
    result = study(tmp_path, Scaled(1.0))
    outcomes = result.arrays["free-standing/analytic"]
    assert outcomes.shape == (3, COUNT)
    # engines' rows come from `simulate`, the reference from the batch: an independent path to the same outcomes
    assert (outcomes == result.arrays["free-standing/exudyn"]).all()
    for row, values in zip(rows_of(result, "curve", "analytic"), outcomes, strict=True):
        assert row["overturned"] == (values == 1).sum() and row["size"] == COUNT
        assert (row["low"], row["high"]) == pytest.approx(wilson(row["overturned"], COUNT))
    (check,) = (row for row in result.rows if row["part"] == "check")
    assert check["undecided"] == 0


def test_failed_runs_are_left_out_in_pairs_and_told(tmp_path):
    result = study(tmp_path, Scaled(1.0, failing=(3, 7)))
    assert [row["size"] for row in rows_of(result, "curve", "exudyn")] == [COUNT - 2] * 3
    assert [row["left_out"] for row in rows_of(result, "pair", "exudyn")] == [2, 2, 2]
    assert (result.arrays["free-standing/exudyn"][:, [3, 7]] == -1).all()
    page = section(result)
    assert "Runs that failed: 24" in " ".join(page.text)
    assert len(page.evidence) == 24 and "raw evidence" in page.evidence[0][1]


def test_the_figure_has_a_point_for_every_solver_and_intensity(tmp_path):
    result = study(tmp_path, Scaled(1.0))
    above, below = draw(result).axes
    assert len(above.containers) == 6 and all(len(bars[0].get_xdata()) == 3 for bars in above.containers)
    assert len(below.lines) == 5 and below.get_xlabel() and above.get_ylabel()
    share = above.containers[0][0].get_ydata()
    assert share == pytest.approx((result.arrays["free-standing/analytic"] == 1).mean(axis=1))
    assert np.all(np.diff(share) > 0)


def test_an_interrupted_study_takes_up_its_own_rows(tmp_path, monkeypatch):
    """Real runs in real worker processes; the first attempt ends in the middle."""
    scenes = {"free-standing": ("caryatid-rigid", {}, (1.0,))}
    store = tmp_path / "runs.jsonl"

    def attempt():
        (path,) = compute(STUDY, tmp_path, engines=ENGINES.engines, workers=1, progress=False, scenes=scenes, motions=2)
        return read_result(path)

    def stopping(ask, **options):
        steps, rows = plan(ask, **options), None
        for _ in range(2):
            rows = yield steps.send(rows)
        raise KeyboardInterrupt

    stopped = dataclasses.replace(STUDY, plan=stopping)
    with pytest.raises(KeyboardInterrupt):
        compute(stopped, tmp_path, engines=ENGINES.engines, workers=1, progress=False, scenes=scenes, motions=2)
    before = store.read_text()
    assert len(before.splitlines()) == 4
    first = attempt()
    assert store.read_text().startswith(before)
    assert len(store.read_text().splitlines()) == 8
    again = attempt()  # nothing left to run
    assert len(store.read_text().splitlines()) == 8
    assert without_cost(again.rows) == without_cost(first.rows)
    assert all((first.arrays[name] == again.arrays[name]).all() for name in first.arrays)


def without_cost(rows):
    return [{key: value for key, value in row.items() if key != "cpu_per_run"} for row in rows]
