"""The Caryatid study: its parts against closed forms and single runs, and the command end to end on a short motion."""

import math

import numpy as np
import pytest

from analytic import PulseMotion, SampledMotion, load_scene, simulate, synthetic_motion
from analytic.linear_oscillator import displacement_spectrum
from analytic.records import read_record
from analytic.rocking import RockingModel
from comparisons.cli import main
from comparisons.running.provenance import PROJECT_FOLDER, RESULTS, read_result
from comparisons.running.refine import Transition
from comparisons.running.sources import source_digests
from comparisons.running.study import compute
from comparisons.showing.rows import where
from comparisons.studies.caryatid import STUDY
from comparisons.studies.caryatid.cost import DIVISIONS, _cpu_at, _fixed_step
from comparisons.studies.caryatid.formulas import formulas
from comparisons.studies.caryatid.paper import (
    CORRECTED,
    DERIVED,
    NOT_CHECKABLE,
    NOT_REPRODUCIBLE,
    OTHER_MOTION,
    REPRODUCED,
    is_papers_motion,
    judged,
    motion_values,
)
from comparisons.studies.caryatid.runs import FREE, ISOLATED, caryatid, oscillator, slender_block
from comparisons.studies.caryatid.variations import (
    BOTH,
    NEITHER,
    ONLY_FREE,
    ONLY_ISOLATED,
    _intervals,
    _overlap,
    benefit,
    claims,
    contact,
    impact_friction,
    uplift_slenderness,
)

DUZCE = PROJECT_FOLDER.parent / "shared" / "records" / "RSN1605_DUZCE_DZC270.AT2"


@pytest.fixture(scope="module")
def short():
    """A sampled one-sine acceleration of 0.55 g and 1.5 Hz, 4 s long: the free-standing Caryatid overturns."""
    pulse = PulseMotion("one-sine", 0.55 * 9.81, 3 * math.pi, start=0.2)
    return SampledMotion(0.01, pulse.acceleration(0.01 * np.arange(401)), "a short pulse")


@pytest.fixture(scope="module")
def rows():
    return formulas()[0]


def test_every_equation_and_table_has_a_row(rows):
    checks = {row["number"]: row["value"] for row in where(rows, part="equation")}
    equations = "(1) (2) (3)–(6) (7) (8) (9)–(11) (12) (13) (14)".split()
    assert [*checks] == [*equations, "Fig. 3", "Table 1(a)", "Table 1(b)"]
    assert checks["(2)"] < 1e-7 and checks["(3)–(6)"] < 1e-9 and checks["(9)–(11)"] < 1e-9 and checks["(8)"] < 1e-12
    assert [row["number"] for row in where(rows, part="equation", status=CORRECTED)] == ["(8)", "(12)"]


def test_numbers_without_motion(rows):
    values = {row["quantity"]: row for row in where(rows, part="value")}
    assert [row["where"] for row in where(values.values(), status=NOT_REPRODUCIBLE)] == ["Figs 1, 2"]
    assert values["α [-]"]["study"] == pytest.approx(44.69, abs=0.005)
    assert values["damping ξ as W_D/(4π E_s) [%]"]["study"] == pytest.approx(15.0, abs=0.05)
    assert values["period T_bi [s]"]["study"] == pytest.approx(1.9993, abs=5e-5)


def test_misprints_are_seen_in_numbers(rows):
    found = {row["where"]: row for row in where(rows, part="misprint")}
    assert found["eq. (8)"]["value_corrected"] == pytest.approx(1, abs=1e-12)
    # momentum share of the base's jump: (1 - e_phi) (R cos gamma - 1) of the whole
    isolated = load_scene("caryatid-isolated")
    after = RockingModel.of(isolated).impact(1.0)[0]
    assert found["eq. (8)"]["value_printed"] == pytest.approx(
        1 + (1 - after) * (isolated.block.half_height - 1), rel=1e-9
    )
    assert found["eq. (12)"]["value_corrected"] < 1e-9
    assert found["eq. (12)"]["value_printed"] == pytest.approx(1, abs=1e-3)
    assert found["Table 1(a), ξ"]["value_printed"] == pytest.approx(30.0, abs=0.05)


def test_a_number_outside_the_printed_digits_is_not_reproduced():
    assert judged("", "", 0.212, 0.2124, 0.0005)["status"] == REPRODUCED
    missed = judged("", "", 0.212, 0.2126, 0.0005), judged("", "", 0.212, None), judged("", "", "stands", "rocks")
    assert {row["status"] for row in missed} == {NOT_REPRODUCIBLE}
    assert judged("", "", 0.212, 0.212, 0.0005, own=False)["status"] == OTHER_MOTION


