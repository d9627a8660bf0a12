"""The two sides of a comparison, from our runs and from the paper's tables."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from neol.spec.configuration import load_configuration
from neol.study.campaign.grid import Cell
from neol.study.campaign.reference import settings
from neol.study.claims.effect import Statistic, Summary
from neol.study.claims.questions import Side
from neol.study.outcomes.outcomes import Metric, Outcomes
from neol.study.outcomes.paper_numbers import PAPER_SEEDS, PRINTED_IN, values
from neol.study.outcomes.statistics import Floats

_PRINTED = {"final_best": ("table3", "table4"), "score": ("largest",)}
"""Choices of cells whose means the paper prints, by outcome."""

CHOOSING, TESTED = slice(0, None, 2), slice(1, None, 2)
"""Seeds that choose the best of several cells, and those on which it is tested."""


@dataclass(frozen=True, slots=True)
class Choice:
    """The cells that represent a method on a task."""

    cells: tuple[Cell, ...]
    """The cells; empty if the budget has none."""
    one_of: bool
    """Whether only the best of them represents the method; otherwise all do."""
    papers: bool
    """Whether these are the paper's cells; otherwise the budget's substitutes."""

    def values(self, of_cell: Mapping[Cell, Floats]) -> Floats:
        """Return float64[cells, seeds]; a cell chosen by the even seeds has its odd ones."""
        table = np.array([of_cell[cell] for cell in self.cells])
        if not self.one_of or len(self.cells) == 1:
            return table
        best = int(np.argmax(table[:, CHOOSING].mean(axis=1)))
        return table[best : best + 1, TESTED]


@dataclass(frozen=True, slots=True)
class Runs:
    """Some of a campaign's seeds: the same places in the order of seeds for every cell."""

    outcomes: Outcomes
    begin: int
    end: int

    def tables(self, choices: Sequence[Choice], outcome: Metric) -> list[Floats]:
        """Return the runs of each of some choices that are compared with each other."""
        cells = list(dict.fromkeys(cell for choice in choices for cell in choice.cells))
        samples = self.outcomes.samples(cells, outcome)
        of_cell = {
            cell: sample[self.begin : self.end] for cell, sample in zip(cells, samples, strict=True)
        }
        return [choice.values(of_cell) for choice in choices]

    def summaries(
        self, sides: Sequence[Sequence[Choice]], outcome: Metric, statistic: Statistic = "mean"
    ) -> list[Summary]:
        """Summarise each of some sides that are compared: its methods together.

        Where only some of a side's methods have a chosen cell, all have that cell's seeds.
        """
        tables = iter(self.tables([choice for side in sides for choice in side], outcome))
        return [
            Summary.of_runs(
                np.concatenate(_of_same_seeds([next(tables) for _ in side])),
                spread=statistic == "spread",
            )
            for side in sides
        ]


def choose(outcomes: Outcomes, side: Side, task: str, method: str) -> Choice:
    """Return the cells that a side of a question names."""
    grid = outcomes.grid(task, [method])
    largest = max((cell.population for cell in grid), default=0)
    if side.cells in ("table3", "table4"):
        named = settings(int(side.cells[-1])).get((task, method))
        found = [cell for cell in grid if (cell.population, cell.learning_rate) == named]
        if found:
            return Choice(tuple(found), one_of=False, papers=True)
        return Choice(_of_size(grid, largest), one_of=True, papers=False)
    sizes, rates = _papers_grid()
    if side.cells == "largest":
        cells = _of_size(grid, largest)
        papers = largest == max(sizes) and _rates(cells) in ({None}, set(rates))
        return Choice(cells, one_of=True, papers=papers)
    wanted = side.populations or sizes, side.learning_rates or rates
    cells = tuple(
        cell
        for cell in grid
        if cell.population in wanted[0] and cell.learning_rate in (None, *wanted[1])
    )
    expected = len(wanted[0]) * (1 if _rates(cells) == {None} else len(wanted[1]))
    return Choice(cells, one_of=side.cells == "best", papers=len(cells) == expected)


@cache
def printed(
    side: Side, outcome: str, task: str, methods: tuple[str, ...], baseline: str
) -> Summary | None:
    """Return the paper's numbers of some methods, from the table with this baseline."""
    if side.cells not in _PRINTED.get(outcome, ()) or baseline not in ("neat", "neat_wo"):
        return None
    table = values(PRINTED_IN[outcome, baseline])
    found = [table.get((task, method), (None, None)) for method in methods]
    numbers = [(mean, sd) for mean, sd in found if mean is not None and sd is not None]
    return Summary.printed(numbers, PAPER_SEEDS) if len(numbers) == len(found) else None


def _of_same_seeds(tables: Sequence[Floats]) -> list[Floats]:
    """Keep the tested seeds of every table if one table has no others."""
    fewest = min(table.shape[1] for table in tables)
    return [table if table.shape[1] == fewest else table[:, TESTED] for table in tables]


def _of_size(cells: Iterable[Cell], population: int) -> tuple[Cell, ...]:
    return tuple(cell for cell in cells if cell.population == population)


def _rates(cells: Iterable[Cell]) -> set[float | None]:
    return {cell.learning_rate for cell in cells}


@cache
def _papers_grid() -> tuple[tuple[int, ...], tuple[float, ...]]:
    budget = load_configuration("paper").budget
    return budget.populations_of(budget.tasks[0]), budget.learning_rates
