"""The study of a shake table, on made-up tests: both layouts are read, nothing of a single test is stored, what is told
is what was counted. The real tests, where they are at hand: `REAL`."""

import dataclasses
import gzip
import json
import math
import sys
from pathlib import Path

import numpy as np
import pytest
from answered import answered, by_model, by_runs, stored
from made_up_shake_table import (
    MEASURED,
    NAMES,
    RECORDS,
    RESULTS,
    SCENE,
    SHEET,
    book,
    fell,
    labview,
    lists,
    own,
    peak_of,
    published,
    pulse,
)
from record_files import write

from analytic import SceneError, SettingError, simulate
from analytic.records import G
from analytic.rocking import RockingModel
from comparisons.execution import results
from comparisons.execution.by_solver import check_same, split
from comparisons.execution.plan import Request
from comparisons.execution.runner import sample_of
from comparisons.metrics.statistics import wilson
from comparisons.plotting.parts import where
from comparisons.studies import get_study
from comparisons.studies.rows import read_study, wrong_with
from comparisons.studies.shake_table import campaign, study
from comparisons.studies.shake_table.campaign import ALL, FEWEST, PADDED, disclosed, outcomes_of, read_campaign
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
from comparisons.studies.shake_table.study import answers, differences, leaning, over_slendernesses
from engines import ENGINES

pytestmark = pytest.mark.xdist_group("shake table")  # its runs are made once

