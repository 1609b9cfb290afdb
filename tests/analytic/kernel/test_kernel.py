"""The compiled kernel against closed forms, conservation laws, symmetry and its own order."""

import gc
import itertools
import math
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest
from bearing_laws import bearings_of
from from_python import from_python
from literature import A_IMPACTS, A_REST, A_TILT, B_TILT, ONE_SINE, ONE_SINE_SLENDER, under_a_pulse
from numba import njit
from numba.core.registry import cpu_target
from rough_motions import rough
from scipy.integrate import solve_ivp
from scipy.special import ellipk, ellipkinc

from analytic import (
    Block,
    PulseMotion,
    SampledMotion,
    Scene,
    SettingError,
    Start,
    batch,
    overturning_map,
    rocking_spectrum,
    simulate,
    simulate_many,
)
from analytic.advice.bearing_scan import displacement_spectrum
from analytic.checks import closed_form
from analytic.kernel import layout
from analytic.kernel import march as kernel
from analytic.kernel.cache import digest
from analytic.kernel.compiled import compiling, entry, inner
from analytic.kernel.layout import END_TILT, END_Z, ROWS, TOTALS
from analytic.kernel.march import run
from analytic.scene import BASE, caryatid_block, problem_a, problem_b
from analytic.scene import BEARINGS as LRB
from analytic.solver import ground, options, parameters

P = 2.6
CARYATID = caryatid_block(0.28)
PROBLEM_A, PROBLEM_B = problem_a(12.0), problem_b(12.0)


def isolated(slenderness=0.18, **parts):
    scene = Scene(block=CARYATID, base=BASE, bearings=LRB, motion=rough(3), duration=8.0)
    return scene.with_(block={"slenderness": slenderness}, **parts)


def end_state(scene, tolerance):
    chosen = options(tolerance, record=False)
    return run(parameters(scene), ground(scene.motion), chosen)[0][END_TILT : END_Z + 1]


def impacts_until(response, rate):
    """Return number and time of the first impact that leaves less than `rate` [rad/s]."""
    return next((n, impact.time) for n, impact in enumerate(response.impacts, 1) if abs(impact.rate_after) < rate)


@pytest.mark.parametrize(("settings", "accuracy"), [({"tolerance": 1e-16}, 1e-13), ({}, 1e-10)])
def test_a(settings, accuracy):
    response = simulate(PROBLEM_A, **settings)
    times = [impact.time for impact in response.impacts[:10]]
    assert times == pytest.approx(A_IMPACTS, rel=accuracy)
    end = simulate(PROBLEM_A.with_(duration=7.0), **settings).end
    assert abs(end.tilt) == pytest.approx(A_TILT, rel=10 * accuracy)


def test_a_comes_to_rest_after_every_impact():
    response = simulate(PROBLEM_A, tolerance=1e-16)
    for rate, (number, time) in A_REST.items():
        assert impacts_until(response, rate * P) == (number, pytest.approx(time, abs=1e-11))
    limit = closed_form.rest_time(P, 0.25, 1 - 1.5 * math.sin(0.25) ** 2, 0.9 * 0.25)
    assert response.rests == (pytest.approx(limit, abs=1e-11),)
    assert (response.end.tilt, response.end.tilt_rate) == (0, 0)


@pytest.mark.parametrize("number", [5, 20, 40, 60])
def test_a_run_may_end_in_any_swing_however_short(number):
    known = P, 0.25, 1 - 1.5 * math.sin(0.25) ** 2, 0.9 * 0.25
    begin, end = closed_form.free_rocking(*known, number + 1).times[-2:]
    duration = float(begin + 0.3 * (end - begin))
    state = simulate(problem_a(duration)).end
    assert (state.time, state.tilt) == (
        duration,
        pytest.approx(closed_form.free_rocking_tilt(*known, duration), rel=1e-5),
    )


def test_b():
    response = simulate(PROBLEM_B, tolerance=1e-16)
    assert response.uplifts == pytest.approx([math.asin(1 / 1.2) / 5.2], abs=1e-15)
    assert impacts_until(response, 1e-4 * P) == (81, pytest.approx(9.145490645, abs=1e-9))
    end = simulate(PROBLEM_B.with_(duration=6.0), tolerance=1e-16).end
    assert abs(end.tilt) == pytest.approx(B_TILT, rel=1e-12)


