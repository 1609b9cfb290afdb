"""Every exercise's answer, found on another way than the lesson finds it."""

import math

import numpy as np
import pytest

from analytic import Scene, simulate, synthetic_motion
from analytic.caryatid import BASE, BEARINGS, MASS, RADIUS, caryatid_block
from analytic.closed_form import swing_energy
from analytic.rocking import restitution
from analytic.twin import simulate_twin
from comparisons.lessons import engine_runs
from comparisons.lessons.topics import bearing, caryatid, chaos, checks, corner, cost, impacts, lessons, tipping


def test_every_exercise_is_tried_here():
    """A new exercise needs a line of its own in this file."""
    source = __import__("pathlib").Path(__file__).read_text()
    for lesson in lessons():
        for exercise in lesson.exercises:
            module = lesson.view.__module__.rsplit(".", 1)[-1]
            assert f"{module}.{exercise.compute.__name__}()" in source, exercise.question


class TestTipping:
    def test_half_the_width_over_half_the_height(self):
        assert tipping.lifting_acceleration() == pytest.approx(0.3 / 1.0, rel=1e-12)

    def test_the_second_implementation_falls_there_too(self):
        edge = tipping.first_fall()
        for side, outcome in ((1e-5, "overturns"), (-1e-5, "rocks")):
            scene = tipping.pulse_scene(edge * (1 + side)).with_(duration=6.0)
            assert simulate_twin(scene, history=False, energy=False).outcome == outcome

    def test_a_larger_block_survives(self):
        size = tipping.size_that_survives()
        assert simulate(tipping.pulse_scene(0.5, size=size * (1 + 1e-6)), history=False).outcome == "rocks"
        assert simulate(tipping.pulse_scene(0.5, size=size * (1 - 1e-6)), history=False).outcome == "overturns"


class TestImpacts:
    def test_a_rectangle(self):
        assert impacts.worked_number() == pytest.approx(1 - 1.5 * math.sin(0.28) ** 2, rel=1e-9)

    def test_swings_by_their_energy(self):
        e = 1 - 1.5 * math.sin(0.28) ** 2
        ratio = swing_energy(0.28, 0.1 * 0.28) / swing_energy(0.28, 0.8 * 0.28)
        assert impacts.swings_to_a_tenth() == math.ceil(math.log(ratio) / (2 * math.log(e)))

    def test_flat_landing(self):
        assert impacts.no_rocking_on() == pytest.approx(math.asin(math.sqrt(2 / 3)), rel=1e-12)

    def test_momentum(self):
        """Horizontal, and angular about the new corner: two equations, solved as such."""
        m, h, b = MASS, RADIUS * math.cos(0.28), RADIUS * math.sin(0.28)
        inertia = 4 / 3 * m * RADIUS**2
        both = np.array([[m * h, m + BASE.mass], [inertia, m * h]])
        _, jump = np.linalg.solve(both, [m * h, inertia - 2 * m * b * b])
        assert impacts.momentum_on_the_base() == pytest.approx(jump, rel=1e-12)


class TestBearing:
    def test_the_loop_in_closed_form(self):
        stiff, alpha = BEARINGS.ka - BEARINGS.kb, BEARINGS.alpha
        closed = 4 * bearing.LAW.f0 * 0.30 - 2 * stiff / ((alpha - 1) * (alpha - 2))
        assert bearing.cycle_energy() == pytest.approx(closed, rel=1e-5)

    def test_the_period_of_the_secant(self):
        force = 4 * (BEARINGS.kb * 0.30 + bearing.LAW.f0)  # on the limit curve
        assert bearing.secant_period() == pytest.approx(2 * math.pi * math.sqrt((MASS + 212) * 0.30 / force), rel=1e-4)

    def test_half_of_thirty_per_cent(self):
        assert bearing.usual_damping() == pytest.approx(15, rel=1e-3)

    def test_the_jump_of_the_misprint(self):
        assert bearing.misprinted_jump() == pytest.approx(2 * bearing.LAW.f0, rel=1e-3)


