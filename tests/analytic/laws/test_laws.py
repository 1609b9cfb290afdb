import math

import numpy as np
import pytest
from bearing_laws import F0, NAMES, bearings_of
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from analytic import (
    Base,
    Bearings,
    Block,
    PulseMotion,
    Scene,
    SceneError,
    SettingError,
    Start,
    load_scene,
    simulate,
    simulate_many,
    synthetic_motion,
)
from analytic.advice import bearing_scan
from analytic.advice.bearing_scan import DAMPING_STEP, PERIOD_STEP, first_stroke, scan_bearings
from analytic.checks.twin import simulate_twin
from analytic.rocking import BearingLaw, design_bearings, properties, steady_cycle
from comparisons.execution.results import commit_seed

KA, KB, ALPHA = 6.22e4, 6.22e3, 44.69
PAPER = BearingLaw.of(Bearings(ka=KA, kb=KB, alpha=ALPHA))
BOUC_WEN = BearingLaw.of(Bearings(law="bouc-wen", ka=KA, kb=KB, alpha=ALPHA))
EXTREME = [(KA, KB, 1.5), (KA, KB, 200.0), (1.0001 * KB, KB, ALPHA), (KA, KB, 1.001), (KA, 0.0, 3.0)]


def bearing(ka, kb, alpha):
    return BearingLaw.of(Bearings(ka=ka, kb=kb, alpha=alpha, delta_k=min(1e-20, 1e-6 * (ka - kb))))


def rate(law, z, s):
    """Return dz/dx of the algebraic law in direction s, with the term of D0 in full."""
    c = law.constants
    y = c.d0 + (1 - c.alpha) * (s * z - c.f0) / c.dk
    return c.dk * max(y, 0.0) ** (c.alpha / (c.alpha - 1))


def test_constants_of_table_1b():
    assert 2 * PAPER.constants.x0 == pytest.approx(2.57907793, abs=1e-8)
    assert PAPER.f0 == pytest.approx(640.65003, abs=1e-5)


def test_slopes():
    h = 1e-6  # extrapolated from h and h/2: the law bends within centimetres
    virgin = (4 * PAPER.hysteretic(0.0, h / 2) - PAPER.hysteretic(0.0, h)) / h + KB
    assert virgin == pytest.approx(33769.44, abs=0.01)
    # right after a reversal on the limit curve the stiffness is ka
    limit = PAPER.hysteretic(0.0, 2.0)
    assert (limit - PAPER.hysteretic(limit, -1e-8)) / 1e-8 + KB == pytest.approx(KA, rel=1e-5)


@pytest.mark.parametrize("case", EXTREME)
def test_closed_form_solves_the_rate_form(case):
    law = bearing(*case)
    for share, s in ((0.0, 1), (0.7, -1), (-0.99, 1), (1.0, -1)):
        z0 = share * law.f0
        travel = np.array([1e-4, 0.01, 0.1, 1.0, 2.0])  # beyond 1.33 m
        path = solve_ivp(
            lambda u, z, s=s: [s * rate(law, z[0], s)], (0, 2.0), [z0], "LSODA", travel, rtol=1e-11, atol=1e-11 * law.f0
        )
        closed = [law.hysteretic(z0, s * u) for u in travel]
        np.testing.assert_allclose(closed, path.y[0], rtol=0, atol=1e-8 * law.f0)


def test_bouc_wen_solves_its_rate_and_has_the_same_limits():
    law = BOUC_WEN
    assert (law.f0, law.kb, law.dk) == (PAPER.f0, PAPER.kb, PAPER.dk)
    path = solve_ivp(lambda u, z: [-0.5 * law.dk * (1 + z[0] / law.f0)], (0, 0.1), [law.f0], rtol=1e-11, atol=1e-9)
    assert law.hysteretic(law.f0, -0.1) == pytest.approx(path.y[0, -1], abs=1e-7)


def test_linear_bearing_has_no_memory():
    law = BearingLaw.of(Bearings(law="linear", ka=1e4, count=3, damping=5.0))
    assert law.force(0.1, law.start(0.1), 2.0) == pytest.approx(3 * (1000 + 10))
    assert BearingLaw.of(None).force(0.1, 0.0, 1.0) == 0