@pytest.mark.parametrize("ratio", ONE_SINE)
@pytest.mark.parametrize("table, slenderness", [(ONE_SINE, 0.25), (ONE_SINE_SLENDER, 1e-4)])
def test_boundaries(table, slenderness, ratio):
    # one-sine pulse, p = 2.14, e = 0.9: given to five decimals
    for k, boundary in enumerate(table[ratio]):
        for factor, above in ((1 - 1e-5, False), (1 + 1e-5, True)):
            scene = under_a_pulse(boundary * factor, ratio, slenderness)
            response = simulate(scene, history=False)
            overturns = response.outcome == "overturns" and response.unstable_time is not None
            assert overturns == (above == (k % 2 == 0))


@pytest.mark.parametrize("amplitude", [1.2, 2.0, 5.0])
def test_the_shortest_rectangular_pulse_that_overturns_a_slender_block(amplitude):
    """Without an impact its length is log(a/(a - 1))/p (Housner 1963), a over g gamma."""
    shortest = math.log(amplitude / (amplitude - 1)) / 2.14
    for factor in (1 - 1e-4, 1 + 1e-4):
        scene = under_a_pulse(amplitude, math.pi / (factor * shortest * 2.14), 1e-4, "rectangular")
        assert (simulate(scene, history=False).outcome == "overturns") == (factor > 1)


@pytest.mark.parametrize(
    "scene",
    [PROBLEM_A.with_(duration=3.0), isolated(motion=None, start=Start(tilt=0.1), duration=0.5)],
    ids=["rigid", "base"],
)
def test_error_falls_as_asked(scene):
    exact = end_state(scene, 1e-17)
    tolerances = np.array([1e-4, 1e-6, 1e-8, 1e-10, 1e-12])
    errors = np.array([np.abs(end_state(scene, tolerance) - exact).max() for tolerance in tolerances])
    slope = np.polyfit(np.log10(tolerances), np.log10(errors), 1)[0]
    assert 0.8 < slope < 1.3
    # a steady factor above the tolerance: what the motion makes of a local error
    scale = np.abs(exact[2:]).max() if scene.base else 1.0
    assert (errors[2:] < 1e4 * tolerances[2:] * scale).all()


@pytest.mark.parametrize(
    ("setting", "value"),
    [("tolerance", 0.0), ("tolerance", 1.0), ("rest_rate", 0.0), ("output_step", -1.0), ("tolerance", math.nan)],
)
def test_out_of_range(setting, value):
    with pytest.raises(SettingError, match=setting):
        simulate(PROBLEM_A, **{setting: value})


def test_more_events_than_the_first_try_keeps(monkeypatch):
    monkeypatch.setattr("analytic.solver.CAPACITY", 16)
    assert simulate(PROBLEM_A).impact_count == 177


# Closed forms, and the linear oscillator.


# Problem A: released at rest from 0.9 gamma, Housner's restitution; times of a high-precision solution.
A = (2.60, 0.25, 1 - 1.5 * math.sin(0.25) ** 2, 0.9 * 0.25)  # omega_r, slenderness, restitution, tilt


def test_impact_times_and_tilt_of_problem_a():
    np.testing.assert_allclose(closed_form.free_rocking(*A, 10).times, A_IMPACTS, rtol=0, atol=1e-13)
    assert abs(closed_form.free_rocking_tilt(*A, 7.0)) == pytest.approx(A_TILT, abs=1e-14)


@pytest.mark.parametrize("threshold", A_REST)
def test_impacts_until_rest_of_problem_a(threshold):
    count, time = A_REST[threshold]
    assert closed_form.impacts_to_rest(*A, threshold * A[0]) == count
    assert closed_form.free_rocking(*A, count).times[-1] == pytest.approx(time, abs=2e-13)


def test_rest_time_is_the_limit_of_the_impact_times():
    assert closed_form.rest_time(*A) == pytest.approx(closed_form.free_rocking(*A, 420).times[-1], abs=2e-13)
    assert closed_form.free_rocking_tilt(*A, 11.0) == 0


def test_remaining_time_is_second_order_in_the_rate():
    run = closed_form.free_rocking(*A, 420)
    deceleration = A[0] ** 2 * math.sin(A[1])
    remaining = [closed_form.remaining_time(run.rates_after[n], A[2], deceleration) for n in (40, 47)]
    errors = [remaining[0] - (run.times[-1] - run.times[40]), remaining[1] - (run.times[-1] - run.times[47])]
    # seven impacts more scale the rate by e^7
    assert math.log(errors[0] / errors[1]) / math.log(A[2] ** -7) == pytest.approx(3, abs=0.1)


