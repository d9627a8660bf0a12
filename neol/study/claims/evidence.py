"""Evidence of runs on a question: the effects of its parts and of the question as a whole.

A part is one rule on one task. The whole is not a vote of the parts: its effect is the average of
all rules against the same baseline, averaged over the tasks.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from neol.study.campaign.grid import Cell
from neol.study.claims.effect import Effect, average, combined
from neol.study.claims.parts import State
from neol.study.claims.sides import Choice, Runs
from neol.study.outcomes.outcomes import Outcomes

LEAST_SEEDS = 6
"""Fewest seeds from which effects are computed; where a cell is chosen, half of them remain."""


@dataclass(frozen=True, slots=True)
class Evidence:
    """Effects of our runs and of the paper's numbers, for a part of a question or the whole."""

    label: str
    cells: tuple[Cell, ...]
    """Cells whose runs it uses, or of which one is chosen."""
    papers_cells: bool
    """Whether the cells are all those of the paper's question."""
    ours: Effect | None = None
    """Effect of our runs; None if they are too few, or do not vary."""
    paper: Effect | None = None
    """Effect of the paper's numbers; None if it prints no such numbers."""
    margin: float = 0.0
    """Effects smaller than this count as none."""
    state: State | None = None
    """State of the part if a rule other than the effect's interval decides it."""


@dataclass(frozen=True, slots=True)
class Answered:
    """Evidence on all parts of a question, and on the whole; None where the parts decide."""

    parts: tuple[Evidence, ...]
    whole: Evidence | None


def measured(
    label: str,
    choices: Sequence[Choice],
    runs: Runs,
    effect: Callable[[], Effect | None],
    paper: Effect | None,
    margin: float = 0.0,
) -> Evidence:
    """Return evidence on a part, whose effect is computed if there are enough runs.

    `choices` are all cells that it needs; `paper` and `margin` go with it as they are.
    """
    cells = tuple(cell for choice in choices for cell in choice.cells)
    papers = all(choice.cells and choice.papers for choice in choices)
    enough = runs.end - runs.begin >= LEAST_SEEDS
    complete = leading(runs.outcomes, cells) >= runs.end
    there = enough and complete and all(choice.cells for choice in choices)
    ours = effect() if there else None
    return Evidence(label, cells, papers, ours, paper, margin)


def averaged(each: Sequence[Evidence]) -> Evidence:
    """Return the average over tasks, or over parts."""
    if len(each) == 1:
        return each[0]
    ours, paper = ([getattr(one, name) for one in each] for name in ("ours", "paper"))
    return Evidence(
        "all",
        tuple(cell for one in each for cell in one.cells),
        all(one.papers_cells for one in each),
        None if None in ours else average(ours),
        None if None in paper else average(paper),
        float(np.mean([one.margin for one in each])),
    )


def minus(first: Evidence, second: Evidence) -> Evidence:
    """Return the first side's effect minus the second's."""

    def effect(name: Literal["ours", "paper"]) -> Effect | None:
        one, other = getattr(first, name), getattr(second, name)
        return None if one is None or other is None else combined([(1, one), (-1, other)])

    return Evidence(
        "all",
        (*first.cells, *second.cells),
        first.papers_cells and second.papers_cells,
        effect("ours"),
        effect("paper"),
        first.margin,
    )


def leading(outcomes: Outcomes, cells: Sequence[Cell]) -> int:
    """Return how many of the first seeds all cells have."""
    return min((outcomes.leading(cell) for cell in cells), default=0)
