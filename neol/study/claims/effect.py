"""Effects made of means and standard deviations: what the paper prints is enough to compute them.

A `Summary` holds the moments of a cell's runs, ours or the paper's. A contrast of summaries is an
`Effect`: a value with its standard error, from which intervals, tests and predictions follow by
normal theory with unequal variances (Welch 1947).
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Literal

import numpy as np
from scipy import optimize, stats

from neol.study.outcomes.contrasts import Difference
from neol.study.outcomes.statistics import Floats

Statistic = Literal["mean", "spread"]
Scale = Literal["raw", "sd", "relative"]
TELESCOPE_POWER = 1 / 3


@dataclass(frozen=True, slots=True)
class Effect(Difference):
    """A difference, or a contrast of more than two averages."""

    def predicts(self, other: "Effect", alpha: float) -> bool:
        """Return whether another study's effect lies where this one predicts it."""
        low, high = combined([(1, other), (-1, self)]).interval(1 - alpha)
        return low <= 0 <= high

    @property
    def telescope(self) -> float:
        """Return the effect that this effect's study would have detected with a power of one third.

        The test is a two-sided t-test at 0.05 (Simonsohn 2015). A smaller effect is too small for
        the study to have been evidence of it.
        """
        return self.error * _noncentrality(round(self.degrees, 3))


@dataclass(frozen=True, slots=True)
class Summary:
    """Moments of one side of a comparison, averaged over its cells.

    `spread` is the logarithm of the standard deviation, None where the runs of a cell do not vary
    or it is not needed; `sd` is the standard deviation itself, averaged as variance.
    """

    mean: Effect
    spread: Effect | None
    sd: float

    @classmethod
    def of_runs(cls, values: Floats, *, spread: bool = False) -> "Summary":
        """Summarise our runs, float64[cells, n] with n >= 3, seeds in the same order in each cell.

        A seed's runs are averaged first, so that what they share does not make the average look
        more certain than it is. The spread, if needed, has the jackknife's error.
        """
        means = values.mean(axis=0)
        n, variances = len(means), values.var(axis=1, ddof=1)
        error = float(np.std(means, ddof=1)) / math.sqrt(n)
        spreads = average([*map(_log_sd, values)]) if spread and variances.all() else None
        return cls(Effect(float(means.mean()), error, n - 1), spreads, math.sqrt(variances.mean()))

    @classmethod
    def printed(cls, cells: Sequence[tuple[float, float]], n: int) -> "Summary":
        """Summarise the paper's means and deviations; the spread's error is normal theory's."""
        means = [Effect(mean, sd / math.sqrt(n), n - 1) for mean, sd in cells]
        sds = [sd for _, sd in cells]
        error = 1 / math.sqrt(2 * (n - 1))
        spread = average([Effect(math.log(sd), error, n - 1) for sd in sds]) if all(sds) else None
        return cls(average(means), spread, math.sqrt(np.mean(np.square(sds))))


def difference(
    ours: Summary, theirs: Summary, statistic: Statistic = "mean", scale: Scale = "raw"
) -> Effect | None:
    """Return one side minus the other; None where it is not defined.

    `sd` divides it by the standard deviation of a run, averaged as variance over both sides;
    `relative` by the other side's size. Both propagate the divisor's error.
    """
    if statistic == "spread":
        if ours.spread is None or theirs.spread is None:
            return None
        return combined([(1, ours.spread), (-1, theirs.spread)])
    if scale == "relative":
        return _relative(ours.mean, theirs.mean)
    raw = combined([(1, ours.mean), (-1, theirs.mean)])
    return raw if scale == "raw" else _standardised(raw, ours, theirs)


def average(effects: Sequence[Effect]) -> Effect:
    """Return the average of independent effects."""
    return combined([(1 / len(effects), effect) for effect in effects])


def combined(terms: Iterable[tuple[float, Effect]]) -> Effect:
    """Return a weighted sum of independent effects, with Satterthwaite's degrees of freedom."""
    terms = list(terms)
    value = sum(weight * effect.value for weight, effect in terms)
    variances = [(weight * effect.error) ** 2 for weight, effect in terms]
    total = sum(variances)
    if not total:
        return Effect(value, 0.0, min(effect.degrees for _, effect in terms))
    shares = [
        (part / total) ** 2 / effect.degrees
        for part, (_, effect) in zip(variances, terms, strict=True)
    ]
    return Effect(value, math.sqrt(total), 1 / sum(shares))


def _standardised(raw: Effect, ours: Summary, theirs: Summary) -> Effect | None:
    variance = (ours.sd**2 + theirs.sd**2) / 2
    if not variance:
        return raw if raw.value == 0 else None
    doubt = sum(each.sd**4 / (2 * each.mean.degrees) for each in (ours, theirs))
    sd = math.sqrt(variance)
    value = raw.value / sd
    error = math.hypot(raw.error / sd, value * math.sqrt(doubt) / (2 * variance))
    return Effect(value, error, raw.degrees)


def _relative(ours: Effect, theirs: Effect) -> Effect | None:
    if not theirs.value:
        return None
    size = abs(theirs.value)
    slopes = [(1 / size, ours), (-ours.value / (theirs.value * size), theirs)]
    error = combined(slopes)
    return Effect((ours.value - theirs.value) / size, error.error, error.degrees)


def _log_sd(values: Floats) -> Effect:
    """Return the logarithm of the standard deviation with the jackknife's error (Miller 1968)."""
    n = len(values)
    variance = np.var(values, ddof=1)
    squares = (values - np.mean(values)) ** 2
    without = ((n - 1) * variance - n / (n - 1) * squares) / (n - 2)
    with np.errstate(divide="ignore"):
        each = 0.5 * np.log(np.maximum(without, 1e-12 * variance))
    error = math.sqrt((n - 1) / n * float(np.sum((each - each.mean()) ** 2)))
    return Effect(0.5 * math.log(variance), error, n - 1)


@cache
def _noncentrality(degrees: float) -> float:
    """Return the effect, in standard errors, that a two-sided t-test at 0.05 detects 1 in 3."""
    critical = float(stats.t.isf(0.025, degrees))

    def missing(size: float) -> float:
        return float(stats.nct.sf(critical, degrees, size)) - TELESCOPE_POWER

    return float(optimize.brentq(missing, 0.0, 4.0))
