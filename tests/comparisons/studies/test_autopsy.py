"""The study of one impact: its causes are those of its rows, and what cannot be told is not silent."""

import pytest
from answered import answered

from analytic import simulate
from comparisons.measuring.causes import CAUSES
from comparisons.running.provenance import Result
from comparisons.running.study import Ask
from comparisons.running.sweep import Row
from comparisons.studies.autopsy import STUDY
from comparisons.studies.autopsy.cases import GROUNDS, SECONDS, plan, scene_on


def told(engine, variant="fine", tier="tuned", error=1e-7, cause=None, ground="rigid ground", **more):
    time = [-2e-3, -1e-3, 0.0, 1e-3, 2e-3]
    frames = {
        "straddle": {"time": time, "landing": [2e-3, 1e-3, 0.0, 0.0, 0.0]},
        "energy": {"time": time, "energy": [1.0, 1.0, 0.9, 0.9, 0.9]},
    }
    row = {"engine": engine, "variant": variant, "tier": tier, "best": tier == "tuned", "ground": ground}
    row |= {"failure": None, "placed": False}
    return {**row, "error": error, "cause": cause, "steps": 2, "lasting": 1e-3, "lost": 0.1, "frames": frames, **more}


def result(*rows):
    settings = {"slenderness": 0.2, "start": 0.6, "least": 1e-3, "causes": CAUSES}
    return Result("autopsy", settings, list(rows), {})


def test_the_scene_holds_one_impact_and_the_swing_after_it():
    for ground in GROUNDS:
        run = simulate(scene_on(ground))
        assert run.impacts[0].time < SECONDS - 0.2 and run.end.time == pytest.approx(SECONDS)


def test_rows_carry_the_diagnosis_or_the_failure():
    def run(batch):
        assert {case.tag["ground"] for case in batch.cases} == set(GROUNDS)
        first = {"error": 1e-7, "cause": None}
        return [
            Row(case, {} if k else first, {"reason": "a crash"} if k else None, {"cpu_seconds": 0.1}, False)
            for k, case in enumerate(batch.cases)
        ]

    found = answered(plan(Ask(("pymunk",))), run)[-1]
    assert [row["failure"] is None for row in found.rows] == [True] + [False] * (len(found.rows) - 1)
    assert found.rows[0]["error"] == 1e-7 and {row["engine"] for row in found.rows} == {"pymunk"}


def test_the_finding_counts_the_best_and_names_the_causes_of_the_rest():
    bad = told("exudyn", "native", "defaults", -0.02, "adhesion", deepest=8e-4)
    found = STUDY.finding(result(told("exudyn"), told("pymunk"), bad))
    assert found.title.startswith("Why engines err: 2 of 2 impacts at their best") and "adhesion" in found.title
    (table,) = found.tables
    assert table.rows[0][:4] == ["exudyn, native", "rigid ground", "−0.020", "adhesion"] and table.rows[0][5] == "0.80"
    assert [row[3] for row in table.rows[1:]] == ["none (below 0.001)"] * 2
    worse = STUDY.finding(result(told("exudyn", error=0.01, cause="step"), told("pymunk")))
    assert "1 of 2 impacts" in worse.title and "step" in worse.title


def test_what_cannot_be_told_is_evidence():
    silent = {
        "engine": "pybullet",
        "variant": "v",
        "tier": "tuned",
        "best": True,
        "ground": "rigid ground",
        "failure": None,
    }
    crashed = {"engine": "dart", "variant": "v", "ground": "rigid ground", "failure": {"reason": "a crash"}}
    shown = STUDY.section(result(told("exudyn"), {**silent, "why_not": "no corner is struck"}, crashed))
    assert shown.evidence == (
        ("pybullet, v, rigid ground", "no corner is struck"),
        ("dart, v, rigid ground", "a crash"),
    )
    assert [row[0] for row in shown.tables[0].rows] == ["exudyn, fine"]
