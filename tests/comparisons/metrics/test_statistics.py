"""Statistics against published examples, exact enumeration and simulation."""

import math

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.stats import chi2, norm

from analytic.response import EDGE
from comparisons.metrics.statistics import (
    CLASSES,
    DRAWS,
    Confusion,
    Fragility,
    bent,
    brier,
    class_of,
    clustered,
    cohen_kappa,
    compare_outcomes,
    confusion,
    detectable_difference,
    draws,
    equality,
    fit_fragility,
    folds,
    goodness,
    halves,
    held_out,
    holm,
    interval,
    logistic,
    mcnemar,
    middle,
    points,
    resampled,
    right,
    threshold,
    wilson,
    wilson_by_group,
)
from comparisons.studies.fragility.study import State, effects
from engines.comparison import END


@pytest.mark.parametrize(
    "count, size, low, high",
    [(81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 20, 0.0, 0.1611), (1, 29, 0.0061, 0.1718)],
)
def test_wilson_intervals_of_newcombe_1998(count, size, low, high):
    # Newcombe (1998), Statistics in Medicine 17, Table I, method 3
    assert wilson(count, size) == pytest.approx((low, high), abs=5e-5)


def test_exact_mcnemar():
    # Fagerland, Lydersen and Laake (2013), BMC Med Res Methodol 13:91: airway responsiveness, 1 and 7 discordant
    assert mcnemar(Confusion(12, 1, 1, 7)) == pytest.approx(0.0703, abs=5e-5)
    assert mcnemar(Confusion(0, 0, 6, 16)) == pytest.approx(2 * sum(math.comb(22, k) for k in range(7)) / 2**22)
    assert mcnemar(Confusion(50, 50, 0, 0)) == 1.0
    assert mcnemar(Confusion(0, 0, 5, 0)) == 2 / 2**5 and mcnemar(Confusion(9, 9, 3, 3)) == 1.0


def test_cohen_kappa_of_fleiss_cohen_everitt():
    # Fleiss, Cohen and Everitt (1969): two raters, three diagnoses, 200 patients: kappa 0.429, its standard
    # error 0.0538 (Fleiss, Statistical Methods for Rates and Proportions, 2nd ed., section 13.1)
    table = 200 * np.array([[0.53, 0.05, 0.02], [0.11, 0.14, 0.05], [0.01, 0.06, 0.03]])
    kappa, low, high = cohen_kappa(table)
    assert kappa == pytest.approx(0.429, abs=5e-4)
    assert (high - low) / (2 * 1.959964) == pytest.approx(0.0538, abs=2e-4)


def test_cohen_kappa_without_disagreement_and_without_variety():
    kappa, low, high = cohen_kappa([[10, 0], [0, 10]])
    assert kappa == high == 1.0 and 0.5 < low < 0.9  # 20 agreements prove no perfect agreement
    assert cohen_kappa([[1000, 0], [0, 1000]])[1] > low
    assert cohen_kappa([[20, 0], [0, 0]]) == (None, None, None)


def test_confusion_counts_and_refuses_what_is_not_paired():
    a, b = np.array([[True, True, True, False, False], [True, False, False, True, False]])
    table = confusion(a, b)
    assert table == Confusion(both_stand=1, both_overturn=1, only_a=2, only_b=1) and table.size == 5
    assert table.table().tolist() == [[1, 1], [2, 1]]
    for wrong in ((a[:-1], b), (a.astype(float), b), (a[:0], b[:0])):
        with pytest.raises(ValueError, match="leave failed runs out in pairs"):
            confusion(*wrong)


@pytest.mark.parametrize("size, discordance", [(50, 0.2), (200, 0.05), (200, 0.0)])
def test_a_detectable_difference_is_detected_as_often_as_it_says(size, discordance):
    difference = detectable_difference(size, discordance)
    rate = max(discordance, difference)
    random = np.random.default_rng(2)
    draws = random.multinomial(size, [(rate + difference) / 2, max(rate - difference, 0) / 2, 1 - rate], 4000)
    kinds, counts = np.unique(draws, axis=0, return_counts=True)
    seen = [mcnemar(Confusion(int(rest), 0, int(only_a), int(only_b))) <= 0.05 for only_a, only_b, rest in kinds]
    assert np.average(seen, weights=counts) == pytest.approx(0.8, abs=0.02)  # 3 standard errors of 4000 draws