@pytest.mark.parametrize(("period", "damping"), [(2.0, 0.05), (2.0, 0.30)])
def test_oscillator_scene_is_the_linear_oscillator(short, period, damping):
    response = simulate(oscillator(short, period, damping), history=False)
    assert response.outcome == "stands"
    expected = displacement_spectrum(short, [period], [damping])[0, 0]
    assert response.peak_base_displacement == pytest.approx(expected, rel=1e-9)


def test_slender_block_has_the_period_asked_for(short):
    assert 2 * math.pi / slender_block(short, 3.7, 0.28).rocking_frequency == pytest.approx(3.7, rel=1e-12)


def test_slenderness_claims_on_a_pulse(short):
    found, arrays = claims(short, quick=True)
    intervals = {row["claim"]: row["intervals"] for row in where(found, part="claim")}
    # bisection with the kernel against the acceleration of a block that stays down
    ((low, high),) = intervals["isolated does not rock"]
    assert low == pytest.approx(uplift_slenderness(short), abs=2e-5) and high == 0.45
    _, edge = intervals["free-standing overturns"][-1]
    free = caryatid(FREE, short).with_(duration=20.0)  # time to fall
    beside = [simulate(free.with_(block={"slenderness": edge + by})).outcome == "overturns" for by in (-1e-4, 1e-4)]
    assert beside == [True, False]
    assert len(arrays["claims/slenderness"]) == len(arrays["claims/vulnerable period"])


def test_intervals_and_their_overlap():
    changes = [Transition(0.2, 0.2001, False, True), Transition(0.3, 0.3001, True, False)]
    assert _intervals(changes, False) == [[0.2001, 0.3]]
    assert _intervals(changes[1:], True) == [[0.1, 0.3]]
    assert _intervals([], False) == [] and _intervals([], True) == [[0.1, 0.45]]
    assert _overlap([[0.1, 0.3], [0.35, 0.4]], [[0.2, 0.36]]) == [[0.2, 0.3], [0.35, 0.36]]


def test_benefit_map_against_single_runs(short):
    slendernesses, intensities = np.array([0.12, 0.2, 0.28, 0.4]), np.array([0.5, 1.0, 2.0, 3.0])
    category, lifted, displacement = benefit(short, slendernesses, intensities)
    named = {(False, False): BOTH, (True, False): ONLY_ISOLATED, (False, True): ONLY_FREE, (True, True): NEITHER}
    for i, gamma in enumerate(slendernesses):
        for k, factor in enumerate(intensities):
            change = {"block": {"slenderness": gamma}, "motion": short.scaled(factor), "duration": 20.0}
            free, isolated = (
                simulate(caryatid(name, short).with_(**change), history=False) for name in (FREE, ISOLATED)
            )
            assert category[i, k] == named[free.outcome == "overturns", isolated.outcome == "overturns"]
            assert lifted[i, k] == (isolated.outcome != "stands")
            expected = np.nan if isolated.outcome == "overturns" else isolated.peak_base_displacement
            assert displacement[i, k] == pytest.approx(expected, rel=1e-6, nan_ok=True)
    assert len(np.unique(category)) >= 3


def test_friction_of_an_impact():
    for gamma in (0.1, 0.28, 0.45):
        rigid = load_scene("caryatid-rigid").with_(block={"slenderness": gamma})
        sine, cosine = math.sin(gamma), math.cos(gamma)
        assert impact_friction(rigid) == pytest.approx(1.5 * sine * cosine / (2 - 1.5 * sine**2), rel=1e-12)
        # on the base: change of the block's momentum, sideways and upward
        scene = load_scene("caryatid-isolated").with_(block={"slenderness": gamma})
        w, (b, h) = -1.0, (scene.block.half_width, scene.block.half_height)
        after, jump = RockingModel.of(scene).impact(w)
        sideways, upward = jump + h * (after - w), b * (abs(after) + abs(w))
        assert impact_friction(scene) == pytest.approx(abs(sideways) / upward, rel=1e-12)


def test_contact_of_a_block_that_stays_down_is_its_acceleration(short):
    found, arrays = contact(short, quick=True)
    free, isolated = found
    response = simulate(caryatid(ISOLATED, short), history=False)
    assert response.outcome == "stands" and isolated["min_normal_ratio"] == 1
    assert isolated["friction_demand"] == pytest.approx(response.peak_base_acceleration / 9.81, rel=1e-9)
    falling = simulate(caryatid(FREE, short))
    assert falling.outcome == "overturns"  # what comes in the last fall does not count
    before = simulate(caryatid(FREE, short).with_(duration=falling.unstable_time), history=False)
    assert free["friction_demand"] == pytest.approx(before.friction_demand, rel=1e-3)
    assert not arrays[f"contact/{FREE} upright"].all() and arrays[f"contact/{ISOLATED} upright"].any()


