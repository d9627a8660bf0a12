"""The levels of each look."""

import numpy as np
import pytest
from scipy import stats

from neol.study.claims.looks import LOOKS, level, look, nominal_levels, overall_p


def test_levels_are_the_published_ones() -> None:
    """Lan and DeMets' bounds for three equal looks at 0.05, as their program prints them."""
    bounds = [stats.norm.isf(level(number) / 2) for number in range(3)]
    assert bounds == pytest.approx([3.7103, 2.5114, 1.9930], abs=1e-4)


@pytest.mark.parametrize(("seeds", "number"), [(9, None), (10, 0), (19, 0), (20, 1), (31, 2)])
def test_a_look_needs_its_seeds(seeds: int, number: int | None) -> None:
    assert look(seeds) == number


def test_looking_three_times_rejects_as_often_as_it_says() -> None:
    random = np.random.default_rng(0)
    evidence = random.standard_normal((200_000, LOOKS[-1])).cumsum(axis=1)
    z = np.array([evidence[:, seeds - 1] / np.sqrt(seeds) for seeds in LOOKS])
    bounds = np.array([stats.norm.isf(each / 2) for each in nominal_levels(0.05)])
    rejected = (np.abs(z) > bounds[:, None]).any(axis=0).mean()
    assert rejected == pytest.approx(0.05, abs=0.002)
    plain = (np.abs(z) > stats.norm.isf(0.025)).any(axis=0).mean()
    assert plain > 0.09  # what the plan pays for


@pytest.mark.parametrize("alpha", [0.05, 0.01, 0.05 / 11])
@pytest.mark.parametrize("number", range(3))
def test_the_overall_p_inverts_the_levels(alpha: float, number: int) -> None:
    assert overall_p(nominal_levels(alpha)[number], number) == pytest.approx(alpha, rel=5e-3)


def test_an_early_look_counts_less() -> None:
    assert overall_p(0.001, 0) > overall_p(0.001, 1) > overall_p(0.001, 2) > 0.001
    assert overall_p(1.0, 0) == pytest.approx(1.0)
