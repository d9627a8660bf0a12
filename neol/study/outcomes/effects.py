"""What the paper does not show: effect sizes, aggregates, equal cost, selection bias.

Each function makes a table from a budget's outcomes; `effect_figures` draws it. Seeds are the
units. Cells are taken as independent samples of them, which they are not wholly: a seed gives all
methods the same episodes and, as far as their sizes agree, the same first population. As far as
that makes their runs alike, the intervals of a difference are too wide rather than too narrow.
"""

import math
from collections.abc import Sequence
from functools import cache
from typing import NamedTuple

import gymnasium
import numpy as np
import pandas as pd

from neol.spec.configuration import load_configuration
from neol.spec.constants import Budget
from neol.study.campaign.methods import challengers, shown_methods
from neol.study.outcomes import paper_numbers
from neol.study.outcomes.outcomes import EQUAL, Metric, Outcomes, Setting
from neol.study.outcomes.statistics import (
    Effect,
    Floats,
    bootstrap,
    estimate,
    holm,
    interquartile_mean,
    interval,
    mean_interval,
    mean_superiority,
    performance_profile,
    rank_sum,
    seeds_needed,
    superiority,
)

ABLATION = "neat_wo"
FITNESS, SCORE, HELD_OUT = OUTCOMES = "final fitness", "SCORE", "held-out return"
"""What methods are compared by."""


class Family(NamedTuple):
    """Each rule, and NEAT (w/o) unless it is the other side, against a method on each task."""

    outcome: str
    setting: Setting
    metric: Metric
    against: str
    declared: bool
    """Whether its tests of rules are of the declared family, of which Holm's correction is."""
    paper_table: int | None = None
    """The paper's p-values of the same comparison."""

    def methods(self, budget: Budget) -> tuple[str, ...]:
        """Those that are compared."""
        return challengers(budget) + (() if self.against == ABLATION else (ABLATION,))


COMPARISONS = (
    Family(FITNESS, "table3", "final_best", "neat", True, 5),
    Family(SCORE, "score", "score", "neat", True, 6),
    Family(HELD_OUT, "table3", "held_out", "neat", False),
    Family(FITNESS, "table4", "final_best", ABLATION, True),
    Family(SCORE, "score", "score", ABLATION, True),
    Family(HELD_OUT, "table4", "held_out", ABLATION, False),
)
"""Four of three rules on four tasks make the declared family of 48 tests."""


@cache
def thresholds() -> dict[str, float]:
    """Gymnasium's reward thresholds: the unit in which returns of all tasks are put together.

    Of each of the paper's tasks that has one.
    """
    environments = {name: task.environment for name, task in load_configuration().tasks.items()}
    found = {name: gymnasium.spec(each).reward_threshold for name, each in environments.items()}
    return {name: threshold for name, threshold in found.items() if threshold is not None}


def effect_sizes(outcomes: Outcomes, budget: Budget, seed: int = 0) -> pd.DataFrame:
    """Each of `COMPARISONS`: A12 with interval, p-values, Holm's over the family, seeds needed.

    A row with task "all" is the probability of improvement: A12 averaged over the tasks. The tests
    of NEAT (w/o) are of no family.
    """
    random = np.random.default_rng(seed)
    rows: list[dict[str, object]] = []
    for comparison in COMPARISONS:
        for method in comparison.methods(budget):
            declared = comparison.declared and method != ABLATION
            table = comparison.paper_table if declared else None
            place: dict[str, object] = {
                "outcome": comparison.outcome,
                "method": method,
                "against": comparison.against,
            }
            pairs = {
                task: [
                    _chosen(outcomes, comparison.setting, task, each, comparison.metric)
                    for each in (method, comparison.against)
                ]
                for task in budget.tasks
            }
            for task, pair in pairs.items():
                effect, p = _effect(superiority, pair, random), rank_sum(*pair)
                tested = {
                    "p": p,
                    "p_holm": p if declared else math.nan,
                    "seeds_needed": seeds_needed(effect["a12"]),
                    "paper_a12": paper_numbers.paper_a12(table, task, method)
                    if table
                    else math.nan,
                }
                rows.append(place | {"task": task} | effect | tested)
            samples = [sample for pair in pairs.values() for sample in pair]
            rows.append(place | {"task": "all"} | _effect(mean_superiority, samples, random))
    frame = pd.DataFrame(rows)
    frame["p_holm"] = holm(frame["p_holm"].tolist())
    return frame


def aggregates(outcomes: Outcomes, budget: Budget, seed: int = 0) -> pd.DataFrame:
    """Interquartile mean of the final fitness in units of Gymnasium's thresholds, with interval."""
    random = np.random.default_rng(seed)
    rows = []
    for method in shown_methods(budget):
        samples = _normalised(outcomes, budget.tasks, method)
        for task, some in (
            *((task, [sample]) for task, sample in samples.items()),
            ("all", list(samples.values())),
        ):
            iqm = estimate(interquartile_mean, some, random) if some else None
            if iqm is not None:
                rows.append((task, method, min(map(len, some)), iqm.value, iqm.low, iqm.high))
    return pd.DataFrame(rows, columns=["task", "method", "seeds", "iqm", "low", "high"])


