"""The constants study: each constant is really another one in its runs, and the table says what moved."""

import pytest
from answered import answered, by_model, stored

from comparisons.running.cases import Case
from comparisons.running.plan import Request
from comparisons.running.run_sample import case_of
from comparisons.showing.parts import where
from comparisons.studies import get_study
from comparisons.studies.constants.page import NOT_A_BIT
from comparisons.studies.constants.study import changed, measure
from comparisons.studies.restitution.cases import free_scene, variants_of
from engines import installed_engines

DECLARED = [one for one in variants_of(installed_engines()) if one[2].constants]
HARD, STUDY = "engines.step_size:GROWTH", get_study("constants")


@pytest.fixture(scope="module")
def found():
    (found,) = answered(STUDY.plan(Request(installed_engines(), quick=True)), by_model())
    return found


@pytest.mark.parametrize("engine, name, variant", DECLARED, ids=lambda one: one if isinstance(one, str) else "")
def test_every_constant_declared_is_there_and_changes(engine, name, variant):
    for constant in variant.constants:
        value, given = changed(variant, constant, 2.0)
        (other,) = (
            given.get("constants", given["settings"]).values() if ":" in constant else [given["settings"][constant]]
        )
        assert other == 2 * value and type(other) is type(value)


def test_a_run_has_the_changed_constant_and_the_next_one_has_not():
    pytest.importorskip("pybullet")
    scene = free_scene(0.2, None, 0.6).with_(duration=1.0)
    plain = Case(scene, DECLARED[-1][0], settings={"history": False})
    other = Case(scene, plain.solver, settings=plain.settings, constants={"engines.stepping:SMALLEST_STEP": 1e-5})
    before, between, after = (measure(case, case.run()) for case in (plain, other, plain))
    assert before == after != between and between["steps"] < before["steps"]
    assert plain.key(measure) != other.key(measure)


def test_a_constant_that_is_none_is_an_error():
    case = Case(free_scene(0.2, None, 0.6), constants={"engines.step_size:NONE": 1.0})
    with pytest.raises(AttributeError, match="NONE"):
        case.run()


def test_rows_are_those_of_every_change(found):
    assert {row["engine"] for row in found.rows} == {engine for engine, *_ in DECLARED}
    for engine, name, variant in DECLARED:
        rows = where(found.rows, engine=engine, variant=name)
        assert [row["change"] for row in rows] == ["as it is", *["halved", "doubled"] * len(variant.constants)]
        assert [row["constant"] for row in rows[1::2]] == list(variant.constants)


def test_the_page_says_what_moved(found, tmp_path):
    first, row = found.rows[0], found.rows[2]
    row.update(first, **{key: row[key] for key in ("change", "constant", "what", "value")})
    for one in found.rows:
        one.update(rms=1e-4, peak_median=1e-4, peak_worst=1e-4)
    row.update(rms=3e-4, peak_median=1.05e-4, peak_worst=0.5e-4, outcomes_changed=1, moved=5, cpu_ratio=2.0)
    page = STUDY.page(stored(tmp_path, "constants", found))
    line = page.whole().tables[0].rows[0]
    assert line[-1] == "1 other outcomes; e × 3.0; peak, worst × 0.50; CPU × 2.0"
    assert page.whole().tables[0].rows[1][-1] == NOT_A_BIT
    assert f": {row['constant'].rpartition(':')[2].replace('_', ' ')} alone moves" in page.title


def test_the_row_of_a_run_that_failed_has_its_reason(tmp_path):
    def failure(case):
        return {"kind": "solver", "reason": "it fell apart"} if case.tag["change"] == "halved" else None

    (found,) = answered(STUDY.plan(Request(installed_engines(), quick=True)), by_model(failure=failure))
    page = STUDY.page(stored(tmp_path, "constants", found))
    runs = found.rows[0]["runs"]
    assert page.whole().tables[0].rows[0][-2:] == [f"{runs} runs fail", NOT_A_BIT]
    assert page.evidence[0][1] == "it fell apart"


def test_a_stored_run_keeps_its_constants():
    scene = free_scene(0.2, None, 0.6)
    table = {"scene": scene.model_dump(), "engine": "analytic", "variant": None, "settings": {}, "tag": {}}
    assert case_of({**table, "constants": {HARD: 8}}).constants == {HARD: 8} and case_of(table).constants == {}
