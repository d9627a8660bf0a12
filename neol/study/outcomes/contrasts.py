"""The primary comparison of two groups of runs: the difference of their means.

Its interval is Welch's (1947), from each side's number of seeds, mean and standard deviation alone,
so numbers that the paper prints are compared in the same way as our runs. Where both sides share
their seeds, `paired` is the analysis of the pairs. Too little data gives NaN, never a guess.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
import numpy.typing as npt
from scipy import stats

from neol.study.outcomes.statistics import ALPHA, Estimate

WHY_THEY_DIFFER = (
    "The difference of means is the primary comparison. A12 and the rank-sum test ask how often "
    "one run beats another, by any margin, so they may disagree with it where a few runs "
    "decide the mean."
)
"""Sentences for captions that show A12 or p-values beside the difference."""


@dataclass(frozen=True, slots=True)
class Moments:
    """The number of runs, their mean and standard deviation, as a table prints them."""

    seeds: int
    mean: float
    sd: float
    """Standard deviation with n - 1 in its denominator; NaN below two seeds."""

    @classmethod
    def of(cls, sample: npt.ArrayLike) -> Self:
        """Return the moments of some runs, float64[n]."""
        values = np.asarray(sample, dtype=np.float64)
        mean = float(values.mean()) if len(values) else math.nan
        sd = float(values.std(ddof=1)) if len(values) > 1 else math.nan
        return cls(len(values), mean, sd)


@dataclass(frozen=True, slots=True)
class Difference:
    """A difference of two means with the standard error and degrees of freedom of its test."""

    value: float
    error: float
    """Standard error of the difference; 0 where neither side varies."""
    degrees: float
    """Degrees of freedom of Student's t."""

    def interval(self, confidence: float = 1 - ALPHA) -> tuple[float, float]:
        """Return the interval of the true difference; a single point if neither side varies."""
        if self.error == 0:
            return self.value, self.value
        reach = float(stats.t.ppf((1 + confidence) / 2, self.degrees)) * self.error
        return self.value - reach, self.value + reach

    def p(self, null: float = 0.0) -> float:
        """Return the two-sided p-value of the hypothesis that the true difference is `null`."""
        if self.error == 0:
            return float(self.value == null)
        return float(2 * stats.t.sf(abs(self.value - null) / self.error, self.degrees))


def difference(sample: Moments, against: Moments) -> Difference:
    """Return the difference of two means with Welch's degrees of freedom (unequal variances)."""
    first, second = (
        each.sd**2 / each.seeds if each.seeds else math.nan for each in (sample, against)
    )
    error, value = math.sqrt(first + second), sample.mean - against.mean
    if not error > 0:  # no spread, or NaN
        return Difference(value, error, math.nan)
    shares = first**2 / (sample.seeds - 1) + second**2 / (against.seeds - 1)
    return Difference(value, error, (first + second) ** 2 / shares)


def paired(sample: Mapping[int, float], against: Mapping[int, float]) -> Difference:
    """Return the mean difference of the runs that share a seed; values are given by seed."""
    gaps = [sample[seed] - against[seed] for seed in sorted(sample.keys() & against.keys())]
    moments = Moments.of(gaps)
    error = moments.sd / math.sqrt(moments.seeds) if gaps else math.nan
    return Difference(moments.mean, error, moments.seeds - 1)


def correlation(sample: Mapping[int, float], against: Mapping[int, float]) -> float:
    """Return Pearson's correlation over shared seeds; NaN for fewer than 3, or without spread."""
    shared = sorted(sample.keys() & against.keys())
    pairs = np.array([(sample[seed], against[seed]) for seed in shared]).reshape(-1, 2)
    if len(pairs) < 3 or (pairs == pairs[0]).all(axis=0).any():
        return math.nan
    return float(np.corrcoef(pairs.T)[0, 1])


def sd_ratio(sample: Moments, against: Moments, confidence: float = 1 - ALPHA) -> Estimate:
    """Return the ratio of two standard deviations, with its interval from F (normal outcomes).

    NaN where a side has fewer than two seeds, or the divisor is 0.
    """
    if not (sample.sd >= 0 and against.sd > 0):
        return Estimate(math.nan, math.nan, math.nan)
    ratio = sample.sd / against.sd
    tails = (1 + confidence) / 2, (1 - confidence) / 2
    quantiles = stats.f.ppf(tails, sample.seeds - 1, against.seeds - 1)
    low, high = ratio / np.sqrt(quantiles)
    return Estimate(ratio, float(low), float(high))


def sd_p(sample: Moments, against: Moments) -> float:
    """Return the two-sided p-value of the F test of equal standard deviations (normal outcomes).

    It is 0 if one side has no spread, 1 if neither has.
    """
    if not (sample.sd >= 0 and against.sd >= 0):
        return math.nan
    if 0 in (sample.sd, against.sd):
        return float(sample.sd == against.sd)
    ratio, degrees = (sample.sd / against.sd) ** 2, (sample.seeds - 1, against.seeds - 1)
    return float(2 * min(stats.f.cdf(ratio, *degrees), stats.f.sf(ratio, *degrees)))


def not_below_the_best(groups: Sequence[Moments]) -> list[bool]:
    """Return which groups are not distinguishable from the best, by one-sided Welch tests.

    Each test is at `ALPHA` divided by the number of rivals, so the group with the highest true mean
    is selected with probability 1 - ALPHA or more (subset selection; Gupta 1965). A group without a
    mean is left out; one without a standard deviation stays.
    """
    level = ALPHA / max(len(groups) - 1, 1)

    def lies_below(group: Moments, rival: Moments) -> bool:
        lead = difference(rival, group)
        return lead.value > 0 and lead.p() / 2 < level

    return [
        not (math.isnan(group.mean) or any(lies_below(group, rival) for rival in groups))
        for group in groups
    ]


def compare(sample: Mapping[int, float], against: Mapping[int, float]) -> dict[str, float]:
    """Return the primary comparison of two groups of runs, given by seed, as a table's columns.

    `difference` with Welch's interval, `low` and `high`, and two-sided `p`; the mean difference of
    the pairs that share a seed, `paired`, with its interval, and their `correlation`.
    """
    moments = [Moments.of(list(side.values())) for side in (sample, against)]
    between, within = difference(*moments), paired(sample, against)
    low, high = between.interval()
    paired_low, paired_high = within.interval()
    return {
        "seeds": min(each.seeds for each in moments),
        "difference": between.value,
        "low": low,
        "high": high,
        "p": between.p(),
        "paired": within.value,
        "paired_low": paired_low,
        "paired_high": paired_high,
        "correlation": correlation(sample, against),
    }
