"""What the paper does not show: effect sizes, aggregates, equal cost, selection bias.

Each function makes a table from a budget's outcomes; `beyond_figures` draws it. Seeds are the
units. Cells are taken as independent samples of them, which they are not wholly: a seed gives all
methods the same episodes, and NEAT and the rules the same first population of a size. As far as
that makes their runs alike, the intervals of a difference are too wide rather than too narrow.
"""

import math
from collections.abc import Sequence

import numpy as np
import pandas as pd

from neol.analysis import reference
from neol.analysis.outcomes import Outcomes
from neol.analysis.statistics import (
    Floats,
    bootstrap,
    estimate,
    holm,
    interquartile_mean,
    interval,
    mean_interval,
    mean_superiority,
    paper_statistic,
    performance_profile,
    rank_sum,
    seeds_needed,
    superiority,
)

RULES = ("bcm", "hebb", "oja")
COMPARISONS = (
    ("final fitness", "table3", "final_best", "neat", 5),
    ("SCORE", "score", "score", "neat", 6),
    ("ablation, final fitness", "table4", "final_best", "neat_wo", None),
    ("ablation, SCORE", "score", "score", "neat_wo", None),
)
"""The declared family of tests: name, setting, metric, against whom, the paper's table of p-values.

Three rules on each task in each: with four tasks 48 tests.
"""
SOLVED = {"cartpole": 475.0, "lunar_lander": 200.0, "hopper": 3800.0, "bipedal_walker": 300.0}
"""Gymnasium's own reward thresholds: the unit in which returns of all tasks are put together."""


def effects(outcomes: Outcomes, tasks: Sequence[str], seed: int = 0) -> pd.DataFrame:
    """Each rule against NEAT: A12 with interval, p-values, Holm's over the family, seeds needed.

    A row with task "all" is the probability of improvement: A12 averaged over the tasks.
    """
    random = np.random.default_rng(seed)
    rows = []
    for name, setting, metric, against, table in COMPARISONS:
        printed = reference.values(table) if table else {}
        for rule in RULES:
            pairs = {
                task: [_chosen(outcomes, setting, task, each, metric) for each in (rule, against)]
                for task in tasks
            }
            for task, pair in pairs.items():
                a12 = estimate(superiority, pair, random)
                p, _ = printed.get((task, f"{rule}_vs_neat"), (math.nan, None))
                u = paper_statistic(p, digits=4 if table == 5 else 3)
                rows.append(
                    {
                        "comparison": name,
                        "task": task,
                        "method": rule,
                        "against": against,
                        "seeds": min(map(len, pair)),
                        "a12": a12.value,
                        "low": a12.low,
                        "high": a12.high,
                        "p": rank_sum(*pair),
                        "seeds_needed": seeds_needed(a12.value),
                        "paper_a12": math.nan if u is None else u / 900,
                    }
                )
            complete = [sample for pair in pairs.values() for sample in pair]
            overall = estimate(mean_superiority, complete, random)
            rows.append(
                {
                    "comparison": name,
                    "task": "all",
                    "method": rule,
                    "against": against,
                    "seeds": min(map(len, complete)),
                    "a12": overall.value,
                    "low": overall.low,
                    "high": overall.high,
                }
            )
    frame = pd.DataFrame(rows)
    frame["p_holm_family"] = holm(frame["p"].tolist())
    return frame


def aggregates(outcomes: Outcomes, tasks: Sequence[str], seed: int = 0) -> pd.DataFrame:
    """Interquartile mean of the final fitness in units of Gymnasium's thresholds, with interval."""
    random = np.random.default_rng(seed)
    rows = []
    for method in (*RULES, "neat", "neat_wo"):
        samples = _normalised(outcomes, tasks, method)
        for task, some in (
            *((task, [sample]) for task, sample in samples.items()),
            ("all", list(samples.values())),
        ):
            iqm = estimate(interquartile_mean, some, random) if some else None
            if iqm is not None:
                rows.append((task, method, min(map(len, some)), iqm.value, iqm.low, iqm.high))
    return pd.DataFrame(rows, columns=["task", "method", "seeds", "iqm", "low", "high"])


def profiles(outcomes: Outcomes, tasks: Sequence[str], seed: int = 0) -> pd.DataFrame:
    """Performance profiles: the share of runs above each threshold, all tasks weighing the same."""
    random = np.random.default_rng(seed)
    thresholds = np.linspace(-0.5, 1.6, 85)
    effect = performance_profile(thresholds)
    rows = []
    for method in (*RULES, "neat", "neat_wo"):
        samples = list(_normalised(outcomes, tasks, method).values())
        if not samples or not min(map(len, samples)):
            continue
        low, high = interval(bootstrap(effect, samples, random, 1000), min(map(len, samples)))
        rows += list(
            zip([method] * len(thresholds), thresholds, effect(*samples), low, high, strict=True)
        )
    return pd.DataFrame(rows, columns=["method", "threshold", "share", "low", "high"])


def efficiency(outcomes: Outcomes) -> pd.DataFrame:
    """SCORE and the best-so-far fitness at equal cost, by task, method and population.

    Means over the learning rates, then over the seeds: nothing is selected. A row for each metric.
    """
    metrics = ["score", "equal_evaluations", "equal_steps"]
    long = outcomes.runs.melt(
        ["task", "method", "population", "seed"], metrics, var_name="metric", value_name="value"
    )
    return _mean_by(long, ["metric", "task", "method", "population"])


def selection(outcomes: Outcomes) -> pd.DataFrame:
    """How far the training maximum flatters: final best minus the champion's held-out mean.

    By task, method and population: means over the learning rates, then over the seeds.
    """
    runs = outcomes.runs.assign(value=outcomes.runs["final_best"] - outcomes.runs["held_out"])
    gap = _mean_by(runs, ["task", "method", "population"])
    return gap.merge(
        runs.groupby(["task", "method", "population"], as_index=False)[
            ["final_best", "held_out"]
        ].mean()
    )


def _chosen(outcomes: Outcomes, setting: str, task: str, method: str, metric: str) -> Floats:
    cell = outcomes.chosen(setting, task, method)
    return np.array([]) if cell is None else outcomes.values(cell, metric)


def _normalised(outcomes: Outcomes, tasks: Sequence[str], method: str) -> dict[str, Floats]:
    """A method's final fitness on each task that has a threshold, divided by it."""
    setting = "table4" if method == "neat_wo" else "table3"
    return {
        task: _chosen(outcomes, setting, task, method, "final_best") / SOLVED[task]
        for task in tasks
        if task in SOLVED
    }


def _mean_by(table: pd.DataFrame, keys: list[str]) -> pd.DataFrame:
    """Mean of `value` with Student's interval, by some keys.

    A seed's runs share its random numbers, so they are averaged to one value first. `runs` counts
    those seeds, `without_value` the runs that have none, such as a champion that failed everywhere.
    """
    rows = []
    for place, runs in table.groupby(keys, sort=False):
        values = runs.groupby("seed")["value"].mean().dropna().to_numpy(dtype=np.float64)
        low, high = mean_interval(values)
        mean = float(values.mean()) if len(values) else math.nan
        without = int(runs["value"].isna().sum())
        rows.append((*place, len(values), without, mean, float(low), float(high)))
    return pd.DataFrame(rows, columns=[*keys, "runs", "without_value", "mean", "low", "high"])
