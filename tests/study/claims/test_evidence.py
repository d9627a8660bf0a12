"""Evidence on a question: choices, ranks, shares and sensitivity."""

import numpy as np
import pytest
from scipy import stats

from neol.study.campaign.grid import Cell
from neol.study.claims.effect import Effect
from neol.study.claims.parts import between_rates, ranked, share_state
from neol.study.claims.sides import Choice

CELLS = tuple(Cell("hopper", "bcm", 300, rate) for rate in (0.00025, 0.0025, 0.025, 0.25))


def test_the_best_cell_is_chosen_by_the_even_seeds_and_tested_on_the_odd_ones() -> None:
    values = dict.fromkeys(CELLS, np.zeros(6))
    values[CELLS[2]] = np.array([9.0, 1.0, 9.0, 2.0, 9.0, 3.0])
    values[CELLS[3]] = np.array([0.0, 50.0, 0.0, 50.0, 0.0, 50.0])
    assert Choice(CELLS, one_of=True, papers=True).values(values).tolist() == [[1.0, 2.0, 3.0]]
    assert Choice(CELLS[:1], one_of=True, papers=True).values(values).shape == (1, 6)
    assert Choice(CELLS, one_of=False, papers=True).values(values).shape == (4, 6)


def test_choosing_the_best_of_four_supports_nothing_more_often_than_it_says() -> None:
    """Choosing on the tested seeds, as the old rule did, would give 0.14 to 0.16."""
    random = np.random.default_rng(0)
    choice, split, same = Choice(CELLS, one_of=True, papers=True), 0, 0
    for _ in range(3000):
        values = dict(zip(CELLS, random.standard_normal((4, 30)), strict=True))
        against = random.standard_normal(30)
        (tested,) = choice.values(values)
        split += (
            stats.ttest_ind(tested, against, equal_var=False, alternative="greater").pvalue < 0.05
        )
        best = max(values.values(), key=np.mean)
        same += stats.ttest_ind(best, against, equal_var=False, alternative="greater").pvalue < 0.05
    assert split / 3000 == pytest.approx(0.05, abs=0.012)
    assert same / 3000 > 0.1


@pytest.mark.parametrize("noise", [1.0, 2.0])
def test_noise_is_no_sensitivity(noise: float) -> None:
    """The range of the means grows with noise; this does not."""
    random = np.random.default_rng(1)
    found = [between_rates(random.normal(0, noise, (4, 10))) for _ in range(4000)]
    assert np.mean(found) == pytest.approx(0, abs=0.012 * noise**2)
    effects = np.array([[0.0], [1.0], [2.0], [3.0]])
    found = [between_rates(effects + random.normal(0, noise, (4, 10))) for _ in range(4000)]
    assert np.mean(found) == pytest.approx(effects.var(ddof=1), abs=0.06 * noise)


def lead(value: float) -> Effect:
    return Effect(value, 1.0, 1e6)


@pytest.mark.parametrize(
    ("leads", "at_most", "state"),
    [
        ((5.0, 5.0, 5.0), 1, "for"),
        ((5.0, 5.0, 1.0), 1, "open"),
        ((5.0, 5.0, -5.0), 1, "against"),
        ((5.0, 5.0, -5.0), 2, "for"),
        ((5.0, -5.0, -5.0), 2, "against"),
        ((5.0, 1.0, -5.0), 2, "open"),
        ((2.1, 2.1, 0.0), 2, "open"),  # 0.018 each, but the rivals were picked
    ],
)
def test_a_rank_is_sure_only_if_enough_rivals_are(
    leads: tuple[float, ...], at_most: int, state: str
) -> None:
    assert ranked([lead(each) for each in leads], at_most, 0.05) == state


def test_a_rank_among_equals_is_seldom_sure() -> None:
    random = np.random.default_rng(2)
    sure = 0
    for _ in range(4000):
        first, *others = random.standard_normal(4)
        leads = [Effect(first - other, np.sqrt(2), 1e6) for other in others]
        sure += ranked(leads, 2, 0.05) == "for"
    assert sure / 4000 <= 0.025


@pytest.mark.parametrize(
    ("reached", "runs", "state"),
    [(30, 30, "for"), (29, 30, "open"), (10, 10, "open"), (20, 30, "against"), (0, 30, "against")],
)
def test_a_share_is_sure_by_its_exact_interval(reached: int, runs: int, state: str) -> None:
    assert share_state(reached, runs, 0.9, 0.0463) == state
