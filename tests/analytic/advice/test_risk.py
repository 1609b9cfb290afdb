"""Odds against closed forms: where the boundary in one value is known, the probability is that of its distribution."""

import math

import numpy as np
import pytest
from roads import KINDS
from scipy.stats import norm, truncnorm

from analytic import Base, Bearings, Block, PulseMotion, Scene, SceneError, SettingError, Start, load_scene
from analytic.advice.risk import SPREADS, _drawn, _factor, risk, spreads_of

G, GAMMA, DRAWS = 9.81, 0.25, 3000
BLOCK = Block(mass=400.0, radius=1.0, slenderness=GAMMA)
COV = 0.1
SIGMA = math.sqrt(math.log1p(COV**2))  # of the logarithm


def constant(acceleration, seconds=60.0):
    """A constant ground acceleration that outlasts all that happens."""
    return PulseMotion("rectangular", acceleration, math.pi / seconds)


def below(limit, value):
    """Probability that a quantity, lognormal about `value`, lies below the limit."""
    return norm.cdf(math.log(limit / value) / SIGMA)


def only(name, scene, motion, **options):
    """The odds with only one quantity drawn."""
    spreads = {**dict.fromkeys(spreads_of(scene), 0.0), name: COV}
    return risk(scene, [[motion]], draws=DRAWS, spreads=spreads, **options)


# {limit state: (scene, quantity drawn, acceleration, value at which the state is reached: it is for all lower ones)}
LEVEL = 0.95 * G * math.tan(GAMMA)
GROUND = Scene(block=BLOCK)
STOCKY = Block(mass=400.0, radius=1.0, slenderness=1.2)
MASS, STIFFNESS = 600.0, 2000.0
ON_SPRINGS = Scene(
    block=STOCKY, base=Base(mass=200.0), bearings=Bearings(law="linear", count=4, ka=STIFFNESS, x_max=0.15)
)
PUSH = 0.94 * 4 * STIFFNESS * 0.15 / (2 * MASS)
CLOSED = {
    "lifts": (GROUND, "slenderness", LEVEL, math.atan(LEVEL / G)),  # a = g tan(gamma)
    "overturns": (GROUND, "slenderness", LEVEL, math.atan(LEVEL / G)),  # and then nothing brings it back
    "slides": (Scene(block=STOCKY, friction=0.3), "friction", 0.32 * G, 0.32),  # a = mu g
    "stroke": (ON_SPRINGS, "ka", PUSH, 2 * MASS * PUSH / 4 / 0.15),  # a step moves a spring by twice F/k
}


@pytest.mark.parametrize("state", CLOSED)
def test_the_odds_are_the_closed_form(state):
    scene, name, acceleration, limit = CLOSED[state]
    result = only(name, scene, constant(acceleration))
    values = {"slenderness": GAMMA, "friction": 0.3, "ka": STIFFNESS}
    wanted = below(limit, values[name])
    assert 0.2 < wanted < 0.8
    drawn = values[name] * np.exp(SIGMA * result.scores[0, :, 0])
    assert ((drawn < limit) == (result.reached[state][0] == 1)).all()
    (share,) = result.by_record(state)
    error = math.sqrt(wanted * (1 - wanted) / DRAWS)
    assert abs(share - wanted) < 3 * error and result.runs.sum() == DRAWS
    change, noise = result.effects(state)[name]
    assert change == pytest.approx(-norm.pdf(norm.ppf(wanted)), abs=4 / math.sqrt(DRAWS))  # E[z 1(z < c)]
    assert 0 < noise < 0.1


def test_what_does_not_matter_is_within_the_noise():
    result = risk(GROUND, [[constant(LEVEL)]], draws=DRAWS)
    (slenderness, its_noise), (restitution, noise) = result.effects("lifts").values()
    assert abs(slenderness) > 10 * its_noise / 3 and abs(restitution) < noise


def test_the_odds_converge_with_the_root_of_the_draws():
    """The boundary in slenderness is known, and so is the scatter of the estimate from seed to seed."""
    spreads = {"slenderness": COV, "restitution": 0.0}
    wanted, seeds = below(math.atan(LEVEL / G), GAMMA), range(40)
    for draws in (25, 225):
        shares = [
            risk(GROUND, [[constant(LEVEL)]], draws=draws, spreads=spreads, seed=seed).by_record("lifts")[0]
            for seed in seeds
        ]
        error = math.sqrt(wanted * (1 - wanted) / draws)
        assert 0.75 < np.std(shares) / error < 1.25 and abs(np.mean(shares) - wanted) < 3 * error / math.sqrt(40)


def test_the_reversed_motion_has_the_same_odds():
    scene, motions = load_scene("caryatid-isolated"), [PulseMotion("one-sine", 7.0, f) for f in (5.0, 6.0, 7.0)]
    left, right = (
        risk(scene, [[motion.scaled(sign)] for motion in motions], draws=40, spreads={"slenderness": 0.1})
        for sign in (1, -1)
    )
    assert 0 < left.by_record("lifts").mean() < 1 or 0 < left.by_record("overturns").mean() < 1
    for state in left.reached:
        np.testing.assert_array_equal(left.reached[state], right.reached[state])


