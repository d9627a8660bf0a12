"""The grid of a budget: its cells, their runs, and the path of each record."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from decimal import Decimal
from pathlib import Path

from neol.base.errors import UserError
from neol.run.record import campaign_name
from neol.spec.configuration import Configuration, load_configuration
from neol.spec.constants import Budget
from neol.spec.run_spec import RunSpec
from neol.study.campaign.methods import without_mutation
from neol.study.campaign.reference import settings

RESULTS = Path("results")


@dataclass(frozen=True, slots=True)
class Cell:
    """One configuration of a grid; `learning_rate` is None for a method without a rule."""

    task: str
    method: str
    population: int
    learning_rate: float | None

    @property
    def folder(self) -> Path:
        """Folder of its records below a budget's folder: cartpole/hebb/p050_lr0.00025."""
        suffix = "" if self.learning_rate is None else f"_lr{_plain(self.learning_rate)}"
        return Path(self.task, self.method, f"p{self.population:03d}{suffix}")


@dataclass(frozen=True, slots=True)
class Block:
    """Seeds `first` to `last` of a cell, which one job runs into one record."""

    home: Path
    """Folder of the budget that keeps its record, below the results folder: rare_mutation/smoke."""
    cell: Cell
    first: int
    last: int

    @property
    def seeds(self) -> range:
        return range(self.first, self.last + 1)

    @property
    def record(self) -> Path:
        """Path below the results folder; it ends like cartpole/neat/p050/seeds_000-004.parquet."""
        name = f"seeds_{self.first:03d}-{self.last:03d}.parquet"
        return self.home / self.cell.folder / name


def home(configuration: Configuration) -> Path:
    """Return the folder of a campaign's records below the results folder: rare_mutation/smoke."""
    return Path(campaign_name(configuration.reading, configuration.budget.name))


def cells(configuration: Configuration) -> list[Cell]:
    """Return the budget's grid in the order of its file: tasks, methods, populations, rates."""
    return [cell for task in configuration.budget.tasks for cell in _cells(configuration, task)]


def blocks(configuration: Configuration) -> list[Block]:
    """Return the budget's jobs in the order of its cells and seeds."""
    return [block for cell in cells(configuration) for block in _split(configuration, cell)]


def check_shared_records(configuration: Configuration) -> None:
    """Check that runs whose records another budget keeps are runs of that budget.

    Raises UserError, with the first record that is not.
    """
    budget = configuration.budget
    for task, name in budget.records_of.items():
        keeper = load_configuration(name, reading=configuration.reading)
        kept = set(blocks(keeper))
        for block in blocks(configuration):
            if block.cell.task == task and not (
                block in kept and run_specs(keeper, block) == run_specs(configuration, block)
            ):
                raise UserError(
                    f"budget {budget.name}: records_of.{task} = {name}: {block.record} is not a "
                    f"record of that budget, or not with the same constants"
                )


def run_specs(configuration: Configuration, block: Block) -> list[RunSpec]:
    """Return the runs of a block in the order of their seeds."""
    cell = block.cell
    return [
        configuration.run_spec(
            task=cell.task,
            method=cell.method,
            population=cell.population,
            learning_rate=cell.learning_rate,
            generations=configuration.budget.generations_of(cell.task),
            seed=seed,
        )
        for seed in block.seeds
    ]


def paper_cells(configuration: Configuration, table: int) -> dict[tuple[str, str], Cell]:
    """Return the budget's cells of the paper's Table 3 or 4, by task and method."""
    available = set(cells(configuration))
    named = _configurations(configuration.budget, table)
    return {(cell.task, cell.method): cell for cell in named if cell in available}


def _cells(configuration: Configuration, task: str) -> list[Cell]:
    budget = configuration.budget
    grid = [
        Cell(task, method, population, learning_rate)
        for method in budget.methods
        for population in budget.populations_of(task)
        for learning_rate in (
            budget.learning_rates if configuration.methods[method].learns else [None]
        )
    ]
    part = budget.configurations_of(task)
    if part == "grid":
        return grid
    named = _configurations(budget, 4)
    if part == "tables":
        named += _configurations(budget, 3)
    return [cell for cell in grid if replace(cell, method=without_mutation(cell.method)) in named]


def _configurations(budget: Budget, table: int) -> list[Cell]:
    """Return the cells of the paper's Table 3 or 4, for the budget's tasks.

    Where a task has these cells alone, a population that it does not have becomes its largest.
    """

    def available(task: str, population: int) -> int:
        there = budget.populations_of(task)
        is_kept = budget.configurations_of(task) == "grid" or population in there
        return population if is_kept else max(there)

    return [
        Cell(task, method, available(task, population), learning_rate)
        for (task, method), (population, learning_rate) in settings(table).items()
        if task in budget.tasks
    ]


def _split(configuration: Configuration, cell: Cell) -> Iterator[Block]:
    budget = configuration.budget
    keeper = budget.records_of.get(cell.task, budget.name)
    place = Path(campaign_name(configuration.reading, keeper))
    size = budget.seeds_per_job_of(cell.task)
    seeds = budget.seeds_of(cell.task)
    for part in (seeds[begin : begin + size] for begin in range(0, len(seeds), size)):
        yield Block(place, cell, part[0], part[-1])


def _plain(number: float) -> str:
    """Return the shortest decimal that reads back as the number, without an exponent."""
    return format(Decimal(repr(number)), "f")
