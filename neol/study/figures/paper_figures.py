"""The paper's Figures 2 to 11 from a budget's records."""

import math
from collections.abc import Sequence

import numpy as np
import pandas as pd

from neol.pictures.labels import TASK_LABELS, task_label
from neol.spec.constants import Budget
from neol.study.campaign.grid import Cell, cells
from neol.study.campaign.methods import challengers
from neol.study.figures.convergence import convergence
from neol.study.figures.figure import Drawing
from neol.study.figures.heatmaps import heatmaps
from neol.study.outcomes import paper_numbers
from neol.study.outcomes.campaign_runs import Campaign
from neol.study.outcomes.chosen_cells import SETTINGS, candidates
from neol.study.outcomes.contrasts import Moments, not_below_the_best
from neol.study.outcomes.effects import thresholds
from neol.study.outcomes.movement import is_near_control
from neol.study.outcomes.statistics import mean_interval
from neol.study.output.captions import describe_budget, describe_samples
from neol.study.tables.summary import summarise

HEATMAPS = {
    **{4 + position: (task, "final_best") for position, task in enumerate(TASK_LABELS)},
    **{8 + position: (task, "score") for position, task in enumerate(TASK_LABELS)},
}
"""The paper's Figures 4 to 11: task and outcome of each."""
_GROWS = (
    "SCORE grows with the population by construction (it falls if fitness is below 0), so compare "
    "cells of one population size."
)


def figure2(campaign: Campaign) -> Drawing:
    """Figure 2: convergence and final fitness of the rules and NEAT, in the cells of Table 3."""
    return _convergence("figure2", campaign, "table3")


def figure3(campaign: Campaign) -> Drawing:
    """Figure 3: as Figure 2, against NEAT without weight mutation, in the cells of Table 4."""
    colours = "NEAT (w/o) is purple; in the paper it is red, as NEAT is."
    return _convergence("figure3", campaign, "table4", colours)


def heatmaps_of(budget: Budget) -> list[int]:
    """Return the numbers of the heat maps of the tasks whose grid a budget has."""
    return [number for number, (task, _) in HEATMAPS.items() if task in budget.grid_tasks]


def heatmap(number: int, campaign: Campaign) -> Drawing:
    """Figure 4 to 11: a task's mean final best fitness, or SCORE, over its whole grid."""
    task, metric = HEATMAPS[number]
    configuration = campaign.configuration
    budget = configuration.budget
    methods = [each for each in (*challengers(budget), "neat") if each in budget.methods]
    shown = [cell for cell in cells(configuration) if cell.task == task and cell.method in methods]
    outcome = (
        "best fitness of the final generation (return)"
        if metric == "final_best"
        else f"SCORE, with M = {describe_samples(campaign, [task])}"
    )
    table = _cells(campaign, shown, metric)
    figure = heatmaps(
        table,
        title=f"{task_label(task)}: {outcome}",
        methods=methods,
        populations=budget.populations_of(task),
        learning_rates=budget.learning_rates,
        seeds=len(budget.seeds_of(task)),
        note=describe_budget(configuration, [task]) + (f" {_GROWS}" if metric == "score" else ""),
    )
    return Drawing(f"figure{number}", figure, configuration, campaign.sources(shown), table)


def curves(campaign: Campaign, setting: str) -> pd.DataFrame:
    """Return the best fitness of each generation of the runs that Figure 2 or 3 shows.

    Columns: task, method, seed, generation, best_fitness. `setting` is "table3" or "table4".
    """
    chosen, _ = _chosen(campaign, setting)
    runs = [campaign.runs(cell).rows.assign(task=cell.task, method=cell.method) for cell in chosen]
    columns = ["task", "method", "seed", "generation", "best_fitness"]
    return pd.concat(runs)[columns] if runs else pd.DataFrame(columns=columns)


def _chosen(campaign: Campaign, setting: str) -> tuple[list[Cell], dict[tuple[str, str], str]]:
    """Return the cell of each task and method, and what the choice of some lacked."""
    chosen, incomplete = [], {}
    for (task, method), among in candidates(campaign.configuration, setting).items():
        here = summarise(campaign, among, setting)
        if here.population is not None:
            chosen.append(Cell(task, method, here.population, here.learning_rate))
        if here.incomplete:
            incomplete[task, method] = here.incomplete
    return chosen, incomplete


