"""The paper's Figures 2 to 11 from a budget's records."""

import pandas as pd

from neol.pictures.labels import TASK_LABELS, task_label
from neol.spec.constants import Budget
from neol.study.campaign.grid import Cell, cells
from neol.study.campaign.methods import challengers
from neol.study.figures.figure import Drawing
from neol.study.figures.plots import convergence, heatmaps
from neol.study.outcomes.campaign_runs import Campaign
from neol.study.outcomes.chosen_cells import SETTINGS, candidates
from neol.study.output.captions import describe_budget, describe_samples
from neol.study.tables.summary import summarise

HEATMAPS = {
    **{4 + position: (task, "final_best") for position, task in enumerate(TASK_LABELS)},
    **{8 + position: (task, "score") for position, task in enumerate(TASK_LABELS)},
}
"""The paper's Figures 4 to 11: task and outcome of each."""
_GROWS = (
    "SCORE grows with the population by construction (falls, where fitness is below 0), so compare "
    "cells of one population size."
)


def figure2(campaign: Campaign) -> Drawing:
    """Figure 2: convergence and final fitness of the rules and NEAT, in the cells of Table 3."""
    return _convergence("figure2", campaign, "table3")


def figure3(campaign: Campaign) -> Drawing:
    """Figure 3: the same against NEAT without weight mutation, in the cells of Table 4."""
    colours = "NEAT (w/o) is purple, in the paper red as NEAT is."
    return _convergence("figure3", campaign, "table4", colours)


def heatmaps_of(budget: Budget) -> list[int]:
    """The numbers of the heat maps whose tasks a budget has."""
    return [number for number, (task, _) in HEATMAPS.items() if task in budget.tasks]


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
    figure = heatmaps(
        _outcomes(campaign, shown, metric),
        metric=metric,
        title=f"{task_label(task)}: {outcome}",
        methods=methods,
        populations=budget.populations,
        learning_rates=budget.learning_rates,
        seeds=budget.seed_count,
        note=describe_budget(configuration, [task]) + (f" {_GROWS}" if metric == "score" else ""),
    )
    return Drawing(f"figure{number}", figure, configuration, campaign.sources(shown))


def _convergence(name: str, campaign: Campaign, setting: str, remark: str = "") -> Drawing:
    configuration = campaign.configuration
    methods = SETTINGS[setting].methods(configuration.budget)
    chosen, incomplete = [], {}
    for (task, method), among in candidates(configuration, setting).items():
        here = summarise(campaign, among, setting)
        if here.population is not None:
            chosen.append(Cell(task, method, here.population, here.learning_rate))
        if here.incomplete:
            incomplete[task, method] = here.incomplete
    curves = [
        campaign.runs(cell).rows.assign(task=cell.task, method=cell.method) for cell in chosen
    ]
    columns = ["task", "method", "seed", "generation", "best_fitness"]
    figure = convergence(
        pd.concat(curves)[columns] if curves else pd.DataFrame(columns=columns),
        tasks=configuration.budget.tasks,
        methods=methods,
        seeds=configuration.budget.seed_count,
        note=f"Configurations of Table {SETTINGS[setting].paper_table}. "
        f"{describe_budget(configuration)} {remark}".strip(),
        incomplete=incomplete,
    )
    considered = [cell for among in candidates(configuration, setting).values() for cell in among]
    return Drawing(name, figure, configuration, campaign.sources(considered))


def _outcomes(campaign: Campaign, shown: list[Cell], metric: str) -> pd.DataFrame:
    rows = [
        (cell.method, cell.population, cell.learning_rate, seed, value)
        for cell in shown
        for seed, value in campaign.values(cell, metric).items()
    ]
    columns = ["method", "population", "learning_rate", "seed", metric]
    return pd.DataFrame(rows, columns=columns).astype({"learning_rate": float})