def test_five_pairs_can_show_no_difference_and_more_pairs_show_smaller_ones():
    assert detectable_difference(5, 0.0) is None  # 5 of 5 on one side: p = 0.0625
    assert detectable_difference(6, 0.0) is not None
    least = [detectable_difference(size, 0.02) for size in (50, 100, 200, 1200)]
    assert least == sorted(least, reverse=True)


def test_holm_adjusts_step_by_step():
    # Holm (1979): smallest times n, next times n - 1, never falling, never above 1
    assert holm([0.01, 0.04, 0.03, 0.005]) == pytest.approx([0.03, 0.06, 0.06, 0.02])
    assert holm([[0.9, 0.8]]).tolist() == [[1.0, 1.0]]


def test_a_comparison_is_of_paired_outcomes():
    motion = np.arange(200)
    result = compare_outcomes(motion < 80, (motion < 80) & (motion >= 2))
    assert (result["only_a"], result["only_b"], result["both_overturn"], result["both_stand"]) == (2, 0, 78, 120)
    assert result["difference"] == -0.01 and result["p_value"] == 0.5
    assert result["detectable_difference"] == detectable_difference(200, 0.01)


@pytest.mark.parametrize("groups, size", [(6, 50), (20, 50), (100, 40)])
@pytest.mark.parametrize("probability", [0.02, 0.1, 0.5])
def test_an_interval_by_group_covers_whatever_the_groups_have_in_common(groups, size, probability):
    """Beta-binomial groups, from almost independent runs to groups of one outcome. Chance takes 3 % of 400 at most."""
    rng = np.random.default_rng(1)
    for common in (0.01, 0.05, 0.2, 0.6, 0.95):
        spread = (1 - common) / common
        true = rng.beta(probability * spread, (1 - probability) * spread, (400, groups))
        intervals = np.array([wilson_by_group(each, size) for each in rng.binomial(size, true) / size])
        covered = ((intervals[:, 0] <= probability) & (probability <= intervals[:, 1])).mean()
        assert covered >= 0.9 and (intervals >= 0).all() and (intervals <= 1).all()
        if common == 0.01 and probability == 0.5:  # hardly anything in common: almost as narrow as of all runs
            assert np.diff(intervals).mean() < 2 * np.diff(wilson(groups * size / 2, groups * size)) * (
                2 if groups == 6 else 1
            )


def test_an_interval_by_group_of_equal_outcomes_counts_groups():
    assert wilson_by_group([0.0] * 100, 40)[0] == 0 and 0.035 < wilson_by_group([0.0] * 100, 40)[1] < 0.04
    assert wilson_by_group([1.0] * 100, 40)[1] == 1 and wilson_by_group([1.0], 40)[0] < 0.02
    low, high = wilson_by_group([0.0, 1.0], 40)
    assert low < 0.02 and high > 0.98
    draws = np.arange(400) < 100
    assert wilson_by_group(draws, 1) == pytest.approx(wilson(100, 400), abs=5e-4)  # of one group, its runs


def test_wilson_takes_sizes_that_are_not_whole():
    assert wilson(1.5, 50.5) == pytest.approx(np.mean([wilson(1, 50), wilson(2, 51)], axis=0), abs=1e-3)
    assert wilson(0, 100) == pytest.approx((0.0, 1.959964**2 / (100 + 1.959964**2))) and wilson(7, 7)[1] == 1.0


