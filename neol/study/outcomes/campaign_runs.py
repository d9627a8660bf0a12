"""A budget's runs, read from its records."""

import hashlib
import math
import sys
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Self

import numpy as np
import pandas as pd

from neol.base.errors import UserError
from neol.base.files import read_bounded
from neol.run.provenance import refuse_another_package
from neol.run.record import SCHEMA, Record
from neol.run.record_file import MAX_RECORD_BYTES, parse_record
from neol.spec.configuration import Configuration
from neol.spec.run_spec import RunSpec
from neol.study.campaign.grid import RESULTS, Block, Cell, blocks, cells, run_specs
from neol.study.outcomes.score import samples, score
from neol.study.outcomes.statistics import Floats


@dataclass(frozen=True, slots=True)
class Source:
    """A record that was read."""

    path: str
    """Path that begins with the results folder's name: results/rare_mutation/smoke/cartpole/..."""
    sha256: str
    """SHA-256 of the file."""
    spec: str
    """Digest of the specification without the seed."""
    runs: dict[int, str]
    """Trajectory digest of each seed."""

    @classmethod
    def read(cls, results: Path, below: Path, spec: RunSpec) -> tuple[Record, Self]:
        """Read the record at a path below a results folder, as `read_record` does, and its source.

        Both come from the same bytes, since another process may replace the file meanwhile.
        """
        path = results / below
        content = read_bounded(path, MAX_RECORD_BYTES)
        record = parse_record(path, content, spec)
        source = cls(
            path=str(Path(results.resolve().name, below)),
            sha256=hashlib.sha256(content).hexdigest(),
            spec=record.spec.digest(),
            runs={info.seed: info.digest for info in record.seeds},
        )
        return record, source


@dataclass(frozen=True)
class CellRuns:
    """The runs of one cell that have records."""

    cell: Cell
    rows: pd.DataFrame
    """One row for each seed and generation, with the columns of a record."""
    missing: tuple[int, ...]
    """Seeds of the budget that no record holds."""
    sources: tuple[Source, ...]
    held_out: dict[int, float]
    """Mean return of the champion in fresh episodes, by seed; NaN where all of them failed."""
    cpu_seconds: dict[int, float]
    """CPU seconds of each seed."""

    @cached_property
    def best_fitness(self) -> dict[int, Floats]:
        """Best fitness of each generation, by seed."""
        rows = self.rows.sort_values(["seed", "generation"])
        return {
            int(seed): best.to_numpy(dtype=np.float64)  # type: ignore[arg-type]
            for seed, best in rows.groupby("seed")["best_fitness"]
        }

    @property
    def final_best(self) -> dict[int, float]:
        """Best fitness of the final generation, by seed."""
        return {seed: float(best[-1]) for seed, best in self.best_fitness.items()}


class Campaign:
    """A budget's runs in a results folder; each cell is read once, when it is first asked for."""

    def __init__(
        self, configuration: Configuration, results: Path = RESULTS, *, partial: bool = False
    ) -> None:
        """Raise UserError if the calling workflow runs another installation of neol.

        `partial`: whether runs are expected to be missing, so that no note says which.
        """
        refuse_another_package()
        self.configuration = configuration
        self._results = results
        self._partial = partial
        self._blocks: dict[Cell, list[Block]] = {}
        for block in blocks(configuration):
            self._blocks.setdefault(block.cell, []).append(block)
        self._read: dict[Cell, CellRuns] = {}

    def runs(self, cell: Cell) -> CellRuns:
        """Return a cell's runs. Raises UserError for a damaged record or one of another spec."""
        if cell not in self._read:
            self._read[cell] = self._read_cell(cell)
        return self._read[cell]

    def values(self, cell: Cell, metric: str) -> dict[int, float]:
        """Return an outcome of the cell's runs by seed: final_best, score or held_out."""
        runs = self.runs(cell)
        if metric == "score":
            return {
                seed: score(best, cell.population, self.score_samples(cell.task))
                for seed, best in runs.best_fitness.items()
            }
        return {"final_best": runs.final_best, "held_out": runs.held_out}[metric]

    def score_samples(self, task: str) -> float:
        """Return M, by which the SCORE of a task's runs is divided in this budget."""
        budget = self.configuration.budget
        return samples(budget.generations_of(task), max(budget.populations_of(task)))

    def sources(self, cells: Iterable[Cell]) -> tuple[Source, ...]:
        """Return the records of some cells, each once."""
        return tuple(source for cell in dict.fromkeys(cells) for source in self.runs(cell).sources)

    def _read_cell(self, cell: Cell) -> CellRuns:
        missing: list[int] = []
        rows: list[pd.DataFrame] = []
        sources: list[Source] = []
        held_out: dict[int, float] = {}
        cpu_seconds: dict[int, float] = {}
        for block in self._blocks[cell]:
            path = self._results / block.record
            if not path.exists():
                missing += block.seeds
                continue
            spec = run_specs(self.configuration, block)[0]
            record, source = Source.read(self._results, block.record, spec)
            missing += _missing(path, record, block)
            rows.append(record.frame())
            for info in record.seeds:
                mean = info.held_out.mean
                held_out[info.seed] = math.nan if mean is None else mean
                cpu_seconds[info.seed] = info.cpu_seconds
            sources.append(source)
        if missing and not self._partial:
            seeds = ", ".join(map(str, missing))
            print(f"neol: {cell.folder}: no record of seeds {seeds}", file=sys.stderr)
        table = pd.concat(rows, ignore_index=True) if rows else pd.DataFrame(columns=SCHEMA.names)
        return CellRuns(cell, table, tuple(missing), tuple(sources), held_out, cpu_seconds)


def _missing(path: Path, record: Record, block: Block) -> list[int]:
    """Return the block's seeds that its record does not hold."""
    there = {info.seed for info in record.seeds}
    strangers = sorted(there - set(block.seeds))
    if strangers:
        raise UserError(
            f"{path}: holds seed {strangers[0]}, its name says {block.first} to {block.last}; "
            "restore it, or remove it and run again"
        )
    return [seed for seed in block.seeds if seed not in there]


SECONDS_IN_AN_HOUR = 3600


COSTS = ("runs", "evaluations", "env_steps", "core_hours")


def costs(campaign: Campaign) -> pd.DataFrame:
    """Return the costs of a budget: a row for each task and for "all" of them, columns `COSTS`.

    Environment steps are those of training. Core-hours are CPU time; they include held-out
    episodes but not worker processes.
    """
    rows = []
    for cell in cells(campaign.configuration):
        runs = campaign.runs(cell)
        spent = runs.rows.groupby("seed")[["evaluations", "env_steps"]].max().sum()
        hours = sum(runs.cpu_seconds.values()) / SECONDS_IN_AN_HOUR
        rows.append(
            (cell.task, len(runs.cpu_seconds), spent["evaluations"], spent["env_steps"], hours)
        )
    by_task = pd.DataFrame(rows, columns=["task", *COSTS]).groupby("task", sort=False).sum()
    by_task.loc["all"] = by_task.sum()
    counts = ["runs", "evaluations", "env_steps"]
    return by_task.astype(dict.fromkeys(counts, "int64"))