BILINEAR = BearingLaw.of(bearings_of("bilinear"))
LAWS = st.sampled_from([PAPER, BOUC_WEN, BILINEAR, *(bearing(*case) for case in EXTREME)])
TRAVELS = st.floats(-3.0, 3.0).filter(lambda u: u == 0 or abs(u) > 1e-12)


@given(LAWS, st.floats(-1.0, 1.0), TRAVELS, st.floats(0.0, 1.0))
@settings(deadline=None, max_examples=200)
def test_a_travel_may_be_cut_anywhere_and_its_force_is_bounded_monotone_odd_and_continuous(law, share, travel, cut):
    z, tiny = share * law.f0, 1e-9 * travel
    after = law.hysteretic(z, travel)
    middle = law.hysteretic(z, cut * travel)
    assert law.hysteretic(middle, travel - cut * travel) == pytest.approx(after, abs=1e-9 * law.f0)
    assert math.isfinite(after) and abs(after) <= law.f0 * (1 + 1e-12)
    assert (after - z) * travel >= -1e-12 * law.f0 * abs(travel)
    assert law.hysteretic(-z, -travel) == -after and law.hysteretic(z, 0.0) == z
    # by no more than the largest stiffness allows
    assert abs(law.hysteretic(z, tiny) - z) <= law.dk * abs(tiny) * (1 + 1e-6) + 1e-9 * law.f0


# The bearings that hold, against single runs at random points.
PULSE = PulseMotion("one-sine", 2.5, 4.8)
SCENE = load_scene("caryatid-isolated")
POINTS = 400


@pytest.fixture
def coarse(monkeypatch):
    """Make scans of few bearings."""
    monkeypatch.setattr(bearing_scan, "PERIOD_STEP", 0.06)
    monkeypatch.setattr(bearing_scan, "DAMPING_STEP", 0.02)


def held(scene, motions, points, stroke, tilt=0.0):
    """Return whether bearings designed anew for each (period, damping) hold under all motions."""
    holds = np.ones(len(points), dtype=bool)
    designs = [design_bearings(scene.total_mass, period, damping, stroke) for period, damping in points]
    for motion in motions:
        outcomes = simulate_many([scene.with_(bearings=bearings, motion=motion, duration=None) for bearings in designs])
        calm = ~outcomes.lifted if tilt == 0 else outcomes.peak_tilt <= tilt * scene.block.slenderness
        holds &= calm & ~outcomes.failed & (outcomes.peak_base_displacement <= stroke)
    return holds


@pytest.mark.long
@pytest.mark.parametrize(("stroke", "tilt", "scale"), [(0.25, 0.0, 1.0), (0.3, 0.2, 1.5)])
def test_the_region_is_that_of_single_runs_but_within_one_per_cent_of_its_edge(stroke, tilt, scale):
    motions = [synthetic_motion().scaled(scale), synthetic_motion(seed=7).scaled(scale)]
    scan = scan_bearings(SCENE, motions, stroke, tilt=tilt)
    random = np.random.default_rng(commit_seed())
    ends = np.log(scan.periods[[0, -1]])
    points = np.column_stack(
        [np.exp(random.uniform(*ends, POINTS)), random.uniform(scan.dampings[0], scan.dampings[-1], POINTS)]
    )
    truth = held(SCENE, motions, points, stroke, tilt)
    assert 0.02 * POINTS < truth.sum() < 0.98 * POINTS
    for (period, damping), holds in zip(points, truth, strict=True):
        if scan.holds(period, damping) != holds:
            about = [
                scan.holds(period * (1 + PERIOD_STEP * i), damping + DAMPING_STEP * k)
                for i in (-1, 0, 1)
                for k in (-1, 0, 1)
            ]
            assert holds in about


@pytest.fixture(scope="module")
def scanned():
    """Return (scan, [(runs done, all runs)] as reported)."""
    progress = []
    scan = scan_bearings(SCENE, [PULSE], 0.3, progress=lambda done, known: progress.append((done, known)))
    return scan, progress


@pytest.mark.parametrize("name", ["least_stroke", "softest"])
def test_the_bearings_named_hold_in_a_run_of_their_own(scanned, name):
    scan, _ = scanned
    point = getattr(scan, name)
    bearings = scan.bearings(*point)
    got = properties(bearings, SCENE.total_mass, 0.3)
    assert (got.period, got.damping_equivalent) == pytest.approx(point, rel=1e-3)
    response = simulate(SCENE.with_(bearings=bearings, motion=PULSE, duration=None), history=False)
    assert response.outcome == "stands"
    assert response.peak_base_displacement <= 0.3


