"""Compare a reading's NEAT and NEAT (w/o) with the paper's: docs/readings-plan.md.

The paper prints four means with their standard deviations: the final best fitness and, as SCORE,
the mean over generations, of both baselines on Lunar Lander at P = 300. A number is compatible if
it lies in the 99% predictive interval that our runs give for 30 further ones.
"""

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd
from scipy import stats

from neol.base.errors import UserError
from neol.network.rules import BASELINES
from neol.run.record import column_values
from neol.spec.configuration import load_configuration
from neol.study.campaign.grid import RESULTS, run_specs
from neol.study.campaign.search import baseline_blocks, source
from neol.study.outcomes.campaign_runs import SECONDS_IN_AN_HOUR, Source
from neol.study.outcomes.paper_numbers import PAPER_SEEDS, PRINTED_IN, values
from neol.study.outcomes.score import (
    PAPER_GENERATIONS,
    PAPER_POPULATION,
    PAPER_SAMPLES,
    best_so_far,
)
from neol.study.outcomes.statistics import Floats

TASK = "lunar_lander"
COUNTINGS = ("of the generation", "so far")
"""Two ways to count best fitness: each generation's (the paper's formula), or the best so far."""
QUANTITIES = ("final", "mean")
"""Best fitness in the last generation, and averaged over generations."""
LEVEL = 0.99
_OUTCOMES = {"final": "final_best", "mean": "score"}
"""The outcome from whose printed values each quantity follows: SCORE is a mean in other units."""


def paper_number(method: str, quantity: str) -> tuple[float, float]:
    """Return the paper's mean and standard deviation over its 30 seeds."""
    mean, sd = values(PRINTED_IN[_OUTCOMES[quantity], method])[TASK, method]
    assert sd is not None
    unit = PAPER_SAMPLES / (PAPER_POPULATION * PAPER_GENERATIONS) if quantity == "mean" else 1.0
    return mean * unit, sd * unit


def predictive_mean(sample: Floats) -> tuple[float, float]:
    """Return the predictive interval of the mean of `PAPER_SEEDS` further runs (normal theory)."""
    n = len(sample)
    t = stats.t.ppf((1 + LEVEL) / 2, n - 1)
    reach = t * sample.std(ddof=1) * math.sqrt(1 / n + 1 / PAPER_SEEDS)
    return float(sample.mean() - reach), float(sample.mean() + reach)


def predictive_sd(sample: Floats) -> tuple[float, float]:
    """Return the predictive interval of the standard deviation of `PAPER_SEEDS` further runs."""
    tails = (1 - LEVEL) / 2, (1 + LEVEL) / 2
    ratios = stats.f.ppf(tails, PAPER_SEEDS - 1, len(sample) - 1)
    low, high = sample.std(ddof=1) * np.sqrt(ratios)
    return float(low), float(high)


def comparisons(
    readings: Sequence[str], budget: str, results: Path = RESULTS
) -> tuple[pd.DataFrame, tuple[Source, ...], float]:
    """Compare each number of each reading with the paper's: a table, the records, their core-hours.

    Columns: `reading`, `counting`, `method`, `quantity`; `seeds`, the number of runs;
    their `mean` and `sd` with the predictive intervals `mean_low`, `mean_high`, `sd_low` and
    `sd_high`; the paper's `paper_mean` and `paper_sd`; `distance`, |mean - paper_mean| / paper_sd;
    `fitting`, how many of the paper's two numbers lie in their intervals, and `compatible`,
    whether both do. Fewer than two runs give NaN and are not compatible. Raises UserError as
    `Source.read` does.
    """
    rows, sources, seconds = [], dict[str, Source](), dict[str, float]()
    for reading in readings:
        for method in BASELINES:
            curves, read, spent = _curves(reading, method, budget, results)
            sources |= {each.path: each for each in read}
            seconds |= spent
            for counting in COUNTINGS:
                counted = curves if counting == COUNTINGS[0] else [*map(best_so_far, curves)]
                for quantity in QUANTITIES:
                    of_runs = np.array(
                        [curve[-1] if quantity == "final" else curve.mean() for curve in counted]
                    )
                    place = reading, counting, method, quantity
                    rows.append((*place, *_compare(of_runs, *paper_number(method, quantity))))
    intervals = ["mean_low", "mean_high", "sd_low", "sd_high"]
    columns = ["reading", "counting", "method", "quantity", "seeds", "mean", "sd", *intervals]
    columns += ["paper_mean", "paper_sd", "distance", "fitting"]
    table = pd.DataFrame(rows, columns=columns)
    table["compatible"] = table["fitting"] == 2
    return table, tuple(sources.values()), sum(seconds.values()) / SECONDS_IN_AN_HOUR


def ranking(table: pd.DataFrame, seeds: int) -> pd.DataFrame:
    """Rank readings by their distance, nearest first: a row for each reading and counting.

    `distance` is the largest of a reading's four, `fitting` how many of the paper's eight numbers
    fit, and `compatible` whether all do.
    A reading is left out where a baseline has fewer than `seeds` runs.
    """
    grouped = table.groupby(["reading", "counting"], sort=False)
    summary = {"seeds": "min", "distance": "max", "fitting": "sum", "compatible": "all"}
    rows = grouped.agg(summary).reset_index()
    return rows[rows["seeds"] >= seeds].sort_values("distance", kind="stable", ignore_index=True)


def to_confirm(ranked: pd.DataFrame, always: str, count: int = 3) -> list[str]:
    """Return the `count` nearest readings, by the smaller of their two distances, and `always`.

    If `always` is among them, one more reading is taken.
    """
    nearest = list(dict.fromkeys(ranked["reading"]))
    chosen = nearest[: count + (always in nearest[:count])]
    return list(dict.fromkeys([*chosen, always]))


def _curves(
    reading: str, method: str, budget: str, results: Path
) -> tuple[list[Floats], list[Source], dict[str, float]]:
    """Return each run's best fitness by generation, the records, and the CPU seconds of each."""
    curves: list[Floats] = []
    sources: list[Source] = []
    spent: dict[str, float] = {}
    configuration = load_configuration(budget, reading=source(reading, method))
    for block in baseline_blocks(reading, method, budget):
        path = results / block.record
        if not path.exists():
            continue
        record, read = Source.read(results, block.record, run_specs(configuration, block)[0])
        if [info.seed for info in record.seeds] != list(block.seeds):
            raise UserError(f"{path}: does not hold the seeds that its name says")
        best, seed = (column_values(record.table, name) for name in ("best_fitness", "seed"))
        curves += [best[seed == info.seed] for info in record.seeds]
        sources.append(read)
        spent[read.path] = sum(info.cpu_seconds for info in record.seeds)
    return curves, sources, spent


def _compare(sample: Floats, paper_mean: float, paper_sd: float) -> tuple[float, ...]:
    """Return the columns of `comparisons` for one number, from `seeds` on."""
    seeds = len(sample)
    mean = float(sample.mean()) if seeds else math.nan
    distance = abs(mean - paper_mean) / paper_sd
    if seeds < 2:
        return seeds, mean, *[math.nan] * 5, paper_mean, paper_sd, distance, 0
    means, sds = predictive_mean(sample), predictive_sd(sample)
    fitting = (means[0] <= paper_mean <= means[1]) + (sds[0] <= paper_sd <= sds[1])
    sd = float(sample.std(ddof=1))
    return seeds, mean, sd, *means, *sds, paper_mean, paper_sd, distance, fitting
