"""What every run of a budget came to: one row a run, from which all statistics are made."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal

import numpy as np
import pandas as pd

from neol.spec.constants import Budget
from neol.study.campaign.grid import Cell, cells
from neol.study.outcomes.campaign_runs import Campaign
from neol.study.outcomes.chosen_cells import SETTINGS, candidates, choose
from neol.study.outcomes.score import mean_best_so_far
from neol.study.outcomes.statistics import Floats

METRICS = {
    "final_best": "final best fitness",
    "score": "SCORE",
    "equal_evaluations": "mean best-so-far fitness at equal evaluations",
    "equal_steps": "mean best-so-far fitness at equal environment steps",
    "held_out": "held-out return of the champion",
}
"""Outcomes of a run, and how they are called in print."""
_OWN = ("final_best", "score", "held_out")
"""Those that a run has by itself; the others compare runs of a task up to where all have come."""
EQUAL = {"equal_evaluations": "evaluations", "equal_steps": "env_steps"}
"""What each of those is a mean over: a column of records."""


@dataclass(frozen=True)
class Outcomes:
    """The runs of a budget that there are."""

    runs: pd.DataFrame
    """A row a run: task, method, population, learning_rate (NaN for none), seed, and `METRICS`."""
    cells: tuple[Cell, ...]
    """The budget's grid, whether it has runs or not."""
    candidates: Mapping[str, Mapping[tuple[str, str], list[Cell]]]
    """By setting, task and method: the cells that it chooses among."""
    budget: Budget
    equal: Mapping[tuple[str, str], tuple[float, float]] = field(default_factory=dict)
    """By task and measure at equal cost: the range of its mean, common to all runs of the task."""

    def unit(self, metric: str, task: str) -> str:
        """What a metric is called, with the range that it is a mean over."""
        if (task, metric) not in self.equal:
            return METRICS[metric]
        first, last = self.equal[task, metric]
        return f"{METRICS[metric]} ({first:.0f} to {last:.0f})"

    def values(self, cell: Cell, metric: str) -> Floats:
        """The runs of a cell, by seed."""
        return self._by_cell.get(cell, self.runs.iloc[:0])[metric].to_numpy(dtype=np.float64)

    def mean(self, cell: Cell, metric: str) -> float:
        """Over the seeds that there are; NaN without any."""
        values = self.values(cell, metric)
        return float(values.mean()) if len(values) else float("nan")

    def missing(self, cell: Cell) -> int:
        """How many of its seeds a cell lacks."""
        return self.budget.seed_count - len(self._by_cell.get(cell, ()))

    def grid(self, task: str, methods: Iterable[str]) -> list[Cell]:
        """All cells of a task and some methods."""
        return [cell for cell in self.cells if cell.task == task and cell.method in methods]

    def chosen(self, setting: str, task: str, method: str) -> Cell | None:
        """The cell that stands for a method on a task; None if there is none, or none complete."""
        metric, among = SETTINGS[setting].metric, self.candidates[setting].get((task, method), [])
        values = {cell: self.values(cell, metric).tolist() for cell in among}
        return choose(values, [cell for cell in among if not self.missing(cell)])

    @cached_property
    def _by_cell(self) -> dict[Cell, pd.DataFrame]:
        keys = ["task", "method", "population", "learning_rate"]
        groups = self.runs.sort_values("seed").groupby(keys, dropna=False)
        return {_cell(*place): runs for place, runs in groups}  # type: ignore[arg-type]


def gather(campaign: Campaign) -> Outcomes:
    """The outcomes of all runs of a campaign."""
    configuration = campaign.configuration
    grid = tuple(cells(configuration))
    equal = {
        (task, metric): equal_range(campaign, [cell for cell in grid if cell.task == task], column)
        for task in configuration.budget.tasks
        for metric, column in EQUAL.items()
    }
    rows = [row for cell in grid for row in _rows(campaign, cell, equal)]
    columns = ["task", "method", "population", "learning_rate", "seed", *_OWN, *EQUAL]
    return Outcomes(
        pd.DataFrame(rows, columns=columns).astype(
            dict.fromkeys(["learning_rate", *METRICS], np.float64)
        ),
        grid,
        {setting: candidates(configuration, setting) for setting in SETTINGS},
        configuration.budget,
        equal,
    )


def equal_range(campaign: Campaign, compared: Iterable[Cell], column: str) -> tuple[float, float]:
    """From where and to where all runs of some cells have a best-so-far fitness: NaN without runs.

    `column` is evaluations or env_steps. From the latest end of a first generation to the earliest
    end of a run.
    """
    spent = [
        (run.iloc[0], run.iloc[-1])
        for cell in compared
        for _, run in campaign.runs(cell).rows.groupby("seed")[column]
    ]
    if not spent:
        return float("nan"), float("nan")
    first, last = zip(*spent, strict=True)
    return float(max(first)), float(min(last))


def _rows(
    campaign: Campaign, cell: Cell, equal: Mapping[tuple[str, str], tuple[float, float]]
) -> Iterator[tuple[object, ...]]:
    """What each run of a cell came to."""
    own = [campaign.values(cell, metric) for metric in _OWN]
    for seed, run in campaign.runs(cell).rows.groupby("seed"):
        at_equal = [
            mean_best_so_far(run["best_fitness"], run[column], *equal[cell.task, metric])
            for metric, column in EQUAL.items()
        ]
        place = cell.task, cell.method, cell.population, cell.learning_rate, seed
        yield *place, *(values[int(seed)] for values in own), *at_equal  # type: ignore[arg-type]


def _cell(task: str, method: str, population: int, learning_rate: float) -> Cell:
    rate = None if np.isnan(learning_rate) else float(learning_rate)
    return Cell(task, method, int(population), rate)


Metric = Literal["final_best", "score", "equal_evaluations", "equal_steps", "held_out"]


Setting = Literal["table3", "table4", "score"]
