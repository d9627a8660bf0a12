"""Analyses beyond the paper's: effect sizes, aggregates, equal cost, selection bias.

Each function makes a table from a budget's outcomes; `neol.study.figures` draws it. Seeds are the
units. A seed gives all methods the same episodes and, as far as their sizes agree, the same first
population. Each difference of independent samples therefore comes with the correlation of runs that
share a seed and with the paired difference, whose interval is narrower where such runs are alike.
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
from neol.study.campaign.grid import Cell
from neol.study.campaign.methods import challengers, shown_methods
from neol.study.outcomes import paper_numbers
from neol.study.outcomes.contrasts import Moments, compare, difference
from neol.study.outcomes.outcomes import EQUAL, Metric, Outcomes, Setting
from neol.study.outcomes.statistics import (
    ALPHA,
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
FITNESS, SCORE, HELD_OUT = "final fitness", "SCORE", "held-out return"
"""Outcome by which methods are compared, in print."""


class Family(NamedTuple):
    """Comparisons of each rule, and of NEAT (w/o), with a baseline on each task."""

    outcome: str
    setting: Setting
    metric: Metric
    against: str
    declared: bool
    """Whether its tests of rules belong to the declared family that Holm's correction covers."""
    paper_tables: tuple[int, ...] = ()
    """The paper's tables that print the means of the same comparison."""
    paper_p_values: int | None = None
    """The paper's table of p-values of this comparison."""

    def methods(self, budget: Budget) -> tuple[str, ...]:
        """Return the methods that are compared with the baseline."""
        return challengers(budget) + (() if self.against == ABLATION else (ABLATION,))


COMPARISONS = (
    Family(FITNESS, "table3", "final_best", "neat", True, (1, 7), 5),
    Family(SCORE, "score", "score", "neat", True, (2, 8), 6),
    Family(HELD_OUT, "table3", "held_out", "neat", False),
    Family(FITNESS, "table4", "final_best", ABLATION, True, (7,)),
    Family(SCORE, "score", "score", ABLATION, True, (8,)),
    Family(HELD_OUT, "table4", "held_out", ABLATION, False),
)
"""Four of them, with three rules on four tasks each, make the declared family of 48 tests."""


@cache
def thresholds() -> dict[str, float]:
    """Return Gymnasium's reward threshold of each of the paper's tasks that has one.

    It is the unit in which returns of several tasks are averaged.
    """
    environments = {name: task.environment for name, task in load_configuration().tasks.items()}
    found = {name: gymnasium.spec(each).reward_threshold for name, each in environments.items()}
    return {name: threshold for name, threshold in found.items() if threshold is not None}


def effect_sizes(outcomes: Outcomes, budget: Budget, seed: int = 0) -> pd.DataFrame:
    """Return the effect sizes of `COMPARISONS`: a row for each comparison, method and task.

    `difference` has Welch's interval (`low`, `high`) and two-sided `p`, corrected by Holm over the
    declared family in `p_holm`. The same runs also give the analysis of pairs that share a seed
    (`paired`, its interval, and their `correlation`), A12 with its bootstrap interval, and the
    two-sided rank-sum test. From the paper come the difference of its printed means with Welch's
    interval, and A12 from its p-value. `seeds_needed` is for the paper's A12. `near_control` says
    that the rule hardly moves a weight there. A row with task "all" is the probability of
    improvement, A12 averaged over several tasks. Tests of NEAT (w/o) belong to no family.
    """
    random = np.random.default_rng(seed)
    rows: list[dict[str, object]] = []
    for family in COMPARISONS:
        for method in family.methods(budget):
            declared = family.declared and method != ABLATION
            both, pairs = (method, family.against), list[Floats]()
            place: dict[str, object] = {
                "outcome": family.outcome,
                "method": method,
                "against": family.against,
            }
            for task in budget.tasks:
                sides = [_chosen(outcomes, family.setting, task, each) for each in both]
                runs = [_by_seed(outcomes, cell, family.metric) for cell in sides]
                pair = [np.array(list(side.values())) for side in runs]
                primary = compare(*runs)
                paper_a12 = (
                    paper_numbers.paper_a12(family.paper_p_values, task, method)
                    if family.paper_p_values and declared
                    else math.nan
                )
                beside = {
                    **_effect(superiority, pair, random),
                    "p_rank_sum": rank_sum(pair[0], pair[1]),
                    **_papers(family, task, method),
                    "paper_a12": paper_a12,
                    "seeds_needed": seeds_needed(paper_a12, alpha=ALPHA / 2),
                    "near_control": sides[0] in outcomes.near_control,
                }
                tested = {"p_holm": primary["p"] if declared else math.nan}
                rows.append(place | {"task": task} | primary | tested | beside)
                pairs += pair
            if len(budget.tasks) > 1:
                together = _effect(mean_superiority, pairs, random)
                seeds = min(map(len, pairs))
                rows.append(place | {"task": "all", "seeds": seeds} | together)
    frame = pd.DataFrame(rows)
    frame["p_holm"] = holm(frame["p_holm"].tolist())
    return frame


