import csv
import math
from collections import Counter
from itertools import combinations, product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from neol.study.campaign.reference import REFERENCE
from neol.study.outcomes.contrasts import Moments, difference
from neol.study.outcomes.statistics import (
    Floats,
    bootstrap,
    estimate,
    holm,
    interquartile_mean,
    interval,
    mean_interval,
    mean_superiority,
    paper_statistic,
    performance_profile,
    rank_sum,
    seeds_needed,
    superiority,
)


def mean_difference(sample: Floats, against: Floats) -> Floats:
    return np.asarray(sample.mean(axis=-1) - against.mean(axis=-1))


def sd_difference(sample: Floats, against: Floats) -> Floats:
    return np.asarray(sample.std(axis=-1, ddof=1) - against.std(axis=-1, ddof=1))


EFFECTS = (superiority, mean_superiority, interquartile_mean, mean_difference, sd_difference)
SAMPLES = st.lists(st.integers(-5, 5), min_size=2, max_size=12).map(
    lambda values: np.array(values, dtype=float)
)


def random(seed: int = 0) -> np.random.Generator:
    return np.random.default_rng(seed)


class TestRankSum:
    def test_exact_by_hand(self) -> None:
        """Among the 20 ways to split six ranks in two halves, one is as extreme on either side."""
        assert rank_sum([4, 5, 6], [1, 2, 3]) == pytest.approx(2 / 20)
        assert rank_sum([1, 2, 3], [4, 5, 6]) == pytest.approx(2 / 20)
        assert rank_sum([4, 5, 6], [1, 2, 3], "greater") == pytest.approx(1 / 20)
        assert rank_sum([1, 2, 3], [4, 5, 6], "greater") == pytest.approx(1)

    def test_ties_by_hand(self) -> None:
        """U = 7 of 9; sd^2 = 9/12 (7 - (2^3 - 2 + 2^3 - 2) / 30); z = (7 - 4.5 - 0.5) / sd."""
        z = 2.0 / math.sqrt(0.75 * (7 - 12 / 30))
        assert rank_sum([2, 3, 4], [1, 2, 3]) == pytest.approx(2 * stats.norm.sf(z))

    def test_degenerate(self) -> None:
        assert rank_sum([500, 500], [500, 500]) == 1
        assert math.isnan(rank_sum([], [1]))
        assert rank_sum([2], [1], "greater") == 0.5

    def test_the_papers_p_values_are_two_sided(self) -> None:
        """Each p-value without ties is that of exactly one U at 30 against 30 seeds, two-sided."""
        with (REFERENCE / "tables.csv").open() as file:
            printed = {
                (row["table"], row["task"], row["column"]): row["value"]
                for row in csv.DictReader(file)
                if row["table"] in ("5", "6") and row["task"] != "cartpole"
            }
        found = {
            place: paper_statistic(float(p), digits=4 if place[0] == "5" else 3, seeds=30)
            for place, p in printed.items()
        }
        assert len(found) == 18
        assert None not in found.values()
        assert found["5", "hopper", "hebb_vs_neat"] == 579  # one-sided: p = 0.0287, below 0.05

    def test_a_papers_p_value_from_its_statistic(self) -> None:
        """Two samples of 30 with U = 579 print Table 5's 5.746e-2 when tested on both sides."""
        against = np.arange(30.0)
        beaten = np.array([19] * 21 + [20] * 9)  # 579 in all
        sample = beaten - 0.5 + np.arange(30) / 100
        assert f"{rank_sum(sample, against):.3e}" == "5.746e-02"


def test_holm_by_hand() -> None:
    adjusted = holm([0.01, 0.04, math.nan, 0.03, 0.9])
    assert adjusted[[0, 1, 3, 4]].tolist() == pytest.approx([0.04, 0.09, 0.09, 0.9])
    assert math.isnan(adjusted[2])


@given(st.lists(st.floats(0, 1), min_size=1, max_size=8))
def test_holm_lies_between_the_raw_p_value_and_bonferroni(p: list[float]) -> None:
    adjusted = holm(p)
    assert (adjusted >= np.array(p)).all()
    assert (adjusted <= np.minimum(1, len(p) * np.array(p)) + 1e-12).all()