def test_least_stroke_is_the_least_and_softest_the_longest_and_progress_ends_at_the_number_of_runs(scanned):
    scan, progress = scanned
    run = ~np.isnan(scan.stroke) & (scan.demand <= 1)
    row, column = np.unravel_index(np.where(run, scan.stroke, np.inf).argmin(), run.shape)
    assert scan.least_stroke == (scan.periods[column], scan.dampings[row])
    assert scan.softest[0] == scan.periods[run.any(axis=0)].max()
    assert progress[-1][0] == progress[-1][1] and all(done <= known for done, known in progress)


def test_the_mass_of_the_base_does_not_matter_where_the_block_does_not_lift(coarse):
    """Block and base move as one: the same periods and dampings hold; the constants are proportional to the mass."""
    light, heavy = (
        scan_bearings(SCENE.with_(base={"mass": share * SCENE.block.mass}), [PULSE], 0.25) for share in (0.1, 3.0)
    )
    assert ((light.demand <= 1) == (heavy.demand <= 1)).mean() > 0.999  # in rounding
    assert light.least_stroke == heavy.least_stroke and light.softest == heavy.softest
    ratio = heavy.bearings(*heavy.softest).ka / light.bearings(*light.softest).ka
    assert ratio == pytest.approx(4.0 / 1.1, rel=1e-6)


def test_at_the_first_stroke_there_are_bearings_and_at_a_third_of_it_there_are_none(coarse):
    scene, motions = SCENE.with_(block={"slenderness": 0.2}), [PulseMotion("one-sine", 2.0, 4.8)]
    stroke = first_stroke(scene, motions)
    assert (scan_bearings(scene, motions, stroke).demand <= 1).any()
    assert not (scan_bearings(scene, motions, stroke / 3).demand <= 1).any()


def test_there_is_no_first_stroke_where_there_are_no_bearings_at_any(coarse):
    pulse = PulseMotion("one-sine", 10.0, 2.3)
    assert first_stroke(SCENE, [SCENE.motion, pulse]) is None
    for stroke in (0.3, 1.0):
        assert not (scan_bearings(SCENE, [pulse], stroke).demand <= 1).any()


@pytest.mark.parametrize(
    ("scene", "motions", "options", "words"),
    [
        (load_scene("caryatid-rigid"), 1, {}, "base"),
        (SCENE, 0, {}, "no motion"),
        (SCENE, 1, {"stroke": -1.0}, "stroke"),
        (SCENE, 1, {"stroke": math.nan}, "stroke"),
        (SCENE, 1, {"tilt": 2.0}, "tilt"),
        (SCENE, 1, {"periods": (2.0, 1.0)}, "periods"),
        (SCENE, 1, {"count": 0}, "count"),
    ],
)
def test_what_is_out_of_range_is_refused(scene, motions, options, words):
    with pytest.raises((SceneError, SettingError), match=words):
        scan_bearings(scene, [SCENE.motion] * motions, **{"stroke": 0.25, **options})


@pytest.mark.parametrize("friction, tilt", [(0.1, 0.5), (0.6, 0.0)])
def test_with_a_friction_bearings_hold_only_where_the_block_does_not_slide_either(coarse, friction, tilt):
    scene, motions = SCENE.with_(friction=friction), [PULSE.scaled(0.7)]
    scan = scan_bearings(scene, motions, 0.3, tilt=tilt)
    plain = scan_bearings(SCENE, motions, 0.3, tilt=tilt)
    assert ((scan.demand <= 1) <= (plain.demand <= 1)).all()
    assert ((scan.demand <= 1).sum() < (plain.demand <= 1).sum()) == (friction == 0.1)
    for row, column in np.argwhere(~np.isnan(scan.stroke))[::11]:
        bearings = scan.bearings(scan.periods[column], scan.dampings[row])
        response = simulate(scene.with_(bearings=bearings, motion=motions[0], duration=None), history=False)
        slides = response.sliding is not None and response.sliding.path > 0
        assert not (slides and scan.demand[row, column] <= 1 - 1e-3)
        fails = slides or response.outcome != "stands" or response.peak_base_displacement > 0.3
        assert fails or scan.demand[row, column] <= 1


