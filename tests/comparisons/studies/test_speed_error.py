"""The speed-error study: its errors against known ones, its boundary search, tables, repetition and growth."""

import dataclasses
import math

import numpy as np
import pytest

from analytic import simulate
from analytic.errors import SettingError
from analytic.time_stepping import simulate_time_stepping
from comparisons.cli import main
from comparisons.measuring import models
from comparisons.running.cases import Case, solver
from comparisons.running.provenance import Result, read_result
from comparisons.running.store import Store
from comparisons.running.study import RUNS, compute
from comparisons.studies.speed_error import STUDY, growth, tables
from comparisons.studies.speed_error.figures import check_axes, draw_growth, draw_pareto
from comparisons.studies.speed_error.ladders import NEEDED
from comparisons.studies.speed_error.measure import errors
from comparisons.studies.speed_error.page import section
from comparisons.studies.speed_error.scenes import margin, trials
from comparisons.studies.speed_error.tables import cost_at_error, extras, orders, ranking_stability
from comparisons.studies.speed_error.timing import measure, searched
from engines import get_engine


@pytest.fixture(scope="module")
def by_name():
    return {trial.name: trial for trial in trials()}


@pytest.fixture(scope="module")
def free(by_name):
    return by_name["free-rigid"]


@pytest.fixture(scope="module")
def near(by_name):
    return by_name["near-overturning"]


def changed(trial, change):
    """Errors of the reference with its list of impacts changed."""
    values = trial.reference.to_json()
    return errors(trial, {**values, "impacts": change([dict(impact) for impact in values["impacts"]])})


def test_the_five_scenes_do_what_their_names_say(by_name):
    outcomes = {name: trial.reference.outcome for name, trial in by_name.items()}
    assert outcomes["isolated-standing"] == "stands"
    assert {outcomes[name] for name in ("free-rigid", "free-sliding", "isolated-rocking")} == {"rocks"}


def test_the_reference_has_no_error_against_itself(by_name):
    for trial in by_name.values():
        found = errors(trial, trial.reference.to_json())
        assert found.pop("lost_impacts") == 0
        assert set(found) == set(trial.measures) - {"boundary_shift"}
        assert max(found.values()) < 1e-12


def test_late_impacts_are_seen_as_late(free):
    def late(impacts):
        return [{**impact, "time": impact["time"] + 1e-4} for impact in impacts]

    found = changed(free, late)
    assert found["impact_time"] == pytest.approx(1e-4, rel=1e-9)
    assert found["restitution"] < 1e-12


def test_a_missing_impact_is_lost(free):
    assert changed(free, lambda impacts: impacts[:1] + impacts[2:])["lost_impacts"] == 1


def test_swings_that_lose_energy_show_as_restitution(free):
    """Rates that fall by 1 % more from impact to impact than eq. (7) says: e is 1 % low, whatever the impact shows."""

    def slower(impacts):
        return [{**impact, "rate_before": impact["rate_before"] * 0.99**k} for k, impact in enumerate(impacts)]

    e = free.reference.impacts[0].rate_after / free.reference.impacts[0].rate_before
    assert changed(free, slower)["restitution"] == pytest.approx(0.01 * e, rel=1e-6)


def test_the_margin_is_conserved_in_flight_and_its_sign_decides(near):
    for factor, overturns in ((0.98, False), (1.02, True)):
        scene = near.scene.with_(motion=near.scene.motion.scaled(factor))
        early, late = (margin(scene, simulate(scene.with_(duration=time), history=False).end) for time in (1.2, 1.7))
        assert early == pytest.approx(late, abs=1e-12)
        assert (early > 0) == overturns
        whole = simulate(scene.with_(duration=20.0), history=False)
        assert (whole.outcome == "overturns") == overturns


