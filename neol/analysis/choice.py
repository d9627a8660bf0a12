"""Which of a budget's cells stands for a method on a task."""

from collections.abc import Mapping

from neol.campaign import Cell, cells, paper_cells
from neol.spec import Configuration

METHODS = ("bcm", "hebb", "oja", "neat")
"""Columns of the paper's Table 1, in its order."""


def candidates(configuration: Configuration) -> dict[tuple[str, str], list[Cell]]:
    """The cells that Table 1 chooses among, for each task and method that the budget has.

    The paper's configuration (Table 3) alone where the budget's grid has it, otherwise the grid.
    """
    grid, paper = cells(configuration), paper_cells(configuration, table=3)
    chosen: dict[tuple[str, str], list[Cell]] = {}
    for cell in grid:
        place = cell.task, cell.method
        if cell.method in METHODS and paper.get(place, cell) == cell:
            chosen.setdefault(place, []).append(cell)
    return chosen


def best(means: Mapping[Cell, float]) -> Cell:
    """The cell with the highest mean, as the paper chooses (Table 5's caption).

    Of equal means the smaller population wins, then the smaller rate.
    """
    return min(means, key=lambda cell: (-means[cell], cell.population, cell.learning_rate or 0.0))
