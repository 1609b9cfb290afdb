"""Stored runs done again: what holds, what differs, what cannot be run any more; and what is stored of runs."""

import json
import sys
from pkgutil import resolve_name

import fake_solvers
import pytest
from answered import edit
from fake_solvers import cases, scene

from analytic import PulseMotion, SampledMotion, load_scene, synthetic_motion
from analytic.motion import paired
from comparisons.execution import by_solver
from comparisons.execution import runner as run_sample
from comparisons.execution.by_solver import age, last_check
from comparisons.execution.cases import Case, root_of, solver
from comparisons.execution.code_digests import source_digests, today
from comparisons.execution.plan import Batch, Computed, Study
from comparisons.execution.results import RESULTS, ResultError, read_result, write_result
from comparisons.execution.runner import case_of, check, check_all, compute, sample_of
from comparisons.execution.sweep import Row
from comparisons.metrics import agreement
from comparisons.report.answer import origin_of


def _plan(ask):
    rows = yield Batch(cases("fails", 1) + cases("raises", 8) + cases(count=3), fake_solvers.tilt, "tilts")
    return Computed({}, [row.values for row in rows])


STUDY = Study("tilts", "How far?", _plan)


def sampled(*which):
    """What is stored of runs of cases."""
    return sample_of(
        (Batch([case], fake_solvers.tilt, ""), Row(case, {"peak": 1.0}, None, {}, False)) for case in which
    )


@pytest.mark.parametrize("path", by_solver.results_in(RESULTS), ids=lambda path: path.name)
def test_what_a_stored_run_calls_is_there_today(path):
    """Modules move: `code_digests.ALIASES` says where to, or the run could not be done again."""
    runs = by_solver.read(path).runs
    for name in {run["measure"] for run in runs}:
        assert callable(resolve_name(today(name))), name
    for name in {run["engine"] for run in runs if ":" in run["engine"]}:
        assert callable(solver(name)) and source_digests([root_of(name)]), name


@pytest.fixture
def result(tmp_path):
    (path,) = compute(STUDY, tmp_path, engines=(), workers=1, progress=False)
    return path


def changed(path, change):
    """The result with its stored runs changed; all of them are in the model's file, as no engine was asked for."""
    path = path / "analytic.json"
    old = read_result(path)
    for run in old.runs:
        change(run)
    write_result(path, old.kind, {}, old.rows, modules=["analytic"], runs=old.runs, run_count=old.run_count)


def test_unchanged_code_holds_and_the_result_says_when_it_was_checked(result):
    outcome = check(result, 30, 1, record=True, workers=1, progress=False)
    assert (outcome.runs, outcome.held, outcome.stored, outcome.total) == (12, 12, 12, 12)  # failed runs among them
    read = by_solver.read(result)
    last = read.provenance["check"]
    assert (last["runs"], last["held"], last["seed"]) == (12, 12, 1)
    assert "12 of 12 runs hold" in last_check(read) and last_check(read) in origin_of(read)
    read.provenance["sources"]["analytic.gone"] = ""
    assert age(read).endswith(last_check(read))
    before = (result / "analytic.json").read_bytes()
    assert check(result, 5, 2, workers=1, progress=False).runs == 5
    assert (result / "analytic.json").read_bytes() == before  # not recorded: not asked for


def test_a_run_that_differs_is_named_with_both_numbers(result):
    def change(run):
        if run["tag"]["i"] == 2 and run["engine"].endswith("sound"):
            run["values"]["peak"] *= 1 + 1e-8  # ten times what rounding is allowed

    changed(result, change)
    outcome = check(result, 30, 1, record=True, workers=1, progress=False)
    assert outcome.held == by_solver.read(result).provenance["check"]["held"] == 11
    assert outcome.differences == ("fake_solvers:sound, i = 2: peak: stored 0.000400000004, now 0.0004",)


@pytest.mark.parametrize(
    "part, value, words",
    [
        ("engine", "nosuchengine", "cannot be run any more (unknown solver 'nosuchengine'"),
        ("measure", "fake_solvers:gone", "cannot be run any more (module 'fake_solvers' has no attribute 'gone'"),
        ("settings", {"spring": 1.0}, "sound when stored, now exception: TypeError"),
        ("variant", "springs-of-old", ", springs-of-old, i = "),
        ("failure", {"kind": "crash", "reason": "killed"}, "crash: killed when stored, now sound"),
        ("digest", "0", "digest: stored 0, now"),
    ],
)
def test_what_is_gone_or_fails_otherwise_does_not_hold(result, part, value, words):
    def change(run):
        if run["engine"].endswith("sound"):
            run[part] = value

    changed(result, change)
    outcome = check(result, 30, 1, workers=1, progress=False)
    assert outcome.held == 9 and all(words in each for each in outcome.differences), outcome.differences