def test_equal_seeds_give_equal_draws_on_any_number_of_threads():
    scene = load_scene("caryatid-isolated")
    records = [[PulseMotion("one-sine", 7.0, frequency)] for frequency in (5.0, 6.0, 7.0)]
    first, again = (risk(scene, records, draws=20, seed=3, workers=workers) for workers in (1, 3))
    np.testing.assert_array_equal(first.scores, again.scores)
    assert all((first.reached[state] == again.reached[state]).all() for state in first.reached)
    fewer = risk(scene, records[:2], draws=20, seed=3, spreads={"slenderness": 0})
    np.testing.assert_array_equal(fewer.scores, first.scores[:2, :, 1:])
    other = risk(scene, records, draws=20, seed=4)
    assert not (other.scores == first.scores).any() and len(np.unique(first.scores)) == first.scores.size


def test_the_scale_and_the_motions_of_a_record():
    """Half of the motions of a record lift the block; with the scale, all of them do."""
    weak, strong = constant(0.5 * LEVEL), constant(2 * LEVEL)
    one, two = (risk(GROUND, [[weak, strong], [weak, weak]], draws=5, scale=scale) for scale in (1.0, 4.0))
    assert one.by_record("lifts").tolist() == [0.5, 0.0] and two.by_record("lifts").tolist() == [1.0, 1.0]
    assert (one.runs == 2).all() and one.why == ""


@pytest.mark.parametrize("value, size", [(0.9, 0.05), (0.98, 0.03), (0.4, 0.5), (1.0, 0.1)])
def test_the_restitution_is_a_normal_distribution_cut_at_0_and_1(value, size):
    scores = norm.ppf((np.arange(1000) + 0.5) / 1000)
    drawn = np.array([value * _factor("restitution", value, size, score) for score in scores])
    wanted = truncnorm.ppf(norm.cdf(scores), -1 / size, (1 / value - 1) / size, loc=value, scale=size * value)
    np.testing.assert_allclose(drawn, wanted, rtol=1e-6)
    assert (drawn >= 0).all() and (drawn <= 1).all()


def test_the_restitution_of_the_law_of_impact_follows_the_drawn_slenderness():
    """That of a rectangle is 1 - 3/2 sin^2(gamma); at 0.955 rad none is left to draw."""
    stocky = Scene(block=Block(mass=1.0, radius=1.0, slenderness=0.9), start=Start(tilt=0.4))
    sizes = spreads_of(stocky, {"slenderness": 0.1})
    result = risk(stocky, [[None]], draws=40, spreads=sizes)
    drawn, refusal = _drawn(stocky, sizes, result.scores[0])
    assert list(sizes) == ["slenderness", "restitution"] and refusal == "" and len(drawn) == 40 == result.runs.sum()
    left = 0
    for (_, score), scene in zip(result.scores[0], drawn.values(), strict=True):
        kept = 1 - 1.5 * math.sin(scene.block.slenderness) ** 2
        if kept > 0:
            left += 1
            wanted = kept * _factor("restitution", kept, 0.03, score)
            assert scene.block.restitution == pytest.approx(wanted, rel=1e-9)
        else:
            assert scene.block.restitution is None
    assert 20 < left < 40


def test_runs_that_fail_count_neither_way(tmp_path):
    (tmp_path / "near.toml").write_text(KINDS["free-standing it is refused"][0])
    scene = load_scene(tmp_path / "near.toml")
    result = risk(scene, [[None]], draws=60, spreads={"friction": 0.3})
    lost = int((result.runs == 0).sum())
    assert 5 < lost < 55 and "friction" in result.why
    assert (result.reached["lifts"][result.runs == 0] == 0).all()
    assert result.by_record("lifts")[0] == result.reached["lifts"].sum() / (60 - lost)


def test_a_scene_of_which_no_draw_can_be_run_is_refused():
    scene = Scene(block=BLOCK, friction=0.02, start=Start(tilt=0.2))
    with pytest.raises(SceneError, match=r"friction = 0.02"):
        risk(scene, [[None]], draws=3)


@pytest.mark.parametrize(
    "spreads, draws, message",
    [
        ({"mass": 0.1}, 2, r"mass=0.1: nothing that is drawn for this scene; choose slenderness, restitution"),
        ({"friction": 0.1}, 2, r"friction=0.1: nothing that is drawn"),
        ({"slenderness": 0.6}, 2, r"slenderness=0.6: give a coefficient of variation from 0 to 0.5"),
        ({"slenderness": math.nan}, 2, "give a coefficient of variation"),
        ({"slenderness": "much"}, 2, "slenderness=much: give a coefficient of variation"),
        ({}, 1, "draws = 1: give at least 2"),
        ({}, 10**7, "at most 1000000 runs"),
    ],
)
def test_what_cannot_be_drawn_is_refused(spreads, draws, message):
    with pytest.raises(SettingError, match=message):
        risk(GROUND, [[constant(1.0)]], draws=draws, spreads=spreads)


def test_each_spread_has_a_source():
    assert all(spread.source and 0 < spread.size < 0.5 for spread in SPREADS.values())