class TestCaryatid:
    def test_lifting_is_the_bearings_force(self):
        """Up to the least slenderness the block is one mass with its base: its peak acceleration is all that counts."""
        run = simulate(caryatid.scene_of(0.45, 1.0, synthetic_motion()), history=False)
        assert run.outcome == "stands"
        level = run.peak_base_acceleration / 9.81
        assert math.tan(caryatid.least_slenderness()) == pytest.approx(level, rel=1e-9)
        assert caryatid.reserve() == pytest.approx(100 * (1 - level / math.tan(0.28)), rel=1e-9)

    def test_isolation_may_harm(self):
        edge = caryatid.harmful_pulse()
        assert edge < math.tan(0.28)
        for side, outcome in ((1e-6, "overturns"), (-1e-6, "rocks")):
            pulse = caryatid.PulseMotion("one-sine", edge * (1 + side) * 9.81, 2 * math.pi / 1.8)
            assert simulate(caryatid.scene_of(0.28, 1.0, pulse), history=False).outcome == outcome
            assert simulate(caryatid.scene_of(0.28, None, pulse), history=False).outcome == "stands"


class TestCorner:
    def test_half_a_step(self):
        assert 0.5 * 4.0 * 0.9 < corner.worst_shift() < 0.5 * 5.0 * 1.05

    def test_the_first_step_that_is_off_by_more(self):
        step = 1e-3 * corner.step_for_one_per_cent()
        place = int(np.argmin(np.abs(corner.SCAN - step)))
        assert corner.rate_error(float(corner.SCAN[place + 1])) >= 0.01
        assert max(corner.rate_error(float(s)) for s in corner.SCAN[: place + 1]) < 0.01

    def test_first_order(self):
        assert corner.order() == pytest.approx(1.0, abs=0.15)


class TestChaos:
    def test_two_horizons_give_the_same_growth(self):
        slope = math.log(1e6) / (chaos.horizon(-9.0) - chaos.horizon(-3.0))
        assert chaos.growth() == pytest.approx(slope, rel=0.6)
        assert chaos.hair_for_twenty_seconds() == pytest.approx(math.log(1e15) / chaos.growth(), rel=1e-9)

    def test_the_crowd_one_by_one(self):
        values = chaos.RESTITUTION * (1 + 0.01 * np.linspace(-1, 1, chaos.CROWD))
        runs = [simulate(chaos.scene().with_(block={"restitution": e}), history=False) for e in values]
        assert chaos.share_that_falls() == 100 * np.mean([run.outcome == "overturns" for run in runs])


@pytest.fixture
def without_engines(monkeypatch):
    monkeypatch.setattr(cost, "engine_runs", lambda: ())


class TestCost:
    def test_the_next_step_is_off_by_more(self):
        step = 1e-3 * cost.coarsest_step()
        by_step = {run.value: run.error for run in engine_runs.own_runs()}
        assert all(error < cost.TARGET for value, error in by_step.items() if value <= step)
        coarser = min(value for value in by_step if value > step)
        assert by_step[coarser] >= cost.TARGET

    def test_the_table_counts_them(self, without_engines):
        assert cost.passing_solvers() == len(cost.table().rows) == 2
        assert cost.event_driven_share() > 0


class TestChecks:
    def test_the_misprint_is_a_length_too_many(self):
        scene = Scene(block=caryatid_block(0.28), base=BASE)
        too_long = RADIUS * math.cos(0.28) - 1  # in metres
        assert checks.misprint_factor() == pytest.approx(100 * too_long, rel=1e-9)
        assert checks.misprint_defect() == pytest.approx(100 * too_long * (1 - restitution(scene)), rel=1e-9)

    def test_first_order(self):
        assert checks.observed_order() == pytest.approx(1.0, abs=0.15)

    def test_the_mirror(self):
        assert checks.mirror_defect() == 0.0

    def test_the_event_driven_model_passes_them_all(self):
        assert max(checks.checks("event-driven", 6.0).values()) < 1e-8
        assert min(value for name, value in checks.checks("fixed steps", 2.0).items() if name != "mirror") > 1e-3
