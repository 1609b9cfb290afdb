"""Every measure is tried on analytic responses, where its own error is known, and on ones made wrong on purpose."""

import dataclasses
import functools
import itertools
import json
import math
from types import SimpleNamespace

import numpy as np
import pytest

from analytic import Base, Block, PulseMotion, Scene, Start, simulate
from analytic.rocking import BearingLaw, restitution
from analytic.scene import BASE, BEARINGS, MASS
from comparisons.metrics import agreement
from comparisons.metrics.agreement import QUANTITIES, TABLE, measure_all, rows
from comparisons.metrics.errors import (
    base_jump_error,
    compare,
    energy_errors,
    graph_distance,
    impact_errors,
    impact_time_errors,
    rate_restitution,
    strong_impacts,
    swing_restitution,
)
from comparisons.studies.restitution.study import free_scene
from engines import get_engine, installed_engines


def free(slenderness=0.25, base=None, start=0.6, duration=10.0, **block):
    return Scene(
        block=Block(mass=3172.05, radius=1.0884, slenderness=slenderness, **block),
        base=base,
        start=Start(tilt=start * slenderness),
        duration=duration,
    )


@pytest.mark.parametrize("slenderness, step", [(0.1, None), (0.2, None), (0.25, 0.04), (0.3, None), (0.45, None)])
@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("base", [None, Base(mass=3172.05)])
def test_swing_energies_and_successive_rates_give_the_restitution_of_eq_7(slenderness, side, base, step):
    scene = free(slenderness, base, start=0.6 * side)
    response = simulate(scene, output_step=step)
    measured = swing_restitution(scene, response)
    clear = np.isfinite(measured)
    assert clear.sum() >= 5
    assert np.abs(measured[clear] - restitution(scene)).max() < 1e-8
    np.testing.assert_allclose(rate_restitution(response), restitution(scene), atol=1e-9)


def test_swing_energies_need_free_rocking_and_a_history():
    isolated = free(0.2, BASE, duration=1.5).with_(bearings=BEARINGS)
    blind, response = simulate(free(), history=False), simulate(isolated)
    with pytest.raises(ValueError, match="state_restitution"):
        swing_restitution(isolated, response)
    with pytest.raises(ValueError, match="history=True"):
        swing_restitution(free(), blind)
    assert np.abs(impact_errors(isolated, response)["state"]).max() < 1e-9
    assert not [
        errors for errors in (impact_errors(isolated, response), impact_errors(free(), blind)) if "swing" in errors
    ]


def test_impact_times_match_by_side_and_a_lost_one_is_nan():
    response = simulate(free())
    late = [dataclasses.replace(impact, time=impact.time + 1e-3) for k, impact in enumerate(response.impacts) if k != 3]
    errors = impact_time_errors(dataclasses.replace(response, impacts=late), response)[:8]
    np.testing.assert_allclose(errors, [1e-3] * 3 + [np.nan] + [1e-3] * 4, atol=1e-12)


def graph(time, tilt):
    """All that `graph_distance` asks of a response."""
    return SimpleNamespace(history=SimpleNamespace(time=time, tilt=tilt))


of_graphs = functools.partial(graph_distance, tilt_scale=1.0, time_scale=1.0)


def test_graph_distance_of_a_late_jump_is_its_delay():
    time = np.linspace(0, 4, 4001)
    early, late = (graph(time, np.where(time < jump, 0.0, 1.0)) for jump in (2.0, 2.05))
    distance = of_graphs(early, late, time_scale=2.0)
    # Both jumps are ramps over one sample, so the distance is the perpendicular one between the ramps.
    assert distance == pytest.approx(0.05 / 2.0 / math.hypot(1.0, 0.001 / 2.0), rel=1e-9)
    assert of_graphs(late, early, time_scale=2.0) == distance
    assert of_graphs(early, late, time_scale=2.0, until=1.9) < 1e-18  # round-off


@pytest.mark.parametrize("cut", [0.0, 0.003, 0.4])
def test_graph_distance_is_over_the_same_span(cut):
    """A falling block whose history ends `cut` seconds before the other's, off its samples."""
    time = np.linspace(0, 2, 201)
    short = np.append(time[time < 2 - cut], 2 - cut)
    fall, part = graph(time, np.exp(time)), graph(short, np.interp(short, time, np.exp(time)))
    for until in (math.inf, 1.234):
        assert max(of_graphs(fall, part, until=until), of_graphs(part, fall, until=until)) < 1e-12


