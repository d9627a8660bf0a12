"""The rules of parts that are no comparison of two averages: ranks, shares, sensitivity."""

from collections.abc import Sequence
from typing import Literal

import numpy as np
from scipy import stats

from neol.study.claims.effect import Effect, combined
from neol.study.outcomes.statistics import Floats

State = Literal["for", "against", "open"]
"""What is sure of a part: that it is as the paper says, that it is not, or neither."""


def ranked(leads: Sequence[Effect], at_most: int, alpha: float) -> State:
    """Whether a method surely has, or surely lacks, a rank, by its leads over its rivals.

    It has it if at least so many rivals lie below; the p-value of that is the partial conjunction's
    (Benjamini and Heller 2008), which pays for the rivals being picked by the same runs.
    """
    rivals = len(leads)
    below = sorted(_one_sided(lead) for lead in leads)
    above = sorted(_one_sided(combined([(-1, lead)])) for lead in leads)
    enough = rivals + 1 - at_most
    if (rivals - enough + 1) * below[enough - 1] < alpha / 2:
        return "for"
    return "against" if (rivals - at_most + 1) * above[at_most - 1] < alpha / 2 else "open"


def share_state(reached: int, runs: int, share: float, alpha: float) -> State:
    """Whether at least this share of runs surely reaches a level (Clopper and Pearson 1934)."""
    low = stats.beta.ppf(alpha, reached, runs - reached + 1) if reached else 0.0
    high = stats.beta.isf(alpha, reached + 1, runs - reached) if reached < runs else 1.0
    return "for" if low >= share else "against" if high < share else "open"


def between_rates(values: Floats) -> float:
    """Variance of a mean between learning rates, without what noise adds to it.

    float64[rates, seeds]. The product of two different seeds' deviations has that variance as its
    expectation, whatever the noise; this is its mean over all pairs of seeds.
    """
    deviations = values - values.mean(axis=0)
    rates, seeds = values.shape
    total = deviations.sum(axis=1)
    products = total @ total - np.sum(deviations**2)
    return float(products / (seeds * (seeds - 1) * (rates - 1)))


def _one_sided(effect: Effect) -> float:
    return effect.p() / 2 if effect.value > 0 else 1 - effect.p() / 2
