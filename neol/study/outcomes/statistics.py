"""Statistics over seeds: tests, effect sizes, bootstrap intervals. The seed of a run is the unit.

Samples are float64[n], one value a run; a bootstrap draws from an explicit generator. Too little
data gives NaN, never a guess.
"""

import math
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt
from scipy import stats

ALPHA = 0.05
"""The level of every test; intervals hold 1 - ALPHA."""
Floats = npt.NDArray[np.float64]
Effect = Callable[..., Floats]
"""A function of samples, seeds along the last axis: float64[..., n_1], [..., n_2], ... -> [...]."""

RESAMPLES = 10_000
POWER = 0.8
"""Probability with which the seeds that a test needs would find an effect."""


@dataclass(frozen=True, slots=True)
class Estimate:
    """A value with its interval; NaN where the samples do not give one."""

    value: float
    low: float
    high: float


# --- Tests --------------------------------------------------------------------------------------


def rank_sum(
    sample: npt.ArrayLike,
    against: npt.ArrayLike,
    alternative: Literal["two-sided", "greater"] = "two-sided",
) -> float:
    """Return the p-value of the Wilcoxon rank-sum test: do two samples tend to different values?

    With `greater`: does `sample` tend to larger values? `scipy.stats.mannwhitneyu`: normal
    approximation with corrections for ties and continuity, exact for 8 seeds or fewer without ties.
    (`scipy.stats.ranksums` corrects for neither.) The two-sided one is what the paper's Tables 5
    and 6 print: see `paper_statistic`. 1 where all values are equal.
    """
    sample, against = np.asarray(sample, dtype=np.float64), np.asarray(against, dtype=np.float64)
    if not len(sample) or not len(against):
        return math.nan
    if len(np.unique(np.concatenate([sample, against]))) == 1:
        return 1.0
    return float(stats.mannwhitneyu(sample, against, alternative=alternative).pvalue)


def paper_statistic(p: float, digits: int, seeds: int) -> int | None:
    """Return the Mann-Whitney U above its mean whose two-sided p-value prints as `p`.

    For every p-value of Tables 5 and 6 but CartPole's, which has ties, there is exactly one at 30
    against 30 seeds. So the paper prints two-sided p-values, twice those that its captions name.
    """
    mean, sd = seeds**2 / 2, math.sqrt(seeds**2 * (2 * seeds + 1) / 12)
    u = np.arange(math.ceil(mean), seeds**2 + 1)
    two_sided = 2 * stats.norm.sf((u - mean - 0.5) / sd)
    found = [int(each) for each, value in zip(u, two_sided, strict=True) if _same(value, p, digits)]
    return found[0] if len(found) == 1 else None


def holm(p_values: Sequence[float]) -> Floats:
    """Return Holm's adjusted p-values of a family (Holm 1979); NaN does not belong to it."""
    p = np.asarray(p_values, dtype=np.float64)
    adjusted = np.full(p.shape, np.nan)
    order = [index for index in np.argsort(p) if not math.isnan(p[index])]
    steps = p[order] * np.arange(len(order), 0, -1)
    adjusted[order] = np.minimum(1.0, np.maximum.accumulate(steps))
    return adjusted


# --- Effects ------------------------------------------------------------------------------------


def superiority(sample: Floats, against: Floats) -> Floats:
    """Return A12: the probability that a run of `sample` beats one of `against`.

    Ties count half (Vargha and Delaney 2000).
    """
    ours, theirs = sample[..., :, None], against[..., None, :]
    return np.asarray(((ours > theirs) + 0.5 * (ours == theirs)).mean(axis=(-2, -1)))


def mean_superiority(*pairs: Floats) -> Floats:
    """Return the probability of improvement (Agarwal et al. 2021): mean A12, one pair per task."""
    each = [superiority(*pair) for pair in zip(pairs[::2], pairs[1::2], strict=True)]
    return np.asarray(np.mean(each, axis=0))


