"""The primary comparison, against SciPy's own tests of samples and of summaries."""

import math

import numpy as np
import pytest
from scipy import stats

from neol.study.outcomes.contrasts import (
    Difference,
    Moments,
    correlation,
    difference,
    paired,
    sd_p,
    sd_ratio,
)

RANDOM = np.random.default_rng(5)
FIRST, SECOND = RANDOM.normal(3, 1, 8), RANDOM.normal(2, 4, 30)
BY_SEED = dict(enumerate(FIRST))
PARTNER = {seed: 0.5 * value + 0.1 * seed for seed, value in BY_SEED.items()}


def test_the_difference_of_means_is_welchs() -> None:
    ours = difference(Moments.of(FIRST), Moments.of(SECOND))
    test = stats.ttest_ind(FIRST, SECOND, equal_var=False)
    assert ours.value == pytest.approx(FIRST.mean() - SECOND.mean())
    assert ours.interval() == pytest.approx(tuple(test.confidence_interval(0.95)))
    assert ours.interval(0.9) == pytest.approx(tuple(test.confidence_interval(0.9)))
    assert ours.p() == pytest.approx(test.pvalue)
    assert ours.degrees == pytest.approx(test.df)
    shifted = stats.ttest_ind(FIRST - 0.7, SECOND, equal_var=False)
    assert ours.p(0.7) == pytest.approx(shifted.pvalue)


def test_printed_numbers_are_enough() -> None:
    """The paper prints a mean and a deviation over 30 seeds."""
    printed = Moments(30, 311.77, 8.18)
    ours = difference(Moments.of(FIRST), printed)
    spread = FIRST.std(ddof=1)
    test = stats.ttest_ind_from_stats(FIRST.mean(), spread, 8, 311.77, 8.18, 30, equal_var=False)
    assert ours.p() == pytest.approx(test.pvalue)


def test_pairs_are_those_of_one_seed() -> None:
    """Runs are paired by seed in any order; a seed that one side lacks is left out."""
    extra = dict(reversed(PARTNER.items())) | {99: 1000.0}
    test = stats.ttest_rel(FIRST, list(PARTNER.values()))
    ours = paired(BY_SEED, extra)
    assert ours.interval() == pytest.approx(tuple(test.confidence_interval(0.95)))
    assert ours.p() == pytest.approx(test.pvalue)
    expected = stats.pearsonr(FIRST, list(PARTNER.values())).statistic
    assert correlation(BY_SEED, extra) == pytest.approx(expected)


def test_the_ratio_of_deviations_is_fs() -> None:
    """The interval excludes 1 exactly where the two-sided F test is significant."""
    ratio = sd_ratio(Moments.of(FIRST), Moments.of(SECOND))
    squared = FIRST.var(ddof=1) / SECOND.var(ddof=1)
    assert ratio.value == pytest.approx(math.sqrt(squared))
    for bound in (ratio.low, ratio.high):
        tail = stats.f.cdf(squared / bound**2, 7, 29)
        assert min(tail, 1 - tail) == pytest.approx(0.025)
    assert ratio.low < ratio.value < ratio.high


def test_without_spread_it_is_a_point() -> None:
    same, higher = Moments(10, 500.0, 0.0), Moments(30, 501.0, 0.0)
    assert difference(same, higher).interval() == (-1, -1)
    assert difference(same, higher).p() == 0
    assert difference(same, same).p() == 1
    assert math.isnan(sd_ratio(higher, same).value)
    assert math.isnan(correlation({0: 1.0, 1: 1.0, 2: 1.0}, {0: 1.0, 1: 2.0, 2: 3.0}))


@pytest.mark.parametrize("runs", [[], [1.0]])
def test_too_few_runs_give_no_interval(runs: list[float]) -> None:
    few = difference(Moments.of(runs), Moments.of(SECOND))
    pairs = paired(dict(enumerate(runs)), BY_SEED)
    assert all(math.isnan(each) for one in (few, pairs) for each in (*one.interval(), one.p()))


def test_a_difference_may_be_given() -> None:
    """The interval is 2.228 standard errors either way, with 10 degrees of freedom."""
    assert Difference(1.0, 2.0, 10).interval() == pytest.approx((1 - 4.456, 1 + 4.456), abs=1e-3)


def test_deviations_that_differ_by_f() -> None:
    """The p-value is one minus the level at which the interval of the ratio touches 1."""
    first, second = Moments.of(FIRST), Moments.of(SECOND)
    p = sd_p(first, second)
    at_level = sd_ratio(first, second, 1 - p)
    assert pytest.approx(at_level.high) == 1 or pytest.approx(at_level.low) == 1
    assert sd_p(second, first) == pytest.approx(p)
    assert sd_p(Moments(10, 1.0, 0.0), second) == 0
    assert sd_p(Moments(10, 1.0, 0.0), Moments(30, 2.0, 0.0)) == 1
    assert math.isnan(sd_p(Moments.of([1.0]), second))
