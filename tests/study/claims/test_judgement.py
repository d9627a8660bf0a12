"""The levels at which parts of claims are decided."""

import numpy as np
import pytest
from scipy import stats

from neol.study.claims.judgement import DecisionRule, Judgement, by_interval, by_rank_sum, by_share
from neol.study.outcomes.statistics import mean_difference, seeds_needed
from tests.helpers.claimed import around


def judged(rule: DecisionRule, *means: float, alpha: float = 0.05) -> Judgement:
    """Of samples around these means."""
    samples = [np.array(around(mean)) for mean in means]
    return rule(samples, np.random.default_rng(0), alpha)


def test_of_several_cells_each_must_lead_the_more_surely() -> None:
    """Welch's half-widths are 1.31 at 5% and 1.54 at 2.5%: the lead lies between."""
    assert judged(by_share(0.5), 1.4, 0).right
    assert not judged(by_share(0.5), 1.4, 0, 1.4, 0).right
    assert judged(by_share(0.5), 1.6, 0, 1.6, 0).right


def test_a_contradiction_of_one_of_many_cells_uses_the_claims_level() -> None:
    assert judged(by_share(0.5), 0, 1.4).wrong
    assert not judged(by_share(0.5), 0, 1.4, alpha=0.01).wrong


@pytest.mark.parametrize(
    ("means", "picked", "alpha", "level"),
    [
        ((1, 0), (4, 1), 0.05, 0.05 / 4),
        ((0, 1), (1, 4), 0.02, 0.02 / 4),
        ((1, 0), (1, 4), 0.02, 0.05),
    ],
)
def test_seeds_needed_use_the_level_that_decides(
    means: tuple[float, float], picked: tuple[int, int], alpha: float, level: float
) -> None:
    plain = judged(by_interval(mean_difference), 1, 0).needed
    here = judged(by_interval(mean_difference, picked=picked), *means, alpha=alpha).needed
    z = [stats.norm.isf(each / 2) + stats.norm.isf(0.2) for each in (level, 0.05)]
    assert here == pytest.approx(plain * (z[0] / z[1]) ** 2, rel=0.15)  # both are rounded up


def test_seeds_needed_to_contradict_significance_use_the_claims_level() -> None:
    worse = judged(by_rank_sum(differs=True), 0, 1, alpha=0.01)
    assert worse.needed == seeds_needed(worse.effect + 0.5, alpha=0.01)
    assert worse.needed > seeds_needed(worse.effect + 0.5)