def test_runs_of_one_record_count_as_one():
    """However many they are: 0 of 187 runs under 50 records say no more than 0 of 50."""
    records = [k % 50 for k in range(187)]
    word, (low, high) = equality(np.zeros(187, dtype=bool), records)
    assert word == "inconclusive (too few runs)" and low == 0.0
    assert high == pytest.approx(1.959964**2 / (50 + 1.959964**2)) == pytest.approx(0.0713, abs=1e-4)
    differs = np.arange(187) == 3
    assert equality(differs, records)[1] == wilson(50 / 187, 50)  # the share of runs, known as well as that of 50
    assert equality(differs, records)[1][1] > high  # a run that differs never makes it surer
    assert equality(differs, range(187)) == equality(differs)
    assert equality([True] * 40 + [False] * 147, records)[0] == "no"


FEW = "inconclusive (too few runs)"


@pytest.mark.parametrize(
    "differ, size, word",
    # an upper limit below 5 % is equal: 0 of 72 leave 5.07 %, 4 of 200 5.03 %; few runs acquit nobody and can convict
    [(0, 100, "yes"), (0, 73, "yes"), (0, 72, FEW), (3, 200, "yes"), (4, 200, "no"), (1, 40, FEW), (20, 40, "no")],
)
def test_equal_means_that_the_upper_limit_is_below_five_per_cent(differ, size, word):
    result, limits = equality(np.arange(size) < differ)
    assert result == word and limits == wilson(differ, size)


# The class of a run: by what counts, and left out by the model's word alone.


@pytest.mark.parametrize(
    "comparable, quantities, counted, word",
    [
        ("yes", [], None, "right"),
        ("yes", ["peak_tilt"], None, "differs"),
        ("yes", ["peak_tilt"], END, "right"),
        ("yes", ["peak_tilt", "fall_time"], END, "differs"),  # it falls in both, at another time
        ("yes", ["impacts_before_fall"], END, "differs"),
        ("yes", None, END, "failed"),
        (EDGE, None, None, "left out"),
        (EDGE, ["outcome"], None, "left out"),
        ("the normal force falls to 0 in the analytic model", [], None, "left out"),
    ],
)
def test_one_word_for_each_run(comparable, quantities, counted, word):
    assert class_of(comparable, quantities, counted) == word and word in CLASSES


# Fragility against a published example, closed forms and simulation.


# Bliss (1935), beetles killed by carbon disulphide; probit by maximum likelihood:
# intercept -34.935 (s.e. 2.648), slope 19.728 (s.e. 1.487) per log10 dose (Dobson; Agresti)
DOSE = np.array([1.6907, 1.7242, 1.7552, 1.7842, 1.8113, 1.8369, 1.8610, 1.8839])
SIZE = np.array([59, 60, 62, 56, 63, 59, 62, 60])
KILLED = np.array([6, 13, 18, 28, 52, 53, 61, 60])


def test_fragility_of_bliss_1935():
    fit = fit_fragility(np.exp(DOSE), KILLED, SIZE)
    assert 1 / fit.dispersion == pytest.approx(19.728, abs=1e-3)
    assert math.log(fit.median) / fit.dispersion == pytest.approx(34.935, abs=2e-3)


def test_bootstrap_has_the_published_standard_errors_of_bliss():
    # every beetle is a run: as many as died, and as survived, at each dose
    dose = np.repeat(np.exp(DOSE), SIZE)
    killed = np.concatenate([np.arange(size) < dead for dead, size in zip(KILLED, SIZE, strict=True)])
    medians, dispersions = resampled(dose, killed, draws(400, len(dose), seed=1))
    assert (draws(400, len(dose), seed=1).sum(axis=1) == len(dose)).all()
    assert np.std(1 / dispersions) == pytest.approx(1.487, rel=0.12)
    # of the median by the delta method, from the expected information
    p = norm.cdf(-34.935 + 19.728 * DOSE)
    weight = SIZE * norm.pdf(-34.935 + 19.728 * DOSE) ** 2 / (p * (1 - p))
    design = np.column_stack([np.ones(8), DOSE])
    gradient = np.array([-1, -34.935 / 19.728]) / 19.728
    variance = gradient @ np.linalg.inv(design.T @ (design * weight[:, None])) @ gradient
    assert np.std(np.log(medians)) == pytest.approx(math.sqrt(variance), rel=0.12)
    low, high = interval(math.exp(34.935 / 19.728), medians)
    assert math.log(high / low) == pytest.approx(2 * 1.96 * math.sqrt(variance), rel=0.12)