def interquartile_mean(*samples: Floats) -> Floats:
    """Return the mean of the middle half of a task's runs (IQM), averaged over the tasks.

    Agarwal et al. (2021) pool the runs of all tasks before they trim. With few tasks of unlike
    levels that trims whole tasks away and leaves only those in the middle.
    """
    return np.asarray(np.mean([stats.trim_mean(each, 0.25, axis=-1) for each in samples], axis=0))


def performance_profile(thresholds: npt.ArrayLike) -> Effect:
    """Return the effect "share of runs above each threshold", tasks weighing equally.

    This is the performance profile of Agarwal et al. (2021).
    """
    tau = np.asarray(thresholds, dtype=np.float64)

    def shares(*samples: Floats) -> Floats:
        each = [(sample[..., None, :] > tau[:, None]).mean(axis=-1) for sample in samples]
        return np.asarray(np.mean(each, axis=0))

    return shares


# --- Intervals ----------------------------------------------------------------------------------


def bootstrap(
    effect: Effect,
    samples: Sequence[Floats],
    random: np.random.Generator,
    resamples: int = RESAMPLES,
) -> Floats:
    """Return effects of resampled runs, float64[resamples, ...]; each sample is its own stratum."""
    drawn = [
        sample[random.integers(len(sample), size=(resamples, len(sample)))] for sample in samples
    ]
    return effect(*drawn)


def interval(
    replicates: Floats, seeds: int
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Return the expanded 95% percentile interval of replicates, along their first axis.

    For few seeds the plain percentile interval is too narrow: by about t sqrt(n / (n - 1)) / z for
    a mean. Quantiles further out by that factor correct it (Hesterberg 2015). `seeds` is n, of the
    smallest sample; NaN below two.
    """
    if seeds < 2:
        nothing = np.full(replicates.shape[1:], np.nan)
        return nothing, nothing
    t = stats.t.isf(ALPHA / 2, seeds - 1) * math.sqrt(seeds / (seeds - 1))
    tail = float(stats.norm.sf(t))
    low, high = np.quantile(replicates, [tail, 1 - tail], axis=0)
    return low, high


def estimate(
    effect: Effect,
    samples: Sequence[npt.ArrayLike],
    random: np.random.Generator,
    *,
    resamples: int = RESAMPLES,
) -> Estimate:
    """Return an effect with its stratified 95% bootstrap interval; NaN where a sample is empty."""
    arrays = [np.asarray(sample, dtype=np.float64) for sample in samples]
    seeds = min(len(array) for array in arrays)
    if not seeds:
        return Estimate(math.nan, math.nan, math.nan)
    value = float(effect(*arrays))
    if seeds < 2:
        return Estimate(value, math.nan, math.nan)
    low, high = interval(bootstrap(effect, arrays, random, resamples), seeds)
    return Estimate(value, float(low), float(high))


def mean_interval(values: Floats) -> tuple[Floats, Floats]:
    """Return Student's 95% interval of the mean over the last axis; NaN below two values."""
    if values.shape[-1] < 2:
        nothing = np.full(values.shape[:-1], np.nan)
        return nothing, nothing
    with warnings.catch_warnings(action="ignore"):  # of values that are all equal
        low, high = stats.ttest_1samp(values, 0.0, axis=-1).confidence_interval(1 - ALPHA)
    return np.asarray(low), np.asarray(high)


# --- Power --------------------------------------------------------------------------------------


def seeds_needed(superiority: float, *, alpha: float = ALPHA) -> float:
    """Return the seeds per method that the one-sided rank-sum test needs for an A12 (Noether 1987).

    With power `POWER`: (z_alpha + z_power)^2 / (6 (A12 - 1/2)^2), rounded up; infinite for no
    effect, NaN for an unknown one. An approximation, best for shifts of moderate size.
    """
    if math.isnan(superiority):
        return math.nan
    if superiority == 0.5:
        return math.inf
    z = stats.norm.isf(alpha) + stats.norm.isf(1 - POWER)
    return float(math.ceil(z**2 / (6 * (superiority - 0.5) ** 2)))


def _same(value: float, printed: float, digits: int) -> bool:
    return float(f"{value:.{digits - 1}e}") == printed
