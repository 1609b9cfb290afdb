"""The study of a shake table, on made-up tests: both layouts are read, nothing of a single test is stored, what is told
is what was counted. The real tests, where they are at hand: `REAL`."""

import dataclasses
import gzip
import itertools
import json
import math
import sys
from pathlib import Path

import numpy as np
import pytest
from answered import answered, by_model, by_runs, stored
from record_files import write
from table_tests import MEASURED, RECORDS, RESULTS, SHEET, book, fell, labview, lists, own, peak_of, published, pulse

from analytic import simulate
from analytic.errors import SettingError
from analytic.records import G
from analytic.rocking import RockingModel
from comparisons.measuring.forecasts import FEWEST, right
from comparisons.measuring.statistics import wilson
from comparisons.running import provenance
from comparisons.running.plan import Request
from comparisons.running.run_sample import sample_of
from comparisons.showing.parts import where
from comparisons.studies import get_study
from comparisons.studies.rows import ROWS, read_study, wrong_with
from comparisons.studies.shake_table import at_hand, campaign, granite, study
from comparisons.studies.shake_table.campaign import outcomes_of
from comparisons.studies.shake_table.judging import (
    BY_RECORD,
    MODEL,
    Forecast,
    Outcomes,
    judged,
    of_each_record,
    paired,
    score,
)
from comparisons.studies.shake_table.reading import read_campaign
from comparisons.studies.shake_table.runs import ALL, answers, differences
from comparisons.studies.shake_table.shaking import leaning, over_slendernesses
from comparisons.studies.shake_table.telling import array_of, cell_rows, cells, may_be_told, quarter_rows, text_of
from comparisons.studies.shake_table.told import ALIKE
from engines import ENGINES