def test_quarter_period_equals_the_difference_of_legendre_integrals():
    omega_r, gamma = 2.6, 0.25
    for peak in (0.1, 0.5, 0.9, 0.999):
        k = math.cos(gamma * (1 - peak) / 2)
        psi = math.asin(math.cos(gamma / 2) / k)
        legendre = (ellipk(k * k) - ellipkinc(psi, k * k)) / omega_r
        energy = closed_form.swing_energy(gamma, peak * gamma)
        # the Legendre parameter k^2 is rounded to 1e-16, which its complement k'^2 feels
        tolerance = 1e-16 / (math.sin(gamma * (1 - peak) / 2) ** 2 * omega_r) + 1e-14
        assert closed_form.quarter_period(omega_r, gamma, energy) == pytest.approx(legendre, abs=tolerance)


def test_small_swings_are_parabolas():
    gamma, rate = 0.25, 1e-7
    quarter = closed_form.quarter_period(1.0, gamma, (rate / 2) ** 2)
    assert quarter == pytest.approx(rate / math.sin(gamma), rel=1e-12)


def test_tilt_is_mirrored_and_continuous_at_impacts():
    assert closed_form.free_rocking_tilt(*A[:3], -A[3], 3.0) == -closed_form.free_rocking_tilt(*A, 3.0)
    assert closed_form.free_rocking_tilt(*A, 0.0) == pytest.approx(A[3], abs=1e-16)
    for time in A_IMPACTS:
        assert abs(closed_form.free_rocking_tilt(*A, time)) < 1e-12


@pytest.mark.parametrize("tilt", (0.0, 0.25, -0.3))
def test_tilts_that_do_not_rock_are_refused(tilt):
    with pytest.raises(ValueError, match="slenderness"):
        closed_form.free_rocking(*A[:3], tilt, 3)
    with pytest.raises(ValueError, match="unstable"):
        closed_form.quarter_period(2.6, 0.25, math.sin(0.125) ** 2)


def test_slender_limit_of_the_exact_forms_is_housners():
    """G. W. Housner (1963), Bull. Seismol. Soc. Am. 53(2), 403-417: period and peaks of a slender block."""
    gamma, ratio, e, omega_r = 1e-4, 0.6, 0.93, 2.0
    known = omega_r, gamma, e, ratio * gamma
    run = closed_form.free_rocking(*known, 4)
    assert 4 * run.times[0] == pytest.approx(4 / omega_r * math.acosh(1 / (1 - ratio)), rel=1e-8)
    energies = e ** (2 * np.arange(1, 4)) * (1 - (1 - ratio) ** 2)
    peaks = [closed_form.free_rocking_tilt(*known, time) for time in 0.5 * (run.times[1:] + run.times[:-1])]
    np.testing.assert_allclose(np.abs(peaks) / gamma, 1 - np.sqrt(1 - energies), rtol=1e-7)


def test_long_step_gives_the_overshoot_of_a_damped_oscillator():
    periods, ratios, a = np.array([0.3, 1.0, 2.317]), np.array([0.0, 0.05, 0.3]), 2.0
    step = SampledMotion(0.05, np.full(200, a))  # 10 s: the first peak lies inside, between samples
    zeta, w = ratios[:, None], 2 * math.pi / periods
    overshoot = a / w**2 * (1 + np.exp(-zeta * math.pi / np.sqrt(1 - zeta**2)))
    np.testing.assert_allclose(displacement_spectrum(step, periods, ratios)[1:], overshoot[1:], rtol=1e-12)
    # undamped: the drop to zero after the step may add to it, but never take away
    assert (displacement_spectrum(step, periods, ratios)[0] >= overshoot[0] * (1 - 1e-12)).all()


@pytest.mark.parametrize(
    "shape, frequency, w, response",
    [
        # after a pulse of length t1 the free vibration has amplitude 2 a/w^2 |sin(w t1/2)|; during it 2 a/w^2 at most
        ("rectangular", math.pi / 0.3, 2.0, 2 * math.sin(0.3)),
        ("rectangular", math.pi, 2.0, 2 * math.sin(1.0)),
        # x = -(a/2w^2)(sin u - u cos u), u = w t: after one full turn free vibration of amplitude pi a/w^2
        ("one-sine", 3.0, 3.0, math.pi),
    ],
)
def test_undamped_under_a_pulse(shape, frequency, w, response):
    peak = displacement_spectrum(PulseMotion(shape, 1.5, frequency), [2 * math.pi / w], [0.0])[0, 0]
    assert peak == pytest.approx(response * 1.5 / w**2, rel=1e-12 if shape == "rectangular" else 1e-6)


