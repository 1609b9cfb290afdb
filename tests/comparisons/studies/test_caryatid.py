"""The Caryatid study: its parts against closed forms and single runs, and the command end to end on a short motion."""

import math

import numpy as np
import pytest

from analytic import PulseMotion, SampledMotion, load_scene, simulate, synthetic_motion
from analytic.advice.bearing_scan import displacement_spectrum
from analytic.rocking import restitution
from comparisons.execution.by_solver import read
from comparisons.execution.plan import Transition
from comparisons.execution.results import RESULTS
from comparisons.execution.runner import compute
from comparisons.plotting.parts import where
from comparisons.studies import get_study
from comparisons.studies.caryatid.paper import (
    CORRECTED,
    DERIVED,
    FREE,
    ISOLATED,
    NOT_CHECKABLE,
    NOT_REPRODUCIBLE,
    OTHER_MOTION,
    REPRODUCED,
    caryatid,
    formulas,
    is_papers_motion,
    judged,
    motion_values,
)
from comparisons.studies.caryatid.study import (
    BOTH,
    NEITHER,
    ONLY_FREE,
    ONLY_ISOLATED,
    _intervals,
    _overlap,
    benefit,
    claims,
    oscillator,
    slender_block,
    uplift_slenderness,
)
from engines import ENGINES, installed_engines

pytestmark = pytest.mark.xdist_group("caryatid")  # its runs are made once

STUDY = get_study("caryatid")


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
    within = {"(2)": 1e-7, "(3)–(6)": 1e-9, "(9)–(11)": 1e-9, "(8)": 1e-12}
    assert not [number for number, most in within.items() if not checks[number] < most]
    assert [row["number"] for row in where(rows, part="equation", status=CORRECTED)] == ["(8)", "(12)"]


def test_numbers_without_motion(rows):
    values = {row["quantity"]: row for row in where(rows, part="value")}
    assert [row["where"] for row in where(values.values(), status=NOT_REPRODUCIBLE)] == ["Figs 1, 2"]
    assert values["α [-]"]["study"] == pytest.approx(44.69, abs=0.005)
    assert values["damping ξ as W_D/(4π E_s) [%]"]["study"] == pytest.approx(15.0, abs=0.05)
    assert values["period T_bi [s]"]["study"] == pytest.approx(1.9993, abs=5e-5)


def test_misprints_are_seen_in_numbers(rows):
    printed, corrected = (
        {row["where"]: row[f"value_{kind}"] for row in where(rows, part="misprint")}
        for kind in ("printed", "corrected")
    )
    assert corrected["eq. (8)"] == pytest.approx(1, abs=1e-12) and corrected["eq. (12)"] < 1e-9
    # momentum share of the base's jump: (1 - e_phi) (R cos gamma - 1) of the whole
    isolated = load_scene("caryatid-isolated")
    share = (1 - restitution(isolated)) * (isolated.block.half_height - 1)
    assert printed["eq. (8)"] == pytest.approx(1 + share, rel=1e-9)
    assert printed["eq. (12)"] == pytest.approx(1, abs=1e-3)
    assert printed["Table 1(a), ξ"] == pytest.approx(30.0, abs=0.05)


@pytest.mark.parametrize(
    "printed, found, own, status",
    [(0.212, 0.2124, True, REPRODUCED), (0.212, 0.2126, True, NOT_REPRODUCIBLE), (0.212, 0.212, False, OTHER_MOTION)],
)
def test_a_number_outside_the_printed_digits_is_not_reproduced(printed, found, own, status):
    assert judged("", "", printed, found, 0.0005, papers_motion=own)["status"] == status


@pytest.mark.parametrize(("period", "damping"), [(2.0, 0.05), (2.0, 0.30)])
def test_scenes_of_figure_5_have_the_period_asked_for(short, period, damping):
    response = simulate(oscillator(short, period, damping), history=False)
    assert response.outcome == "stands"
    expected = displacement_spectrum(short, [period], [damping])[0, 0]
    assert response.peak_base_displacement == pytest.approx(expected, rel=1e-9)
    assert 2 * math.pi / slender_block(short, period, 0.28).rocking_frequency == pytest.approx(period, rel=1e-12)


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
    assert [_intervals(changes, False), _intervals(changes[1:], True)] == [[[0.2001, 0.3]], [[0.1, 0.3]]]
    assert [_intervals([], False), _intervals([], True)] == [[], [[0.1, 0.45]]]
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


@pytest.mark.slow
def test_end_to_end(short, tmp_path):
    engines = [name for name in installed_engines() if ENGINES[name].subject]
    files = compute(STUDY, tmp_path, engines=engines, quick=True, progress=False, motion=short)
    of_paper, under, histories = map(read, files)
    assert [len(STUDY.page(result).whole().figures) for result in (of_paper, under, histories)] == [2, 4, 1]
    assert all(sum(part.stat().st_size for part in file.glob("*.npz")) < 500_000 for file in files)
    for scene, outcome in ((FREE, "overturns"), (ISOLATED, "stands")):
        model, *others = where(under.rows, part="run", scene=scene)
        assert model["engine"] == "analytic" and {row["outcome"] for row in (model, *others)} == {outcome}
        strokes = [row["peak_base_displacement"] for row in others]
        assert strokes and strokes == pytest.approx([model["peak_base_displacement"]] * len(strokes), rel=1e-3)
    # what may be passed on holds no value of the motion
    kept = np.concatenate([values.ravel() for values in under.arrays.values()])
    assert not np.isin(np.float32(short.samples[30:50]), kept).any()
    # the numbers of another motion are never said to be the paper's
    assert {row["status"] for row in where(under.rows, where="Fig. 6")} == {OTHER_MOTION}


def test_only_a_duzce_record_has_to_meet_what_the_paper_prints(short):
    duzce = SampledMotion(short.dt, short.samples, "RSN1605_DUZCE_DZC270.AT2")
    assert is_papers_motion(duzce) and not is_papers_motion(short)
    assert not is_papers_motion(synthetic_motion()) and "duzce" in synthetic_motion().label
    rows = read(RESULTS / "caryatid-under-rsn1605-duzce-dzc270").rows
    for values in (where(rows, part="value"), list(motion_values(where(rows, part="run"), duzce, 0.2))):
        assert {row["paper"] for row in where(values, status=REPRODUCED)} <= {"overturns", "stands", "yes", 4.0}
        assert len(where(values, status=REPRODUCED)) >= 21 and len(where(values, status=NOT_CHECKABLE)) == 7
        unprinted = where(values, paper="not printed")
        assert len(unprinted) == 15 and {row["status"] for row in unprinted} == {DERIVED}


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--record", "no-such-record.AT2"], "no-such-record.AT2"),
        (["--units", "g"], "--record"),
        (["--output", __file__], "is a file"),
    ],
)
def test_mistakes_end_with_status_2_before_any_run(rocking, arguments, message, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    status, _, err = rocking("study", "caryatid", *arguments)
    assert status == 2 and message in err and not list(tmp_path.iterdir())