def test_fragility_does_not_depend_on_the_unit_of_intensity():
    plain, scaled = (fit_fragility(unit * np.array([1, 2, 4]), [2, 9, 17], [20, 20, 20]) for unit in (1.0, 9.81))
    assert (scaled.median, scaled.dispersion) == pytest.approx((9.81 * plain.median, plain.dispersion), rel=1e-6)


@pytest.mark.parametrize(
    "overturned, message",
    [
        ([0, 0, 20], "do not overlap"),
        ([0, 7, 20], "do not overlap"),
        ([0, 0, 0], "do not overlap"),
        ([20, 20, 20], "do not overlap"),
        ([15, 10, 5], "does not become likelier"),
    ],
)
def test_counts_that_determine_no_curve_are_an_error(overturned, message):
    with pytest.raises(ValueError, match=message):
        fit_fragility([1.0, 2.0, 3.0], overturned, [20, 20, 20])


def cloud(count, dispersion, seed, median=0.6):
    """Independent runs: (intensities evenly over the logarithm, whether each exceeds a lognormal capacity)."""
    random = np.random.Generator(np.random.PCG64(seed))
    intensity = 0.06 * 100 ** random.random(count)
    return intensity, intensity > median * np.exp(dispersion * random.standard_normal(count))


def test_intervals_cover_a_known_curve_as_often_as_they_say():
    covered = []
    for seed in range(60):
        runs = cloud(200, 0.4, seed)
        curve, samples = fit_fragility(*runs), resampled(*runs, draws(40, 200, seed))
        limits = map(interval, (curve.median, curve.dispersion), samples)
        covered.append([low <= truth <= high for (low, high), truth in zip(limits, (0.6, 0.4), strict=True)])
    assert np.mean(covered) == pytest.approx(0.95, abs=0.06)  # 3 standard errors of 120 intervals


def test_the_test_of_fit_rejects_a_true_curve_as_often_as_it_says_and_a_wrong_one_always():
    clouds = [cloud(400, 0.6, seed) for seed in range(300)]
    p_values = [goodness(*each, fit_fragility(*each)) for each in clouds]
    assert np.mean(np.array(p_values) < 0.1) == pytest.approx(0.1, abs=0.055)  # 3 standard errors of 300
    assert np.mean(p_values) == pytest.approx(0.5, abs=0.055)
    intensity, exceeded = cloud(2000, 0.4, 1)
    saved = (intensity > 0.9) & (np.arange(2000) % 4 == 0)  # scaling up saves every fourth
    assert goodness(intensity, exceeded & ~saved, fit_fragility(intensity, exceeded & ~saved)) < 1e-6
    assert goodness(intensity[:8], exceeded[:8], fit_fragility(intensity, exceeded)) is None


def test_goodness_by_hand():
    """Three bins of 14, 15 and 15 runs, each of probability 1/2: of variance 1/4."""
    exceeded = np.concatenate([np.arange(size) < count for size, count in ((14, 11), (15, 4), (15, 9))])
    flat = Fragility(1.0, 1e20)  # 1/2 everywhere
    pearson = (11 - 7) ** 2 / (14 / 4) + (4 - 7.5) ** 2 / (15 / 4) + (9 - 7.5) ** 2 / (15 / 4)
    assert goodness(np.arange(1.0, 45.0), exceeded, flat) == pytest.approx(chi2.sf(pearson, 3 - 2), rel=1e-9)