@pytest.mark.parametrize("factor", [1 + 1e-8, 1.001, 0.97, 1.06])
def test_a_shifted_boundary_is_found_where_it_is(near, factor):
    def run(scene):
        return simulate(scene.with_(motion=scene.motion.scaled(factor)), history=False)

    _, shifts = searched(run, near.scene, near.boundary)
    found = errors(near, near.reference.to_json(), shifts)["boundary_shift"]
    assert found == pytest.approx(abs(1 / factor - 1), rel=0.05, abs=1e-12)


def test_a_solver_without_boundary_nearby_gets_none(near):
    def run(scene):
        return simulate(scene.with_(motion=scene.motion.scaled(0.5)), history=False)

    _, shifts = searched(run, near.scene, near.boundary)
    assert "boundary_shift" not in errors(near, near.reference.to_json(), shifts)


def test_error_and_cpu_time_are_of_the_same_runs(free):
    case = Case(free.scene, "time-stepping", None, {"step": 1e-3, "history": False}, {"boundary": None})
    alone = simulate_time_stepping(free.scene, step=1e-3, history=False)
    values = measure(case, alone)
    assert values["impacts"] == alone.to_json()["impacts"]
    assert values["cost"]["cpu_seconds"] > 0
    assert values["cost"]["repeats"] > 1  # a run this short is repeated


def test_a_heavy_base_errs_by_its_mass_ratio(free):
    found = errors(free, simulate(models.on_heavy_base(free.scene), history=False).to_json())
    assert 0.01 / models.HEAVY < found["restitution"] < 1 / models.HEAVY


def test_a_tuned_free_block_rocks_as_the_planar_one(free):
    pytest.importorskip("pybullet")
    free_block = solver(get_engine("pybullet").variants["fixed-step"].free_block)
    found = errors(free, free_block(free.scene, step=1e-3, history=False).to_json())
    assert found["lost_impacts"] == 0
    assert found["restitution"] < 5e-3


def test_a_first_script_is_not_touched_by_other_clients(free):
    """Bullet's contact threshold is process-global: a tuned run must not leak into a script with default settings."""
    pybullet = pytest.importorskip("pybullet")
    ends = []
    for threshold in (1e-3, 5e-2):
        client = pybullet.connect(pybullet.DIRECT)
        pybullet.setPhysicsEngineParameter(contactBreakingThreshold=threshold, physicsClientId=client)
        pybullet.disconnect(client)
        ends.append(get_engine("pybullet").simulate(free.scene, variant="first-script", history=False).end)
    assert ends[0] == ends[1]


def row(family, cpu, error, lost=0, step=1.0, failure=None, model=NEEDED):
    return {
        "table": "ladder",
        "scene": "s",
        "family": family,
        "model": model,
        "law": None,
        "value": step,
        "errors": {"impact_time": error},
        "lost_impacts": lost,
        "cpu_seconds": cpu,
        "step": step,
        "failure": failure,
        "knob": "step",
    }


def result_of(rows):
    settings = {"scenes": {"s": {"title": "s", "measures": ["impact_time"]}}, "applied_impacts": {}}
    return Result(STUDY.name, settings, rows, {}, {"cpu_seconds": np.array([[one["cpu_seconds"]] for one in rows])})


def test_cost_at_an_error_is_the_cheapest_sound_run_that_reaches_it():
    rows = [
        row("a", 3.0, 1e-5),
        row("a", 1.0, 1e-3),
        row("a", 0.5, 1e-2),
        row("b", 0.1, 1e-5, lost=2),
        row("b", 2.0, 1e-4),
        row("c", 0.01, 1e-9, failure={"reason": "x"}),
        row("d", 1e-3, 1e-9, model="more"),
    ]
    found = cost_at_error(result_of(rows), "s", 1e-3)
    assert [(family, one["cpu_seconds"]) for family, one in found.items()] == [("a", 1.0), ("b", 2.0)]
    assert list(cost_at_error(result_of(rows), "s", 1e-4)) == ["b", "a"]
    assert cost_at_error(result_of(rows), "s", 1e-6) == {}