def test_agrees_with_scipy_on_noise():
    motion = SampledMotion(0.02, np.random.default_rng(3).normal(size=150))
    w, zeta, corners = 2 * math.pi / 0.37, 0.07, 0.02 * np.arange(150)
    state, peak = np.zeros(2), 0.0
    for start in corners[:-1]:

        def slope(t, y):
            return [y[1], -2 * zeta * w * y[1] - w * w * y[0] - np.interp(t, corners, motion.samples)]

        part = solve_ivp(
            slope, (start, start + 0.02), state, "DOP853", rtol=1e-12, atol=1e-14, events=lambda t, y: y[1]
        )
        state = part.y[:, -1]
        peak = max(peak, np.abs(part.y[0]).max(), *(abs(turn[0]) for turn in part.y_events[0]))
    assert displacement_spectrum(motion, [0.37], [zeta])[0, 0] == pytest.approx(peak, rel=1e-9)


def test_shape_scale_and_mirror():
    motion = SampledMotion(0.01, np.random.default_rng(5).normal(size=400))
    periods, ratios = np.linspace(0.1, 4, 17), [0.02, 0.1, 0.3]
    spectrum = displacement_spectrum(motion, periods, ratios)
    assert spectrum.shape == (3, 17)
    np.testing.assert_array_equal(displacement_spectrum(motion, periods, ratios, scale=-1.0), spectrum)
    np.testing.assert_array_equal(displacement_spectrum(motion, periods, ratios, scale=2.0), 2 * spectrum)


@pytest.mark.parametrize(("periods", "ratios"), [([0.0], [0.1]), ([math.nan], [0.1]), ([1.0], [1.0]), ([1.0], [-0.1])])
def test_out_of_range_is_refused(periods, ratios):
    with pytest.raises(SettingError):
        displacement_spectrum(PulseMotion("one-sine", 1.0, 1.0), periods, ratios)


# Batches: the same outcomes as one run at a time, whatever the number of workers.


GRAVITY = 9.81
BLOCK = Block(mass=1.0, radius=3 * GRAVITY / (4 * 2.14**2), slenderness=0.25, restitution=0.9)
SLENDER = caryatid_block(0.18)


def mixed_scenes():
    """Return rigid and isolated scenes in no order: pulses, records, no motion, with and without vertical motion."""
    pulses = PulseMotion("ricker", 4.0, 5.0), PulseMotion("one-cosine", 5.0, 7.0), PulseMotion("rectangular", 4.0, 3.0)
    rigid = [Scene(block=SLENDER, motion=motion, duration=12.0) for motion in (rough(1, 4.0), *pulses, rough(2, 6.0))]
    rigid[2:2] = [Scene(block=SLENDER, start=Start(tilt=0.02 * k), duration=12.0) for k in range(5)]
    bearings = [bearings_of(law, count=4) for law in ("algebraic", "bilinear")]
    scenes = [scene.with_(base=BASE, bearings=part) for part in bearings for scene in rigid[::-1]] + rigid
    shaken = [(scene, scene.motion) for scene in scenes if scene.motion]
    return [scene.with_(motion=replace(motion, vertical=motion.scaled(0.5))) for scene, motion in shaken] + scenes


def test_simulate_many_equals_one_at_a_time():
    scenes = mixed_scenes()
    many = simulate_many(scenes, tolerance=1e-14)
    assert len(set(many.overturns)) == 2  # the set holds both outcomes
    assert not many.failed.any()
    for i, scene in enumerate(scenes):
        single = simulate(scene, tolerance=1e-14, history=False)
        assert many.overturns[i] == (single.outcome == "overturns")
        assert many.lifted[i] == (single.outcome != "stands")
        assert many.peak_tilt[i] == pytest.approx(single.peak_tilt, rel=1e-8, abs=1e-12)
        if not many.overturns[i]:
            assert many.peak_base_displacement[i] == pytest.approx(single.peak_base_displacement, rel=1e-9)


