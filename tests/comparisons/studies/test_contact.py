"""Why engines err in one impact: the causes told are those of the rows, and what cannot be told is not silent."""

import pytest
from answered import answered, by_model

from analytic import simulate
from comparisons.measuring.autopsy import CAUSES
from comparisons.running.plan import Request
from comparisons.running.provenance import Result
from comparisons.running.sweep import Row
from comparisons.showing.parts import where
from comparisons.studies.restitution.cases import GROUNDS, IMPACT_SECONDS, Grid, impact_scene
from comparisons.studies.restitution.contact import contact
from comparisons.studies.restitution.study import plan

GRID = Grid((0.2,), (None,), (0.6,), (), 4, ((0.25,), (1.0,), (2.0,)))


def told(engine, variant="fine", tier="tuned", error=1e-7, cause=None, ground="rigid ground", **more):
    time = [-2e-3, -1e-3, 0.0, 1e-3, 2e-3]
    frames = {
        "straddle": {"time": time, "landing": [2e-3, 1e-3, 0.0, 0.0, 0.0]},
        "energy": {"time": time, "energy": [1.0, 1.0, 0.9, 0.9, 0.9]},
    }
    return {
        **{"engine": engine, "variant": variant, "tier": tier, "best": tier == "tuned", "ground": ground},
        **{"failure": None, "placed": False, "error": error, "cause": cause, "steps": 2, "lasting": 1e-3},
        **{"energy_lost": 0.1, "frames": frames, **more},
    }


def result(*rows):
    settings = {"why": {"slenderness": 0.2, "start": 0.6, "least": 1e-3, "causes": CAUSES}}
    return Result("restitution", settings, [{"part": "why", **row} for row in rows], {})


@pytest.mark.parametrize("ground", GROUNDS)
def test_the_scene_holds_one_impact_and_the_swing_after_it(ground):
    run = simulate(impact_scene(ground))
    assert run.impacts[0].time < IMPACT_SECONDS - 0.2 and run.end.time == pytest.approx(IMPACT_SECONDS)


def test_rows_carry_the_diagnosis_or_the_failure():
    def run(batch):
        if batch.label != "one impact":
            return by_model()(batch)
        crash, cost = {"reason": "a crash"}, {"cpu_seconds": 0.1}
        return [Row(case, {} if k else {"error": 1.23456e-7}, crash if k else None, cost, False)
                for k, case in enumerate(batch.cases)]  # fmt: skip

    rows = answered(plan(Request(("pymunk",)), GRID), run)[-1].rows
    first, *others = where(rows, part="why")
    assert (first["error"], first["failure"]) == (1.23456e-7, None) and all(row["failure"] for row in others)
    assert {row["ground"] for row in (first, *others)} == {*GROUNDS}


def test_the_page_counts_default_variants_and_names_the_causes_of_the_rest():
    bad = told("exudyn", "native", "defaults", -0.02, "adhesion", deepest=8e-4)
    page = contact(result(told("exudyn"), told("pymunk", "fast", best=False), told("pymunk"), bad))
    opening = page.opening()
    assert "2 of 2" in opening.title and "adhesion" in opening.title
    first, *sound = opening.tables[0].rows
    assert first[:4] == ["exudyn, native", "rigid ground", "−0.020", "adhesion"] and first[5] == "0.80"
    assert [row[0] for row in sound] == ["exudyn, fine", "pymunk, fine"]
    assert [row[0] for row in page.whole().tables[1].rows] == ["pymunk, fast"]  # each impact stands in one table
    assert opening.figures[0].svg.count(b'<svg class="chart"') == 2  # of the frames that these rows have
    worse = contact(result(told("exudyn", error=0.01, cause="step"), told("pymunk")))
    assert "1 of 2" in worse.title and "step" in worse.title


def test_what_cannot_be_told_is_evidence():
    silent = {"engine": "pybullet", "variant": "v", "ground": "rigid ground", "failure": None}
    crashed = {**silent, "engine": "dart", "failure": {"reason": "a crash"}}
    shown = contact(result(told("exudyn"), {**silent, "why_not": "no corner is struck"}, crashed)).whole()
    assert shown.evidence == (
        ("pybullet, v, rigid ground", "no corner is struck"),
        ("dart, v, rigid ground", "a crash"),
    )
    assert [row[0] for row in shown.tables[0].rows] == ["exudyn, fine"]