@pytest.mark.parametrize("law", ["algebraic", "bouc-wen"])
def test_fixed_step_of_the_cost_claim_solves_the_same_problem(law):
    scene = caryatid(ISOLATED, synthetic_motion()).with_(bearings={"law": law}, duration=synthetic_motion().end)
    exact = simulate(scene, history=False)
    errors = [
        abs(_fixed_step(scene, n)[1] - exact.end.base_displacement) / exact.peak_base_displacement
        for n in (DIVISIONS[0], DIVISIONS[-1])
    ]
    assert errors[0] < 1e-4 and errors[1] < 1e-2 * errors[0]


def test_cost_at_an_error_lies_between_the_rungs():
    errors, cpu = [1e-4, 1e-6, 1e-8], [1.0, 10.0, 100.0]
    assert _cpu_at(1e-5, errors, cpu) == pytest.approx(math.sqrt(10))
    assert _cpu_at(1e-3, errors, cpu) is None and _cpu_at(1e-9, errors, cpu) is None


def test_end_to_end(short, tmp_path):
    files = compute(STUDY, tmp_path, quick=True, progress=False, motion=short)
    of_paper, under, histories = map(read_result, files)
    for result, figures in ((of_paper, 2), (under, 7), (histories, 1)):
        shown = STUDY.page(result).whole()
        assert len(shown.figures) == figures and all(figure.alt and figure.caption for figure in shown.figures)
        assert all(len(row) == len(table.columns) for table in shown.tables for row in table.rows)
    assert all(file.with_suffix(".npz").stat().st_size < 500_000 for file in files)
    for scene, outcome in ((FREE, "overturns"), (ISOLATED, "stands")):
        runs = where(under.rows, part="run", scene=scene)
        assert {row["outcome"] for row in runs} == {outcome} and runs[0]["engine"] == "analytic"
        for row in runs:
            assert row["peak_base_displacement"] == pytest.approx(runs[0]["peak_base_displacement"], rel=1e-3)
    # what may be passed on holds no value of the motion
    for name, values in under.arrays.items():
        assert values.size < 1 or not np.isin(np.float32(short.samples[30:50]), values).any(), name
    # the numbers of another motion are never said to be the paper's
    assert {row["status"] for row in where(under.rows, where="Fig. 6")} == {OTHER_MOTION}


def test_what_shows_is_not_behind_a_result():
    behind = source_digests([STUDY.plan.__module__])
    assert "comparisons.studies.caryatid.cost" in behind
    assert not [name for name in behind if name.endswith(".page") or ".showing" in name]


def test_only_a_duzce_record_has_to_meet_what_the_paper_prints(short):
    duzce = SampledMotion(short.dt, short.samples, "RSN1605_DUZCE_DZC270.AT2")
    assert is_papers_motion(duzce) and not is_papers_motion(short)
    assert not is_papers_motion(synthetic_motion()) and "duzce" in synthetic_motion().label
    rows = read_result(RESULTS / "caryatid-under-rsn1605-duzce-dzc270.json").rows
    for values in (where(rows, part="value"), list(motion_values(where(rows, part="run"), duzce, 0.2))):
        assert {row["paper"] for row in where(values, status=REPRODUCED)} <= {"overturns", "stands", "yes", 4.0}
        assert len(where(values, status=REPRODUCED)) >= 21 and len(where(values, status=NOT_CHECKABLE)) == 7
        unprinted = where(values, paper="not printed")
        assert len(unprinted) == 15 and {row["status"] for row in unprinted} == {DERIVED}


@pytest.mark.skipif(not DUZCE.exists(), reason="the Duzce record lies in ../shared/records, which is absent")
def test_the_papers_outcomes_and_this_projects_numbers_under_the_record():
    motion = read_record(DUZCE)
    free, isolated = (simulate(caryatid(name, motion), history=False) for name in (FREE, ISOLATED))
    assert free.outcome == "overturns" and free.overturning_time - motion.peak_time == pytest.approx(3.6, abs=1.0)
    assert isolated.outcome == "stands" and isolated.peak_base_displacement == pytest.approx(0.212, abs=5e-4)
    assert isolated.peak_base_acceleration / 9.81 == pytest.approx(0.236, abs=5e-4)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--record", "no-such-record.AT2"], "no-such-record.AT2"),
        (["--units", "g"], "--record"),
        (["--output", __file__], "is a file"),
    ],
)
def test_mistakes_end_with_status_2_before_any_run(arguments, message, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as ended:
        main(["study", "caryatid", *arguments])
    assert ended.value.code == 2 and message in capsys.readouterr().err
    assert not list(tmp_path.iterdir())
