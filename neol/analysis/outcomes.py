"""What every run of a budget came to: one row a run, from which all statistics are made."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt
import pandas as pd

from neol.analysis.choice import best
from neol.campaign import Cell

Floats = npt.NDArray[np.float64]

METRICS = {
    "final_best": "final best fitness",
    "score": "SCORE",
    "equal_evaluations": "mean best-so-far fitness at equal evaluations",
    "equal_steps": "mean best-so-far fitness at equal environment steps",
    "held_out": "held-out return of the champion",
}
"""Outcomes of a run, and how they are called in print."""

CHOSEN_BY = {"table3": "final_best", "table4": "final_best", "score": "score"}
"""Each setting, and the metric whose highest mean chooses where the paper's cell is not there.

`table3`, `table4`: the paper's configurations; `score`: the largest population and the best rate.
"""


@dataclass(frozen=True)
class Outcomes:
    """The runs of a budget that there are."""

    runs: pd.DataFrame
    """A row a run: task, method, population, learning_rate (NaN for none), seed, and `METRICS`."""
    cells: tuple[Cell, ...]
    """The budget's grid, whether it has runs or not."""
    candidates: Mapping[str, Mapping[tuple[str, str], list[Cell]]]
    """By setting, task and method: the cells that it chooses among."""
    seeds: int
    """How many each cell should have."""
    generations: int

    def values(self, cell: Cell, metric: str) -> Floats:
        """The runs of a cell, by seed."""
        return self._by_cell.get(cell, self.runs.iloc[:0])[metric].to_numpy(dtype=np.float64)

    def mean(self, cell: Cell, metric: str) -> float:
        """Over the seeds that there are; NaN without any."""
        values = self.values(cell, metric)
        return float(values.mean()) if len(values) else float("nan")

    def missing(self, cell: Cell) -> int:
        """How many of its seeds a cell lacks."""
        return self.seeds - len(self._by_cell.get(cell, ()))

    def grid(self, task: str, methods: Iterable[str]) -> list[Cell]:
        """All cells of a task and some methods."""
        return [cell for cell in self.cells if cell.task == task and cell.method in methods]

    def chosen(self, setting: str, task: str, method: str) -> Cell | None:
        """The cell that stands for a method on a task: the highest mean of the complete ones.

        A single candidate is taken as it is; None where the budget has none, or none is complete.
        """
        among = self.candidates[setting].get((task, method), [])
        if len(among) == 1:
            return among[0]
        complete = [cell for cell in among if not self.missing(cell)]
        if not complete:
            return None
        return best({cell: self.mean(cell, CHOSEN_BY[setting]) for cell in complete})

    @cached_property
    def _by_cell(self) -> dict[Cell, pd.DataFrame]:
        keys = ["task", "method", "population", "learning_rate"]
        groups = self.runs.sort_values("seed").groupby(keys, dropna=False)
        return {_cell(*place): runs for place, runs in groups}  # type: ignore[arg-type]


def _cell(task: str, method: str, population: int, learning_rate: float) -> Cell:
    rate = None if np.isnan(learning_rate) else float(learning_rate)
    return Cell(task, method, int(population), rate)