def test_the_first_stroke_is_that_of_bearings_on_which_it_does_not_slide(coarse):
    motions = [PulseMotion("one-sine", 6.0, 6.0)]
    held, rubs = (first_stroke(SCENE.with_(friction=friction), motions) for friction in (None, 0.22))
    assert held < rubs == first_stroke(SCENE.with_(block={"slenderness": math.atan(0.22)}), motions)


@pytest.mark.parametrize("amplitude, holds", [(0.1, True), (80.0, False)])
def test_where_all_hold_or_none_the_second_scan_has_no_runs(coarse, amplitude, holds):
    motion = PulseMotion("one-sine", amplitude, 2.0)
    scan = scan_bearings(SCENE, [motion], 0.2)
    assert ((scan.demand <= 1) == holds).all()
    assert (scan.least_stroke is not None) == (scan.softest is not None) == scan.holds(*scan.nearest) == holds
    assert not scan.holds(99.0, 0.1)
    period, damping = scan.nearest
    scene = SCENE.with_(bearings=scan.bearings(period, damping), motion=motion, duration=None)
    assert (simulate(scene, history=False).outcome == "stands") == holds


# Bearing design: Table 1(a) to Table 1(b) and back, and targets that cannot be met.


MASS = 3172.05 + 212.0
TABLE_1B = Bearings(count=4, ka=6.22e4, kb=6.22e3, alpha=44.69)


def test_table_1b_comes_out_of_table_1a_to_the_printed_digits():
    bearings = design_bearings(MASS, period=2.0, damping=0.30, x_max=0.30, definition="paper")
    assert f"{bearings.ka:.2e} {bearings.kb:.2e} {bearings.alpha:.2f}" == "6.22e+04 6.22e+03 44.69"


def test_table_1a_comes_out_of_table_1b():
    got = properties(TABLE_1B, MASS, 0.30)
    assert got.period == pytest.approx(1.9993, abs=5e-5)
    assert got.period_kb == pytest.approx(2.317, abs=5e-4)
    assert got.damping_paper == pytest.approx(0.300, abs=5e-4)
    assert got.damping_equivalent == pytest.approx(0.150, abs=5e-4)
    assert got.cycle_loss == pytest.approx(708.752, abs=5e-4)
    assert properties(TABLE_1B, MASS, 0.10).cycle_loss == pytest.approx(196.277, abs=5e-4)


@pytest.mark.parametrize("amplitude", [0.02, 0.10, 0.30, 1.0])
def test_cycle_loss_against_quadrature_and_the_closed_form(amplitude):
    law = BearingLaw.of(TABLE_1B)
    loss, force = steady_cycle(law, amplitude)
    z = -(force - law.kb * amplitude)  # the steady cycle is symmetric
    x = np.linspace(-amplitude, amplitude, 20001)
    forces = np.array([law.hysteretic(z, dx) for dx in x - x[0]])
    assert loss == pytest.approx(2 * np.trapezoid(forces, x), rel=1e-6)
    if amplitude >= 0.15:  # all on the limit curves
        limit = 4 * law.f0 * amplitude - 2 * law.dk / ((law.constants.alpha - 1) * (law.constants.alpha - 2))
        assert loss == pytest.approx(limit, rel=1e-9)


@settings(max_examples=60, deadline=None)
@given(st.floats(1.0, 4.0), st.floats(0.05, 0.3), st.floats(0.15, 0.6), st.sampled_from(["paper", "equivalent"]))
def test_every_design_meets_its_targets(period, damping, x_max, definition):
    try:
        bearings = design_bearings(MASS, period, damping, x_max, definition=definition)
    except SettingError as error:
        assert "damping" in str(error) or "x_max" in str(error)
        return
    got = properties(bearings, MASS, x_max)
    assert got.period == pytest.approx(period, rel=1e-3)
    assert (got.damping_paper if definition == "paper" else got.damping_equivalent) == pytest.approx(damping, rel=1e-3)