def test_workers_are_as_many_as_are_asked_for_and_do_not_change_a_bit(monkeypatch):
    scenes, pools = mixed_scenes(), []
    monkeypatch.setattr(
        batch, "ThreadPoolExecutor", lambda workers: pools.append(workers) or ThreadPoolExecutor(workers)
    )
    serial, parallel = simulate_many(scenes, workers=1), simulate_many(scenes, workers=2)
    for name in ("overturns", "peak_tilt", "peak_base_displacement", "impacts"):
        assert np.array_equal(getattr(serial, name), getattr(parallel, name))
    assert set(pools) == {2}  # one worker needs no thread


def test_no_scenes():
    assert simulate_many([]).overturns.shape == (0,)


@pytest.mark.parametrize(
    "shape, vertical, fine",
    [("one-sine", 0.0, 1), ("one-sine", 0.8, 4), ("one-cosine", 0.0, 4), ("half-sine", -0.5, 4), ("ricker", 0.0, 4)],
)
def test_an_overturning_map_is_that_of_full_runs(shape, vertical, fine):
    """After the pulse the energy integral decides; a full run must agree in outcome and peak."""
    scene = Scene(block=BLOCK, duration=60.0)
    frequencies, amplitudes = np.linspace(1.5, 7, 23)[::fine], np.linspace(1.05, 9, 29)[::fine]
    phase = 0.7 if vertical else 0.0
    outcomes = overturning_map(
        scene.with_(duration=None if vertical else 60.0),
        shape,
        frequencies,
        amplitudes,
        tolerance=1e-16,
        vertical_ratio=vertical,
        vertical_phase=phase,
    )
    full = []
    for a, f in itertools.product(amplitudes * GRAVITY * math.tan(0.25), frequencies * scene.rocking_frequency):
        up = PulseMotion(shape, vertical * a, f, phase=phase) if vertical else None
        full.append(simulate(scene.with_(motion=PulseMotion(shape, a, f, vertical=up)), history=False, tolerance=1e-16))
    assert outcomes.overturns.ravel().tolist() == [response.outcome == "overturns" for response in full]
    assert outcomes.peak_tilt.ravel() == pytest.approx([response.peak_tilt for response in full], rel=1e-9)


def test_a_rocking_spectrum_runs_until_decided_and_is_that_of_full_runs():
    motion, periods = rough(5, 5.0, duration=8.0), np.linspace(0.8, 7.0, 21)
    cut = SampledMotion(motion.dt, motion.samples[: round(4.0 / motion.dt)])  # in the strong shaking
    outcomes = rocking_spectrum(cut, periods, 0.25)
    assert outcomes.decided.all() and 0 < outcomes.overturns.sum() < len(periods)
    for i, period in enumerate(periods):
        block = Block(mass=1.0, radius=0.75 * GRAVITY * (period / (2 * math.pi)) ** 2, slenderness=0.25)
        response = simulate(Scene(block=block, motion=cut, duration=cut.end + 60.0), history=False)
        assert outcomes.overturns[i] == (response.outcome == "overturns")
        # to rounding, and what the motion makes of it where the block hardly rocks
        assert outcomes.peak_tilt[i] == pytest.approx(response.peak_tilt, abs=1e-8)
    short = rocking_spectrum(cut, periods, 0.25, duration=0.9 * cut.end)
    assert not short.decided[~short.overturns].any()


# Inner functions are compiled as `analytic.kernel.compiled` says: numba has no public option for one part of it.


def native(function):
    """Return the machine code of a compiled function itself, without its wrappers."""
    (text,) = function.inspect_llvm().values()
    bodies = [part.partition("\n}")[0] for part in text.split("\ndefine ")[1:]]
    return "".join(
        body for body in bodies if not any(word in body.split("(")[0] for word in ("cpython", "cfunc", "NRT_"))
    )


def test_no_reference_is_counted_in_what_is_compiled_without():
    """Where an array is passed on and kept, numba counts a reference, an atomic operation; here it does not."""

    def hand_on(array, other, first):
        kept = array if first else other
        for _ in range(int(kept[0])):
            kept = other if kept[1] > 0 else array
        return kept[0]

    counts = {}
    for name, decorate in (("counted", njit), ("entry", entry)):
        function = decorate(hand_on)
        function(np.ones(3), np.ones(3), True)
        counts[name] = "NRT_incref" in native(function) or "atomicrmw" in native(function)
    assert counts == {"counted": True, "entry": False}


