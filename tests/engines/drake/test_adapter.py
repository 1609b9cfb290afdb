"""Drake, beside what every engine must fulfil: accuracy of its variants, the limits of its solvers, what is refused."""

import math

import numpy as np
import pytest

pytest.importorskip("pydrake", reason="pydrake is not installed: see README.md")

from released import impact_errors, scene  # noqa: E402

from analytic import Bearings, PulseMotion, SampledMotion, Start, load_scene  # noqa: E402
from analytic import simulate as exact  # noqa: E402
from analytic.rocking import restitution  # noqa: E402
from comparisons.measuring.restitution import impact_errors as impact_quantities  # noqa: E402
from engines import get_engine  # noqa: E402
from engines.contract import Mismatch  # noqa: E402
from engines.drake import scene as built  # noqa: E402

simulate = get_engine("drake").simulate
BEARINGS = Bearings(count=4, ka=6.22e4, kb=6.22e3, alpha=44.69)


@pytest.mark.parametrize("slenderness, base", [(0.1, None), (0.2, 212.0)])
def test_accuracy_knob_means_error_of_restitution(slenderness, base):
    coarse, fine = (impact_errors(simulate, slenderness, base, 4, 2.5, accuracy=knob)[0] for knob in (1e-3, 1e-6))
    assert 1e-4 < coarse < 2e-3
    assert coarse / fine > 200
    assert fine < 1e-5


@pytest.mark.slow
def test_expert_is_of_first_order():
    errors = [impact_errors(simulate, 0.2, None, 4, 3.0, variant="expert", step=step)[0] for step in (1e-3, 2e-4)]
    assert errors[1] < 1e-3
    assert 2.5 < errors[0] / errors[1] < 10  # 5 but for the phase of the steps


@pytest.mark.slow
@pytest.mark.parametrize("step", [1e-3, 2e-4])
def test_first_script_is_off_at_any_step(step):
    """Its contact, soft by default, leaves the block too fast: e from the swings around three impacts."""
    given = scene(0.2, 212.0, 3.0, start=Start(tilt=0.1))
    off = impact_quantities(given, simulate(given, variant="first-script", step=step), 3)["swing"]
    assert 5e-3 < np.mean(off) < 3e-2


def test_drake_and_not_the_adapter_decides_the_impact():
    """Landing at the rate w, the block goes on at eq. (7)'s: after three updates of Drake's plant, from velocities."""
    for base in (None, 212.0):
        given = scene(0.3, base)
        contacts, b, h = built.build(given).contacts, given.block.half_width, given.block.half_height
        state = built.start_of(given)
        count = len(state) // 2
        state[count : count + 3] = -b, h, 1.0
        for _ in range(3):
            state[count:] = contacts.kick(state, np.zeros(count))
        assert state[count + 2] == pytest.approx(restitution(given), abs=1e-6)


def test_a_block_that_stands_is_not_said_to_rock():
    """Its corners yield: below uplift the block tilts by 7e-6 of its slenderness in long steps."""
    motion = SampledMotion(1 / 60, np.sin(np.pi * np.arange(0.0, 8.0, 1 / 60)))
    response = simulate(load_scene("caryatid-isolated").with_(motion=motion, duration=8.0), largest_step=1 / 60)
    assert (response.outcome, response.impact_count) == ("stands", 0)


@pytest.mark.parametrize("slenderness", [0.05, 0.25, 0.45, 1.2])
@pytest.mark.parametrize("share", [1.05, 4 / 3, 3.0])
def test_jamming_is_the_least_over_all_tilts(slenderness, share):
    given = scene(slenderness).with_(block={"corner_inertia": share * 3172.05 * 1.0884**2})
    angle = np.linspace(1e-3, slenderness, 20001)
    lift, drag = share - 1 + np.sin(angle) ** 2, np.sin(angle) * np.cos(angle)  # of a corner, by a normal impulse
    assert built.jamming(given) == pytest.approx((lift / drag).min(), rel=1e-6)


def test_tamsi_finds_no_solution_where_a_corner_could_jam(monkeypatch):
    """Why the adapter gives it less; and a step that Drake does not solve is a failure in Drake's words."""
    monkeypatch.setattr(built, "UNJAMMED", math.inf)
    response = simulate(scene(0.3, 212.0, bearings=BEARINGS, start=Start(tilt=0.1, tilt_rate=0.3)))
    assert response.outcome == "failed"
    assert response.failure.reason == "Drake found no solution of a step"
    assert "failed to converge" in response.failure.message and "at step" in response.failure.message


def test_a_corner_that_slips_is_held_by_sap(monkeypatch):
    """With hardly any friction for TAMSI, SAP has most updates to do: the same motion, and the model's."""
    given = scene(0.25, duration=0.4, motion=PulseMotion("one-sine", 20.0, 12.0))
    usual, held, kick = simulate(given).end.tilt, [], built.Contacts.kick

    def counted(self, *state):
        held.append(self.friction == built.FRICTION)
        return kick(self, *state)

    monkeypatch.setattr(built.Contacts, "kick", counted)
    monkeypatch.setattr(built, "UNJAMMED", 0.05)
    other = simulate(given).end.tilt
    assert sum(held) > 100
    assert other == pytest.approx(usual, abs=1e-4)
    assert other == pytest.approx(exact(given).end.tilt, abs=1e-4)


def forgetful_friction(monkeypatch):
    material = built.material
    monkeypatch.setattr(built, "material", lambda friction, *rest: material(0.9, *rest))


def forgetful_mass(monkeypatch):
    solid = built.solid
    monkeypatch.setattr(built, "solid", lambda mass, inertia: solid(0.9 * mass, inertia))


@pytest.mark.parametrize(
    "forgets, words", [(forgetful_friction, "friction is"), (forgetful_mass, "block: mass is 2854.8")]
)
def test_what_drake_does_not_hold_as_asked_is_refused(monkeypatch, forgets, words):
    forgets(monkeypatch)
    response = simulate(scene(0.2, start=Start(tilt=0.1)))
    assert response.outcome == "failed"
    with pytest.raises(Mismatch, match=words):
        built.build(scene(0.2))


def test_warnings_name_what_is_outside():
    assert simulate(scene(0.25, 212.0, 0.5, start=Start(tilt=0.1))).warnings == ()
    (told,) = simulate(scene(0.25, 212.0, 0.1, start=Start(tilt=0.1)), variant="first-script").warnings
    assert "verified in no range" in told
