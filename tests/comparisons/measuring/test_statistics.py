"""Statistics against published examples, exact enumeration and simulation."""

import math

import numpy as np
import pytest

from comparisons.measuring.statistics import (
    Confusion,
    cohen_kappa,
    compare,
    confusion,
    detectable_difference,
    equality,
    holm,
    mcnemar,
    wilson,
)


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
    seen = [mcnemar(Confusion(int(rest), 0, int(one), int(other))) <= 0.05 for one, other, rest in kinds]
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
    found = compare(motion < 80, (motion < 80) & (motion >= 2))
    assert (found["only_a"], found["only_b"], found["both_overturn"], found["both_stand"]) == (2, 0, 78, 120)
    assert found["difference"] == -0.01 and found["p_value"] == 0.5
    assert found["detectable_difference"] == detectable_difference(200, 0.01)


def test_wilson_takes_sizes_that_are_not_whole():
    assert wilson(1.5, 50.5) == pytest.approx(np.mean([wilson(1, 50), wilson(2, 51)], axis=0), abs=1e-3)
    assert wilson(0, 100) == pytest.approx((0.0, 1.959964**2 / (100 + 1.959964**2))) and wilson(7, 7)[1] == 1.0


def test_runs_of_one_record_count_as_one():
    """However many they are: 0 of 187 runs under 50 records say no more than 0 of 50."""
    records = [k % 50 for k in range(187)]
    word, (low, high) = equality(np.zeros(187, dtype=bool), records)
    assert word == "inconclusive (too few runs)" and low == 0.0
    assert high == pytest.approx(1.959964**2 / (50 + 1.959964**2)) == pytest.approx(0.0713, abs=1e-4)
    one = np.arange(187) == 3
    assert equality(one, records)[1] == wilson(50 / 187, 50)  # the share of runs, known as well as that of 50
    assert equality(one, records)[1][1] > high  # a run that differs never makes it surer
    assert equality(one, range(187)) == equality(one)
    assert equality([True] * 40 + [False] * 147, records)[0] == "no"


FEW = "inconclusive (too few runs)"


@pytest.mark.parametrize(
    "differ, size, word",
    # an upper limit below 5 % is equal: 0 of 72 leave 5.07 %, 4 of 200 5.03 %; few runs acquit nobody and can convict
    [(0, 100, "yes"), (0, 73, "yes"), (0, 72, FEW), (3, 200, "yes"), (4, 200, "no"), (1, 40, FEW), (20, 40, "no")],
)
def test_equal_means_that_the_upper_limit_is_below_five_per_cent(differ, size, word):
    found, limits = equality(np.arange(size) < differ)
    assert found == word and limits == wilson(differ, size)