def aggregates(outcomes: Outcomes, budget: Budget, seed: int = 0) -> pd.DataFrame:
    """Return interquartile means of final fitness, in units of Gymnasium's thresholds.

    Each task has a row for each method; rows with task "all" hold the mean of several tasks.
    """
    random = np.random.default_rng(seed)
    rows = []
    for method in shown_methods(budget):
        samples = _normalised(outcomes, budget.tasks, method)
        parts = {task: [sample] for task, sample in samples.items()}
        if len(samples) > 1:
            parts["all"] = list(samples.values())
        for task, some in parts.items():
            iqm = estimate(interquartile_mean, some, random)
            rows.append((task, method, min(map(len, some)), iqm.value, iqm.low, iqm.high))
    return pd.DataFrame(rows, columns=["task", "method", "seeds", "iqm", "low", "high"])


def profiles(outcomes: Outcomes, budget: Budget, seed: int = 0) -> pd.DataFrame:
    """Return performance profiles: the share of runs above each threshold, tasks weighing equally.

    A profile is a step function: a row has the share from its threshold to the next one. The
    thresholds are the values of all runs, and one below them, where the share is still 1.
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
    """Return SCORE and the best-so-far fitness at equal cost, by task, method and population.

    Values are means over the learning rates, then over the seeds: nothing is selected. There is a
    row for each metric and for each of two ranges: methods of one `population` share nearly their
    whole runs, cells of all `populations` much less. `first` and `last` are the evaluations (or
    steps) that a mean at equal cost is taken between. SCORE has no range; divided by P it is
    `score_per_genome`.
    """
    keys = ["metric", "compared", "task", "method", "population"]
    own = outcomes.runs.assign(compared="population")
    scores = [
        own.assign(metric="score", value=own["score"]),
        own.assign(metric="score_per_genome", value=own["score"] / own["population"]),
    ]
    tables = [_mean_by(pd.concat(scores), keys)]
    for metric in EQUAL:
        for task in outcomes.budget.tasks:
            grid = [cell for cell in outcomes.cells if cell.task == task]
            sizes = dict.fromkeys(cell.population for cell in grid)
            together = [[cell for cell in grid if cell.population == size] for size in sizes]
            for compared, groups in (("population", together), ("populations", [grid])):
                for group in groups:
                    runs = _at_equal_cost(outcomes, group, metric)
                    means = _mean_by(runs.assign(metric=metric, compared=compared), keys)
                    first, last = outcomes.equal_range(group, metric)
                    tables.append(means.assign(first=first, last=last))
    return pd.concat([each for each in tables if len(each)] or tables, ignore_index=True)


def selection_bias(outcomes: Outcomes) -> pd.DataFrame:
    """Return the selection bias: final best fitness minus the champion's held-out mean.

    A row for each task, method and population has means over the learning rates, then over the
    seeds. The means of the two terms are over the runs that have both.
    """
    keys = ["task", "method", "population"]
    runs = outcomes.runs.assign(value=outcomes.runs["final_best"] - outcomes.runs["held_out"])
    both = runs.dropna(subset="value").groupby([*keys, "seed"])[["final_best", "held_out"]].mean()
    means = both.groupby(keys).mean().reset_index()
    return _mean_by(runs, keys).merge(means, how="left")


def _papers(family: Family, task: str, method: str) -> dict[str, float]:
    """Return the difference of the paper's printed means with Welch's interval; else NaN."""
    printed = paper_numbers.moments(family.paper_tables, task)
    both = [printed.get(each, Moments(0, math.nan, math.nan)) for each in (method, family.against)]
    papers = difference(*both)
    low, high = papers.interval()
    return {"paper_difference": papers.value, "paper_low": low, "paper_high": high}


def _effect(
    effect: Effect, samples: Sequence[Floats], random: np.random.Generator
) -> dict[str, float]:
    """Return an A12 with its interval, as columns of a table."""
    a12 = estimate(effect, samples, random)
    return {"a12": a12.value, "a12_low": a12.low, "a12_high": a12.high}


def _chosen(outcomes: Outcomes, setting: str, task: str, method: str) -> Cell | None:
    """Return a method's cell; NEAT (w/o), which Table 3 lacks, has its cell of Table 4."""
    setting = "table4" if (setting, method) == ("table3", ABLATION) else setting
    return outcomes.chosen(setting, task, method)


def _by_seed(outcomes: Outcomes, cell: Cell | None, metric: str) -> dict[int, float]:
    """Return an outcome of a cell's runs by seed, without the runs that lack it."""
    if cell is None:
        return {}
    values = zip(outcomes.seeds(cell), outcomes.values(cell, metric).tolist(), strict=True)
    return {seed: value for seed, value in values if not math.isnan(value)}


def _at_equal_cost(outcomes: Outcomes, compared: Sequence[Cell], metric: str) -> pd.DataFrame:
    """Return the runs of some cells with their `value`, a mean at equal cost."""
    rows = [
        (cell.task, cell.method, cell.population, seed, value)
        for cell, values in zip(compared, outcomes.samples(compared, metric), strict=True)
        for seed, value in zip(outcomes.seeds(cell), values, strict=True)
    ]
    return pd.DataFrame(rows, columns=["task", "method", "population", "seed", "value"])


def _normalised(outcomes: Outcomes, tasks: Sequence[str], method: str) -> dict[str, Floats]:
    """Return a method's final fitness on each task that has a threshold, divided by it."""
    chosen = {task: _chosen(outcomes, "table3", task, method) for task in tasks}
    return {
        task: np.array([*_by_seed(outcomes, cell, "final_best").values()]) / thresholds()[task]
        for task, cell in chosen.items()
        if task in thresholds()
    }


def _mean_by(table: pd.DataFrame, keys: list[str]) -> pd.DataFrame:
    """Return the mean of `value` with Student's interval, by some keys.

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
