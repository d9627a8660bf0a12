"""Levels of repeated looks at the same question, as seeds are added.

Looks are at 10, 20 and 30 seeds. The spending function of Lan and DeMets (1983) resembles O'Brien
and Fleming's bounds: an early look needs strong evidence, the last one hardly more than a single
test.
"""

import math
from functools import cache

import numpy as np
from scipy import optimize, stats

from neol.study.outcomes.statistics import ALPHA, Floats

LOOKS = (10, 20, 30)
"""Seeds of each method at each look."""


def look(seeds: int) -> int | None:
    """Return the last look, from 0 on, that has its seeds; None before the first."""
    done = [number for number, needed in enumerate(LOOKS) if seeds >= needed]
    return done[-1] if done else None


def level(number: int) -> float:
    """Return the two-sided level of one look's test; all looks together have `ALPHA`."""
    return nominal_levels(ALPHA)[number]


def overall_p(p: float, number: int) -> float:
    """Return the repeated p-value: the overall level at which this look just rejects.

    It is at most alpha with a probability of alpha, independent of when one stops (Jennison and
    Turnbull 2000, chapter 9). Holm's correction applies to it as to any p-value.
    """
    overall, at_look = _table()
    return float(np.exp(np.interp(math.log(max(p, 1e-300)), at_look[number], overall)))


@cache
def nominal_levels(alpha: float) -> tuple[float, ...]:
    """Return the level of each look's two-sided test; all together reject with `alpha`."""
    times = [seeds / LOOKS[-1] for seeds in LOOKS]
    # Each side spends its half of alpha, a, as 2 - 2 Phi(z_{a/2} / sqrt(t)).
    spent = [4 * stats.norm.sf(stats.norm.isf(alpha / 4) / math.sqrt(time)) for time in times]
    # The sum of evidence is a Brownian motion; `density` is that of paths not stopped before.
    positions, density = np.zeros(1), np.ones(1)
    levels, before = [], (0.0, 0.0)
    for time, total in zip(times, spent, strict=True):
        step = math.sqrt(time - before[0])

        def crossing(
            bound: float,
            positions: Floats = positions,
            density: Floats = density,
            step: float = step,
        ) -> float:
            beyond = stats.norm.sf((bound - positions) / step)
            beyond += stats.norm.sf((bound + positions) / step)
            return float(density @ beyond)

        more = total - before[1]
        bound = optimize.brentq(lambda at: crossing(at) - more, 0.0, 40 * step, xtol=1e-12)  # noqa: B023
        levels.append(float(2 * stats.norm.sf(bound / math.sqrt(time))))
        nodes, weights = np.polynomial.legendre.leggauss(64)
        reached = nodes * bound
        moves = stats.norm.pdf((reached[:, None] - positions[None, :]) / step) / step
        positions, density = reached, weights * bound * (moves @ density)
        before = time, total
    return tuple(levels)


@cache
def _table() -> tuple[Floats, Floats]:
    """Return logarithms of overall levels, and of the corresponding levels of each look."""
    overall = np.array([*np.geomspace(1e-12, 0.1, 45), *np.linspace(0.15, 0.95, 9), 1.0])
    levels = [nominal_levels(float(alpha)) for alpha in overall[:-1]] + [(1.0,) * len(LOOKS)]
    return np.log(overall), np.log(np.maximum(np.array(levels).T, 1e-300))