def test_observed_order_of_a_second_order_ladder():
    rows = [row("a", 1.0, 3 * step**2, step=step) for step in (1e-1, 1e-2, 1e-3)]
    order, spread, points = orders(result_of(rows), "s")["a"]
    assert order == pytest.approx(2.0, abs=1e-12) and points == 3 and spread < 1e-12


@pytest.mark.parametrize(
    "rounds, pairs, swapped",
    [
        # a, b, c by rounds: quiet, all told apart; b swaps with c; noise of a factor of 2 tells only c from the others
        ([[1.0, 1.0, 1.0, 1.0], [1.3, 1.3, 1.3, 1.3], [1.7, 1.7, 1.7, 1.7]], 3, 0),
        ([[1.0, 1.0, 1.0, 1.0], [1.3, 1.5, 1.3, 1.5], [1.9, 1.4, 1.9, 1.4]], 3, 1),
        ([[1.0, 2.0, 1.0, 2.0], [1.4, 1.4, 1.4, 1.4], [9.0, 9.0, 9.0, 9.0]], 2, 0),
    ],
)
def test_a_rank_counts_where_the_rounds_tell_two_solvers_apart(monkeypatch, rounds, pairs, swapped):
    monkeypatch.setattr(tables, "LEVELS", (1e-3,))
    monkeypatch.setattr(tables, "NOISE", 50 if swapped else tables.NOISE)  # of three settings, one is noisy
    rows = [row(family, float(np.median(cpu)), 1e-5) for family, cpu in zip("abc", rounds, strict=True)]
    result = dataclasses.replace(result_of(rows), arrays={"cpu_seconds": np.array(rounds)})
    tie, found, changed = ranking_stability(result)
    assert (found, len(changed)) == (pairs, swapped)
    assert tie >= tables.TIE
    assert swapped == 0 or changed == [("s", 1e-3, "b", "c")]


def test_more_than_needed_stands_beside_what_is_needed():
    rows = [row("a", 2.0, 1e-4), row("a", 6.0, 1e-2, model="more")]
    (found,) = extras(result_of(rows))
    assert (found["cost_ratio"], found["error"], found["needed_error"]) == (3.0, 1e-2, 1e-4)


def test_time_stepping_shows_its_order_in_the_boundary(near):
    """The time at which an impact is noticed is one step late at most: the boundary moves with the first power."""
    shifts = []
    for step in (1e-3, 1e-4, 1e-5):
        _, found = searched(
            lambda scene, step=step: simulate_time_stepping(scene, step=step, history=False), near.scene, near.boundary
        )
        shifts.append(errors(near, near.reference.to_json(), found)["boundary_shift"])
    assert shifts[0] < 2e-3
    assert shifts[2] < 0.1 * shifts[0]


def test_refined_motion_is_the_same_motion(by_name):
    scene = by_name["isolated-standing"].scene
    fine = growth.sampled(scene, 800)
    peaks = [simulate(one, history=False).peak_base_displacement for one in (scene, fine)]
    assert peaks[1] == pytest.approx(peaks[0], rel=1e-10)


def test_a_run_grows_in_steps_and_not_in_memory(by_name):
    steps, memory = [], []
    durations = 50, 100, 200, 400
    for duration in durations:
        scene = growth.lasting(by_name["isolated-standing"].scene, duration)
        case = growth.Point("duration", duration, "kernel", scene, "analytic").case(0)
        values = growth.grown(case, case.run())
        assert values["end"] == duration
        steps.append(values["steps"])
        memory.append(values["traced_bytes"])
    exponent, _ = growth.fit(durations, steps)
    assert exponent == pytest.approx(1.0, abs=0.05)
    assert max(memory) < 1.01 * min(memory)


def small(entry):
    names = {"kernel", "time-stepping", "pybullet, fixed-step"}
    return entry.family in names


def run_small(folder, near):
    (path,) = compute(STUDY, folder, quick=True, progress=False, repeats=2, scenes=[near], keep=small, grow=False)
    return read_result(path)


