import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from neol.study.outcomes.score import best_so_far, best_so_far_at, mean_best_so_far, samples, score


def test_score_by_hand() -> None:
    assert score([1.0, 2.0, 4.0], population=10, samples=100.0) == pytest.approx(0.7)


@pytest.mark.parametrize(("population", "printed"), [(50, 0.12), (300, 0.75)])
def test_score_has_the_papers_scale(population: int, printed: float) -> None:
    """CartPole at its ceiling has 0.12 at P = 50; its bound at P = 300 is 0.75 (A.8.2)."""
    solved = np.full(500, 500.0)
    assert score(solved, population, samples(500, 300)) == pytest.approx(printed, abs=0.006)


def test_samples_is_the_papers_and_keeps_scores_comparable() -> None:
    assert samples(500, 300) == 1e8
    paper = score(np.full(500, 250.0), 300, samples(500, 300))
    assert score(np.full(40, 250.0), 100, samples(40, 100)) == pytest.approx(paper, rel=1e-12)


def test_best_so_far_never_falls() -> None:
    assert best_so_far([1.0, 3.0, 2.0]).tolist() == [1.0, 3.0, 3.0]


def test_step_function_jumps_when_a_generation_is_complete() -> None:
    values = best_so_far_at([9, 10, 19, 20, 99], best_fitness=[1.0, 3.0], spent=[10, 20])
    assert np.isnan(values[0])
    assert values[1:].tolist() == [1.0, 1.0, 3.0, 3.0]


def test_mean_best_so_far_by_hand() -> None:
    # 1 from 10 to 20, 3 from 20 to 40: (1 * 5 + 3 * 15) / 20 between 15 and 35
    assert mean_best_so_far([1.0, 3.0, 2.0], [10, 20, 40], first=15, last=35) == pytest.approx(2.5)


@pytest.mark.parametrize(("first", "last"), [(9, 20), (10, 41), (20, 20), (30, 20)])
def test_mean_best_so_far_is_nan_outside_of_the_run(first: float, last: float) -> None:
    assert np.isnan(mean_best_so_far([1.0, 3.0, 2.0], [10, 20, 40], first, last))


@given(st.lists(st.floats(-1e3, 1e3), min_size=2, max_size=20), st.integers(1, 50))
def test_mean_best_so_far_does_not_depend_on_how_runs_are_cut_into_generations(
    best: list[float], size: int
) -> None:
    """Generations split in two, each half with the whole's best, are the same curve."""
    spent = size * np.arange(1, len(best) + 1)
    whole = mean_best_so_far(best, spent, spent[0], spent[-1])
    halves = np.sort(np.concatenate([spent, spent + size / 2]))
    split = mean_best_so_far(np.repeat(best, 2), halves, spent[0], spent[-1])
    assert split == pytest.approx(whole)
