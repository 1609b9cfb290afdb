"""The compiled kernel against closed forms, conservation laws, symmetry and its own order."""

import math

import numpy as np
import pytest
from bearing_laws import to_law
from literature import A_IMPACTS, A_REST, A_TILT, B_TILT, ONE_SINE, ONE_SINE_SLENDER, under_a_pulse

from analytic import Base, SampledMotion, Scene, SettingError, Start, simulate
from analytic.bearing import BearingLaw
from analytic.caryatid import BASE, caryatid_block
from analytic.caryatid import BEARINGS as LRB
from analytic.kernel import run
from analytic.layout import TOTALS
from analytic.problems import problem_a, problem_b
from analytic.rocking import RockingModel
from analytic.solver import ground, options, parameters
from analytic.taylor import base_series

P = 2.6
CARYATID = caryatid_block(0.28)
PROBLEM_A, PROBLEM_B = problem_a(12.0), problem_b(12.0)


def shaken(seed=3, dt=0.01, duration=6.0, peak=4.0):
    """A rough motion with a corner at every sample."""
    rng = np.random.default_rng(seed)
    t = np.arange(0, duration, dt)
    a = np.sin(2 * np.pi * 0.8 * t) + 0.6 * rng.standard_normal(len(t))
    a *= np.exp(-(((t - 2) / 1.5) ** 2))
    return SampledMotion(dt, peak * a / np.abs(a).max())


def isolated(slenderness=0.18, **parts):
    scene = Scene(block=CARYATID, base=BASE, bearings=LRB, motion=shaken(), duration=8.0)
    return scene.with_(block={"slenderness": slenderness}, **parts)


def end_state(scene, tolerance, order=18):
    totals = np.zeros(TOTALS)
    chosen = options(tolerance, order=order, record=False)
    return np.array(run(parameters(scene), ground(scene.motion), chosen, totals)[0])


def impacts_until(response, rate):
    """Number and time of the first impact that leaves less than `rate` [rad/s]."""
    for number, impact in enumerate(response.impacts, 1):
        if abs(impact.rate_after) < rate:
            return number, impact.time
    raise AssertionError(f"no impact leaves less than {rate}")


class TestProblems:
    def test_a_impact_times(self):
        response = simulate(PROBLEM_A, tolerance=1e-16)
        times = [impact.time for impact in response.impacts[:10]]
        assert times == pytest.approx(A_IMPACTS, rel=1e-13)

    def test_a_state(self):
        end = simulate(PROBLEM_A.with_(duration=7.0), tolerance=1e-16).end
        assert abs(end.tilt) == pytest.approx(A_TILT, rel=1e-12)

    @pytest.mark.parametrize("rate", A_REST)
    def test_a_counts_every_impact_to_rest(self, rate):
        found = impacts_until(simulate(PROBLEM_A, tolerance=1e-16), rate * P)
        assert found == (A_REST[rate][0], pytest.approx(A_REST[rate][1], abs=1e-11))

    def test_a_limit_of_the_impacts(self):
        # from the impact at 1e-4 p the rest of the series takes 2 w/q (1/(1 - e)), q = p^2 sin(gamma)
        response = simulate(PROBLEM_A, tolerance=1e-16)
        number, when = impacts_until(response, 1e-8 * P)
        w, e = abs(response.impacts[number - 1].rate_after), 1 - 1.5 * math.sin(0.25) ** 2
        assert response.rests[0] == pytest.approx(when + 2 * w / (P * P * math.sin(0.25)) / (1 - e), abs=1e-14)

    def test_b(self):
        response = simulate(PROBLEM_B, tolerance=1e-16)
        assert response.uplifts == pytest.approx([math.asin(1 / 1.2) / 5.2], abs=1e-15)
        number, when = impacts_until(response, 1e-4 * P)
        assert number == 81
        assert when == pytest.approx(9.145490645, abs=1e-9)
        end = simulate(PROBLEM_B.with_(duration=6.0), tolerance=1e-16).end
        assert abs(end.tilt) == pytest.approx(B_TILT, rel=1e-12)

    def test_default_tolerance_is_good_to_1e9_s(self):
        times = [impact.time for impact in simulate(PROBLEM_A).impacts[:10]]
        assert times == pytest.approx(A_IMPACTS, abs=1e-9)


class TestOverturning:
    """One-sine pulse, p = 2.14, e = 0.9: the boundaries are given to five decimals."""

    @pytest.mark.parametrize("ratio", ONE_SINE)
    @pytest.mark.parametrize("table, slenderness", [(ONE_SINE, 0.25), (ONE_SINE_SLENDER, 1e-4)])
    def test_boundaries(self, table, slenderness, ratio):
        for k, boundary in enumerate(table[ratio]):
            for factor, above in ((1 - 1e-5, False), (1 + 1e-5, True)):
                scene = under_a_pulse(boundary * factor, ratio, slenderness)
                response = simulate(scene, history=False)
                overturns = response.outcome == "overturns" and response.unstable_time is not None
                assert overturns == (above == (k % 2 == 0))

    @pytest.mark.parametrize("amplitude", [1.2, 2.0, 5.0])
    def test_the_shortest_rectangular_pulse_that_overturns_a_slender_block(self, amplitude):
        """Without an impact: log(a/(a - 1))/p (Housner 1963), a over g gamma."""
        shortest = math.log(amplitude / (amplitude - 1)) / 2.14
        for factor in (1 - 1e-4, 1 + 1e-4):
            scene = under_a_pulse(amplitude, math.pi / (factor * shortest * 2.14), 1e-4, "rectangular")
            assert (simulate(scene, history=False).outcome == "overturns") == (factor > 1)


