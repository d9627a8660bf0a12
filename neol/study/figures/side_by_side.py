"""Records side by side: differences of their configurations, and outcomes of their runs."""

import math
import string
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from neol.base.errors import UserError
from neol.pictures.labels import method_label, task_label
from neol.pictures.style import WIDTH, drawing, footer, styles
from neol.run.record import Record, SeedInfo, join
from neol.run.record_file import read_record
from neol.spec.configuration import budgets, load_configuration
from neol.spec.run_spec import RunSpec, complete
from neol.spec.sources import by_dotted_key
from neol.study.figures.convergence import clip_to_runs, draw_curve
from neol.study.outcomes.score import samples, score
from neol.study.outcomes.statistics import mean_interval
from neol.study.verification.returns import Returns, returns_of

LETTERS = string.ascii_uppercase
UNBOUNDED = Returns(-math.inf, math.inf)


@dataclass(frozen=True)
class Compared:
    """Runs of one configuration."""

    letter: str
    path: Path
    """A record, or a folder whose records are of one configuration."""
    record: Record
    """All of its runs that were recorded."""

    @property
    def spec(self) -> RunSpec:
        """Return the specification, with the first seed."""
        return self.record.spec

    @property
    def name(self) -> str:
        """Return a name such as "BCM, P = 50, η = 0.25"."""
        plasticity = self.spec.plasticity
        rate = f", η = {plasticity.learning_rate:g}" if plasticity.learns else ""
        return f"{method_label(self.spec.method)}, P = {self.spec.population}{rate}"

    @property
    def bounds(self) -> Returns:
        """Return the bounds of a return in the task."""
        return returns_of(self.spec.task) or UNBOUNDED

    @cached_property
    def best_fitness(self) -> pd.DataFrame:
        """Return best fitness: a row for each generation, a column for each seed."""
        table = self.record.frame()
        return table.pivot_table(index="generation", columns="seed", values="best_fitness")


def read_compared(paths: Sequence[Path]) -> list[Compared]:
    """Read the runs that each path names, which must be of one configuration (UserError)."""
    if len(paths) > len(LETTERS):
        raise UserError(f"{len(paths)} are too many to compare; name at most {len(LETTERS)}")
    return [
        Compared(letter, path, _read(path)) for letter, path in zip(LETTERS, paths, strict=False)
    ]


def differing_constants(compared: Sequence[Compared]) -> dict[str, list[str]]:
    """Return the constants that are not the same for all, each with its values."""
    constants = [by_dotted_key(complete(each.spec.without_seed())) for each in compared]
    values = {key: [str(each[key]) for each in constants] for key in constants[0]}
    return {key: each for key, each in values.items() if len(set(each)) > 1}


def outcome_rows(compared: Sequence[Compared]) -> dict[str, list[str]]:
    """Return the outcomes of the runs, each with its mean over seeds and 95% interval.

    Intervals of returns are cut at the bounds of the task. SCORE is included if all are runs of the
    same budget, which gives it its unit.
    """
    rows = {
        "runs": [str(len(each.record.seeds)) for each in compared],
        "final best fitness": [
            _mean(each.best_fitness.ffill().iloc[-1], bounds=each.bounds) for each in compared
        ],
        "held-out return": [
            _mean([_held_out(info) for info in each.record.seeds], bounds=each.bounds)
            for each in compared
        ],
    }
    if divisors := _score_samples(compared):
        rows["SCORE"] = [
            _mean([score(best.dropna(), each.spec.population, divisor)
                   for _, best in each.best_fitness.items()], digits=3)
            for each, divisor in zip(compared, divisors, strict=True)
        ]  # fmt: skip
    return rows


def learning_curves(compared: Sequence[Compared]) -> Figure:
    """Draw best fitness over generations, a panel for each task."""
    tasks = list(dict.fromkeys(each.spec.task.name for each in compared))
    methods = [each.spec.method for each in compared]
    distinct = len(set(methods)) == len(methods)
    looks = styles(methods if distinct else [each.letter for each in compared])
    with drawing():
        figure = Figure(figsize=(WIDTH, 3.2))
        for axes, task in zip(figure.subplots(1, len(tasks), squeeze=False)[0], tasks, strict=True):
            here = [each for each in compared if each.spec.task.name == task]
            for each, label in zip(here, _labels(here), strict=True):
                look = looks[each.spec.method if distinct else each.letter]
                marked = (compared.index(each) + 0.5) / len(compared)
                draw_curve(axes, label, look, each.best_fitness.dropna(), marked)
            values = [each.best_fitness.to_numpy().ravel() for each in here]
            clip_to_runs(axes, pd.Series(np.concatenate(values)))
            axes.set_title(task_label(task))
            axes.set_xlabel("Generation")
            axes.xaxis.set_major_locator(MaxNLocator(5, integer=True))
        figure.axes[0].set_ylabel("Best fitness (return)")
        figure.legend(loc="outside upper center", ncols=min(len(compared), 3))
        several = any(len(each.record.seeds) > 1 for each in compared)
        footer(figure, "Lines: means over seeds; bands: their 95% intervals, cut at the range of "
                       "the runs." if several else "Each line is one run.")  # fmt: skip
    return figure


def _labels(compared: Sequence[Compared]) -> list[str]:
    """Return labels such as "A: BCM, P = 50, η = 0.25"; equal names also list what differs."""
    labels = []
    for each in compared:
        alike = [other for other in compared if other.name == each.name]
        values = {key: of[alike.index(each)] for key, of in differing_constants(alike).items()}
        constants = [f"{key} = {value}" for key, value in values.items()]
        labels.append("\n".join([f"{each.letter}: {each.name}", *constants]))
    return labels


def _read(path: Path) -> Record:
    if not path.is_dir():
        return read_record(path)
    records = [read_record(each) for each in sorted(path.glob("*.parquet"))]
    if not records:
        raise UserError(f"{path}: holds no records; name a record or a folder of one cell's")
    if len({(record.spec.digest(), record.budget, record.reading) for record in records}) > 1:
        raise UserError(
            f"{path}: its records are of several configurations, budgets or readings; "
            "name them one by one"
        )
    seeds = [info.seed for record in records for info in record.seeds]
    if len(set(seeds)) < len(seeds):
        raise UserError(f"{path}: its records hold a seed twice; name them one by one")
    return join(records)


def _held_out(info: SeedInfo) -> float:
    return math.nan if info.held_out.mean is None else info.held_out.mean


def _score_samples(compared: Sequence[Compared]) -> list[float]:
    """Return M for each in the budget of all runs; empty if they are not whole runs of one."""
    names = {each.record.budget for each in compared}
    name = names.pop()
    if names or name not in budgets():
        return []
    budget = load_configuration(name).budget
    whole = all(
        each.spec.task.name in budget.tasks
        and each.spec.generations == budget.generations_of(each.spec.task.name)
        for each in compared
    )
    if not whole:
        return []
    return [
        samples(each.spec.generations, max(budget.populations_of(each.spec.task.name)))
        for each in compared
    ]


def _mean(values: npt.ArrayLike, *, digits: int = 1, bounds: Returns = UNBOUNDED) -> str:
    """Format the mean with Student's interval, cut at the bounds of what is possible."""
    known = np.asarray(values, dtype=np.float64)
    known = known[~np.isnan(known)]
    if not len(known):
        return "none"
    mean = f"{known.mean():.{digits}f}"
    low, high = np.clip(mean_interval(known), bounds.lowest, bounds.highest)
    return mean if len(known) == 1 else f"{mean} [{low:.{digits}f}, {high:.{digits}f}]"