def test_an_inner_function_makes_no_array_and_is_not_called_from_python():
    @inner
    def makes():
        return np.zeros(3)

    with pytest.raises(Exception, match="Only accept returning of array passed into the function"):
        from_python(makes)()


@pytest.mark.parametrize("switch, enabled", [(gc.enable, True), (gc.disable, False)])
def test_the_collector_is_as_before_after_compiling(switch, enabled):
    switch()
    try:
        with compiling():
            assert not gc.isenabled()
        assert gc.isenabled() == enabled
    finally:
        gc.enable()


def test_an_inner_function_is_no_machine_code_but_in_its_entry():
    """numba would optimise and emit it at every level of calls, which takes about half of the time."""

    @inner
    def twice(x):
        return 2 * x

    @inner
    def four_times(x):
        return twice(twice(x))

    @njit
    def called(x):
        return four_times(x) + 1

    assert called(2.0) == 9.0
    linked = [next(iter(function.overloads.values())) for function in (twice, four_times)]
    engine = cpu_target.target_context.codegen()._engine
    assert [engine.is_symbol_defined(overload.fndesc.mangled_name) for overload in linked] == [False, False]
    (whole,) = called.overloads.values()
    assert engine.is_symbol_defined(whole.fndesc.mangled_name)


def test_the_kernel_keeps_to_the_arrays_it_is_given():
    arrays = layout.Arrays(*kernel.arrays(np.empty((1, TOTALS)), capacity=2, outputs=3))
    assert arrays.P.shape[0] == ROWS and [len(rows) for rows in arrays[2:6]] == [2, 2, 2, 3]


# The key of a compiled function is what it does: what it reads counts, and nothing else.
PLAIN = """
LIMIT = 2.0
def inner(x):
    return x * LIMIT
def make(step):
    def outer(x, least=0.5):
        '''What it does.'''
        return max(inner(x), least) + step + sum([k for k in (1, 2)])
    return outer
outer = make(3)
"""


def key_of(text, without=None, module="analytic.made"):
    scope = {"__name__": module}  # followed as the model's own
    exec(text, scope)
    scope.pop(without, None)
    return digest(scope["outer"])


def test_a_module_that_is_moved_or_renamed_counts(monkeypatch):
    """A stored form finds functions and classes by their modules: one from before the move would not load."""
    assert key_of(PLAIN, module="analytic.moved") != key_of(PLAIN)
    before = digest(kernel._run_rows)
    monkeypatch.setattr(layout, "__name__", "analytic.moved")
    assert digest(kernel._run_rows) != before


def test_an_entry_stands_below_what_it_calls():
    """Its key is taken where it stands: a function below would not count, and a stale kernel would run."""
    with pytest.raises(NameError, match="inner, read by .*outer, stands below the entry: move the entry down"):
        key_of(PLAIN, without="inner")
    assert kernel._run_rows._cache._impl.locator.get_source_stamp() == digest(kernel._run_rows)


@pytest.mark.parametrize(
    "before, after",
    [("LIMIT = 2.0", "\nLIMIT = 2.0  # so far"), ("What it does.", "Another sentence."), ("\ndef", "\nOTHER = 1\ndef")],
)
def test_words_lines_and_what_is_not_read_do_not_count(before, after):
    assert key_of(PLAIN.replace(before, after, 1)) == key_of(PLAIN)


@pytest.mark.parametrize(
    "before, after",
    [
        ("2.0", "2.5"),
        ("x * LIMIT", "x / LIMIT"),
        ("0.5", "0.6"),
        ("max", "min"),
        ("make(3)", "make(4)"),
        ("1, 2", "1, 3"),
    ],
)
def test_constants_operations_defaults_closures_and_what_is_called_count(before, after):
    assert key_of(PLAIN.replace(before, after)) != key_of(PLAIN)


def test_the_peak_of_tiny_swings_is_that_of_the_history():
    """An invariant on drawn scenes found this: a peak of 8e-4 of the slenderness was 2.7 % too small."""
    block = Block(mass=1000.0, radius=0.3, slenderness=0.1759013689508464)
    motion = PulseMotion("one-cosine", 1.8307934873923872, 17.87122919784876)
    response = simulate(Scene(block=block, motion=motion, duration=0.8563998150923371))
    assert response.peak_tilt >= np.abs(response.history.tilt).max() * (1 - 1e-9)
