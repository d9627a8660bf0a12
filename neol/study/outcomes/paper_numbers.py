"""The paper's own numbers, as transcribed in paper/reference/."""

import math
from collections.abc import Iterable
from functools import cache

from neol.study.campaign.reference import optional, printed_rows
from neol.study.outcomes.contrasts import Moments
from neol.study.outcomes.statistics import paper_statistic

PAPER_SEEDS = 30
"""Seeds of each method in the paper."""
PRINTED_IN = {
    ("final_best", "neat"): 1,
    ("score", "neat"): 2,
    ("final_best", "neat_wo"): 7,
    ("score", "neat_wo"): 8,
}
"""The paper's table of means by outcome and baseline."""

_TWO_SIDED = (
    "The caption describes the one-sided test, but the paper's p-values are two-sided: with normal "
    "approximation and continuity correction, each (but CartPole's, where values tie) is that of "
    "exactly one U at 30 against 30 seeds. The one-sided p-values are half of them"
)

CONTRADICTIONS = {
    1: (
        "The paper's own Table 1 beside its words: the abstract promises higher final returns on "
        "four benchmarks, but on CartPole all means are 500; it promises tighter variability, but "
        "on Bipedal Walker BCM and Oja deviate more than NEAT; and Section A.8.1 puts NEAT on "
        "Bipedal Walker between 130 and 180, where the table has 183.36.",
    ),
    2: (
        "The paper does not print M; 1e8 is the one constant that fits its Tables 2 and 8. Section "
        '4.3 calls M "the multiple of the number of generations and the population": with that '
        "product SCORE would be the mean best fitness, about 497 on CartPole, not 0.745. With one "
        "M for all populations SCORE grows with the population by construction.",
    ),
    3: (
        "On Bipedal Walker the paper's NEAT stands at population 100, BCM and Oja at 300: Tables 1 "
        "and 5 compare 50,000 evaluations with 150,000.",
    ),
    4: (
        "The paper's Table 7 prints for Hebb on Bipedal Walker the value of Table 1, where its "
        "population is 200, not 300. Table 8 prints SCOREs that no population of 50 can reach.",
    ),
    5: (
        f"{_TWO_SIDED}: 2.87e-2 for Hebb on Hopper. So Section 4.2, p < 0.05 for all rules on all "
        "three tasks, contradicts the printed 5.746e-2, but not the test that it names.",
    ),
    6: (
        f"{_TWO_SIDED}. The abstract calls the improvements significant without exception; Hebb on "
        "Bipedal Walker is not. The caption says that final values were tested, as Table 5's does.",
    ),
    7: (
        "The captions of Tables 7 and 8 make NEAT (w/o) by a learning rate of 0, Section A.5 by "
        "disabling weight mutation: here both hold.",
        "In the paper NEAT (w/o) is above full NEAT (Table 1) on Lunar Lander and Bipedal Walker. "
        "Hebb on Bipedal Walker has the value of Table 1 (population 200); Table 4 says 300.",
    ),
    8: (
        "Table 4 gives CartPole a population of 50, whose SCORE cannot exceed 0.125: the paper's "
        "values are those of Table 2, at 300. Section 4.4 sees consistent gains and A.5 has NEAT "
        "(w/o) trail, but on Bipedal Walker Hebb is lower.",
    ),
}
"""Contradictions of the paper's numbers with its words or each other, by table."""


@cache
def values(table: int) -> dict[tuple[str, str], tuple[float, float | None]]:
    """Return value and deviation by task and column of Tables 1, 2, 5-8; a p-value has none."""
    return {
        (row["task"], row["column"]): (float(row["value"]), optional(row["sd"]))
        for row in printed_rows("tables", table)
    }


def moments(tables: Iterable[int], task: str) -> dict[str, Moments]:
    """Return each method's mean and deviation on a task, from the first table that has it."""
    found: dict[str, Moments] = {}
    for table in tables:
        for (of, method), (mean, sd) in values(table).items():
            if of == task and sd is not None:
                found.setdefault(method, Moments(PAPER_SEEDS, mean, sd))
    return found


def paper_a12(table: int, task: str, method: str) -> float:
    """Return A12 of a rule against NEAT, from its p-value in Table 5 or 6: U over 30 x 30 pairs.

    NaN where the table has no p-value, or not exactly one U has it.
    """
    p, _ = values(table).get((task, f"{method}_vs_neat"), (math.nan, None))
    u = paper_statistic(p, digits=4 if table == 5 else 3, seeds=PAPER_SEEDS)
    return math.nan if u is None else u / PAPER_SEEDS**2