def test_impossible_damping_says_the_most_there_is():
    with pytest.raises(SettingError, match=r"cannot be met.*the most is 0\.\d+") as error:
        design_bearings(MASS, period=2.0, damping=1.5, x_max=0.30, definition="paper")
    most = float(str(error.value).split("the most is ")[1].split(";")[0])
    bearings = design_bearings(MASS, period=2.0, damping=0.9 * most, x_max=0.30, definition="paper")
    assert bearings.ka > bearings.kb > 0


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    "change",
    [
        {"period": 0.0},
        {"period": math.nan},
        {"damping": -0.1},
        {"x_max": 0.0},
        {"stiffness_ratio": 1.0},
        {"definition": "mine"},
        {"count": 0},
        {"damping": 1e308},
        {"mass": 1.01e20},
        {"period": 1e-21},
        {"x_max": 1e300},
        {"stiffness_ratio": 1e21},
    ],
)
def test_targets_out_of_range(change):
    targets = {"mass": MASS, "period": 2.0, "damping": 0.3, "x_max": 0.3, **change}
    with pytest.raises(SettingError, match=f"^{next(iter(change))} = "):
        design_bearings(**targets)


def test_one_bearing_carries_what_four_do():
    single, four = (design_bearings(MASS, 2.0, 0.15, 0.3, count=count) for count in (1, 4))
    assert (single.count, single.ka, single.kb) == (1, pytest.approx(4 * four.ka), pytest.approx(4 * four.kb))
    assert single.alpha == pytest.approx(four.alpha)


EXTREMES = (1e-308, 1e-20, 1e-4, 0.01, 0.64, 1.3, 30.0, 1e4, 1e20, 1e308)


@pytest.mark.filterwarnings("error")
@settings(max_examples=300, deadline=None)
@given(
    st.tuples(*(st.sampled_from((usual, *EXTREMES)) for usual in (MASS, 2.0, 0.15, 0.3))),
    st.sampled_from((1 + 1e-15, 1.1, 10.0, 1e6, 1e20, 1e308)),
    st.sampled_from(["paper", "equivalent"]),
)
def test_extreme_targets_are_met_or_refused_in_one_message_and_scipy_is_silent(targets, ratio, definition):
    try:
        design_bearings(*targets, stiffness_ratio=ratio, definition=definition)
    except (SettingError, SceneError):
        pass


def test_a_damping_beyond_that_of_any_loop_is_told_the_most_there_is():
    """No loop is wider than its rectangle: W_D = 4 F x is 2/pi of critical."""
    for damping in (2 / math.pi, 1e3, 1e20):
        with pytest.raises(SettingError, match=r"the most is 0\.2466"):
            design_bearings(MASS, 2.0, damping, 0.3)


# What every bearing law keeps, and the bilinear one against its closed forms.


YIELD = F0 / (KA - KB)  # x_y [m]

RULES = [BearingLaw.of(bearings_of(name)) for name in NAMES]
RULES.append(BearingLaw.of(bearings_of("algebraic", alpha=2.0, delta_k=1e-6)))
ANY_LAW = st.sampled_from(RULES)
SIZES = st.floats(1e-6, 1.0).flatmap(lambda size: st.sampled_from([size, -size]))


NODES, WEIGHTS = np.polynomial.legendre.leggauss(40)


@settings(deadline=None, max_examples=50)
@given(ANY_LAW, st.floats(-1, 1), SIZES)
def test_work_is_the_integral_of_the_force(rule, share, dx):
    z, s, cuts = share * rule.f0, math.copysign(1.0, dx), [0.0, *np.geomspace(1e-4, 1, 40)]
    corner = rule.unit.begin.py_func(s, z, 1.0, 0.0, rule.constants)[2]  # where the force bends
    if corner < math.inf:
        cuts = sorted([*cuts, min((corner - s * z) / rule.dk / abs(dx), 1.0)])
    integral = sum(
        0.5 * (b - a) * dx * weight * rule.hysteretic(z, dx * (0.5 * (a + b) + 0.5 * (b - a) * node))
        for a, b in zip(cuts[:-1], cuts[1:], strict=True)
        for node, weight in zip(NODES, WEIGHTS, strict=True)
    )
    assert rule.work(z, dx) == pytest.approx(integral, rel=2e-5, abs=1e-7 * F0 * abs(dx))