def test_shifts_of_an_engine_are_its_numbers_over_the_models_by_hand():
    """Two intensities, 1000 runs each: the curves go through the shares."""
    x = np.repeat([math.exp(-1), math.e], 1000)
    model, engine = (
        np.concatenate([np.arange(1000) < 10 * share for share in shares]).astype(float)
        for shares in ((16, 84), (31, 84))
    )
    states = {"overturning": State("tilt", 0.5, "x")}
    (row,) = effects({"x": x}, np.arange(2000), states, ({"tilt": model}, {"tilt": engine}), ("e", "v"))
    low, high = norm.ppf([0.31, 0.84])
    spread = norm.ppf(0.84) / ((high - low) / 2)
    assert row["median_shift"] == pytest.approx(math.exp(-(high + low) / (high - low)), rel=1e-6)
    assert row["dispersion_shift"] == pytest.approx(spread, rel=1e-6) and spread == pytest.approx(1.33, abs=0.01)
    for name, least, most in (("median", 0.6, 0.8), ("dispersion", 1.2, 1.5)):
        below, above = row[f"{name}_interval"]
        assert least < below < row[f"{name}_shift"] < above < most


def test_separated_samples_determine_no_curve():
    intensity, exceeded = np.array([1.0, 2.0, 3.0, 4.0]), np.array([0, 1, 0, 1])
    apart = np.array([[1, 1, 1, 1], [2, 0, 0, 2], [1, 0, 1, 2]])
    medians, dispersions = resampled(intensity, exceeded, apart)
    assert np.isnan(dispersions).tolist() == [False, True, True]
    assert medians[0] == pytest.approx(fit_fragility(intensity, exceeded).median)
    assert interval(1.0, dispersions) is None


def test_points_are_shares_of_equally_many_runs():
    intensity, exceeded = cloud(100, 0.4, 4)
    order, begin = np.argsort(intensity), 0
    for point, size in zip(points(intensity, exceeded, 7), (15, 15, 14, 14, 14, 14, 14), strict=True):
        members = order[begin : begin + size]
        count, middle = int(exceeded[members].sum()), np.exp(np.log(intensity[members]).mean())
        assert (point["size"], point["share"], point["intensity"]) == (size, count / size, pytest.approx(middle))
        assert (point["low"], point["high"]) == wilson(count, size)
        begin += size


# Forecasts of a yes or no: scores, fits and intervals, against values by hand and by brute force.


def test_the_score_of_a_forecast_by_hand():
    probability, happened = [0.0, 0.5, 0.8, 1.0], [False, True, False, True]
    assert brier(probability, happened).tolist() == pytest.approx([0.0, 0.25, 0.64, 0.0])
    assert right(probability, happened).tolist() == [True, True, False, True]
    assert brier([0.5] * 7, [True, False] * 3 + [True]).mean() == 0.25


def test_no_group_is_on_both_sides_and_each_is_judged_once():
    groups = ["a", "b", "a", "c", "b", "a"]
    seen = np.zeros(6, dtype=int)
    for others, held in folds(groups):
        assert not (others & held).any() and (others | held).all()
        assert not {groups[k] for k in np.flatnonzero(others)} & {groups[k] for k in np.flatnonzero(held)}
        seen += held
    assert seen.tolist() == [1] * 6
    assert sum(held for _, held in halves(5)).tolist() == [1] * 5
    assert not any((others & held).any() for others, held in halves(5))


def test_what_is_held_out_is_not_fitted_to():
    """A forecast that only repeats what it was fitted to knows nothing of what was held out."""
    happened, groups = np.array([True, False, True, False, True, True]), ["a", "b", "a", "c", "b", "a"]

    def by_heart(chosen):
        return np.where(chosen, happened, 0.5)

    assert held_out(by_heart, folds(groups), 6).tolist() == [0.5] * 6


@pytest.mark.parametrize("seed", range(5))
def test_a_threshold_is_right_as_often_as_any(seed):
    rng = np.random.default_rng(seed)
    values, happened = rng.integers(0, 9, 20).astype(float), rng.random(20) < 0.5
    best = max(int(((values > at) == happened).sum()) for at in [-np.inf, *np.arange(-0.5, 9)])
    assert int(((values > threshold(values, happened)) == happened).sum()) == best


