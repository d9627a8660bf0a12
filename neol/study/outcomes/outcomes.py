"""The outcomes of a budget's runs: one row for each run, from which all statistics are made."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal

import numpy as np
import pandas as pd

from neol.spec.constants import Budget
from neol.study.campaign.grid import Cell, cells
from neol.study.outcomes.campaign_runs import Campaign
from neol.study.outcomes.chosen_cells import SETTINGS, candidates, choose
from neol.study.outcomes.movement import is_near_control
from neol.study.outcomes.score import mean_best_so_far
from neol.study.outcomes.statistics import Floats

METRICS = {
    "final_best": "final best fitness",
    "score": "SCORE",
    "equal_evaluations": "mean best-so-far fitness at equal evaluations",
    "equal_steps": "mean best-so-far fitness at equal environment steps",
    "held_out": "held-out return of the champion",
}
"""Outcomes of a run, and their names in print."""
_OWN = ("final_best", "score", "held_out")
"""Outcomes that a run has by itself; the others depend on which runs are compared."""
EQUAL = {"equal_evaluations": "evaluations", "equal_steps": "env_steps"}
"""The column of records that counts each outcome's cost."""


@dataclass(frozen=True)
class Outcomes:
    """The runs of a budget that have records."""

    runs: pd.DataFrame
    """One row for each run: task, method, population, learning_rate (NaN for none), seed, outcomes.

    The outcomes are the `METRICS` that a run has by itself; `samples` has the others.
    """
    cells: tuple[Cell, ...]
    """All cells of the budget's grid, with runs or without."""
    candidates: Mapping[str, Mapping[tuple[str, str], list[Cell]]]
    """Cells that a setting chooses among, by setting, task and method."""
    budget: Budget
    histories: Mapping[Cell, pd.DataFrame] = field(default_factory=dict)
    """Histories of the cells with runs: one row for each seed and generation, as in a record."""

    near_control: frozenset[Cell] = frozenset()
    """Cells whose rule hardly moves a weight."""

    def samples(self, compared: Sequence[Cell], metric: str) -> list[Floats]:
        """Return the outcomes of cells that are compared with each other, each by seed.

        A mean at equal cost is taken over the range that the runs of just these cells have in
        common (`equal_range`); NaN where there is none.
        """
        if metric not in EQUAL:
            return [self.values(cell, metric) for cell in compared]
        column, ends = EQUAL[metric], self.equal_range(compared, metric)
        return [
            np.array(
                [
                    mean_best_so_far(run["best_fitness"], run[column], *ends)
                    for run in self._runs(cell)
                ]
            )
            for cell in compared
        ]

    def equal_range(self, compared: Iterable[Cell], metric: str) -> tuple[float, float]:
        """Return the range in which all runs of some cells have a best-so-far fitness.

        It is in evaluations or environment steps, as the metric counts: from the latest end of a
        first generation to the earliest end of a run. NaN without runs.
        """
        column = EQUAL[metric]
        spent = [
            (run[column].iloc[0], run[column].iloc[-1])
            for cell in compared
            for run in self._runs(cell)
        ]
        if not spent:
            return float("nan"), float("nan")
        first, last = zip(*spent, strict=True)
        return float(max(first)), float(min(last))

    def values(self, cell: Cell, metric: str) -> Floats:
        """Return an outcome that a cell's runs have by themselves, by seed."""
        return self._by_cell.get(cell, self.runs.iloc[:0])[metric].to_numpy(dtype=np.float64)

    def seeds(self, cell: Cell) -> list[int]:
        """Return the seeds of a cell's runs, in the order of `values`."""
        return [int(seed) for seed in self._by_cell.get(cell, self.runs.iloc[:0])["seed"]]

    def missing(self, cell: Cell) -> int:
        """Return the number of seeds that a cell lacks."""
        return len(self.budget.seeds_of(cell.task)) - len(self._by_cell.get(cell, ()))

    def leading(self, cell: Cell) -> int:
        """Return how many of the budget's first seeds a cell has before the first missing one."""
        there = set(self._by_cell[cell]["seed"]) if cell in self._by_cell else set()
        seeds = self.budget.seeds_of(cell.task)
        return next((place for place, seed in enumerate(seeds) if seed not in there), len(seeds))

    def grid(self, task: str, methods: Iterable[str]) -> list[Cell]:
        """Return all cells of a task and some methods."""
        return [cell for cell in self.cells if cell.task == task and cell.method in methods]

    def chosen(self, setting: str, task: str, method: str) -> Cell | None:
        """Return a method's cell on a task; None if there is none, or none is complete."""
        metric, among = SETTINGS[setting].metric, self.candidates[setting].get((task, method), [])
        values = {cell: self.values(cell, metric).tolist() for cell in among}
        return choose(values, [cell for cell in among if not self.missing(cell)])

    def _runs(self, cell: Cell) -> Iterator[pd.DataFrame]:
        """Return the generations of each of a cell's runs, by seed."""
        if cell in self.histories:
            yield from (run for _, run in self.histories[cell].groupby("seed"))

    @cached_property
    def _by_cell(self) -> dict[Cell, pd.DataFrame]:
        keys = ["task", "method", "population", "learning_rate"]
        groups = self.runs.sort_values("seed").groupby(keys, dropna=False)
        return {_cell(*place): runs for place, runs in groups}  # type: ignore[arg-type]


def gather(campaign: Campaign, *further: Campaign) -> Outcomes:
    """Return the outcomes of a campaign and of further ones, which have other cells."""
    configuration = campaign.configuration
    campaigns = dict.fromkeys(cells(configuration), campaign)
    campaigns |= {cell: each for each in further for cell in cells(each.configuration)}
    rows = [row for cell, each in campaigns.items() for row in _rows(each, cell)]
    columns = ["task", "method", "population", "learning_rate", "seed", *_OWN]
    return Outcomes(
        pd.DataFrame(rows, columns=columns).astype(
            dict.fromkeys(["learning_rate", *_OWN], np.float64)
        ),
        tuple(campaigns),
        {setting: candidates(configuration, setting) for setting in SETTINGS},
        configuration.budget,
        {cell: each.runs(cell).rows for cell, each in campaigns.items()},
        frozenset(cell for cell, each in campaigns.items() if is_near_control(each, cell)),
    )


def _rows(campaign: Campaign, cell: Cell) -> Iterator[tuple[object, ...]]:
    """Return the outcomes of each run of a cell."""
    own = [campaign.values(cell, metric) for metric in _OWN]
    place = cell.task, cell.method, cell.population, cell.learning_rate
    yield from ((*place, seed, *(values[seed] for values in own)) for seed in sorted(own[0]))


def _cell(task: str, method: str, population: int, learning_rate: float) -> Cell:
    rate = None if np.isnan(learning_rate) else float(learning_rate)
    return Cell(task, method, int(population), rate)


Metric = Literal["final_best", "score", "equal_evaluations", "equal_steps", "held_out"]


Setting = Literal["table3", "table4", "score"]
