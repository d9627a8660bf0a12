"""The choice of the cell that represents a method on a task."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from statistics import fmean

from neol.spec.configuration import Configuration
from neol.spec.constants import Budget
from neol.study.campaign.grid import Cell, cells, paper_cells
from neol.study.campaign.methods import challengers


@dataclass(frozen=True, slots=True)
class CellChoice:
    """A table's rule for choosing the cells that it shows."""

    against: tuple[str, ...]
    """The baseline that rules are compared with: `neat` or `neat_wo`."""
    metric: str
    """Outcome whose highest mean decides between several cells."""
    paper_table: int | None
    """Table of configurations, 3 or 4; None for the largest population with any learning rate."""

    def methods(self, budget: Budget) -> tuple[str, ...]:
        """Return the table's columns in the paper's order."""
        return (*challengers(budget), *self.against)


SETTINGS = {
    "table3": CellChoice(("neat",), "final_best", paper_table=3),
    "table4": CellChoice(("neat_wo",), "final_best", paper_table=4),
    "score": CellChoice(("neat", "neat_wo"), "score", paper_table=None),
}
"""The settings of Tables 1, 3 and 5; of Tables 4 and 7; of Tables 2, 6 and 8."""


def candidates(
    configuration: Configuration, setting: str = "table3"
) -> dict[tuple[str, str], list[Cell]]:
    """Return the cells that a setting chooses among, for each task and method of the budget.

    They are the paper's configuration alone where the budget's grid has it, otherwise the whole
    grid; for SCORE, the cells of the largest population.
    """
    chosen_by, grid = SETTINGS[setting], cells(configuration)
    methods = chosen_by.methods(configuration.budget)
    table, budget = chosen_by.paper_table, configuration.budget
    paper = {} if table is None else paper_cells(configuration, table)
    chosen: dict[tuple[str, str], list[Cell]] = {}
    for cell in grid:
        place = cell.task, cell.method
        is_candidate = (
            cell.population == max(budget.populations_of(cell.task))
            if table is None
            else paper.get(place, cell) == cell
        )
        if cell.method in methods and is_candidate:
            chosen.setdefault(place, []).append(cell)
    return chosen


def choose(values: Mapping[Cell, Sequence[float]], complete: Collection[Cell]) -> Cell | None:
    """Return the best of some cells by their runs' values, among those that have all their seeds.

    A single cell is taken as it is. Returns None if there is no cell, or none is complete.
    """
    if len(values) == 1:
        return next(iter(values))
    means = {cell: fmean(runs) for cell, runs in values.items() if cell in complete}
    return best(means) if means else None


def best(means: Mapping[Cell, float]) -> Cell:
    """Return the cell with the highest mean, as the paper chooses (Table 5's caption).

    Ties go to the smaller population, then to the smaller rate.
    """
    return min(means, key=lambda cell: (-means[cell], cell.population, cell.learning_rate or 0.0))
