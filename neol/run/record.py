"""The record of a block of runs: their rows, champions and held-out episodes."""

import statistics
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, Self, get_type_hints

import numpy as np
import numpy.typing as npt
import pyarrow as pa
from pydantic import FailFast

from neol.base.errors import UserError
from neol.neat.genome import CONNECTION, NODE, Genome
from neol.run.evolution import COLUMNS, Generation
from neol.run.provenance import Provenance
from neol.spec.run_spec import RunSpec
from neol.spec.types import Model, Name, NonNegativeFloat, Sha256

if TYPE_CHECKING:
    import pandas as pd


class Champion(Model):
    """The best genome of the final population; with write-back its weights are learned ones."""

    id: int
    fitness: float
    nodes: Annotated[tuple[tuple[int, float], ...], FailFast()]
    """Nodes as (id, bias), outputs first."""
    connections: Annotated[tuple[tuple[int, int, int, float, bool], ...], FailFast()]
    """Connections as (innovation, source, target, weight, enabled)."""

    @classmethod
    def of(cls, genome: Genome) -> Self:
        """Return the stored form of a genome; all floats are exact."""
        return cls(
            id=genome.id,
            fitness=genome.fitness,
            nodes=tuple(genome.nodes.tolist()),
            connections=tuple(genome.connections.tolist()),
        )

    def genome(self) -> Genome:
        """Return the genome, bit for bit."""
        return Genome(
            self.id,
            np.array(list(self.nodes), dtype=NODE),
            np.array(list(self.connections), dtype=CONNECTION),
            self.fitness,
        )


class HeldOut(Model):
    """The champion's returns in held-out episodes."""

    returns: Annotated[tuple[float | None, ...], FailFast()]
    """Return of each episode; null where it failed."""
    mean: float | None
    """Mean over the episodes that did not fail."""
    sd: float | None
    """Standard deviation over these episodes (ddof = 1); null with fewer than two, or if it is too
    large for a float."""

    @classmethod
    def of(cls, returns: npt.NDArray[np.float64]) -> Self:
        """Return the stored form of returns, float64[episodes], NaN where an episode failed."""
        finite = returns[np.isfinite(returns)].tolist()
        return cls(
            returns=tuple(value if np.isfinite(value) else None for value in returns.tolist()),
            mean=_mean(finite) if finite else None,
            sd=_standard_deviation(finite) if len(finite) > 1 else None,
        )


def _mean(values: Sequence[float]) -> float:
    try:
        return statistics.fmean(values)
    except OverflowError:  # of the sum; the slower mean is exact
        return statistics.mean(values)


def _standard_deviation(values: Sequence[float]) -> float | None:
    try:
        return statistics.stdev(values)
    except OverflowError:
        return None


class SeedInfo(Model):
    """Results and provenance of one run, without its rows."""

    seed: int
    digest: Sha256
    """Digest of the trajectory (networks, returns, steps of each generation); no time, no host."""
    inputs: int
    outputs: int
    champion: Champion
    held_out: HeldOut
    engine: Name
    """Engine that played the episodes; all return the same bits."""
    wall_seconds: NonNegativeFloat
    cpu_seconds: NonNegativeFloat
    """CPU time of the process and its threads, without worker processes."""
    provenance: Provenance


def campaign_name(reading: str, budget: str) -> str:
    """Return a campaign's name, which is its folder below results/: rare_mutation/demo."""
    return f"{reading}/{budget}"


