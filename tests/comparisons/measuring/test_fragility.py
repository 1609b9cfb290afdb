"""Fragility against a published example, closed forms and simulation."""

import math

import numpy as np
import pytest
from scipy.stats import chi2, norm

from comparisons.measuring.statistics import (
    Fragility,
    draws,
    fit_fragility,
    goodness,
    interval,
    points,
    resampled,
    wilson,
)
from comparisons.studies.fragility.fits import State, effects

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
    one, other = (fit_fragility(unit * np.array([1, 2, 4]), [2, 9, 17], [20, 20, 20]) for unit in (1.0, 9.81))
    assert (other.median, other.dispersion) == pytest.approx((9.81 * one.median, one.dispersion), rel=1e-6)


@pytest.mark.parametrize(
    "overturned, said",
    [
        ([0, 0, 20], "do not overlap"),
        ([0, 7, 20], "do not overlap"),
        ([0, 0, 0], "do not overlap"),
        ([20, 20, 20], "do not overlap"),
        ([15, 10, 5], "does not become likelier"),
    ],
)
def test_counts_that_determine_no_curve_are_an_error(overturned, said):
    with pytest.raises(ValueError, match=said):
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
    p_values = [goodness(*one, fit_fragility(*one)) for one in clouds]
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
        own = order[begin : begin + size]
        count, middle = int(exceeded[own].sum()), np.exp(np.log(intensity[own]).mean())
        assert (point["size"], point["share"], point["intensity"]) == (size, count / size, pytest.approx(middle))
        assert (point["low"], point["high"]) == wilson(count, size)
        begin += size