class TestEffects:
    def test_superiority_by_hand(self) -> None:
        """Nine pairs: 5 won, 2 tied."""
        assert superiority(np.array([1.0, 3, 4]), np.array([1.0, 2, 3])) == pytest.approx(6 / 9)

    @given(SAMPLES, SAMPLES)
    def test_superiority_is_the_mann_whitney_statistic(self, a: np.ndarray, b: np.ndarray) -> None:
        u = stats.mannwhitneyu(a, b).statistic
        assert superiority(a, b) == pytest.approx(u / (len(a) * len(b)))
        assert superiority(a, b) + superiority(b, a) == pytest.approx(1)

    def test_every_effect_works_along_the_last_axis(self) -> None:
        a, b = random().normal(size=(5, 7)), random(1).normal(size=(5, 9))
        for effect in EFFECTS:
            singly = [float(effect(*pair)) for pair in zip(a, b, strict=True)]
            assert effect(a, b).tolist() == pytest.approx(singly)

    def test_interquartile_mean_by_hand(self) -> None:
        """The middle four of eight runs."""
        assert interquartile_mean(np.array([99.0, 1, 2, 3]), np.array([4.0, 5, 6, -9])) == 3.5

    def test_performance_profile_by_hand(self) -> None:
        """A task of two runs weighs as much as one of four."""
        shares = performance_profile([0.0, 1.0])(np.array([0.5, 2]), np.array([0.0, 0, 0, 1]))
        assert shares.tolist() == [(1 + 0.25) / 2, 0.25]


class TestIntervals:
    def test_a_seed_decides_the_interval(self) -> None:
        samples = random().normal(size=(2, 10))
        first = estimate(mean_difference, samples, random(7))
        assert estimate(mean_difference, samples, random(7)) == first
        assert estimate(mean_difference, samples, random(8)) != first

    def test_all_equal(self) -> None:
        result = estimate(mean_difference, [[500.0] * 5, [500.0] * 5], random())
        assert (result.value, result.low, result.high) == (0, 0, 0)

    def test_one_seed_has_a_value_but_no_interval(self) -> None:
        result = estimate(mean_difference, [[3.0], [1.0, 2.0]], random())
        assert result.value == 1.5
        assert math.isnan(result.low)

    def test_a_missing_cell_has_nothing(self) -> None:
        assert math.isnan(estimate(mean_difference, [[], [1.0]], random()).value)

    def test_strata_are_resampled_apart(self) -> None:
        """Two samples that are constant each have no spread, however different they are."""
        result = estimate(interquartile_mean, [[0.0] * 4, [10.0] * 4], random())
        assert result.low == result.value == result.high == 5

    @pytest.mark.parametrize("seeds", [5, 10, 30])
    def test_coverage_of_the_mean_is_near_nominal(self, seeds: int) -> None:
        """The plain percentile interval covers 83% for 5 seeds, and Student's 95%."""
        normal = random(seeds)
        covered = 0
        for _ in range(400):
            sample = normal.normal(size=seeds)
            means = sample[normal.integers(seeds, size=(400, seeds))].mean(axis=1)
            low, high = interval(means, seeds)
            covered += bool(low <= 0 <= high)
        assert 0.91 < covered / 400 < 0.985

    def test_agrees_with_scipys_bootstrap_for_many_seeds(self) -> None:
        a, b = random(1).normal(1, 1, 200), random(2).normal(0, 2, 200)
        ours = estimate(mean_difference, [a, b], random(), resamples=9000)
        theirs = stats.bootstrap(
            (a, b),
            lambda x, y, axis: x.mean(axis) - y.mean(axis),
            method="percentile",
            random_state=np.random.default_rng(0),
        ).confidence_interval
        assert ours.low == pytest.approx(theirs.low, abs=0.02)
        assert ours.high == pytest.approx(theirs.high, abs=0.02)

    def test_sd_interval_contains_the_truth(self) -> None:
        wide, narrow = random(1).normal(0, 3, 60), random(2).normal(0, 1, 60)
        result = estimate(sd_difference, [wide, narrow], random())
        assert 0 < result.low < 2 < result.high

    def test_students_interval_by_hand(self) -> None:
        """Means 3 and 3, standard errors sqrt(3) and 0; t is 4.303 with 2 degrees of freedom."""
        low, high = mean_interval(np.array([[0.0, 3.0, 6.0], [3.0, 3.0, 3.0]]))
        half = 4.302653 * math.sqrt(3)
        assert low == pytest.approx([3 - half, 3])
        assert high == pytest.approx([3 + half, 3])
        assert np.isnan(mean_interval(np.array([1.0]))).all()

    def test_welchs_interval_by_hand(self) -> None:
        """The squared standard errors of the means 1 and 2 are 1 and 4."""
        found = difference(Moments.of([0.0, 2.0]), Moments.of([0.0, 4.0]))
        half = stats.t.ppf(0.95, (1 + 4) ** 2 / (1**2 + 4**2)) * math.sqrt(1 + 4)
        assert found.interval(0.9) == pytest.approx((-1 - half, -1 + half))
        assert found.error == pytest.approx(math.sqrt(5))

    def test_without_spread_an_interval_is_a_point(self) -> None:
        assert difference(Moments.of([5.0] * 3), Moments.of([2.0] * 4)).interval(0.9) == (3, 3)