@dataclass(frozen=True, slots=True, repr=False)
class Record:
    """A block of runs that differ only in their seeds."""

    spec: RunSpec
    """Specification with the seed of the first run; `spec_of` returns that of any run."""
    budget: str | None
    """Budget of the constants; None for config/base.yaml alone."""
    reading: str | None
    """Label of the reading of the constants; None if none was chosen."""
    table: pa.Table
    """Rows with the columns of `SCHEMA`, sorted by seed and generation."""
    seeds: tuple[SeedInfo, ...]
    """Results of each run, sorted by seed."""

    def __repr__(self) -> str:
        """Show the runs in one line."""
        spec, seeds = self.spec, [info.seed for info in self.seeds]
        eta = f", eta={spec.plasticity.learning_rate:g}" if spec.plasticity.learns else ""
        shown = str(seeds) if len(seeds) < 4 else f"[{seeds[0]}, ..., {seeds[-1]}] ({len(seeds)})"
        return (
            f"<Record of {spec.task.name}, {spec.method}, P={spec.population}{eta}, "
            f"G={spec.generations}, seeds {shown}>"
        )

    @property
    def campaign(self) -> str | None:
        """Campaign of the record, such as rare_mutation/demo; None without budget or reading."""
        if self.budget is None or self.reading is None:
            return None
        return campaign_name(self.reading, self.budget)

    def frame(self) -> "pd.DataFrame":
        """Return the rows as a data frame.

        Arrow's threads are off, here and in reading: sometimes one still runs when Python ends,
        and aborts it (apache/arrow#34314).
        """
        frame: pd.DataFrame = self.table.to_pandas(use_threads=False)
        return frame

    def spec_of(self, seed: int) -> RunSpec:
        """Return the specification of one run."""
        return self.spec.model_copy(update={"seed": seed})

    def info(self, seed: int) -> SeedInfo:
        """Return the results of one run. Raises UserError for a missing seed."""
        for info in self.seeds:
            if info.seed == seed:
                return info
        known = ", ".join(str(info.seed) for info in self.seeds)
        raise UserError(f"has no seed {seed}; its seeds are {known}")

    def rows_of(self, seed: int) -> dict[str, npt.NDArray[Any]]:
        """Return the columns of one run, with one value for each generation."""
        mine = column_values(self.table, "seed") == seed
        return {name: column_values(self.table, name)[mine] for name in COLUMNS}


def join(records: Iterable[Record]) -> Record:
    """Join records that share a specification, a budget and a reading into one."""
    records = sorted(records, key=lambda record: record.seeds[0].seed)
    first = records[0]
    assert len({(record.spec.digest(), record.budget, record.reading) for record in records}) == 1
    return Record(
        spec=first.spec,
        budget=first.budget,
        reading=first.reading,
        table=pa.concat_tables([record.table for record in records]).combine_chunks(),
        seeds=tuple(info for record in records for info in record.seeds),
    )


_VALUES = get_type_hints(Generation, include_extras=True)


DOCUMENTATION: dict[str, tuple[str, str]] = {
    "seed": ("", "The run's seed."),
    **{name: value.__metadata__ for name, value in _VALUES.items()},
}
"""Unit and meaning of each column."""


_INTEGERS = {"seed"} | {name for name, value in _VALUES.items() if value.__origin__ is int}


SCHEMA = pa.schema(
    [
        pa.field(
            name,
            pa.int64() if name in _INTEGERS else pa.float64(),
            nullable=False,
            metadata={"unit": unit, "meaning": meaning},
        )
        for name, (unit, meaning) in DOCUMENTATION.items()
    ]
)


def describe_columns() -> str:
    """Return the columns as a Markdown table."""

    def cell(text: str) -> str:
        return text.replace("|", "\\|") or "-"

    rows = [
        f"| `{field.name}` | {field.type} | {cell(unit)} | {cell(meaning)} |"
        for field, (unit, meaning) in zip(SCHEMA, DOCUMENTATION.values(), strict=True)
    ]
    return "\n".join(["| column | type | unit | meaning |", "| --- | --- | --- | --- |", *rows])


def history_table(seed: int, history: Sequence[Generation]) -> pa.Table:
    """Return a run's rows."""
    columns = {name: [getattr(row, name) for row in history] for name in COLUMNS}
    columns["seed"] = [seed] * len(history)
    return pa.Table.from_arrays(
        [_array(columns[field.name], field.type) for field in SCHEMA], schema=SCHEMA
    )


def _array(values: list[float], kind: pa.DataType) -> pa.Array:
    content = np.array(values, dtype=kind.to_pandas_dtype())
    return pa.Array.from_buffers(kind, len(values), [None, pa.py_buffer(content)])


def column_values(table: pa.Table, column: str) -> npt.NDArray[Any]:
    """Return a column, int64[rows] or float64[rows]."""
    array = table[column].combine_chunks()
    kind = np.dtype(array.type.to_pandas_dtype())
    return np.frombuffer(array.buffers()[1], kind, len(array), array.offset * kind.itemsize)


if __name__ == "__main__":
    print(describe_columns())