def test_energy_errors_vanish_for_exact_runs_and_see_a_drift():
    scene = free(0.2, BASE, duration=4.0)
    response = simulate(scene)
    assert max(energy_errors(scene, response)) < 1e-10
    history = response.history
    growing = dataclasses.replace(history, tilt_rate=history.tilt_rate * (1 + 1e-3 * history.time))
    drifting = dataclasses.replace(response, history=growing)
    assert min(energy_errors(scene, drifting)) > 1e-4 and max(energy_errors(scene, drifting, until=0.01)) < 1e-5


def test_energy_drift_with_bearings_and_motion_falls_with_the_sampling():
    pulse = PulseMotion("one-sine", 4.0, 6.0)
    scene = free(0.15, BASE, start=0.0, duration=3.0).with_(bearings=BEARINGS, motion=pulse)
    drifts = [energy_errors(scene, simulate(scene, output_step=step))[0] for step in (4e-3, 2e-3, 1e-3)]
    assert drifts[0] / drifts[1] > 3 and drifts[1] / drifts[2] > 3  # trapezoidal rule: factor 4


def test_comparison_tells_overturning_times_and_outcomes():
    scene = free(start=0.0, duration=5.0).with_(motion=PulseMotion("one-sine", 8.0, 6.26))
    runs = reference, stronger, _ = [
        simulate(scene.with_(motion=scene.motion.scaled(factor))) for factor in (1.0, 1.01, 0.2)
    ]
    itself, near, other = (compare(scene, run, reference) for run in runs)
    assert itself.same_outcome and near.same_outcome and not other.same_outcome
    assert near.overturning_time_error == stronger.overturning_time - reference.overturning_time != 0
    assert itself.overturning_time_error == 0 and other.overturning_time_error is None
    itself = compare(free(), *2 * [simulate(free())])
    assert (itself.lost_impacts, itself.peak_tilt_error) == (0, 0)
    assert (itself.impact_time_error, itself.graph_distance) == (0, 0)


CARYATID_BASE = BASE.mass / MASS


@pytest.mark.parametrize("ratio", [None, 10.0, CARYATID_BASE])
@pytest.mark.parametrize("slenderness", [0.1, 0.45])
def test_exact_responses_have_no_error_and_the_printed_jump_has(slenderness, ratio):
    scene = free_scene(slenderness, ratio, 0.5)
    response = simulate(scene)
    errors = impact_errors(scene, response, 3)
    assert len(errors["time"]) == 3
    assert np.abs(errors["swing"]).max() < 1e-8
    assert np.abs(errors["state"]).max() < 1e-9
    if ratio:
        assert np.abs(errors["jump"]).max() < 1e-9
        assert np.abs(errors["jump_8"]).max() < 1e-9
        np.testing.assert_allclose(errors["jump_8_printed"], 1 / scene.block.half_height - 1, atol=1e-9)
        heavier = scene.with_(base=Base(mass=2 * scene.base.mass))
        expected = scene.mass_share / heavier.mass_share - 1
        np.testing.assert_allclose(base_jump_error(heavier, response), expected, atol=1e-9)


@pytest.mark.parametrize("given, off", [(0.9, 0.0), (None, 0.9)])
def test_another_impact_law_is_measured_as_what_it_is(given, off):
    """Of a run with a restitution of .9: no error where its scene gives that, else the difference."""
    scene = free_scene(0.2, None, 0.6).with_(block={"restitution": given})
    errors = impact_errors(scene, simulate(scene.with_(block={"restitution": 0.9})), 3)
    for kind in ("swing", "state"):
        np.testing.assert_allclose(errors[kind], off and off - restitution(scene), atol=1e-8)