def _convergence(name: str, campaign: Campaign, setting: str, remark: str = "") -> Drawing:
    configuration, paper_table = campaign.configuration, {"table3": 1, "table4": 7}[setting]
    budget = configuration.budget
    methods = SETTINGS[setting].methods(configuration.budget)
    chosen, incomplete = _chosen(campaign, setting)
    table = curves(campaign, setting)
    figure = convergence(
        table,
        tasks=configuration.budget.tasks,
        methods=methods,
        seeds={task: len(budget.seeds_of(task)) for task in budget.tasks},
        note=f"Configurations of Table {SETTINGS[setting].paper_table}. "
        f"{describe_budget(configuration)} {remark}".strip(),
        incomplete=incomplete,
        near_control={
            (cell.task, cell.method) for cell in chosen if is_near_control(campaign, cell)
        },
        levels={task: _levels(task, paper_table) for task in configuration.budget.tasks},
    )
    considered = [cell for among in candidates(configuration, setting).values() for cell in among]
    sources = campaign.sources(considered)
    return Drawing(name, figure, configuration, sources, _drawn_curves(table))


def _levels(task: str, paper_table: int) -> dict[str, tuple[float, float]]:
    """Return reference levels of a task's final values: threshold and the paper's means."""
    levels = {}
    if task in thresholds():
        levels["threshold"] = (thresholds()[task], thresholds()[task])
    means = [each.mean for each in paper_numbers.moments([paper_table], task).values()]
    if means:
        levels["paper"] = (min(means), max(means))
    return levels


def _drawn_curves(curves: pd.DataFrame) -> pd.DataFrame:
    """Return the numbers that lines and boxes show: a row for each line point and final value.

    `shown` says which of them a row is. A line's value is a mean over `seeds`, with Student's
    interval `low` to `high`; it goes as far as all seeds do.
    """
    rows: list[tuple[object, ...]] = []
    for (task, method), some in curves.groupby(["task", "method"], sort=False):
        table = some.pivot_table(index="generation", columns="seed", values="best_fitness")
        there = table.dropna()
        low, high = mean_interval(there.to_numpy(dtype=np.float64))
        means = there.mean(axis=1)
        ends = zip(means.items(), low, high, strict=True)
        rows += [
            (task, method, "line", generation, None, len(there.columns), mean, below, above)
            for (generation, mean), below, above in ends
        ]
        last = some.sort_values("generation").groupby("seed").last().reset_index()
        rows += [
            (task, method, "final", generation, seed, 1, value, math.nan, math.nan)
            for seed, generation, value in zip(
                last["seed"], last["generation"], last["best_fitness"], strict=True
            )
        ]
    columns = ["task", "method", "shown", "generation", "seed", "seeds", "value", "low", "high"]
    return pd.DataFrame(rows, columns=columns).astype({"seed": "Int64"})


def _cells(campaign: Campaign, shown: Sequence[Cell], metric: str) -> pd.DataFrame:
    """Return a row for each cell: the mean with its standard error, and whether it may be the best.

    The best is among the cells of one method. SCORE also has the mean divided by P.
    """
    moments = {cell: Moments.of(list(campaign.values(cell, metric).values())) for cell in shown}
    near_best: dict[Cell, bool] = {}
    for method in dict.fromkeys(cell.method for cell in shown):
        own = [cell for cell in shown if cell.method == method]
        near_best |= dict(
            zip(own, not_below_the_best([moments[each] for each in own]), strict=True)
        )
    rows = [
        {
            "task": cell.task,
            "method": cell.method,
            "population": cell.population,
            "learning_rate": cell.learning_rate,
            "seeds": own.seeds,
            "mean": own.mean,
            "standard_error": own.sd / math.sqrt(own.seeds) if own.seeds else math.nan,
            "near_best": near_best[cell],
            "near_control": is_near_control(campaign, cell),
        }
        for cell, own in moments.items()
    ]
    table = pd.DataFrame(rows).astype({"learning_rate": float})
    return (
        table.assign(mean_per_genome=table["mean"] / table["population"])
        if metric == "score"
        else table
    )
