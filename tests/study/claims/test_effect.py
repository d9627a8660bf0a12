"""Effects of means and standard deviations."""

import math

import numpy as np
import pytest
from scipy import stats

from neol.study.claims.effect import Effect, Summary, combined, difference

RANDOM = np.random.default_rng(1)
FIRST, SECOND = RANDOM.normal(3, 2, 12), RANDOM.normal(1, 1, 12)


def summary(*cells: np.ndarray, spread: bool = False) -> Summary:
    return Summary.of_runs(np.array(cells), spread=spread)


def test_a_difference_is_welch_s() -> None:
    effect = difference(summary(FIRST), summary(SECOND))
    test = stats.ttest_ind(FIRST, SECOND, equal_var=False)
    assert effect is not None
    assert effect.p() == pytest.approx(test.pvalue)
    assert effect.interval(0.99) == pytest.approx(tuple(test.confidence_interval(0.99)))


def test_what_the_paper_prints_gives_the_same() -> None:
    """The summaries are of as many seeds as the runs."""
    printed = [Summary.printed([(x.mean(), x.std(ddof=1))], len(x)) for x in (FIRST, SECOND)]
    found, expected = difference(*printed), difference(summary(FIRST), summary(SECOND))
    assert found is not None and expected is not None
    assert (found.value, found.error) == pytest.approx((expected.value, expected.error))


def test_a_seed_s_runs_are_averaged_first() -> None:
    """Two cells that share their runs are no more certain than one."""
    one, two = summary(FIRST), summary(FIRST, FIRST)
    assert two.mean.error == pytest.approx(one.mean.error)
    assert summary(FIRST, 6 - FIRST).mean.error == pytest.approx(
        0
    )  # what one loses the other gains


def test_spread_is_the_difference_of_the_logarithms() -> None:
    effect = difference(summary(FIRST, spread=True), summary(SECOND, spread=True), "spread")
    assert effect is not None
    assert effect.value == pytest.approx(math.log(FIRST.std() / SECOND.std()))
    assert (
        difference(summary(FIRST, spread=True), summary(np.ones(12), spread=True), "spread") is None
    )


@pytest.mark.parametrize("draw", ["normal", "exponential"])
def test_the_spread_s_error_is_right_for_skewed_runs_too(draw: str) -> None:
    random = np.random.default_rng(2)
    samples = getattr(random, draw)(size=(2000, 30))
    effects = [summary(each, spread=True).spread for each in samples]
    values = [effect.value for effect in effects if effect]
    errors = [effect.error for effect in effects if effect]
    assert np.sqrt(np.mean(np.square(errors))) == pytest.approx(np.std(values), rel=0.2)


def test_standard_deviations_and_shares() -> None:
    ours, theirs = Summary.printed([(12.0, 4.0)], 30), Summary.printed([(10.0, 2.0)], 30)
    standardised = difference(ours, theirs, scale="sd")
    relative = difference(ours, theirs, scale="relative")
    assert standardised is not None and relative is not None
    assert standardised.value == pytest.approx(2 / math.sqrt(10))
    assert relative.value == pytest.approx(0.2)
    slope = math.hypot(4 / math.sqrt(30) / 10, 12 / 100 * 2 / math.sqrt(30))
    assert relative.error == pytest.approx(slope)


@pytest.mark.parametrize("scale", ["sd", "relative"])
def test_the_divisor_s_error_is_passed_on(scale: str) -> None:
    random = np.random.default_rng(3)
    effects = [
        difference(
            summary(random.normal(12, 4, 30)), summary(random.normal(10, 2, 30)), scale=scale
        )
        for _ in range(1500)
    ]
    values, errors = zip(*((each.value, each.error) for each in effects if each), strict=True)
    assert np.mean(errors) == pytest.approx(np.std(values), rel=0.07)


def test_nothing_that_varies_has_no_standardised_effect() -> None:
    flat, other = summary(np.full(5, 500.0)), summary(np.full(5, 499.0))
    assert difference(flat, flat, scale="sd") == Effect(0.0, 0.0, 4)
    assert difference(flat, other, scale="sd") is None
    assert difference(flat, flat) == Effect(0.0, 0.0, 4)


def test_a_telescope_sees_its_effect_one_time_in_three() -> None:
    random = np.random.default_rng(4)
    paper = difference(Summary.printed([(0.0, 1.0)], 30), Summary.printed([(0.0, 1.0)], 30))
    assert paper is not None
    first = random.normal(paper.telescope, 1, (20_000, 30))
    second = random.normal(0, 1, (20_000, 30))
    found = stats.ttest_ind(first, second, axis=1).pvalue < 0.05
    assert found.mean() == pytest.approx(1 / 3, abs=0.015)


def test_predictions_hold_both_errors() -> None:
    random = np.random.default_rng(5)
    studies = random.normal(0, 1, (4000, 2, 20))
    inside = [summary(paper).mean.predicts(summary(ours).mean, 0.05) for paper, ours in studies]
    assert np.mean(inside) == pytest.approx(0.95, abs=0.012)


def test_weights_multiply_errors() -> None:
    assert combined([(2, Effect(1.0, 3.0, 9)), (-1, Effect(4.0, 8.0, 9))]).error == 10