RESULT = results.RESULTS / "shake-table"
REAL = Path(__file__).parents[4] / "shared" / "experiments" / "granite-blocks"
ENGINE = next(iter(ENGINES))
FAILURE = {"kind": "solver", "reason": "the solver gave up", "message": "no convergence"}
needs_tests = pytest.mark.skipif(
    not (REAL / RESULTS).is_file(), reason="the shake-table tests are not here (../shared/experiments/granite-blocks)"
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return published(tmp_path_factory.mktemp("published"), without=(13, 20))


@pytest.fixture(scope="module", autouse=True)
def small():
    """A grid that is quickly run."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(campaign, "GRID", 9)
        patch.setattr(study, "KINDS", ({}, {"restitution": 0.9}, {"friction": 0.5}))
        yield


@pytest.fixture(scope="module")
def found(folder, tmp_path_factory):
    """The result with the model in the engine's place, which misses two and fails once."""
    last = answered(study.plan(Request((ENGINE,)), data=str(folder)), by_model(unlike, spoilt))[-1]
    return stored(tmp_path_factory.mktemp("found"), "shake-table", last)


def unlike(case):
    """The scene of a run, which in an engine ends otherwise in a few tests."""
    if case.solver == "analytic" or case.tag["test"] not in ("22", "23"):
        return case.scene
    return case.scene.with_(motion=case.scene.motion.scaled(0.01))


def spoilt(case):
    return FAILURE if case.solver != "analytic" and case.tag == {"test": "12", "specimen": "boulder 2"} else None


@pytest.mark.parametrize("packed", [True, False])
@pytest.mark.parametrize("rate", [200, 800])
def test_the_published_layout_is_read_at_any_sampling(tmp_path, rate, packed):
    place = published(tmp_path, range(11, 17), rate, packed, without=(13,))
    one = read_campaign(place)
    assert [test.name for test in one.tests] == ["11", "12", "14", "15", "16"] and len(one.missing) == 1
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
    published(place, range(11, 16))
    assert read_campaign(tmp_path).digest() == read_campaign(place).digest()


def test_a_record_has_one_name_however_it_is_written():
    for words in ("'RSN1114_KOBE.xlsx'", " RSN1114_KOBE-NS.AT2 ", "RSN1114_KOBEx.xlsx'", "RSN1114_KOBE_A-2--T"):
        assert campaign.record_of(words) == "RSN1114"
    assert campaign.record_of("Somewhere ") == campaign.record_of(" Somewhere") == "Somewhere"
    assert campaign.record_of("RSN11140_X") != "RSN1114"


def test_ones_own_tests_are_read_with_the_slenderness_of_their_scene_as_a_hint(tmp_path):
    one = read_campaign(own(tmp_path, range(6)))
    assert [test.record for test in one.tests[:2]] == ["' RSN1_MADEUP.xlsx'", "RSN1_MADEUP-NS.AT2"]
    assert [test.overturned for test in one.tests] == [(bool(fell(n, 0)),) for n in range(6)]
    assert one.tests[3].motion.peak == pytest.approx(peak_of(3) * G, rel=1e-3)
    (block,) = one.specimens
    assert block.span == pytest.approx((0.055, 0.165)) and block.scene.motion is None


def refused(folder, *words):
    with pytest.raises(SettingError) as caught:
        read_campaign(folder)
    assert "\n" not in str(caught.value) and all(word in str(caught.value) for word in words), str(caught.value)


def rows(change):
    """What lists the results otherwise."""
    return lambda place: lists(place, range(11, 14), change)


# what is done to a folder of three tests, of which the last has no motion: words of the message
DAMAGES = {
    "an outcome that is none": (
        rows(lambda old: [*old[:2], [12, 2, *old[2][2:]], *old[3:]]),
        (RESULTS, "row 3", f"{MEASURED[0]} = 2"),
    ),
    "an outcome that is missing": (
        rows(lambda old: [*old[:2], [12, 0, None, *old[2][3:]]]),
        (RESULTS, "row 3", "None", "write 1"),
    ),
    "a column that is missing": (
        rows(lambda old: [row[:2] + row[3:] for row in old]),
        (RESULTS, f"no column {MEASURED[1]!r}"),
    ),
    "a number that is no test": (
        rows(lambda old: [*old, [99, *old[1][1:]]]),
        (RESULTS, "Test Number = 99", "no such test"),
    ),
    "no list": (rows(lambda old: [["something else"]]), (RESULTS, "no column 'Test Number'")),
    "half a workbook": (
        lambda place: write(place, (place / RESULTS).read_bytes()[:2000], RESULTS),
        (RESULTS, "no readable workbook", "fetch it again"),
    ),
    "no sheet": (
        lambda place: book(place / RESULTS, {"Sheet1": [["Test Number"]]}),
        (f"no sheet {SHEET!r}, but Sheet1",),
    ),
    "no list of records": (lambda place: (place / RECORDS).unlink(), (RECORDS, "fetch it again")),
    "no results": (lambda place: (place / RESULTS).unlink(), (RESULTS, "tests.csv", campaign.REPOSITORY)),
    "no number": (
        lambda place: write(place, labview(*pulse(0.2, 200)).replace("\n0.5\t", "\n0.x\t", 1), "Test012.txt"),
        ("Test012.txt: line ",),
    ),
    "an empty motion": (lambda place: write(place, "", "Test012.txt"), ("Test012.txt: record: is empty",)),
    "half a motion": (
        lambda place: write(place, gzip.compress(bytes(range(256)) * 9)[:200], "Test013.txt.gz"),
        ("Test013.txt.gz", "damaged gzip"),
    ),
    "no motion": (lambda place: [file.unlink() for file in place.glob("Test*.txt")], ("no test has a motion",)),
}


@pytest.mark.parametrize("damage, words", DAMAGES.values(), ids=DAMAGES)
def test_what_is_damaged_is_refused_by_file_place_and_value(tmp_path, damage, words):
    damage(published(tmp_path, range(11, 14), packed=False, without=(13,)))
    refused(tmp_path, str(tmp_path), *words)


def test_no_folder_a_file_and_a_missing_reader_are_refused(tmp_path, folder, monkeypatch):
    refused(tmp_path / "none", "no such folder")
    refused(write(tmp_path, "", "file"), "no such folder")
    monkeypatch.setitem(sys.modules, "openpyxl", None)
    refused(folder, "needs openpyxl", 'pip install -e ".[records]"')


def test_a_block_of_another_slenderness_keeps_its_height_and_its_inertia_about_its_centre():
    for boulder, (mass, height, _) in zip(campaign.specimens(), campaign.BOULDERS.values(), strict=True):
        for angle in (0.04, 0.12, 0.24):
            block = leaning(boulder.scene, angle).block
            assert block.half_height == pytest.approx(height) and block.slenderness == angle
            assert block.centre_inertia == pytest.approx(campaign.INERTIA * campaign.DENSITY) and block.mass == mass
    scene = leaning(boulder.scene, 0.1, restitution=0.9, inertia=1.1, friction=0.4)
    plain = leaning(boulder.scene, 0.1, inertia=1.1)
    assert scene.block.restitution == pytest.approx(0.9 * RockingModel.of(plain).restitution) and scene.friction == 0.4
    assert plain.block.centre_inertia == pytest.approx(1.1 * campaign.INERTIA * campaign.DENSITY)


def test_the_digits_over_slendernesses_are_those_of_single_runs(folder):
    cases = study._grid_cases(read_campaign(folder, every=9), study.KINDS)
    for case in cases[:3]:
        found = over_slendernesses(case, None)["outcomes"]
        for kind, text in zip(case.tag["kinds"], found, strict=True):
            single = [simulate(leaning(case.scene, one, **kind), history=False) for one in case.tag["slendernesses"]]
            assert text == "".join(str(int(one.outcome == "overturns")) for one in single)


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
    alone = score(one, np.array([True, False, False, False]), ["a", "b", "c", "d"])
    assert (alone["right"], alone["misses"], alone["false_alarms"]) == (3, 0, 1)
    assert said["more_right"] == 1 and said["more_interval"] == pytest.approx([0, 3])  # of 4 groups one may come thrice


def test_differences_of_an_engine_and_their_sign_by_hand():
    ours, theirs = "1111110000", "0000110x0-"
    said = differences(
        np.array(list(theirs)),
        np.array(list(ours)),
        np.arange(10) < 2,
        ["a", "a", "a", "b", "b", "c", "c", "d", "d", "e"],
    )
    assert (said["size"], said["failed"], said["only_a"], said["only_b"]) == (9, 1, 4, 0)
    assert (said["both_overturn"], said["both_stand"]) == (2, 2) and said["p_value"] == pytest.approx(0.125)
    assert (said["records_a"], said["records_b"], said["p_records"]) == (2, 0, pytest.approx(0.5))
    assert (said["near"], said["near_missed"], said["near_added"], said["near_failed"]) == (2, 2, 0, 0)
    assert said["interval"] == pytest.approx(wilson(3 / 7 * 4, 4))  # of the others: 2 missed, 1 failed, by 4 records


@pytest.mark.parametrize("sizes, few", [((5,), False), ((12, 0), False), ((4,), True), ((12, 1), True), ((0, 4), True)])
def test_a_sum_over_fewer_than_five_tests_is_not_told(sizes, few):
    assert disclosed({"right": 3, "low": 0.1}, *sizes) == (
        {"right": None, "low": None} if few else {"right": 3, "low": 0.1}
    )


@pytest.mark.parametrize(
    "engine, right, misses",
    [
        ("111111000000", 12, 0),  # as the model: its sums say no more
        ("011111000000", None, None),  # beside the model's, its right answers say how one test ended
        ("000000000000", 6, 6),
        ("000000x00000", 5, None),  # misses and false alarms would say how the failed test ended
        ("111111x00000", None, None),
        ("11xxxxx00000", 7, 0),
        ("1111--------", None, None),  # run on four tests
    ],
)
def test_right_answers_are_told_where_no_difference_of_sums_is_of_fewer_than_five_tests(engine, right, misses):
    measured = np.array([True] * 6 + [False] * 6)
    said = answers(np.array(list(engine)), np.array(list("111111000000")), measured, list(range(12)))
    assert (said["right"], said["misses"]) == (right, misses)


def test_a_threshold_for_each_record_is_right_where_the_scale_alone_decides():
    records, values = ["a"] * 4 + ["b"] * 4, np.array([1.0, 2, 3, 4, 10, 20, 30, 40])
    fell_over = np.array([False, False, True, True, True, True, False, True])
    said = of_each_record(values, fell_over, records)
    assert said[:4].tolist() == [0, 0, 1, 1] and (said[4:] == fell_over[4:]).sum() == 3


# What there is of a campaign: sums over all tests, and over those that an engine ran.
SETTINGS = {"quick", "campaign", "digest", "cite", "tests", "records", "missing", "steps", "overturned", "agree"}
SETTINGS |= {"published", "specimens", "kinds", "equal", "others", "variants", "model_runs", "cpu_seconds"}


@pytest.fixture(params=["computed here", "stored"])
def kept(request):
    """A result that was just computed of made-up tests, and the one that this project stores, of real ones."""
    if request.param == "stored":
        return read_study(RESULT)
    return request.getfixturevalue("found")


def test_nothing_is_stored_that_could_hold_what_was_measured_in_one_test(kept):
    assert get_study("shake-table").parts.keys() == {"score", "fit", "paired", "engine", "failure", "absent"}
    for row in kept.rows:
        assert wrong_with(row, "shake-table") is None and row.get("size", FEWEST) >= FEWEST
        assert all(len(value) <= 2 for value in row.values() if isinstance(value, list))  # no series by test
    assert kept.settings.keys() == SETTINGS | {"changed_while_running"}
    grid = len(kept.settings["specimens"][0]["grid"])
    assert {*kept.arrays} == {f"right/{kind}" for kind in kept.settings["kinds"]}  # sums over all tests
    assert all(array.shape == (2, grid) for array in kept.arrays.values()) and kept.runs == []
    for row in where(kept.rows, part="engine", specimen={"boulder 1", "boulder 2"}):
        apart = row["only_a"] + row["only_b"] + row["failed"]
        assert (row["right"] is None) == (0 < apart < FEWEST)
        assert (row["misses"] is None) == (0 < apart < FEWEST or 0 < row["failed"] < FEWEST)


def test_rows_of_the_study_are_what_was_counted(found, folder):
    result, one = found, read_campaign(folder)
    assert result.settings["missing"] == {"tests": 2, "overturned": None, "ratios": None}  # too few to tell
    assert len(result.settings["tests"]) == len(one.tests) == 22
    for k, specimen in enumerate(("boulder 1", "boulder 2")):
        (row,) = where(result.rows, part="score", specimen=specimen, forecast=MODEL, judged=BY_RECORD)
        assert row["misses"] + row["false_alarms"] == 22 - row["right"]
        (fit,) = where(result.rows, part="fit", specimen=specimen, change="as it is")
        grid = result.settings["specimens"][k]["grid"]
        best, counts = grid.index(fit["slenderness"]), result.arrays["right/as it is"][k]
        blocks = [leaning(one.specimens[k].scene, fit["slenderness"]).with_(motion=test.motion) for test in one.tests]
        ended = np.array([simulate(block, history=False).outcome == "overturns" for block in blocks])
        assert counts[best] == fit["alone_right"] == counts.max() == (ended == outcomes_of(one.tests, k)).sum()
        for row in where(result.rows, part="engine", specimen=specimen):
            assert row["failed"] == (specimen == "boulder 2") and row["only_b"] == 0 < row["only_a"] <= 2
    apart = sum(fell(n, 0) != fell(n, 1) for n in range(11, 35) if n not in (13, 20))
    assert result.settings["agree"] == 22 - apart
    for row in where(result.rows, part="engine", specimen=ALL):
        parts = where(result.rows, part="engine", engine=row["engine"], variant=row["variant"])
        assert row["only_a"] == sum(part["only_a"] for part in parts if part["specimen"] != ALL)
    assert len(where(result.rows, part="failure")) == len(result.settings["variants"]) > 1


def test_an_engine_may_be_computed_alone_though_the_cpu_time_of_the_model_is_another(found):
    later = dataclasses.replace(found, settings=found.settings | {"cpu_seconds": 1.0})
    own = get_study("shake-table")
    assert not own.whole
    check_same(own, split(found, [ENGINE])["analytic"], later, [ENGINE])


def test_no_motion_of_a_table_is_stored_with_the_runs(folder):
    done = []

    def run(batch):
        found = by_model()(batch)
        done.extend((batch, row) for row in found)
        return found

    answered(study.plan(Request(()), data=str(folder)), run)
    assert len(done) > 40 and sample_of(done) == []
    (batch, row), *_ = done
    scene = row.case.scene.with_(motion=dataclasses.replace(row.case.scene.motion, label="sampled motion"))
    unnamed = dataclasses.replace(row, case=dataclasses.replace(row.case, scene=scene))
    assert sample_of([(batch, unnamed)])  # without its name it would be


def test_what_the_missing_tests_did_is_told_as_sums_where_they_are_many(tmp_path):
    missing = read_campaign(published(tmp_path, without=range(11, 18)))
    answer = answered(study.plan(Request(()), data=str(tmp_path)), by_model())[-1]
    assert answer.settings["missing"]["tests"] == len(missing.missing) == 7
    assert answer.settings["missing"]["overturned"] == [sum(fell(n, k) for n in range(11, 18)) for k in (0, 1)]
    expected = [math.exp(np.log(0.1 + 0.001 * np.arange(*ends)).mean()) for ends in ((11, 18), (18, 35))]
    assert answer.settings["missing"]["ratios"] == pytest.approx(expected)


def test_the_page_of_ones_own_tests_says_nothing_of_others(tmp_path):
    result = answered(study.plan(Request((ENGINE,)), data=str(own(tmp_path))), by_model())[-1]
    assert result.settings["agree"] is None and result.settings["cite"] == "" and not where(result.rows, specimen=ALL)
    whole = get_study("shake-table").page(stored(tmp_path, "shake-table", result)).whole()
    words = " ".join((*whole.text, *whole.measured, *(part for part in whole.shown if isinstance(part, str)))).lower()
    assert whole.figures and "one campaign" in words
    assert not [word for word in ("granite", "boulder", "mesh", "referee", "first second") if word in words]
    assert str(tmp_path) not in json.dumps(result.settings)  # no place of anyone's machine


@pytest.mark.slow
def test_real_runs_of_the_model_are_those_of_the_study(tmp_path, folder):
    ways = (by_runs(tmp_path), by_model())  # the first through the runner, with its store
    one, other = (answered(study.plan(Request(()), data=str(folder)), way)[-1] for way in ways)
    assert one.rows == other.rows


@needs_tests
def test_the_real_campaign_is_read():
    one = read_campaign(REAL, every=40)
    assert len(one.tests) == 13 and len(one.missing) == 92
    assert all(abs(np.median(test.motion.samples[:200])) < 1e-9 for test in one.tests)
    assert {len(test.authors[0]) for test in one.tests} == {5} and {len(test.authors[1]) for test in one.tests} == {8}
    assert all(test.motion.dt == pytest.approx(0.005) for test in one.tests)


TESTS, HEADS = 8, "motion,overturned,record\n"


@pytest.fixture
def mine(tmp_path):
    """Sound tests of one's own."""
    place = tmp_path / "own"
    place.mkdir()
    return own(place, range(TESTS), rate=50)


def table(text):
    return {"tests.csv": text}


def scene(more, top=""):
    return {"scene.toml": f"{top}{SCENE}{more}"}


def motion(values, dt=0.02):
    return {"2.csv": f"# acceleration in m/s2, dt = {dt} s\n" + "".join(f"{value}\n" for value in values)}


def listed(*rows, head=HEADS):
    return table(head + "".join(f"{row}\n" for row in rows))


# damage: (files written over the sound ones, None: removed; words of the refusal)
DAMAGE = {
    "no outcome": (listed("0.csv,maybe,a"), ("tests.csv, row 2", "overturned = 'maybe'", "write 1")),
    "an outcome that is not a number": (listed("0.csv,nan,a"), ("tests.csv, row 2", "overturned = 'nan'", "write 1")),
    "an infinite outcome": (listed("0.csv,inf,a"), ("tests.csv, row 2", "overturned = 'inf'", "write 1")),
    "a missing outcome": (listed("0.csv,0,a", "1.csv,,b"), ("tests.csv, row 3", "overturned = ''", "write 1")),
    "no column of outcomes": (listed("0.csv,1", head="motion,fell\n"), ("row 1", "no column 'overturned'")),
    "an unknown column": (listed("0.csv,1,2", head="motion,overturned,when\n"), ("row 1", "'when' is none of")),
    "a column twice": (
        listed("0.csv,1,0", head="motion,overturned,overturned\n"),
        ("row 1", "two columns are called 'overturned'", "remove one"),
    ),
    "too short a row": (listed("0.csv,1,a", "1.csv,1"), ("row 3", "holds 2 columns", "mend it")),
    "no such motion": (listed("0.csv,1,a", "9.csv,1,b"), ("row 3", "motion = '9.csv'", "cannot be read")),
    "a mine as motion": (listed(".,1,a"), ("row 2", "motion = '.'", "cannot be read")),
    "no motion": (listed(",1,a"), ("row 2", "motion = ''", "remove the row")),
    "a unit that is none": (listed("0.csv,1,m", head="motion,overturned,units\n"), ("row 2", "units = 'm'", "m/s2")),
    "a name twice": (
        listed("0.csv,1,a", "1.csv,0,a", head="motion,overturned,name\n"),
        ("two tests are called 'a'", "a name of its own"),
    ),
    "an empty list": (table(""), ("row 1", "no column 'motion'")),
    "no test": (table(HEADS), ("no test has a motion",)),
    "no text": (table(b"\xff\xfe\x00"), ("tests.csv", "cannot be read")),
    "no list": ({"tests.csv": None}, (campaign.RESULTS, "tests.csv", campaign.REPOSITORY)),
    "one test": (listed("0.csv,1,a"), ("tests.csv, record = 'a'", "1 in all", "add tests under a second record")),
    "one record": (
        listed(*(f"{n}.csv,{fell(n, 0)},a" for n in range(TESTS))),
        ("tests.csv, record = 'a'", f"{TESTS} in all", "add tests under a second record"),
    ),
    "one motion under two records": (
        listed("0.csv,1,a", "1.csv,0,b", "0.csv,0,c"),
        ("tests.csv, row 4, record = 'c'", "row 2", "'a'", "one record"),
    ),
    "four tests": (
        listed(*(f"{n}.csv,{n % 2},{n}" for n in range(FEWEST - 1))),
        ("tests.csv: 4 tests", "fewer than 5 are not disclosed", "add tests"),
    ),
    "at rest": (motion([0] * 50), ("tests.csv, row 4, motion = '2.csv'", "0 m/s2 throughout", "remove the test")),
    "constant": (motion([0.1] * 50), ("row 4, motion = '2.csv'", "0.1 m/s2 throughout", "remove the test")),
    "all but nothing": (motion(["0", "5e-324"] * 25), ("row 4, motion = '2.csv'", "no shaking", "remove the test")),
    "too short": (motion(range(PADDED)), ("row 4, motion = '2.csv'", f"holds {PADDED} samples", "the whole record")),
    "too coarse": (
        motion([0, 1, -1, 2, 0] * 5, dt=2.5),
        ("row 4, motion = '2.csv'", "sampled at 2.5 s", "less than 2.5 s", "mend its step"),
    ),
    "a sample that is no number": (motion([0, 1, "nan", 1] * 9), ("row 4, motion = '2.csv'", "2.csv", "line 4")),
    "an infinite sample": (motion([0, 1, "inf", 1] * 9), ("row 4, motion = '2.csv'", "2.csv", "line 4")),
    "an empty motion": ({"2.csv": ""}, ("row 4, motion = '2.csv'", "is empty")),
    "no scene": ({"scene.toml": None}, ("scene.toml", "cannot be read")),
    "a scene that is none": (scene("radius = 1\n"), ("scene.toml", "TOML")),
    "a mass below 0": ({"scene.toml": SCENE.replace("300.0", "-1")}, ("scene.toml", "block.mass = -1")),
    "a slenderness next to nothing": (
        {"scene.toml": SCENE.replace("0.11", "1.5e-20")},
        ("scene: a slenderness of 7.5e-21 rad", "which is tried", "1e-20 on"),
    ),
    "a restitution": (scene("restitution = 0.9\n"), ("scene.toml: block.restitution = 0.9", "leave it out")),
    "a tilt at the start": (scene("[start]\ntilt = 0.5\n"), ("scene.toml: start.tilt = 0.5", "leave it out")),
    "a rate at the start": (scene("[start]\ntilt_rate = 1\n"), ("scene.toml: start.tilt_rate = 1.0", "leave it out")),
    "a base displaced at the start": (
        scene("[base]\nmass = 9\n[start]\nbase_displacement = 0.1\n"),
        ("scene.toml: start.base_displacement = 0.1", "leave it out"),
    ),
    "a motion of the scene": (
        scene('[motion]\npulse = "one-sine"\namplitude = 4.0\nfrequency = 2.0\nvertical_ratio = 0.5\n'),
        ("scene.toml: motion = 'one-sine", "each test has its own", "leave it out"),
    ),
    "a duration": (scene("[run]\nduration = 3.0\n"), ("scene.toml: run.duration = 3.0", "leave it out")),
}


def damaged(mine, files):
    for name, text in files.items():
        if text is None:
            (mine / name).unlink()
        else:
            write(mine, text, name)
    return mine


@pytest.mark.parametrize("quick", [False, True])
@pytest.mark.parametrize("files, words", DAMAGE.values(), ids=DAMAGE)
def test_what_cannot_be_used_is_refused_before_a_run(mine, files, words, quick):
    plan = study.plan(Request((), quick), data=str(damaged(mine, files)))
    with pytest.raises((SettingError, SceneError)) as caught:
        next(plan)
    said = str(caught.value)
    assert "\n" not in said and all(word in said for word in words), said


def test_the_command_ends_with_exit_code_2_and_writes_nothing(mine, rocking, tmp_path):
    damaged(mine, motion([0] * 50))
    out = tmp_path / "out"
    code, _, said = rocking("study", "shake-table", "--quick", "--data", mine, "--output", out)
    assert code == 2 and "motion = '2.csv': is 0 m/s2 throughout" in said and "Traceback" not in said
    assert not list(out.glob("*.json"))


def read_back(mine, place):
    """The result as the study's reader reads it, after its page was written."""
    answer = answered(study.plan(Request((ENGINE,)), data=str(mine)), by_model())[-1]
    result = stored(place, "shake-table", answer)
    assert get_study("shake-table").page(result).whole().tables and result.rows == answer.rows
    return result


# sound tests that say little: {files written over the sound ones}; all but a few are of the second command
LITTLE = {
    "as they are": {},
    "none overturned": listed(*(f"{n}.csv,0,{NAMES[n % 3]}" for n in range(TESTS))),
    "all overturned": listed(*(f"{n}.csv,1,{NAMES[n % 3]}" for n in range(TESTS))),
    "the smaller ones overturned": listed(*(f"{n}.csv,{int(n < 4)},{n}" for n in range(TESTS))),
    "five tests": listed(*(f"{n}.csv,{int(n > 2)},{n}" for n in range(FEWEST))),
    "five tests that end alike": listed(*(f"{n}.csv,0,{n}" for n in range(FEWEST))),
    "two records": listed(*(f"{n}.csv,{int(n % 3 == 0)},{n // 4}" for n in range(TESTS))),
    "two records, each of one outcome": listed(*(f"{n}.csv,{int(n > 3)},{n // 4}" for n in range(TESTS))),
    "one peak, which is the last sample": {f"{n}.csv": motion([0.5] * (9 + n) + [2.0])["2.csv"] for n in range(TESTS)},
    "as short as may be": motion([0, 1, -1, 2, 0] * 2),
    "as coarse as may be": motion([0, 1, -1, 2, 0] * 2, dt=2.49),
    "a block that slides": scene("", "friction = 0.05\n"),
    "a block on bearings": scene('[base]\nmass = 100.0\n[bearings]\nlaw = "linear"\nka = 2e4\n'),
    "a start at rest": scene("[start]\ntilt = 0.0\n"),
}


OFTEN = ("none overturned", "two records, each of one outcome", "one peak, which is the last sample")


@pytest.mark.parametrize(
    "files",
    [pytest.param(files, id=name, marks=() if name in OFTEN else pytest.mark.slow) for name, files in LITTLE.items()],
)
@pytest.mark.filterwarnings("error::RuntimeWarning")
def test_sound_tests_go_all_the_way_and_are_read_back(mine, files, tmp_path):
    result = read_back(damaged(mine, files), tmp_path)
    assert len(result.settings["tests"]) == len((mine / "tests.csv").read_text().splitlines()) - 1


def test_no_restitution_is_changed_of_a_block_that_slides(mine, tmp_path):
    """The model knows none: with it, runs of the grid would fail, and count as standing."""
    kinds = read_back(damaged(mine, scene("", "friction = 0.05\n")), tmp_path).settings["kinds"]
    assert kinds == ["as it is", "friction 0.5"]


def test_a_quick_look_keeps_five_tests_and_two_records(tmp_path):
    place = own(tmp_path, range(12), rate=50)
    assert [test.name for test in read_campaign(place, every=20).tests] == ["1", "3", "5", "7", "9", "11"]
    damaged(place, listed(*(f"{n}.csv,{fell(n, 0)},{int(n == 3)}" for n in range(12))))
    assert len(read_campaign(place, every=20).tests) == 12


def test_published_tests_are_asked_the_same(tmp_path):
    place = published(tmp_path, range(11, 14), packed=False, without=(12, 13))
    with pytest.raises(SettingError, match=rf"{campaign.RECORDS}, record = 'RSN4': no test .* \(1 in all\)"):
        read_campaign(place)
    write(place, labview(*pulse(0.0, 200)), "Test011.txt")
    with pytest.raises(SettingError, match=r"Test011.txt: is 0 m/s2 throughout, .* its file is left out\)"):
        read_campaign(place)
    titles = ["Test No. ", "Ground Motion", "PGV/PGA", "Scaled PGA (g)"]
    book(place / campaign.RECORDS, {"Sheet1": [titles, *([n, f"RSN{n}", 0.1, int(n > 11)] for n in range(11, 14))]})
    with pytest.raises(SettingError, match=rf"{campaign.RECORDS}, row 2, Scaled PGA \(g\) = 0: not above 0; fetch"):
        read_campaign(place)