class TestPower:
    def test_by_hand(self) -> None:
        """(1.6449 + 0.8416)^2 / (6 * 0.2^2) = 25.8"""
        assert seeds_needed(0.7) == 26
        assert seeds_needed(0.3) == 26

    def test_degenerate(self) -> None:
        assert seeds_needed(0.5) == math.inf
        assert math.isnan(seeds_needed(math.nan))
        assert seeds_needed(1.0) == 5

    @pytest.mark.slow
    def test_simulated_power_is_what_was_asked_for(self) -> None:
        """Normal samples that are one standard deviation apart: A12 = Phi(1 / sqrt 2)."""
        seeds = int(seeds_needed(stats.norm.cdf(1 / math.sqrt(2))))
        samples = random()
        found = [
            rank_sum(samples.normal(1, 1, seeds), samples.normal(0, 1, seeds), "greater") < 0.05
            for _ in range(1500)
        ]
        assert 0.74 < np.mean(found) < 0.86


class TestByBruteForce:
    """All possible resamples, counted."""

    @given(st.lists(st.integers(0, 1000), min_size=7, max_size=7, unique=True))
    def test_rank_sum_is_the_share_of_ways_to_part_the_runs(self, values: list[int]) -> None:
        def won(ours: tuple[int, ...]) -> int:
            return sum(value > other for value in ours for other in set(values) - set(ours))

        ours = tuple(values[:3])
        ways = [won(some) >= won(ours) for some in combinations(values, 3)]
        assert rank_sum(ours, values[3:], "greater") == pytest.approx(np.mean(ways))

    def test_bootstrap_draws_each_resample_as_often_as_any_other(self) -> None:
        """Two strata of two runs give 2^2 x 2^2 resamples."""
        a, b = [0.0, 1.0], [0.0, 10.0]
        all_of_them = Counter(
            np.mean(ours) - np.mean(theirs)
            for ours in product(a, repeat=2)
            for theirs in product(b, repeat=2)
        )
        drawn = Counter(
            bootstrap(mean_difference, [np.array(a), np.array(b)], random(), 40_000).tolist()
        )
        assert {value: count / 40_000 for value, count in drawn.items()} == pytest.approx(
            {value: count / 16 for value, count in all_of_them.items()}, abs=0.01
        )

    @given(SAMPLES, SAMPLES)
    def test_superiority_by_loops(self, a: np.ndarray, b: np.ndarray) -> None:
        pairs = [1.0 if x > y else 0.5 if x == y else 0.0 for x in a for y in b]
        assert superiority(a, b) == pytest.approx(sum(pairs) / len(pairs))
