"""Rules for parts that do not compare two averages: ranks, shares, sensitivity."""

from collections.abc import Sequence
from typing import Literal

import numpy as np
from scipy import stats

from neol.study.claims.effect import Effect, combined
from neol.study.outcomes.statistics import Floats

State = Literal["for", "against", "open"]
"""State of a part: significantly as the paper says, significantly not, or neither."""


def ranked(leads: Sequence[Effect], at_most: int, alpha: float) -> State:
    """Return whether a method significantly has, or lacks, a rank, by its leads over its rivals.

    It has the rank if enough rivals are lower. The p-value is that of the partial conjunction
    (Benjamini and Heller 2008), which accounts for picking the rivals by the same runs.
    """
    rivals = len(leads)
    below = sorted(_one_sided(lead) for lead in leads)
    above = sorted(_one_sided(combined([(-1, lead)])) for lead in leads)
    enough = rivals + 1 - at_most
    if (rivals - enough + 1) * below[enough - 1] < alpha / 2:
        return "for"
    return "against" if (rivals - at_most + 1) * above[at_most - 1] < alpha / 2 else "open"


def share_state(reached: int, runs: int, share: float, alpha: float) -> State:
    """Return whether at least this share of runs reaches a level (Clopper and Pearson 1934)."""
    low = stats.beta.ppf(alpha, reached, runs - reached + 1) if reached else 0.0
    high = stats.beta.isf(alpha, reached + 1, runs - reached) if reached < runs else 1.0
    return "for" if low >= share else "against" if high < share else "open"


def between_rates(values: Floats) -> float:
    """Return the variance of a mean between learning rates, without the contribution of noise.

    `values` is float64[rates, seeds]. The expected product of two different seeds' deviations is
    that variance, independent of the noise; the result is its mean over all pairs of seeds.
    """
    deviations = values - values.mean(axis=0)
    rates, seeds = values.shape
    total = deviations.sum(axis=1)
    products = total @ total - np.sum(deviations**2)
    return float(products / (seeds * (seeds - 1) * (rates - 1)))


def _one_sided(effect: Effect) -> float:
    return effect.p() / 2 if effect.value > 0 else 1 - effect.p() / 2