@pytest.mark.parametrize("start, duration", [(1e-3, 10.0), (0.6, 30.0)])
def test_impacts_are_judged_by_the_fastest_of_their_run_however_slow_that_is(start, duration):
    """Released a thousandth of the slenderness from rest, no impact comes to .1 rad/s; later ones are chatter."""
    response = simulate(free(start=start, duration=duration), history=False)
    rates = np.abs([impact.rate_before for impact in response.impacts])
    strong = int((rates >= 0.1 * rates.max()).sum())
    assert (rates.max() < 0.1) == (start < 0.1) and 5 < strong == len(strong_impacts(response)) < len(rates)
    np.testing.assert_allclose(rate_restitution(response), [restitution(free())] * (strong - 1), atol=1e-9)


def test_graph_distance_of_lines_is_that_of_their_ends_and_none_of_one_point():
    """The last samples of a history may be one in rounding, and a horizon may leave none but the first."""
    time, fine = np.append(np.linspace(0, 10, 101), 10.0), np.linspace(0, 10, 777)
    # the end point (10, 20.5) is nearest to (10, 20)
    assert of_graphs(graph(time, 2 * time), graph(fine, 2 * fine + 0.5)) == pytest.approx(0.5, rel=1e-12)
    assert of_graphs(graph(time, time), graph(time, time), until=0.05) is None


# The table of tolerances is as tight as it says; its measures see what they should.


def test_bounds_are_no_looser_than_twice_the_measured_worst_and_rows_are_named_apart():
    assert not [
        row for row in TABLE if not row.measured <= row.bound <= (math.inf if row.round_off else 2 * row.measured)
    ]
    assert len({row.name for row in TABLE}) == len(TABLE)
    named = {row.scenes for row in TABLE if row.measure is not agreement.boundary_shift} - {*agreement.FREE_ROCKING}
    assert all(isinstance(agreement.named_scene(scenes), Scene) for scenes in named)


def test_every_installed_tuned_default_variant_has_its_rows():
    wanted = set(QUANTITIES) - {"restitution from swings, |mean error|"}  # of one variant alone
    for name in installed_engines():
        engine = get_engine(name)
        if engine.variants[engine.default_variant].kind == "tuned":
            assert {(row.variant, row.quantity) for row in rows(name)} == {
                (engine.default_variant, quantity) for quantity in wanted
            }


def test_the_papers_law_agrees_with_the_models_between_many_reversals():
    scene = agreement.named_scene("isolated Caryatid, synthetic motion")
    history = simulate(scene).history
    law, x = BearingLaw.of(scene.bearings), history.base_displacement
    forces = list(itertools.accumulate(np.diff(x), law.hysteretic, initial=law.start(x[0])))
    expected = law.force(x, np.array(forces))
    assert (np.diff(np.sign(np.diff(x))) != 0).sum() > 10
    np.testing.assert_allclose(agreement.paper_force(law, x), expected, atol=1e-9 * law.count * law.f0)


@pytest.mark.parametrize("frequency, amplitude", [(2.0, 1.25090), (5.0, 3.03234)])
def test_the_first_boundary_is_the_published_one(monkeypatch, frequency, amplitude):
    """Published over g slenderness, and for a restitution of 0.9; what falls 6 s after the pulse counts as standing."""
    scene = agreement.boundary_scene
    monkeypatch.setattr(agreement, "boundary_scene", lambda *given: scene(*given).with_(block={"restitution": 0.9}))
    result = agreement.first_boundary(0.25, "one-sine", frequency)
    assert result * math.tan(0.25) / 0.25 == pytest.approx(amplitude, rel=1e-5)


def test_a_row_checks_itself_in_the_tests_of_others():
    engine = installed_engines()[0]
    row = next(row for row in rows(engine, get_engine(engine).default_variant) if row.quantity == "peak tilt")
    runs = {}
    assert 0 < row.check(runs) <= row.bound
    with pytest.raises(AssertionError, match="peak tilt.*tolerated 1e-12"):
        dataclasses.replace(row, bound=1e-12).check(runs)


def test_a_failed_run_is_a_row_that_does_not_hold(monkeypatch):
    def fails(*_):
        raise agreement.Unmeasurable("exudyn failed: it sank")

    (result,) = measure_all((dataclasses.replace(TABLE[0], measure=fails),))
    assert not result["holds"] and result["found"] is None and "sank" in result["failure"]
    json.dumps(result, allow_nan=False)