ON_ONE_WORKER = pytest.mark.xdist_group("speed-error study")  # the small study is run once


@pytest.fixture(scope="module")
def studied(tmp_path_factory, near):
    folder = tmp_path_factory.mktemp("speed-error")
    return folder, [run_small(folder / name, near) for name in ("first", "second")]


@ON_ONE_WORKER
def test_repeating_the_study_gives_the_same_errors_bit_for_bit(studied):
    _, (first, second) = studied
    assert first.rows and all(row["repeatable"] for row in first.rows)
    assert [row["errors"] for row in first.rows] == [row["errors"] for row in second.rows]
    assert all(row["timings"] == 2 for row in first.rows)


@ON_ONE_WORKER
def test_the_study_resumes(studied, near):
    folder, (first, _) = studied
    store = folder / "first" / RUNS
    with Store(store) as kept:
        before = len(kept)
    again = run_small(folder / "first", near)
    with Store(store) as kept:
        assert len(kept) == before
    assert [row["cpu_seconds"] for row in again.rows] == [row["cpu_seconds"] for row in first.rows]


@ON_ONE_WORKER
def test_the_section_speaks_in_numbers_and_draws(studied):
    _, (result, _) = studied
    page = section(result)
    words = " ".join(page.text)
    assert "times the analytic kernel" in words
    assert f"the errors of {len(result.rows)} of {len(result.rows)} settings are the same bit for bit" in words
    assert any("kernel" in cells[0] for table in page.tables for cells in table.rows)
    assert len(page.figures) == 2 and all(figure.svg for figure in page.figures)
    nothing = [
        dataclasses.replace(
            result,
            rows=result.rows
            + [
                {
                    "table": "growth",
                    "family": "kernel",
                    "against": "duration",
                    "value": value,
                    "failure": None,
                    "cpu_seconds": 1e-3 * value,
                    "traced_bytes": 1e5,
                    "resident_bytes": None,
                }
                for value in (1, 2, 4)
            ],
        )
    ]
    assert "exponent 1.000" in draw_growth(nothing[0]).axes[0].get_legend().get_texts()[0].get_text()


@ON_ONE_WORKER
@pytest.mark.parametrize("x, y", [("cpu", "error"), ("step", "boundary-shift"), ("cpu-per-second", "restitution")])
def test_axes_are_at_choice(studied, x, y):
    _, (result, _) = studied
    figure = draw_pareto(result, x, y)
    panel = figure.axes[list(result.settings["scenes"]).index("near-overturning")]
    assert panel.get_xscale() == panel.get_yscale() == "log"
    assert any(len(line.get_xdata()) for line in panel.lines) or y == "restitution"


def test_unknown_axes_are_refused():
    with pytest.raises(SettingError, match="axis 'speed': choose one of cpu, "):
        check_axes("speed")


@ON_ONE_WORKER
def test_replot_draws_from_a_result_file(studied, tmp_path, capsys):
    folder, _ = studied
    with pytest.raises(SystemExit) as left:
        main(
            [
                "study",
                "speed-error",
                "--replot",
                str(folder / "first" / "speed-error.json"),
                "--output",
                str(tmp_path),
                "--x",
                "steps",
                "--y",
                "peak-tilt",
            ]
        )
    assert left.value.code == 0
    assert (tmp_path / "speed-error-steps-peak-tilt.png").stat().st_size > 10_000
    with pytest.raises(SystemExit) as left:
        main(["study", "speed-error", "--replot", str(tmp_path / "none.json"), "--output", str(tmp_path)])
    assert left.value.code == 2
    assert "no such result file" in capsys.readouterr().err


def test_fit_of_a_power():
    x = np.array([1.0, 2.0, 4.0, 8.0])
    exponent, spread = growth.fit(x, 5 * x**0.7)
    assert math.isclose(exponent, 0.7, rel_tol=1e-12) and spread < 1e-12
