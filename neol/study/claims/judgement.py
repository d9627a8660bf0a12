"""The rules by which runs bear a claim out, or contradict it: what decides each of its parts.

A rule judges the samples of a part, float64[n] each, one value a run. Its effect is signed so that
the claim says "above 0". Support is at `ALPHA`; contradiction at the level that the rule is given,
as one part suffices for that.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from neol.study.outcomes.paper_numbers import PAPER_SEEDS
from neol.study.outcomes.statistics import (
    ALPHA,
    Effect,
    Floats,
    bootstrap,
    estimate,
    interval,
    mean_difference,
    mean_difference_error,
    mean_difference_interval,
    rank_sum,
    seeds_for,
    seeds_needed,
    superiority,
)


@dataclass(frozen=True, slots=True)
class Judgement:
    """What samples say: the effect, its 95% interval, and whether they bear the claim out."""

    effect: float
    low: float
    high: float
    right: bool
    wrong: bool
    p: float = math.nan
    """Of the rank-sum test, where that decides."""
    needed: float = math.nan
    """Seeds with which an effect of this size decides 4 times of 5; NaN where it is unknown."""


DecisionRule = Callable[[Sequence[Floats], np.random.Generator, float], Judgement]
"""From samples, the bootstrap's generator and the level of a contradiction."""


def by_interval(
    effect: Effect, *, at_least: bool = False, picked: tuple[int, int] = (1, 1)
) -> DecisionRule:
    """The effect's bootstrap interval lies above 0, or at or below it.

    With `at_least` an effect of 0 bears the claim out as well. `picked` says out of how many cells
    the runs themselves picked the one that should lead, and its rival: the highest of several is
    high by chance alone, so the levels are divided by these numbers.
    """
    leaders, rivals = picked

    def judge(samples: Sequence[Floats], random: np.random.Generator, alpha: float) -> Judgement:
        seeds, value = min(map(len, samples)), float(effect(*samples))
        replicates = bootstrap(effect, samples, random)
        low, high = map(float, interval(replicates, seeds))
        lowest = float(interval(replicates, seeds, 1 - ALPHA / leaders)[0])
        highest = float(interval(replicates, seeds, 1 - alpha / rivals)[1])
        right = lowest >= 0 if at_least else lowest > 0
        wrong = highest < 0 if at_least else highest <= 0
        level = ALPHA / leaders if value > 0 else alpha / rivals
        needed = seeds_for(value, float(replicates.std(ddof=1)), seeds, level)
        return Judgement(value, low, high, right, wrong, needed=needed)

    return judge


def by_one_run(effect: Effect, *, reaches: bool) -> DecisionRule:
    """A mean against a maximum: one run below it shows that the mean is; none, with enough seeds,
    that it `reaches` it.

    As many seeds as the paper's are enough: with 30 of 30 runs at the maximum, at most one in ten
    lies below it (95%, Clopper and Pearson 1934). The interval is the bootstrap's, for the size.
    """

    def judge(samples: Sequence[Floats], random: np.random.Generator, _alpha: float) -> Judgement:
        found = estimate(effect, samples, random)
        below = found.value != 0
        at_maximum = not below and _as_many_as_the_papers(samples)
        right, wrong = (at_maximum, below) if reaches else (below, at_maximum)
        return Judgement(found.value, found.low, found.high, right, wrong)

    return judge


def by_rank_sum(*, differs: bool) -> DecisionRule:
    """Wilcoxon's rank-sum test of two samples; the effect is A12 - 1/2.

    That the first `differs`: the one-sided test is significant, or that of the other side. That it
    does not: the two-sided test is not significant, with no fewer seeds than the paper's.
    """

    def effect(sample: Floats, against: Floats) -> Floats:
        return superiority(sample, against) - 0.5

    def judge(samples: Sequence[Floats], random: np.random.Generator, alpha: float) -> Judgement:
        found = estimate(effect, samples, random)
        value, low, high = found.value, found.low, found.high
        first, second = samples
        higher, lower = rank_sum(first, second, "greater"), rank_sum(second, first, "greater")
        if differs:
            needed = seeds_needed(value + 0.5, alpha=ALPHA if value > 0 else alpha)
            return Judgement(value, low, high, higher < ALPHA, lower < alpha, higher, needed)
        p = min(1.0, 2 * min(higher, lower))
        right = p >= ALPHA and _as_many_as_the_papers(samples)
        return Judgement(value, low, high, right, p < alpha, p)

    return judge


def by_share(more_than: float) -> DecisionRule:
    """In more than this share of pairs of samples the first has the higher mean.

    The share of observed leads would not do: noise draws it towards one half, so it contradicts a
    lead that all cells have. Each pair has its own interval instead (Welch 1947), at the level
    divided by the number of pairs: the share is at least that of the pairs that surely lead, and at
    most that of those that do not surely trail.
    """

    def judge(samples: Sequence[Floats], _random: np.random.Generator, alpha: float) -> Judgement:
        pairs = list(zip(samples[::2], samples[1::2], strict=True))

        def bounds(level: float) -> tuple[float, float]:
            each = [mean_difference_interval(*pair, 1 - level / len(pairs)) for pair in pairs]
            leading, trailing = np.mean([(low > 0, high <= 0) for low, high in each], axis=0)
            return float(leading - more_than), float(1 - trailing - more_than)

        leads = np.array([float(mean_difference(*pair)) for pair in pairs])
        value = float(np.mean(leads > 0)) - more_than
        low, high = bounds(ALPHA)
        if value > 0:
            level, side, enough = ALPHA, leads > 0, math.floor(more_than * len(pairs)) + 1
        else:
            level, side, enough = alpha, leads <= 0, math.ceil((1 - more_than) * len(pairs))
        needed = np.sort(
            [
                seeds_for(
                    float(lead),
                    mean_difference_error(*pair),
                    min(map(len, pair)),
                    level / len(pairs),
                )
                for lead, pair, there in zip(leads, pairs, side, strict=True)
                if there
            ]
        )[enough - 1]
        return Judgement(value, low, high, low > 0, bounds(alpha)[1] <= 0, needed=float(needed))

    return judge


def _as_many_as_the_papers(samples: Sequence[Floats]) -> bool:
    """Whether there are the seeds that a claim of no difference takes."""
    return min(map(len, samples)) >= PAPER_SEEDS