class TestConservation:
    @pytest.mark.parametrize(
        "scene",
        [
            PROBLEM_A,
            PROBLEM_B,
            isolated(),
            isolated(bearings={"law": "bouc-wen"}),
            isolated(bearings={"damping": 800.0}),
            isolated(bearings={"law": "linear"}),
            isolated(bearings=to_law("bilinear")),
        ],
        ids=["A", "B", "algebraic", "bouc-wen", "damped", "linear", "bilinear"],
    )
    def test_energy_ledger_closes(self, scene):
        energy = simulate(scene).energy
        turnover = max(abs(energy.input), abs(energy.potential))
        assert abs(energy.imbalance) < 1e-9 * turnover
        assert energy.impact_loss >= 0
        assert energy.viscous >= 0

    def test_every_impact_conserves_horizontal_momentum(self):
        scene = isolated()
        model, impacts = RockingModel.of(scene), simulate(scene).impacts
        assert len(impacts) > 20
        for impact in impacts:
            block = model.m * CARYATID.radius * math.cos(0.18) * (impact.rate_after - impact.rate_before)
            base = model.M * impact.base_velocity_jump
            assert block + base == pytest.approx(0.0, abs=1e-12 * abs(base))

    def test_bearing_force_is_continuous_at_reversals(self):
        scene = isolated(0.28)
        f0 = BearingLaw.of(LRB).f0
        history = simulate(scene, output_step=1e-5).history
        jumps = np.abs(np.diff(history.bearing_force)) / 4
        reversals = np.flatnonzero(np.diff(np.sign(history.base_velocity)))
        assert len(reversals) > 5
        # within one output step the force may change by ka dx
        travel = np.abs(np.diff(history.base_displacement))
        assert (jumps[reversals] <= LRB.ka * (travel[reversals] + 1e-10) + 1e-9 * f0).all()

    def test_history_obeys_the_law(self):
        scene = isolated()
        law, history = BearingLaw.of(LRB), simulate(scene, output_step=1e-4).history
        z = 0.0
        for x, dx, force in zip(
            history.base_displacement[1:], np.diff(history.base_displacement), history.bearing_force[1:], strict=True
        ):
            z = law.hysteretic(z, dx)
            assert abs(law.force(x, z) - force) / 4 < 2e-3 * law.f0  # reversals fall between output points
        assert abs(z) <= law.f0


class TestConvergence:
    @pytest.mark.parametrize(
        "scene",
        [PROBLEM_A.with_(duration=3.0), isolated(motion=None, start=Start(tilt=0.1), duration=0.5)],
        ids=["rigid", "base"],
    )
    def test_error_falls_as_asked(self, scene):
        exact = end_state(scene, 1e-17)
        tolerances = np.array([1e-4, 1e-6, 1e-8, 1e-10, 1e-12])
        errors = np.array([np.abs(end_state(scene, tolerance) - exact).max() for tolerance in tolerances])
        slope = np.polyfit(np.log10(tolerances), np.log10(errors), 1)[0]
        assert 0.8 < slope < 1.3
        # a steady factor above the tolerance: what the motion makes of a local error
        scale = np.abs(exact[2:]).max() if scene.base else 1.0
        assert (errors[2:] < 1e4 * tolerances[2:] * scale).all()

    @pytest.mark.parametrize("order", [4, 5, 6])
    def test_order_of_the_series(self, order):
        par, errors = parameters(isolated()), []
        law = BearingLaw.of(LRB)
        steps = np.array([0.04, 0.02, 0.01])
        for n in (order, 24):
            rows = np.zeros((10, 27))
            phi, w, S, C, x, v, q, F, absolute, A = rows
            phi[0], w[0], x[0], v[0], A[0], A[1] = 0.05, 0.3, 0.02, 0.4, 1.0, -3.0
            S[0], C[0] = math.sin(0.18 - 0.05), math.cos(0.18 - 0.05)
            z = law.hysteretic(0.0, 0.02)
            F[0] = law.force(0.02, z)
            q[0], factors, _ = law.unit.begin(1.0, z, 1.3, *law.constants)
            base_series(n, par, factors, 1, A, phi, w, S, C, x, v, q, F, absolute)
            errors.append([np.polyval(phi[n::-1], h) for h in steps])
        error = np.abs(np.subtract(*errors))
        observed = np.log2(error[:-1] / error[1:])
        assert observed == pytest.approx([order + 1] * 2, abs=0.5)

    def test_heavy_base_tends_to_rigid_ground(self):
        scene = Scene(block=CARYATID, start=Start(tilt=0.15), duration=3.0)
        rigid = simulate(scene, tolerance=1e-15).end.tilt
        ratios = np.array([1e3, 1e4, 1e5])
        gaps = [
            abs(simulate(scene.with_(base=Base(mass=CARYATID.mass * ratio)), tolerance=1e-15).end.tilt - rigid)
            for ratio in ratios
        ]
        rate = -np.polyfit(np.log10(ratios), np.log10(gaps), 1)[0]
        assert rate == pytest.approx(1.0, abs=0.05)


class TestSettings:
    @pytest.mark.parametrize(
        ("setting", "value"),
        [("tolerance", 0.0), ("tolerance", 1.0), ("rest_rate", 0.0), ("output_step", -1.0), ("tolerance", math.nan)],
    )
    def test_out_of_range(self, setting, value):
        with pytest.raises(SettingError, match=setting):
            simulate(PROBLEM_A, **{setting: value})

    def test_more_events_than_the_first_try_keeps(self, monkeypatch):
        monkeypatch.setattr("analytic.solver.CAPACITY", 16)
        few = options(capacity=16)
        totals = np.zeros(TOTALS)
        kept = run(parameters(PROBLEM_A), ground(None), few, totals)[1]
        assert len(kept) == 16 < simulate(PROBLEM_A).impact_count == 177
