"""Every row of the tolerance table: the engine is run and held to it.

A row can fail: a deliberate change of impact law, bearing law or step makes rows fail.
"""

import functools
import math
import pickle

import pytest
from engine_cases import ACCURATE

from analytic import simulate
from analytic.rocking import BearingLaw, base_jump_length_as_printed, restitution
from comparisons.metrics import agreement
from comparisons.metrics import errors as errors_of
from comparisons.metrics.agreement import TABLE
from engines import ENGINES, get_engine

RUNS, KEPT = {}, {}  # what rows of one variant share; these rows stay on one worker


@pytest.fixture
def shared(monkeypatch):
    """A scene is run once for all rows of a variant."""
    traced = agreement.traced

    def once(engine, variant, scene, history=True):
        key = engine, variant, pickle.dumps(scene)
        if key not in KEPT:
            KEPT[key] = traced(engine, variant, scene)
        return KEPT[key]

    monkeypatch.setattr(agreement, "traced", once)


# Of other engines by hand, or `rocking verify`: what is dear, and on rigid ground what the rows of a sliding base hold.
DEAR = ("overturning boundary", "synthetic motion", "60 s of shaking", "aware, rigid", "script, rigid", "step, rigid")
# Rows whose scenes differ in numbers or in the ground alone from those of another one.
AGAIN = ("2 and 5 times omega_r", "60 s of shaking below uplift, rigid ground")


def marks(row):
    """Main variants of exudyn and PyBullet first; other variants and engines in the second command."""
    long = not ENGINES[row.engine].subject and any(words in row.name for words in DEAR)
    slow = ACCURATE.get(row.engine) != row.variant or any(words in row.name for words in AGAIN)
    sets = [pytest.mark.long] * long or [pytest.mark.slow] * slow
    return [pytest.mark.xdist_group(f"{row.engine} {row.variant}"), *sets]


@pytest.mark.parametrize("row", [pytest.param(row, id=row.name, marks=marks(row)) for row in TABLE])
def test_row_of_the_tolerance_table(row, shared):
    value = row.check(RUNS)
    # Much better than when the bound was set: then the bound says nothing any more.
    assert row.round_off or value >= row.measured / 4, f"{row.name}: {value:.3g}; tighten the table"


def row(quantity, engine, variant, scenes):
    (match,) = [
        candidate
        for candidate in TABLE
        if (candidate.quantity, candidate.engine, candidate.variant, candidate.scenes)
        == (quantity, engine, variant, scenes)
    ]
    return match


def assert_caught(rows):
    """Every row is out of its bound, by a number: a run that broke off is not what is meant."""
    for tested in rows:
        value = tested.found()
        assert math.isfinite(value), f"{tested.name}: {value}"
        assert not tested.holds(value), f"{tested.name}: the mutation is not seen, {value:.3g} {tested.unit}"


def run_otherwise(monkeypatch, change=lambda scene: scene, **settings):
    """Every run of an engine is of another scene, or has other settings."""

    def traced(engine, variant, scene, history=True):
        return get_engine(engine).traced(change(scene), variant=variant, history=history, **settings)

    monkeypatch.setattr(agreement, "traced", traced)


# Impact law. What an engine does at an impact is its own: the model it is held against is changed instead.


# The measures are the same for every engine.
DEFAULT = "pybullet", "impact-aware"


def test_another_restitution_fails(monkeypatch):
    monkeypatch.setattr(agreement, "FREE_ROCKING", {"sliding base": (agreement.BASE, (0.2,))})
    monkeypatch.setattr(errors_of, "restitution", lambda scene: 1.0005 * restitution(scene))
    assert_caught([row("restitution, rms", *DEFAULT, "sliding base")])


@pytest.mark.slow
def test_another_restitution_in_the_model_shifts_times_peaks_and_boundary(monkeypatch):
    def other(scene, **given):
        e = restitution(scene) * 1.01
        return simulate(scene.with_(block={"restitution": e}), **given)

    monkeypatch.setattr(agreement, "simulate", other)
    monkeypatch.setitem(agreement.BOUNDARIES, agreement.PULSES, (0.25, (("one-sine", 5.0),)))
    monkeypatch.setattr(agreement, "FREE_ROCKING", {"rigid ground": (None, (0.2,))})
    driven = "rocking on bearings, one-sine"
    assert_caught(
        [
            row("impact times", *DEFAULT, "rigid ground"),
            row("peak tilt", *DEFAULT, driven),
            row("tilt graph", *DEFAULT, driven),
            row("overturning boundary", *DEFAULT, "one-sine at 2 and 5 times omega_r, rigid ground"),
        ]
    )


def test_eq_8_as_printed_fails(monkeypatch):
    def against_printed(scene, response):
        return [
            impact.base_velocity_jump / (-base_jump_length_as_printed(scene) * impact.rate_before) - 1
            for impact in response.impacts
        ]

    monkeypatch.setattr(agreement, "FREE_ROCKING", {"sliding base": (agreement.BASE, (0.2,))})
    monkeypatch.setattr(errors_of, "base_jump_error", against_printed)
    assert_caught([row("base velocity jump, rms", *DEFAULT, "sliding base")])


# Bearing law.


@pytest.mark.slow
def test_another_alpha_in_the_engine_fails(monkeypatch):
    """The engine is given alpha 1 % larger than the law that its force is held against."""
    run_otherwise(monkeypatch, lambda scene: scene.with_(bearings={"alpha": 1.01 * scene.bearings.alpha}))
    isolated = "isolated Caryatid, synthetic motion"
    assert_caught([row("bearing force replayed", *DEFAULT, isolated), row("peak displacement", *DEFAULT, isolated)])


@pytest.mark.slow
def test_eq_12_as_printed_fails(monkeypatch):
    """Unloading with the printed sign of x: the force jumps at a reversal."""

    monkeypatch.setattr(agreement, "branch", functools.partial(agreement.branch, misprinted=True))
    assert_caught([row("bearing force replayed", *DEFAULT, "isolated Caryatid, synthetic motion")])


class Lagging(BearingLaw):
    """Answers one step late."""

    @functools.cached_property
    def hysteretic(self):
        law, before = super().hysteretic, []

        def lagging(z, *rest):
            before.append(law(z, *rest))
            return before[-2] if len(before) > 1 else z

        return lagging


@pytest.mark.slow
def test_a_bearing_force_that_lags_one_step_fails(monkeypatch):
    tested = row("bearing force replayed", *DEFAULT, "isolated Caryatid, synthetic motion")
    monkeypatch.setattr("engines.loop.BearingLaw", Lagging)
    with pytest.raises(agreement.Unmeasurable, match="does not match the bearing force"):  # the run itself says so
        tested.found()


# Step size, and what stands for it in an adaptive engine.


LARGE, STEP = {"largest_step": 5e-3}, {"step": 1e-3}


@pytest.mark.slow
@pytest.mark.parametrize(
    "engine, variant, changes, quantity, scenes",
    [
        ("exudyn", "compliant-corners", {"stiffness": 2e10}, "restitution, rms", "rigid ground"),
        (*DEFAULT, LARGE, "overturning time", "one-sine of 3.8 g slenderness, rigid ground"),
        ("pybullet", "fixed-step", STEP, "restitution, rms", "sliding base, slenderness 0.2"),
    ],
)
def test_a_coarse_step_fails(monkeypatch, engine, variant, changes, quantity, scenes):
    run_otherwise(monkeypatch, **changes)
    assert_caught([row(quantity, engine, variant, scenes)])
