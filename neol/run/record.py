"""What a block of a cell's runs leaves behind: their rows, champions and held-out episodes."""

import statistics
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Self, get_type_hints

import numpy as np
import numpy.typing as npt
import pyarrow as pa

from neol.base.errors import UserError
from neol.neat.genome import CONNECTION, NODE, Genome
from neol.run.evolution import COLUMNS, Generation
from neol.run.provenance import Provenance
from neol.spec.run_spec import RunSpec
from neol.spec.types import Model, Name, NonNegativeFloat, Sha256

if TYPE_CHECKING:
    import pandas as pd


class Champion(Model):
    """The best genome of the final population; its weights are learned ones with write-back."""

    id: int
    fitness: float
    nodes: tuple[tuple[int, float], ...]
    """(id, bias), outputs first."""
    connections: tuple[tuple[int, int, int, float, bool], ...]
    """(innovation, source, target, weight, enabled)."""

    @classmethod
    def of(cls, genome: Genome) -> Self:
        """The stored form of a genome; all floats exact."""
        return cls(
            id=genome.id,
            fitness=genome.fitness,
            nodes=tuple(genome.nodes.tolist()),
            connections=tuple(genome.connections.tolist()),
        )

    def genome(self) -> Genome:
        """The genome, bit for bit."""
        return Genome(
            self.id,
            np.array(list(self.nodes), dtype=NODE),
            np.array(list(self.connections), dtype=CONNECTION),
            self.fitness,
        )


class HeldOut(Model):
    """The champion's returns in fresh episodes."""

    returns: tuple[float | None, ...]
    """Null where an episode failed."""
    mean: float | None
    """Over the episodes that did not fail."""
    sd: float | None
    """Of the same (ddof = 1); null with fewer than two."""

    @classmethod
    def of(cls, returns: npt.NDArray[np.float64]) -> Self:
        """The stored form of returns, float64[episodes], NaN where an episode failed."""
        finite = returns[np.isfinite(returns)].tolist()
        return cls(
            returns=tuple(value if np.isfinite(value) else None for value in returns.tolist()),
            mean=statistics.fmean(finite) if finite else None,
            sd=statistics.stdev(finite) if len(finite) > 1 else None,
        )


class SeedInfo(Model):
    """What a record knows of one run beside its rows."""

    seed: int
    digest: Sha256
    """Of the trajectory: every generation's networks, returns and steps; no time, no host."""
    inputs: int
    outputs: int
    champion: Champion
    held_out: HeldOut
    engine: Name
    """Which engine played the episodes; all return the same bits."""
    wall_seconds: NonNegativeFloat
    cpu_seconds: NonNegativeFloat
    """Of the process and its threads, not of worker processes."""
    provenance: Provenance


def campaign_name(reading: str | None, budget: str) -> str:
    """How a campaign is called, and its folder below results/: first/demo."""
    return f"{reading}/{budget}"


@dataclass(frozen=True, slots=True)
class Record:
    """A block of runs that differ in their seeds only."""

    spec: RunSpec
    """With the seed of the first run; `spec_of` gives the others'."""
    budget: str | None
    """The budget that the constants come from; None for config/base.yaml alone."""
    reading: str | None
    """The label of the reading that they come from; None where none was chosen."""
    table: pa.Table
    """`SCHEMA`, sorted by seed and generation."""
    seeds: tuple[SeedInfo, ...]
    """By seed."""

    @property
    def campaign(self) -> str | None:
        """The campaign that it is part of, such as first/demo; None where it is of no budget."""
        return None if self.budget is None else campaign_name(self.reading, self.budget)

    def frame(self) -> "pd.DataFrame":
        """The rows as a data frame.

        Without Arrow's threads, here as where a record is read: now and then one of them is still
        there when Python ends, and aborts it (apache/arrow#34314).
        """
        frame: pd.DataFrame = self.table.to_pandas(use_threads=False)
        return frame

    def spec_of(self, seed: int) -> RunSpec:
        """The specification of one of the runs."""
        return self.spec.model_copy(update={"seed": seed})

    def info(self, seed: int) -> SeedInfo:
        """What there is of one of the runs. Raises UserError for a seed that is not there."""
        for info in self.seeds:
            if info.seed == seed:
                return info
        there = ", ".join(str(info.seed) for info in self.seeds)
        raise UserError(f"has no seed {seed}; it holds {there}")

    def rows_of(self, seed: int) -> dict[str, npt.NDArray[Any]]:
        """The columns of one of the runs, a value each generation."""
        mine = column_values(self.table, "seed") == seed
        return {name: column_values(self.table, name)[mine] for name in COLUMNS}


def join(records: Iterable[Record]) -> Record:
    """One record of the runs of several, which share a specification and a budget."""
    records = sorted(records, key=lambda record: record.seeds[0].seed)
    first = records[0]
    assert {record.spec.digest() for record in records} == {first.spec.digest()}
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
"""Each column's unit and meaning."""


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
    """The columns as a Markdown table."""

    def cell(text: str) -> str:
        return text.replace("|", "\\|") or "-"

    rows = [
        f"| `{field.name}` | {field.type} | {cell(unit)} | {cell(meaning)} |"
        for field, (unit, meaning) in zip(SCHEMA, DOCUMENTATION.values(), strict=True)
    ]
    return "\n".join(["| column | type | unit | meaning |", "| --- | --- | --- | --- |", *rows])


def history_table(seed: int, history: Sequence[Generation]) -> pa.Table:
    """A run's rows."""
    columns = {name: [getattr(row, name) for row in history] for name in COLUMNS}
    columns["seed"] = [seed] * len(history)
    return pa.Table.from_arrays(
        [_array(columns[field.name], field.type) for field in SCHEMA], schema=SCHEMA
    )


def _array(values: list[float], kind: pa.DataType) -> pa.Array:
    content = np.array(values, dtype=kind.to_pandas_dtype())
    return pa.Array.from_buffers(kind, len(values), [None, pa.py_buffer(content)])


def column_values(table: pa.Table, column: str) -> npt.NDArray[Any]:
    """One of the columns, int64[rows] or float64[rows]."""
    array = table[column].combine_chunks()
    kind = np.dtype(array.type.to_pandas_dtype())
    return np.frombuffer(array.buffers()[1], kind, len(array), array.offset * kind.itemsize)


if __name__ == "__main__":
    print(describe_columns())