def test_thresholds_that_are_as_good_are_taken_in_the_middle():
    assert threshold([1, 2, 3, 4], [False, False, True, True]) == 2.5
    assert threshold([1, 2], [True, True]) == -np.inf and threshold([1, 2], [False, False]) == np.inf
    assert [middle([3]), middle([3, 8]), middle([3, 4, 9])] == [3, 3, 4]


def test_logistic_regression_is_the_likeliest_one():
    rng = np.random.default_rng(3)
    features = rng.normal(size=(80, 2)) * [1.0, 30.0] + [5.0, -100.0]
    happened = rng.random(80) < 1 / (1 + np.exp(-(features[:, 0] - 5) - 0.05 * (features[:, 1] + 100)))
    chosen = np.arange(80) < 60

    def loss(beta):
        z = np.column_stack([np.ones(80), features - features.mean(axis=0)]) @ beta
        return float((np.log1p(np.exp(z)) - happened * z)[chosen].sum())

    best = minimize(loss, np.zeros(3), method="Nelder-Mead", options={"xatol": 1e-10, "fatol": 1e-12, "maxiter": 9000})
    z = np.column_stack([np.ones(80), features - features.mean(axis=0)]) @ best.x
    np.testing.assert_allclose(logistic(features, happened, chosen), 1 / (1 + np.exp(-z)), atol=1e-4)


@pytest.mark.parametrize("seed", range(5))
def test_logistic_regression_of_collinear_features_and_their_squares_settles(seed):
    """At the likeliest one the slope is 0, but for the ridge, which weighs on other features in each."""
    rng = np.random.default_rng(seed)
    pga = rng.normal(-2, 1, 300)
    plain = np.column_stack([pga, pga + 0.1 * rng.normal(size=300)])
    raw = np.column_stack([plain, plain**2, plain.prod(axis=1)])
    happened = rng.random(300) < 1 / (1 + np.exp(-6 * (pga + 2 + 0.3 * (pga + 2) ** 2)))
    every = np.ones(300, dtype=bool)
    results = [logistic(features, happened, every) for features in (bent(plain), raw)]
    for probability in results:
        assert np.abs(bent(plain).T @ (probability - happened)).max() < 0.01  # of 300 cases
    first, second = (np.log(np.where(happened, probability, 1 - probability)).sum() for probability in results)
    assert first == pytest.approx(second, abs=0.01)
    assert bent(plain).shape == (300, 5)


def test_separated_outcomes_give_a_steep_curve_and_no_overflow():
    x, happened = np.arange(10.0)[:, None], np.arange(10) >= 5
    result = logistic(x, happened, np.ones(10, dtype=bool))
    assert np.isfinite(result).all() and (np.diff(result) >= 0).all() and right(result, happened).all()


def test_an_interval_by_groups_is_that_of_every_draw():
    """Two groups: one of them twice, both, or the other twice, in the ratio 1 to 2 to 1."""
    values, groups = [1.0, 1.0, 1.0, 0.0], ["a", "a", "a", "b"]
    assert clustered(values, groups) == [0.0, 1.0]  # a single group may be drawn alone: a quarter of the draws
    weights = draws(DRAWS, 2, 0)
    means = sorted({(3 * a) / (3 * a + b) for a, b in weights.tolist()})
    assert means == [0.0, 0.75, 1.0]


def test_groups_widen_an_interval_and_do_not_where_each_is_alone():
    values = np.repeat([1.0, 0.0], 50)
    alone, together = clustered(values, range(100)), clustered(values, np.arange(100) // 10)
    assert alone == pytest.approx([0.5 - 0.098, 0.5 + 0.098], abs=0.015)  # 1.96 sqrt(.25/100)
    assert together[1] - together[0] > 2.5 * (alone[1] - alone[0])  # sqrt(10) of it
    assert clustered(values, range(100)) == alone and clustered(values, range(100), seed=1) != alone