@pytest.mark.parametrize("name", NAMES)
def test_a_start_in_mid_path_is_continued_as_the_law_says(name):
    """`begin`, `term` and `reached` of the kernel's step agree with `after_travel` on a base that is released."""
    scene = contact(law=name, start=Start(base_displacement=0.5 * YIELD, base_velocity=0.2), duration=0.02)
    end, rule = simulate(scene).end, BearingLaw.of(scene.bearings)
    z = rule.hysteretic(0.0, end.base_displacement)  # still on its way out
    assert end.base_velocity > 0
    assert end.bearing_force == pytest.approx(rule.force(end.base_displacement, z), rel=1e-13)


# The bilinear law.

HEAVY = Block(mass=3172.05, radius=1.0884, slenderness=1.2)  # never lifts here


def contact(law="bilinear", start=None, duration=3.0, motion=None, **keys):
    return Scene(
        block=HEAVY,
        base=Base(mass=212.0),
        bearings=bearings_of(law, count=4, **keys),
        duration=duration,
        motion=motion,
        start=start or Start(),
    )


RELEASED = contact(start=Start(base_velocity=0.9), duration=1.2)


def swing(stiffness, mass, centre, x, v):
    """Return frequency, amplitude, phase and motion (x, v) of mass x'' = -stiffness (x - centre)."""
    w = math.sqrt(stiffness / mass)
    amplitude, angle = math.hypot(x - centre, v / w), math.atan2(-v / w, x - centre)
    return (
        w,
        amplitude,
        lambda t: (centre + amplitude * math.cos(w * t + angle), -amplitude * w * math.sin(w * t + angle)),
    )


def exact_free_vibration(scene):
    """Return (x, v) in closed form from x = 0 on the virgin bearing: to yield, to the turn, to yield again, and on."""
    n, mass, v = scene.bearings.count, scene.total_mass, scene.start.base_velocity
    w, amplitude, elastic = swing(n * KA, mass, 0.0, 0.0, v)
    first = math.asin(YIELD / amplitude) / w
    w, amplitude, _ = swing(n * KB, mass, -F0 / KB, *elastic(first))
    turn = math.acos((YIELD + F0 / KB) / amplitude) / w
    far = amplitude - F0 / KB
    w, amplitude, back = swing(n * KA, mass, far - (KB * far + F0) / KA, far, 0.0)
    second = math.acos(1 - 2 * YIELD / amplitude) / w
    left = scene.duration - first - turn - second
    w, _, plastic = swing(n * KB, mass, F0 / KB, *back(second))
    assert 0 < left and plastic(left)[1] < 0  # before it turns again
    return plastic(left)


def test_free_vibration_after_yield_is_the_piecewise_exact_one():
    x, v = exact_free_vibration(RELEASED)
    end = simulate(RELEASED, tolerance=1e-16).end
    assert end.base_displacement == pytest.approx(x, abs=1e-13)
    assert end.base_velocity == pytest.approx(v, abs=1e-12)
    twin = simulate_twin(RELEASED, rtol=1e-12, atol=1e-14).end
    assert (twin.base_displacement, twin.base_velocity) == pytest.approx((x, v), abs=1e-11)


def test_loss_of_a_cycle_and_equivalent_stiffness_are_those_of_the_codes():
    bearings, X = bearings_of("bilinear", count=4), 0.2
    loss, force = steady_cycle(BearingLaw.of(bearings), X)
    assert force == pytest.approx(KB * X + F0, rel=1e-14)
    assert loss == pytest.approx(4 * F0 * (X - YIELD), rel=1e-13)
    assert steady_cycle(BearingLaw.of(bearings), 0.9 * YIELD)[0] == pytest.approx(0.0, abs=1e-12 * F0)  # elastic
    got = properties(bearings, 3384.05, X)
    assert got.secant_stiffness == pytest.approx(KB + F0 / X, rel=1e-14)
    assert got.damping_equivalent == pytest.approx(2 * F0 * (X - YIELD) / (math.pi * (KB + F0 / X) * X**2), rel=1e-13)


@pytest.mark.parametrize("steps", [24, 18, 12, 8])
def test_corners_keep_the_order_of_the_series(steps):
    """The error falls with the tolerance as if there were no corner."""
    end = simulate(RELEASED, tolerance=10.0 ** -(steps / 2)).end
    error = abs(end.base_displacement - exact_free_vibration(RELEASED)[0])
    assert error < max(1e2 * 10.0 ** -(steps / 2), 1e-14)