def profiles(outcomes: Outcomes, budget: Budget, seed: int = 0) -> pd.DataFrame:
    """Performance profiles: the share of runs above each threshold, all tasks weighing the same.

    A profile is a step function: a row says the share from its threshold to the next one. The
    thresholds are all values that a run has, and one below, where the share is still 1.
    """
    random = np.random.default_rng(seed)
    samples = {
        method: list(_normalised(outcomes, budget.tasks, method).values())
        for method in shown_methods(budget)
    }
    there = {method: some for method, some in samples.items() if some and all(map(len, some))}
    columns = ["method", "threshold", "share", "low", "high"]
    if not there:
        return pd.DataFrame(columns=columns)
    values = np.unique(np.concatenate([sample for some in there.values() for sample in some]))
    below = values[0] - (0.05 * np.ptp(values) or 0.05)
    thresholds = np.concatenate([[below], values])
    effect = performance_profile(thresholds)
    rows = []
    for method, some in there.items():
        seeds = min(len(sample) for sample in some)
        low, high = interval(bootstrap(effect, some, random, 1000), seeds)
        names = [method] * len(thresholds)
        rows += list(zip(names, thresholds, effect(*some), low, high, strict=True))
    return pd.DataFrame(rows, columns=columns)


def efficiency(outcomes: Outcomes) -> pd.DataFrame:
    """SCORE and the best-so-far fitness at equal cost, by task, method and population.

    Means over the learning rates, then over the seeds: nothing is selected. A row for each metric;
    `first` and `last` are the evaluations (or steps) that a mean at equal cost is taken between.
    """
    metrics = ["score", *EQUAL]
    long = outcomes.runs.melt(
        ["task", "method", "population", "seed"], metrics, var_name="metric", value_name="value"
    )
    table = _mean_by(long, ["metric", "task", "method", "population"])
    ranges = [(task, metric, *ends) for (task, metric), ends in outcomes.equal.items()]
    ends = pd.DataFrame(ranges, columns=["task", "metric", "first", "last"])
    return table.merge(ends, how="left")


def selection_bias(outcomes: Outcomes) -> pd.DataFrame:
    """How far the training maximum flatters: final best minus the champion's held-out mean.

    By task, method and population: means over the learning rates, then over the seeds. Those of the
    two terms are over the runs that have both.
    """
    keys = ["task", "method", "population"]
    runs = outcomes.runs.assign(value=outcomes.runs["final_best"] - outcomes.runs["held_out"])
    both = runs.dropna(subset="value").groupby([*keys, "seed"])[["final_best", "held_out"]].mean()
    means = both.groupby(keys).mean().reset_index()
    return _mean_by(runs, keys).merge(means, how="left")


def _effect(
    effect: Effect, samples: Sequence[Floats], random: np.random.Generator
) -> dict[str, float]:
    """An A12 with its interval, as columns of a table."""
    a12 = estimate(effect, samples, random)
    return {"seeds": min(map(len, samples)), "a12": a12.value, "low": a12.low, "high": a12.high}


def _chosen(outcomes: Outcomes, setting: str, task: str, method: str, metric: str) -> Floats:
    """The runs that stand for a method; NEAT (w/o), which Table 3 lacks, has its Table 4 cell."""
    setting = "table4" if (setting, method) == ("table3", ABLATION) else setting
    cell = outcomes.chosen(setting, task, method)
    return np.array([]) if cell is None else outcomes.values(cell, metric)


def _normalised(outcomes: Outcomes, tasks: Sequence[str], method: str) -> dict[str, Floats]:
    """A method's final fitness on each task that has a threshold, divided by it."""
    return {
        task: _chosen(outcomes, "table3", task, method, "final_best") / thresholds()[task]
        for task in tasks
        if task in thresholds()
    }


def _mean_by(table: pd.DataFrame, keys: list[str]) -> pd.DataFrame:
    """Mean of `value` with Student's interval, by some keys.

    A seed's runs share its random numbers, so they are averaged to one value first. `seeds` counts
    those values, `without_value` the runs that have none: a champion may have failed everywhere.
    """
    rows = []
    for place, runs in table.groupby(keys, sort=False):
        values = runs.groupby("seed")["value"].mean().dropna().to_numpy(dtype=np.float64)
        low, high = mean_interval(values)
        mean = float(values.mean()) if len(values) else math.nan
        without = int(runs["value"].isna().sum())
        rows.append((*place, len(values), without, mean, float(low), float(high)))
    return pd.DataFrame(rows, columns=[*keys, "seeds", "without_value", "mean", "low", "high"])
