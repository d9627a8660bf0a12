"""NEAT's numbers that the search for a reading did not use: other populations and tasks."""

from pathlib import Path

import numpy as np

from neol.network.rules import BASELINES
from neol.pictures.labels import method_label, task_label
from neol.spec.configuration import PAPER_BUDGET, load_configuration
from neol.study.campaign.grid import RESULTS, Cell, blocks
from neol.study.campaign.reference import settings
from neol.study.outcomes.baselines import TASK as SEARCHED
from neol.study.outcomes.campaign_runs import Campaign
from neol.study.outcomes.paper_numbers import moments
from neol.study.outcomes.score import best_so_far
from neol.study.outcomes.statistics import Floats

FINAL_TABLES = (1, 7)
"""The paper's tables of final best fitness: of all methods but NEAT (w/o), and with it."""
CONFIGURATIONS = {"neat": 3, "neat_wo": 4}
"""The paper's tables of the configurations behind these."""


def unused_numbers(reading: str, results: Path = RESULTS) -> list[list[str]]:
    """Return a head, and a row for each task and baseline that has runs at the paper's budget.

    A row has the final best fitness for each population, counted in both ways, and the paper's with
    its population.
    Lunar Lander with the largest population is left out: the search used it. Without runs the
    result is empty. Raises UserError as `Campaign.runs` does.
    """
    configuration = load_configuration(PAPER_BUDGET, reading=reading)
    campaign = Campaign(configuration, results, partial=True)
    budget = configuration.budget
    every = blocks(configuration)
    run = {block.cell for block in every if (results / block.record).exists()}
    populations = budget.populations_of(SEARCHED)
    head = ["task", "method", *(f"P = {each}" for each in populations), "the paper"]
    rows = []
    for task in budget.tasks:
        for method in BASELINES:
            row = [Cell(task, method, each, None) for each in populations]
            shown = run.intersection(row) - {Cell(SEARCHED, method, max(populations), None)}
            if shown:
                finals = [_finals(campaign, cell) if cell in shown else "" for cell in row]
                labels = [task_label(task), method_label(method)]
                rows.append([*labels, *finals, _of_the_paper(task, method)])
    return [head, *rows] if rows else []


def _finals(campaign: Campaign, cell: Cell) -> str:
    """Return mean ± SD of the final best of the generation / so far, and the number of runs."""
    runs = list(campaign.runs(cell).best_fitness.values())
    counted = [runs, [best_so_far(run) for run in runs]]
    finals = [np.array([run[-1] for run in each]) for each in counted]
    return f"{' / '.join(map(_moments, finals))} ({len(runs)})"


def _moments(finals: Floats) -> str:
    mean = f"{finals.mean():,.0f}"
    return mean if len(finals) == 1 else f"{mean} ± {finals.std(ddof=1):,.0f}"


def _of_the_paper(task: str, method: str) -> str:
    paper = moments(FINAL_TABLES, task).get(method)
    if paper is None:
        return ""
    population, _ = settings(CONFIGURATIONS[method])[task, method]
    return f"{paper.mean:,.0f} ± {paper.sd:,.0f} (P = {population})"