def test_results_without_stored_runs_say_what_to_do(tmp_path):
    path = write_result(tmp_path / "tilts" / "analytic.json", "tilts", {}, [], modules=["analytic"])
    for name, words in (
        ("tilts", "nothing to check, none of its 0 runs .* run rocking study tilts"),
        ("other", "other: no such result; run the study"),
        ("tilts", "before runs were stored; run rocking study tilts"),
    ):
        with pytest.raises(ResultError, match=words):
            check_all(name, tmp_path, 3, 0)
        edit(path, lambda content: content.pop("runs", None))


FORMULA = SampledMotion(0.1, [0.0, 1.0 / 3, 0.0])
MOTIONS = {
    "none": None,
    "pulse": PulseMotion("one-sine", 6.0, 5.0, vertical=PulseMotion("one-sine", 2.0, 5.0, phase=0.3)),
    "formula": FORMULA,
    "synthetic": synthetic_motion(seed=3).scaled(1 / 3),
    "pair": paired(synthetic_motion(seed=3), synthetic_motion(seed=4).scaled(0.7)),
    "scaled twice": synthetic_motion(seed=5).scaled(0.1).scaled(0.7),
}


def stored(motion):
    return sampled(Case(scene(0.1).with_(motion=motion), tag={"k": 1}))


@pytest.mark.parametrize("kind", MOTIONS)
def test_a_stored_case_is_the_case_that_was_run(kind):
    (run,) = json.loads(json.dumps(stored(MOTIONS[kind])))
    case = case_of(run)
    assert case.scene.digest() == scene(0.1).with_(motion=MOTIONS[kind]).digest() == run["digest"]
    assert (case.solver, case.tag) == ("analytic", {"k": 1})
    assert ("samples" in run["scene"]["motion"]) == (kind in ("formula", "scaled twice"))


def test_the_values_of_a_record_few_long_motions_and_few_runs_are_stored():
    named = SampledMotion(0.1, [0.0, 1.0, 0.0], "RSN1605_DUZCE_DZC270.AT2")
    for motion in (named, paired(FORMULA, named), SampledMotion(0.1, [0.0] * (run_sample.LONGEST + 1))):
        assert stored(motion) == []
    many = [Case(scene(0.1).with_(motion=SampledMotion(0.1, [0.0, float(k), 0.0]))) for k in range(1, 9)]
    assert len(sampled(*many)) == run_sample.MOTIONS and sampled(*many) == sampled(*many)
    assert len(sampled(*many[:1] * 100)) == run_sample.SIZE


@pytest.mark.parametrize(
    "stored, now, places",
    [
        (1.0, 1.0 + 1e-10, []),
        (1.0, 1.0 + 1e-8, ["x"]),
        (1.0, True, ["x"]),
        (0.0, 0, []),
        ([1, 2], [1], ["x[1]"]),
        ({"a": {"b": 1}}, {"a": {"b": 2}}, ["x.a.b"]),
        ({"cpu_seconds": 1.0, "resident_bytes": 1}, {"cpu_seconds": 2.0, "resident_bytes": 2}, []),
        (None, 0.0, ["x"]),
    ],
)
def test_differences_are_found_in_their_place(stored, now, places):
    assert [where for where, _, _ in by_solver.differences("x", stored, now)] == places


def test_runs_of_an_engine_that_is_not_installed_are_left_out_and_named(result, monkeypatch):
    changed(result, lambda run: run.update(engine="mujoco") if run["tag"] == {"i": 0} else None)
    runs = by_solver.read(result).runs
    kept = sum(run["engine"] != "mujoco" for run in runs)
    monkeypatch.setitem(sys.modules, "mujoco", None)
    outcome = check(result, 30, 1, workers=1, progress=False)
    assert kept < len(runs) and (outcome.runs, outcome.held, outcome.missing) == (kept, kept, ("mujoco",))
    assert "not installed: mujoco" in outcome.words()


GIVEN = load_scene("free-rocking-rigid").with_(block={"restitution": 0.8})


@pytest.mark.parametrize("solver", ["exudyn", "engines.pybullet.free_block:simulate"])
def test_no_engine_is_judged_by_a_restitution_that_it_was_given(solver):
    cases = [Case(GIVEN, name) for name in ("analytic", "twin", "time-stepping", solver)]
    Batch(cases[:3], print, "ours")
    assert len(Batch(cases, print, "shown, not judged", rates=False).cases) == 4
    with pytest.raises(ValueError, match=f"outcomes: {solver} is given block.restitution = 0.8, and not judged by it"):
        Batch(cases, print, "outcomes")


def test_no_tolerance_is_measured_where_the_restitution_is_given():
    with pytest.raises(agreement.Unmeasurable, match="restitution is given"):
        agreement.traced("exudyn", "compliant-corners", GIVEN)
