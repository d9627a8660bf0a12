"""SCORE, the paper's measure of sample efficiency (Section 4.3), and two measures beside it.

SCORE adds up the best fitness of every generation and divides by M "samples". M is one constant
for all population sizes, so with P evaluations behind each term SCORE grows with P by construction.
The mean best-so-far fitness over equal numbers of evaluations, or of environment steps, does not.
"""

import numpy as np
import numpy.typing as npt

from neol.study.outcomes.statistics import Floats

PAPER_SAMPLES = 1e8
"""M of the paper's budget: the paper does not print it; only this constant fits Tables 2 and 8."""
PAPER_GENERATIONS = 500
PAPER_POPULATION = 300


def samples(generations: int, largest_population: int) -> float:
    """Return M of a budget: 1e8 scaled by its generations and largest population.

    Section 4.3 calls M "the multiple of the number of generations and the population". The paper's
    1e8 is 666.7 times its 500 x 300, and every budget's M is the same multiple of its own product.
    So the same mean best fitness at a budget's largest population is the same SCORE in every
    budget.
    """
    size = generations * largest_population
    return PAPER_SAMPLES * size / (PAPER_GENERATIONS * PAPER_POPULATION)


def score(best_fitness: npt.ArrayLike, population: int, samples: float) -> float:
    """Return SCORE of a run: P / M times the sum over its generations of the best fitness."""
    return float(population / samples * np.sum(best_fitness))


def best_so_far(best_fitness: npt.ArrayLike) -> Floats:
    """Return the highest fitness of all generations up to each one."""
    highest: Floats = np.maximum.accumulate(np.asarray(best_fitness, dtype=np.float64))
    return highest


def best_so_far_at(
    points: npt.ArrayLike, best_fitness: npt.ArrayLike, spent: npt.ArrayLike
) -> Floats:
    """Return the best-so-far fitness after `points` evaluations (or steps): a step function.

    `spent` is the total after each generation: it counts once it is complete. NaN before the first.
    """
    index = np.searchsorted(np.asarray(spent), np.asarray(points), side="right")
    return np.concatenate([[np.nan], best_so_far(best_fitness)])[index]


def mean_best_so_far(
    best_fitness: npt.ArrayLike, spent: npt.ArrayLike, first: float, last: float
) -> float:
    """Return the mean best-so-far fitness between `first` and `last` evaluations (or steps).

    It is the exact area under the step function divided by its width. NaN where there is no such
    range, or where the run has no value at its beginning or none at its end.
    """
    spent = np.asarray(spent, dtype=np.float64)
    if not first < last or first < spent[0] or last > spent[-1]:
        return float("nan")
    inside = spent[(spent > first) & (spent < last)]
    edges = np.concatenate([[first], inside, [last]])
    heights = best_so_far_at(edges[:-1], best_fitness, spent)
    return float(np.sum(heights * np.diff(edges)) / (last - first))
