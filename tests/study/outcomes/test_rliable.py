"""The estimators against those of Agarwal et al.'s own package (2021), on the same runs.

Its bootstrap does not run with an `arch` that runs with pandas 3: scipy's stands in for it, in
test_statistics.py.
"""

import numpy as np
import pytest
from rliable import library, metrics

from neol.study.outcomes.statistics import interquartile_mean, mean_superiority, performance_profile

RUNS, TASKS = 60, 4
OURS = np.random.default_rng(1).normal(0.3, 1, size=(RUNS, TASKS))
THEIRS = np.random.default_rng(2).normal(0, 1, size=(RUNS, TASKS))
THRESHOLDS = np.linspace(-1, 1, 5)
PAIRS = [column for pair in zip(OURS.T, THEIRS.T, strict=True) for column in pair]


def test_interquartile_mean() -> None:
    """Average theirs over tasks: pooled, it would trim the tasks that lie outside."""
    by_task = [metrics.aggregate_iqm(column[:, None]) for column in OURS.T]
    assert interquartile_mean(*OURS.T) == pytest.approx(np.mean(by_task))


def test_no_task_is_trimmed_away() -> None:
    """Two tasks far above and below two others: pooled, a change in them would not be seen."""
    apart = OURS + np.array([10, 0, 0, -10])
    better = apart + np.array([1, 0, 0, 1])
    assert metrics.aggregate_iqm(better) == pytest.approx(metrics.aggregate_iqm(apart))
    gain = interquartile_mean(*better.T) - interquartile_mean(*apart.T)
    assert gain == pytest.approx(0.5)


def test_probability_of_improvement() -> None:
    improvement = metrics.probability_of_improvement(OURS, THEIRS)
    assert mean_superiority(*PAIRS) == pytest.approx(improvement)


def test_performance_profile() -> None:
    theirs = [library.run_score_deviation(OURS, threshold) for threshold in THRESHOLDS]
    assert performance_profile(THRESHOLDS)(*OURS.T) == pytest.approx(theirs)
