"""Mean and deviation of each method on each task, ranked, beside the paper's."""

import math
import statistics
from collections.abc import Sequence
from dataclasses import dataclass, replace

from neol.study.campaign.grid import Cell, paper_cells
from neol.study.campaign.reference import settings
from neol.study.outcomes import paper_numbers
from neol.study.outcomes.campaign_runs import Campaign
from neol.study.outcomes.chosen_cells import SETTINGS, candidates, choose
from neol.study.outcomes.movement import is_near_control
from neol.study.tables.table import Emphasis


@dataclass(frozen=True, slots=True)
class Summary:
    """A method on a task: its cell, and an outcome over the cell's seeds."""

    population: int | None = None
    learning_rate: float | None = None
    mean: float = math.nan
    sd: float = math.nan
    rank: Emphasis = ""
    """Rank of the mean among the methods on the task."""


@dataclass(frozen=True, slots=True)
class OwnSummary(Summary):
    """A summary of our runs, from records."""

    chosen: str = ""
    """ "Table 3" or "Table 4" for the paper's cell, "grid" for the best of the grid.

    A budget without the paper's population has its own largest there.
    """
    seeds: int = 0
    """Number of seeds."""
    incomplete: str = ""
    """A note of what is missing; such a value is not ranked."""
    near_control: bool = False
    """Whether the cell's rule hardly moves a weight."""
    held_out: float = math.nan
    """Mean over seeds of the champion's mean return in fresh episodes; NaN without any."""


@dataclass(frozen=True, slots=True)
class OursAndPapers:
    """A method on a task, here and in the paper."""

    task: str
    method: str
    here: OwnSummary
    paper: Summary


def compare(
    campaign: Campaign, setting: str, table: int, methods: Sequence[str]
) -> list[OursAndPapers]:
    """Return the content of a table of means: each method on each of the budget's tasks.

    The setting decides which cells are chosen and which outcome is averaged; `table` is the number
    of the paper's table.
    """
    chosen_among = candidates(campaign.configuration, setting)
    comparisons = []
    for task in campaign.configuration.budget.tasks:
        here = [
            summarise(campaign, chosen_among.get((task, method), []), setting) for method in methods
        ]
        paper = [_paper_summary(task, method, setting, table) for method in methods]
        own_ranks = ranks([math.nan if each.incomplete else each.mean for each in here])
        paper_ranks = ranks([each.mean for each in paper])
        for i, method in enumerate(methods):
            own = replace(here[i], rank=own_ranks[i])
            comparisons.append(
                OursAndPapers(task, method, own, replace(paper[i], rank=paper_ranks[i]))
            )
    return comparisons


def best_fitness(campaign: Campaign) -> list[OursAndPapers]:
    """Return the content of Table 1 (and of Table 3)."""
    return compare(
        campaign,
        "table3",
        table=1,
        methods=SETTINGS["table3"].methods(campaign.configuration.budget),
    )


def summarise(campaign: Campaign, cells: Sequence[Cell], setting: str) -> OwnSummary:
    """Summarise the cell with the highest mean, among those that have all their seeds.

    A single cell is summarised over the seeds that it has, and `incomplete` names missing ones.
    """
    if not cells:
        return OwnSummary(incomplete="not in this budget")
    runs = {cell: campaign.runs(cell) for cell in cells}
    metric, table = SETTINGS[setting].metric, SETTINGS[setting].paper_table
    values = {cell: list(campaign.values(cell, metric).values()) for cell in cells}
    complete = [each for each in cells if not runs[each].missing]
    cell = choose(values, complete)
    if cell is None:
        return OwnSummary(incomplete=f"none of {len(cells)} cells is complete")
    incomplete = ""
    if runs[cell].missing:
        incomplete = f"without seeds {', '.join(map(str, runs[cell].missing))}"
    elif len(complete) < len(cells):
        incomplete = f"chosen among the {len(complete)} of {len(cells)} cells that are complete"
    mean, sd = mean_sd(values[cell])
    fresh = [value for value in runs[cell].held_out.values() if not math.isnan(value)]
    from_paper = table is not None and cell in paper_cells(campaign.configuration, table).values()
    return OwnSummary(
        population=cell.population,
        learning_rate=cell.learning_rate,
        mean=mean,
        sd=sd,
        chosen=f"Table {table}" if from_paper else "grid",
        seeds=len(values[cell]),
        incomplete=incomplete,
        near_control=is_near_control(campaign, cell),
        held_out=mean_sd(fresh)[0],
    )


def mean_sd(values: Sequence[float]) -> tuple[float, float]:
    """Return mean and sample standard deviation (n - 1), independent of the values' order.

    NaN for the mean of nothing and for the deviation of fewer than two values.
    """
    mean = statistics.fmean(values) if values else math.nan
    return mean, statistics.stdev(values) if len(values) > 1 else math.nan


def ranks(means: Sequence[float]) -> list[Emphasis]:
    """Return the rank of each mean in a table's row; NaN is not ranked.

    Means are compared at full precision. All that equal the highest are best, all that equal the
    next one runners-up; but a shared first place leaves no second, as in the paper's CartPole row.
    """
    ranked = sorted((mean for mean in means if not math.isnan(mean)), reverse=True)
    first, second = [*ranked, math.nan, math.nan][:2]
    return ["best" if mean == first else "runner-up" if mean == second else "" for mean in means]


def _paper_summary(task: str, method: str, setting: str, table: int) -> Summary:
    """Return what the paper prints of a method; an empty summary for a task that it lacks."""
    mean, sd = paper_numbers.values(table).get((task, method), (math.nan, None))
    configurations = SETTINGS[setting].paper_table
    printed = {} if configurations is None else settings(configurations)
    population, learning_rate = printed.get((task, method), (None, None))
    return Summary(population, learning_rate, mean, math.nan if sd is None else sd)