RESULT = provenance.RESULTS / "shake-table"
REAL = Path(__file__).parents[4] / "shared" / "experiments" / "granite-blocks"
ENGINE = next(iter(ENGINES))
FAILURE = {"kind": "solver", "reason": "the solver gave up", "message": "no convergence"}
needs_tests = pytest.mark.skipif(
    not (REAL / RESULTS).is_file(), reason="the shake-table tests are not here (../shared/experiments/granite-blocks)"
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return published(tmp_path_factory.mktemp("published"), without=(13, 20))


@pytest.fixture
def small(monkeypatch):
    """A grid that is quickly run."""
    monkeypatch.setattr(campaign, "GRID", 9)
    monkeypatch.setattr(study, "KINDS", ({}, {"friction": 0.5}))


def unlike(case):
    """The scene of a run, which in an engine ends otherwise in a few tests."""
    if case.solver == "analytic" or case.tag["test"] not in ("22", "23"):
        return case.scene
    return case.scene.with_(motion=case.scene.motion.scaled(0.01))


def spoilt(case):
    return FAILURE if case.solver != "analytic" and case.tag == {"test": "12", "specimen": "boulder 2"} else None


@pytest.fixture
def found(folder, small, tmp_path):
    """(the answer with the model in the engine's place, which misses two and fails once; its result)."""
    last = answered(study.plan(Request((ENGINE,)), data=str(folder)), by_model(unlike, spoilt))[-1]
    return last, stored(tmp_path, "shake-table", last)


@pytest.mark.parametrize("packed", [True, False])
@pytest.mark.parametrize("rate", [200, 800])
def test_the_published_layout_is_read_at_any_sampling(tmp_path, rate, packed):
    place = published(tmp_path, range(11, 15), rate, packed, without=(13,))
    one = read_campaign(place)
    assert [test.name for test in one.tests] == ["11", "12", "14"] and len(one.missing) == 1
    for test in one.tests:
        number = int(test.name)
        assert test.motion.dt == pytest.approx(1 / rate, rel=1e-12)
        assert test.motion.peak == pytest.approx(peak_of(number) * G, rel=5e-3)  # Plot 0, in g, less its offset
        assert test.motion.samples[:10].tolist() == pytest.approx([0.0] * 10, abs=1e-5)
        assert test.overturned == (bool(fell(number, 0)), bool(fell(number, 1)))
        assert list(test.authors[0]) == ["KN=1 KS=1", "KN=3 KS=1"] and test.authors[0]["KN=1 KS=1"] is True
        assert test.stated == pytest.approx({"peak": peak_of(number), "ratio": 0.1 + 0.001 * number})


def test_a_checkout_of_the_repository_and_the_folder_in_it_are_one_campaign(tmp_path):
    place = tmp_path / "data" / "Shake_Table_Response"
    place.mkdir(parents=True)
    published(place, range(11, 14))
    assert read_campaign(tmp_path).digest() == read_campaign(place).digest()


def test_a_record_has_one_name_however_it_is_written():
    for words in ("'RSN1114_KOBE.xlsx'", " RSN1114_KOBE-NS.AT2 ", "RSN1114_KOBEx.xlsx'", "RSN1114_KOBE_A-2--T"):
        assert granite.record_of(words) == "RSN1114"
    assert granite.record_of("Somewhere ") == granite.record_of(" Somewhere") == "Somewhere"
    assert granite.record_of("RSN11140_X") != "RSN1114"


def test_ones_own_tests_are_read_with_the_slenderness_of_their_scene_as_a_hint(tmp_path):
    one = read_campaign(own(tmp_path, range(6)))
    assert [test.record for test in one.tests[:2]] == ["' RSN1_MADEUP.xlsx'", "RSN1_MADEUP-NS.AT2"]
    assert [test.overturned for test in one.tests] == [(bool(fell(n, 0)),) for n in range(6)]
    assert one.tests[3].motion.peak == pytest.approx(peak_of(3) * G, rel=1e-3)
    (block,) = one.specimens
    assert block.span == pytest.approx((0.055, 0.165)) and block.scene.motion is None
    assert len(read_campaign(tmp_path, every=4).tests) == 2


def refused(folder, *words):
    with pytest.raises(SettingError) as caught:
        read_campaign(folder)
    assert "\n" not in str(caught.value) and all(word in str(caught.value) for word in words), str(caught.value)


def test_no_folder_and_a_folder_of_something_else_are_refused(tmp_path):
    refused(tmp_path / "none", "no such folder")
    refused(write(tmp_path, "", "file"), "no such folder")
    empty = tmp_path / "empty"
    empty.mkdir()
    refused(empty, RESULTS, "tests.csv", granite.REPOSITORY)


# what is done to the rows of the results: words of the message
LISTS = {
    "an outcome that is none": (
        lambda rows: [*rows[:2], [12, 2, *rows[2][2:]], *rows[3:]],
        ("row 3", f"{MEASURED[0]} = 2"),
    ),
    "an outcome that is missing": (lambda rows: [*rows[:2], [12, 0, None, *rows[2][3:]]], ("row 3", "None", "write 1")),
    "a column that is missing": (lambda rows: [row[:2] + row[3:] for row in rows], (f"no column {MEASURED[1]!r}",)),
    "a number that is no test": (lambda rows: [*rows, [99, *rows[1][1:]]], ("Test Number = 99", "no such test")),
    "no list": (lambda rows: [["something else"]], ("no column 'Test Number'",)),
}


@pytest.mark.parametrize("change, words", LISTS.values(), ids=LISTS)
def test_a_damaged_list_is_refused_by_file_row_and_value(tmp_path, change, words):
    published(tmp_path, range(11, 14))
    lists(tmp_path, range(11, 14), change)
    refused(tmp_path, str(tmp_path / RESULTS), *words)


def test_a_damaged_or_missing_workbook_a_missing_sheet_and_a_missing_reader_are_refused(tmp_path, monkeypatch):
    published(tmp_path, range(11, 13))
    whole = (tmp_path / RESULTS).read_bytes()
    write(tmp_path, whole[: len(whole) // 2], RESULTS)
    refused(tmp_path, RESULTS, "no readable workbook", "fetch it again")
    book(tmp_path / RESULTS, {"Sheet1": [["Test Number"]]})
    refused(tmp_path, f"no sheet {SHEET!r}, but Sheet1")
    write(tmp_path, whole, RESULTS)
    (tmp_path / RECORDS).unlink()
    refused(tmp_path, RECORDS, "fetch it again")
    monkeypatch.setitem(sys.modules, "openpyxl", None)
    refused(tmp_path, "needs openpyxl", 'pip install -e ".[records]"')


def test_damaged_motions_are_refused_and_missing_ones_left_out(tmp_path):
    published(tmp_path, range(11, 14), packed=False)
    text = labview(*pulse(0.2, 200))
    write(tmp_path, text.replace("\n0.5\t", "\n0.x\t", 1), "Test012.txt")
    refused(tmp_path, "Test012.txt: line ")
    write(tmp_path, "", "Test012.txt")
    refused(tmp_path, "Test012.txt: record: is empty")
    (tmp_path / "Test012.txt").unlink()
    write(tmp_path, gzip.compress(text.encode())[:200], "Test012.txt.gz")
    refused(tmp_path, "Test012.txt.gz", "damaged gzip")
    (tmp_path / "Test012.txt.gz").unlink()
    assert len(read_campaign(tmp_path).missing) == 1
    for file in tmp_path.glob("Test*.txt"):
        file.unlink()
    refused(tmp_path, "no test has a motion")


def test_a_block_of_another_slenderness_keeps_its_height_and_its_inertia_about_its_centre():
    for boulder, (mass, height, _) in zip(granite.specimens(), granite.BOULDERS.values(), strict=True):
        for angle in (0.04, 0.12, 0.24):
            block = leaning(boulder.scene, angle).block
            assert block.half_height == pytest.approx(height) and block.slenderness == angle
            assert block.centre_inertia == pytest.approx(granite.INERTIA * granite.DENSITY) and block.mass == mass
    scene = leaning(boulder.scene, 0.1, restitution=0.9, inertia=1.1, friction=0.4)
    plain = leaning(boulder.scene, 0.1, inertia=1.1)
    assert scene.block.restitution == pytest.approx(0.9 * RockingModel.of(plain).restitution) and scene.friction == 0.4
    assert plain.block.centre_inertia == pytest.approx(1.1 * granite.INERTIA * granite.DENSITY)


def test_the_digits_over_slendernesses_are_those_of_single_runs(folder, small):
    cases = study._on_grids(read_campaign(folder, every=9), study.KINDS)
    for case in cases[:3]:
        found = over_slendernesses(case, None)["outcomes"]
        for kind, text in zip(case.tag["kinds"], found, strict=True):
            single = [simulate(leaning(case.scene, one, **kind), history=False) for one in case.tag["slendernesses"]]
            assert text == text_of(one.outcome for one in single)


def test_the_probability_is_the_share_of_a_normal_spread_that_overturns():
    grid = np.radians(np.linspace(2, 14, 601))
    model = np.tile(grid < np.radians(6.5), (3, 1))
    one = Outcomes(grid, model, np.array([True, False, True]))
    place = int(np.argmin(np.abs(one.settings - np.radians([7.0, 1.0])).sum(axis=1)))
    assert one.probabilities[:, place] == pytest.approx([0.3085] * 3, abs=0.005)  # Phi(-1/2)


def test_the_slenderness_is_recovered_from_tests_that_the_model_itself_made():
    """Outcomes of blocks whose slenderness scatters: fitted are the mean and the spread that made them."""
    rng, grid = np.random.default_rng(0), np.radians(np.linspace(2, 14, 61))
    critical = np.radians(rng.uniform(4, 12, 4000))  # a test overturns what is more slender
    measured = np.radians(rng.normal(8.0, 1.2, 4000)) < critical
    one = Outcomes(grid, grid[None] < critical[:, None], measured)
    mean, spread = np.degrees(one.settings[one.fitted(np.ones(4000, dtype=bool))])
    assert mean == pytest.approx(8.0, abs=0.25) and spread == pytest.approx(1.2, abs=0.3)
    assert math.degrees(grid[one.best(np.ones(4000, dtype=bool))]) == pytest.approx(8.0, abs=0.5)
    probability = judged(Forecast(MODEL, one.spread), [str(k % 50) for k in range(4000)], BY_RECORD)
    assert np.isfinite(probability).all()
    best = math.sqrt(2 * math.pi)  # nothing
    assert score(probability, measured, list(range(4000)))["brier"] < 0.12 < best


def test_paired_differences_by_hand():
    one, other = np.array([0.9, 0.2, 0.6, 0.4]), np.array([0.6, 0.7, 0.8, 0.1])
    said = paired(one, other, np.array([True, False, False, False]), ["a", "b", "c", "d"])
    assert said["difference"] == pytest.approx((0.16 - 0.01 + 0.49 - 0.04 + 0.64 - 0.36 + 0.01 - 0.16) / 4)
    low, high = said["interval"]
    assert (said["disagree"], said["right"]) == (1, 1) and low < said["difference"] < high
    assert said["more_right"] == 1 and said["more_interval"] == pytest.approx([0, 3])  # of 4 groups one may come thrice


def test_differences_of_an_engine_and_their_sign_by_hand():
    ours, theirs = "1111110000", "0000110x0-"
    said = differences(theirs, ours, ["a", "a", "a", "b", "b", "c", "c", "d", "d", "e"], np.arange(10) < 2)
    assert (said["size"], said["failed"], said["only_a"], said["only_b"]) == (9, 1, 4, 0)
    assert (said["both_overturn"], said["both_stand"]) == (2, 2) and said["p_value"] == pytest.approx(0.125)
    assert (said["records_a"], said["records_b"], said["p_records"]) == (2, 0, pytest.approx(0.5))
    assert said["on_edge"] == 2 and said["interval"] == pytest.approx(wilson(5 / 9 * 4, 4))


@pytest.mark.parametrize(
    "text, others, told",
    [
        ("1111100000", ["0000000000"], True),
        ("1111000000", ["0000000000"], False),
        ("0000000000", ["0000000000"], True),
        ("11111-----", ["0000-00000"], False),
        ("111110000x", ["1111100000"], False),
        ("1111100000", ["0000000000", "1111110000"], False),
    ],
)
def test_right_answers_are_told_where_they_say_nothing_of_fewer_than_five_tests(text, others, told):
    assert may_be_told(text, others) == told


def test_a_failed_run_is_not_right_and_keeps_misses_and_false_alarms_back():
    measured = np.array([True] * 6 + [False] * 6)
    model = {"part": "run", "engine": "analytic", "variant": "", "specimen": "b", "outcomes": "111111000000"}
    said = answers("000000x00000", [model], [], measured, list(range(12)))
    assert (said["right"], said["model_right"], said["misses"], said["false_alarms"]) == (5, 12, None, None)
    said = answers("000000000000", [model], [], measured, list(range(12)))
    assert (said["right"], said["misses"], said["false_alarms"]) == (6, 6, 0)
    assert answers("111111x00000", [model], [], measured, list(range(12)))["right"] is None


@pytest.mark.parametrize("count", [5, 19, 20, 61, 490])
def test_every_test_is_in_one_cell_of_five_or_more(count):
    rng = np.random.default_rng(count)
    x, y = rng.lognormal(size=(2, count))
    found = cells(x, y)
    assert sorted(np.concatenate(found).tolist()) == list(range(count)) and min(map(len, found)) >= FEWEST
    rows = cell_rows((x, y), x > 1, np.where(x > 1, 0.9, 0.1))
    assert sum(row["size"] for row in rows) == count and sum(row["overturned"] for row in rows) == (x > 1).sum()


def test_quarters_hold_every_test_once_and_few_tests_have_none():
    rng = np.random.default_rng(1)
    ratio, fell_over = rng.lognormal(size=50), rng.random(50) < 0.4
    rows = quarter_rows(ratio, fell_over, np.full(50, 0.25))
    assert [row["size"] for row in rows] == [13, 13, 12, 12] and [row["mean"] for row in rows] == [0.25] * 4
    assert sum(row["overturned"] for row in rows) == fell_over.sum()
    assert [row["ratio"] for row in rows] == sorted(row["ratio"] for row in rows)
    assert quarter_rows(ratio[:16], fell_over[:16], ratio[:16]) == []


def test_a_threshold_for_each_record_is_right_where_the_scale_alone_decides():
    records, values = ["a"] * 4 + ["b"] * 4, np.array([1.0, 2, 3, 4, 10, 20, 30, 40])
    fell_over = np.array([False, False, True, True, True, True, False, True])
    said = of_each_record(values, fell_over, records)
    assert said[:4].tolist() == [0, 0, 1, 1] and (said[4:] == fell_over[4:]).sum() == 3


def test_what_the_missing_tests_did_is_told_as_sums_where_they_are_many(tmp_path, small):
    place = published(tmp_path, without=range(11, 18))
    answer = answered(study.plan(Request(()), data=str(place)), by_model())[-1]
    missing = answer.settings["missing"]
    assert missing["tests"] == 7 and missing["overturned"] == [sum(fell(n, k) for n in range(11, 18)) for k in (0, 1)]
    for mean, numbers in zip(missing["ratios"], (range(11, 18), range(18, 35)), strict=True):
        assert mean == pytest.approx(math.exp(np.mean([math.log(0.1 + 0.001 * n) for n in numbers])))
    words = " ".join(get_study("shake-table").page(stored(tmp_path, "shake-table", answer)).whole().measured)
    assert "7 tests have no motion at hand" in words and "published at 800 Hz" in words


# What a row may have of what was measured: sums over all tests, and over cells; by test there are our own outcomes.
STORED = {
    "score": {
        "size",
        "right",
        "low",
        "high",
        "misses",
        "false_alarms",
        "brier",
        "brier_interval",
        "forecast",
        "judged",
    },
    "fit": {
        "change",
        "slenderness",
        "centre",
        "spread",
        "alone_right",
        "neighbours",
        "size",
        "right",
        "brier",
        "brier_interval",
    }
    | {"misses", "false_alarms"},
    "paired": {"forecast", "beside", "difference", "interval", "more_right", "more_interval", "disagree", "right"},
    "reliability": {"forecast", "size", "mean", "happened"},
    "where": {"among", "forecast", "size", "right"},
    "quarter": {"size", "ratio", "overturned", "mean"},
    "cell": {"size", "pga", "ratio", "overturned", "mean"},
    "run": {"slenderness", "outcomes", "failed", "cpu_seconds"},
    "engine": {"tier", "size", "failed", "both_stand", "both_overturn", "only_a", "only_b", "p_value", "records_a"}
    | {
        "records_b",
        "p_records",
        "near",
        "on_edge",
        "equal",
        "interval",
        "right",
        "low",
        "high",
        "misses",
        "false_alarms",
        "model_right",
    }
    | {"tilt"},
    "failure": {"test", "kind", "reason", "message"},
    "absent": {"reason"},
}
SETTINGS = {"quick", "campaign", "digest", "cite", "tests", "records", "missing", "steps", "overturned", "agree"}
SETTINGS |= {"published", "specimens", "kinds", "equal", "others", "variants", "model_runs", "model_seconds"}
OF_ALL = {"part", "engine", "variant", "specimen"}


@pytest.fixture(params=["computed here", "stored"])
def told(request):
    """A result that was just computed of made-up tests, and the one that this project stores, of real ones."""
    if request.param == "stored":
        return read_study(RESULT)
    return request.getfixturevalue("found")[1]


def test_no_column_is_stored_that_could_hold_what_was_measured_in_one_test(told):
    assert ROWS["shake-table"].keys() == STORED.keys()
    for row in told.rows:
        assert row.keys() <= OF_ALL | STORED[row["part"]] and wrong_with(row, "shake-table") is None
    assert told.settings.keys() == SETTINGS | {"changed_while_running"}
    grid = len(told.settings["specimens"][0]["grid"])
    assert {*told.arrays} == {f"right/{kind}" for kind in told.settings["kinds"]}  # sums over all tests
    assert all(array.shape == (2, grid) for array in told.arrays.values()) and told.runs == []
    for row in where(told.rows, part={"cell", "reliability", "quarter", "where"}):
        assert row["size"] >= FEWEST
    for row in where(told.rows, part="run"):
        assert {*row["outcomes"]} <= set("01x-") and len(row["outcomes"]) == len(told.settings["tests"])


def test_no_sum_beside_outcomes_by_test_says_what_was_measured_in_a_few(told):
    for specimen in ("boulder 1", "boulder 2"):
        runs = where(told.rows, part="run", specimen=specimen)
        shown = [runs[0], *(run for run in runs[1:] if _row_of(told, run)["right"] is not None)]
        for one, other in itertools.combinations(shown, 2):
            pair = array_of(one["outcomes"]), array_of(other["outcomes"])
            apart = int(((pair[0] != pair[1]) & (pair[0] != "-") & (pair[1] != "-")).sum())
            assert apart == 0 or apart >= FEWEST


def test_a_sum_that_says_too_much_is_kept_back(found):
    _, result = found
    assert any(row["right"] is None for row in where(result.rows, part="engine", specimen={"boulder 1", "boulder 2"}))


def _row_of(result, run):
    (row,) = where(result.rows, part="engine", **{key: run[key] for key in ("engine", "variant", "specimen")})
    return row


def test_no_motion_of_a_table_is_stored_with_the_runs(folder, small):
    done, rows = [], None
    plan = study.plan(Request(()), data=str(folder))
    run = by_model()
    while True:
        try:
            step = plan.send(rows)
        except StopIteration:
            break
        rows = run(step) if hasattr(step, "cases") else None
        done += [(step, row) for row in rows or ()]
    assert len(done) > 40 and sample_of(done) == []
    motion = done[0][1].case.scene.motion
    unnamed = dataclasses.replace(motion, label="sampled motion")
    case = dataclasses.replace(done[0][1].case, scene=done[0][1].case.scene.with_(motion=unnamed))
    assert sample_of([(done[0][0], dataclasses.replace(done[0][1], case=case))])  # without its name it would be


def test_rows_of_the_study_are_what_was_counted(found, folder):
    answer, result = found
    one = read_campaign(folder)
    assert result.settings["missing"] == {"tests": 2, "overturned": None, "ratios": None}  # too few to tell
    assert len(result.settings["tests"]) == len(one.tests) == 22
    for k, specimen in enumerate(("boulder 1", "boulder 2")):
        measured = outcomes_of(one.tests, k)
        (row,) = where(result.rows, part="score", specimen=specimen, forecast=MODEL, judged=BY_RECORD)
        hit = right(at_hand.of(result.settings).probabilities[k], measured)
        assert row["right"] == hit.sum() and row["misses"] == (measured & ~hit).sum()
        assert row["misses"] + row["false_alarms"] == 22 - row["right"]
        (fit,) = where(result.rows, part="fit", specimen=specimen, change="as it is")
        grid = result.settings["specimens"][k]["grid"]
        best, counts = grid.index(fit["slenderness"]), result.arrays["right/as it is"][k]
        assert counts[best] == fit["alone_right"] == counts.max()
        ours = where(result.rows, part="run", engine="analytic", specimen=specimen)[0]
        assert int((array_of(ours["outcomes"]) == np.where(measured, "1", "0")).sum()) == fit["alone_right"]
        assert sum(cell["overturned"] for cell in where(result.rows, part="cell", specimen=specimen)) == measured.sum()
        for row in where(result.rows, part="engine", specimen=specimen):
            assert row["failed"] == (specimen == "boulder 2") and row["only_b"] == 0 < row["only_a"] <= 2
    apart = sum(fell(n, 0) != fell(n, 1) for n in range(11, 35) if n not in (13, 20))
    assert result.settings["agree"] == 22 - apart and 0 < apart < FEWEST
    assert not where(result.rows, part="where", among=ALIKE)  # the rest would be few
    for row in where(result.rows, part="engine", specimen=ALL):
        parts = where(result.rows, part="engine", engine=row["engine"], variant=row["variant"])
        assert row["only_a"] == sum(part["only_a"] for part in parts if part["specimen"] != ALL)
    assert len(where(result.rows, part="failure")) == len(result.settings["variants"]) > 1


def test_the_page_with_the_campaign_at_hand_draws_every_test_and_without_it_cells(found, monkeypatch):
    _, result = found
    page = get_study("shake-table").page(result)
    text = page.whole()
    here = "".join(figure.svg.decode() for figure in text.figures)
    assert here.count("test 11: ") == 2 and "Every test: filled" in "".join(one.caption for one in text.figures)
    assert "–" not in _right_of_engines(text)
    monkeypatch.setattr(at_hand, "_READ", {})
    bare = get_study("shake-table").page(result).whole()
    cells_drawn = "".join(figure.svg.decode() for figure in bare.figures)
    assert "test 11: " not in cells_drawn and "overturned; model" in cells_drawn
    assert "–" in _right_of_engines(bare)
    assert "slenderness, fitted to all tests" in bare.figures[0].caption and granite.DOI in " ".join(bare.measured)
    assert "Tuned engines differ from the model in" in " ".join(bare.text)
    said = " ".join(part for part in bare.parts if isinstance(part, str))
    assert f"the same outcome in {result.settings['agree']}." in said


def _right_of_engines(section):
    """Right answers of engines, as the page has them, of both specimens."""
    (one,) = [one for one in section.tables if "beside what was measured" in one.caption]
    places = [place for place, head in enumerate(one.columns) if head.endswith(": right")]
    assert len(places) == 2
    return [row[place] for row in one.rows for place in places]


def test_without_data_the_page_says_where_they_are_to_be_had(tmp_path):
    (answer,) = answered(study.plan(Request(())), by_model())
    result = stored(tmp_path, "shake-table", answer)
    page = get_study("shake-table").page(result)
    assert granite.REPOSITORY in " ".join(page.lead) and page.opening() is None
    assert study.problems(result) and get_study("shake-table").judgements(result) == ()


def test_tests_of_ones_own_go_all_the_way(tmp_path, small):
    place = tmp_path / "own"
    place.mkdir()
    plan = study.plan(Request((ENGINE,)), data=str(own(place)))
    result = stored(tmp_path, "shake-table", answered(plan, by_model())[-1])
    assert result.settings["agree"] is None and result.settings["cite"] == ""
    assert not where(result.rows, among=ALIKE) and not where(result.rows, specimen=ALL)
    whole = get_study("shake-table").page(result).whole()
    words = " ".join((*whole.text, *whole.measured, *(part for part in whole.shown if isinstance(part, str)))).lower()
    assert whole.figures and "one campaign" in words
    assert not [word for word in ("granite", "boulder", "mesh", "referee", "first second") if word in words]
    assert len(get_study("shake-table").judgements(result)) == 1
    assert json.dumps(result.settings).find(str(tmp_path)) == -1  # no place of anyone's machine


def test_quick_takes_one_test_in_twenty(folder, small):
    answer = answered(study.plan(Request((), quick=True), data=str(folder)), by_model())[-1]
    assert answer.settings["tests"] == ["11", "33"] or len(answer.settings["tests"]) == 2


def test_real_runs_of_the_model_are_those_of_the_study(tmp_path, folder, monkeypatch):
    """Through the runner, with its store: nothing is run twice."""
    monkeypatch.setattr(campaign, "GRID", 5)
    monkeypatch.setattr(study, "KINDS", ({},))
    place = tmp_path / "runs"
    first = answered(study.plan(Request(()), data=str(folder)), by_runs(place))[-1]
    lines = (place / "runs.jsonl").read_text().count("\n")
    again = answered(study.plan(Request(()), data=str(folder)), by_runs(place))[-1]
    assert (place / "runs.jsonl").read_text().count("\n") == lines and again.rows == first.rows


@needs_tests
def test_the_real_campaign_is_read():
    one = read_campaign(REAL, every=40)
    assert len(one.tests) == 13 and len(one.missing) == 92
    assert all(abs(np.median(test.motion.samples[:200])) < 1e-9 for test in one.tests)
    assert {len(test.authors[0]) for test in one.tests} == {5} and {len(test.authors[1]) for test in one.tests} == {8}
    assert all(test.motion.dt == pytest.approx(0.005) for test in one.tests)
