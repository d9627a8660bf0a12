"""The multiverse: the answer to each question under every reading of the grid, from records.

docs/readings-plan.md states the questions: is a rule above NEAT, or above NEAT (w/o)?
"""

from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd

from neol.network.rules import BASELINES
from neol.spec.configuration import load_configuration
from neol.study.campaign.grid import RESULTS
from neol.study.campaign.methods import challengers
from neol.study.campaign.multiverse import (
    BUDGET,
    Universe,
    choices,
    complete,
    configuration,
    method_blocks,
)
from neol.study.outcomes.campaign_runs import SECONDS_IN_AN_HOUR, Campaign
from neol.study.outcomes.contrasts import Moments, difference

METRICS = {"final_best": "final fitness", "score": "SCORE", "held_out": "held-out return"}
"""Outcomes that are compared, and their names in print."""
QUESTION = ["task", "metric", "method", "against"]
"""Columns that identify a question."""


class Answers(NamedTuple):
    """Answers of the readings that have records."""

    table: pd.DataFrame
    """One row for each question and reading that has all runs of the question's task.

    The columns `QUESTION`; the option of each choice; `difference` of the two means with its
    interval, `low` to `high`; `distinguishable`, whether that excludes 0.
    """
    readings: dict[str, int]
    """Number of readings that have all their runs, by task."""
    core_hours: float


def answers(results: Path = RESULTS) -> Answers:
    """Return all answers. Raises UserError for a record that is damaged or of another spec."""
    budget = load_configuration(BUDGET).budget
    seconds: dict[str, float] = {}

    @cache
    def campaign(reading: str) -> Campaign:
        return Campaign(load_configuration(BUDGET, reading=reading), results)

    def moments(universe: Universe, task: str, method: str) -> dict[str, Moments]:
        """Return the mean and SD of a method's runs by metric."""
        cells = {block.cell for block in method_blocks(universe, method)}
        (cell,) = (each for each in cells if each.task == task)
        here = campaign(configuration(universe, method).reading)
        runs = here.runs(cell)
        seconds[runs.sources[0].path] = sum(runs.cpu_seconds.values())
        return {
            metric: Moments.of(np.array([*here.values(cell, metric).values()]))
            for metric in METRICS
        }

    rows: list[tuple[object, ...]] = []
    readings = {task: complete(task, results) for task in budget.tasks}
    for task, there in readings.items():
        for universe in there:
            of_methods = {method: moments(universe, task, method) for method in budget.methods}
            for metric in METRICS:
                for against in BASELINES:
                    for method in challengers(budget):
                        sides = of_methods[method][metric], of_methods[against][metric]
                        found = difference(*sides)
                        low, high = found.interval()
                        place = task, metric, method, against, *universe.values()
                        rows.append((*place, found.value, low, high, low > 0 or high < 0))
    columns = [*QUESTION, *choices(), "difference", "low", "high", "distinguishable"]
    hours = sum(seconds.values()) / SECONDS_IN_AN_HOUR
    counts = {task: len(there) for task, there in readings.items()}
    return Answers(pd.DataFrame(rows, columns=columns), counts, hours)


def summary(table: pd.DataFrame) -> pd.DataFrame:
    """Return a summary of each question's answers over all readings, one row each.

    Columns: `QUESTION`; the `median`, `least` and `greatest` difference; the shares of readings in
    which the rule is `above`, distinguishably above (`clearly_above`) and distinguishably below
    (`clearly_below`).
    """
    above, clear = table["difference"] > 0, table["distinguishable"]
    marked = table.assign(above=above, clearly_above=above & clear, clearly_below=~above & clear)
    grouped = marked.groupby(QUESTION, sort=False)
    differences = grouped["difference"].agg(["median", "min", "max"])
    shares = grouped[["above", "clearly_above", "clearly_below"]].mean()
    names = {"min": "least", "max": "greatest"}
    return pd.concat([differences.rename(columns=names), shares], axis=1).reset_index()
