"""Records: what a block of a cell's runs leaves behind, a Parquet file that vouches for itself.

Rows are generations, one per seed. The file's metadata hold, under the key "neol", a JSON of class
`Metadata`, and under "neol_digest" the SHA-256 over that JSON and all columns. `python -m
neol.records` prints the table of columns that stands in docs/records.md.
"""

import hashlib
import io
import json
import statistics
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, Self

import numpy as np
import numpy.typing as npt
import pyarrow as pa
import pyarrow.parquet as pq
import pydantic_core
from pydantic import ValidationError

from neol.complaint import one_line
from neol.errors import UserError
from neol.evolution import COLUMNS, Generation
from neol.files import open_regular, read_bounded, write_atomically
from neol.model import Model
from neol.neat.check import check_genome
from neol.neat.genome import CONNECTION, NODE, Genome
from neol.provenance import Provenance
from neol.spec import RunSpec

SCHEMA_VERSION = 1
MAX_BYTES = 2**28
MAX_ROWS = 10_000_000

# --- Columns ------------------------------------------------------------------------------------

# column: (unit, meaning); the types are those of `Generation`.
DOCUMENTATION = {
    "seed": ("", "The run's seed."),
    "generation": ("", "From 1."),
    "best_fitness": ("return", "Highest fitness of the population: mean return over N episodes."),
    "mean_fitness": ("return", "Mean fitness of the population."),
    "sd_fitness": ("return", "Standard deviation of the population's fitness (ddof = 0)."),
    "evaluations": ("genomes", "Genomes evaluated so far in the run."),
    "env_steps": ("steps", "Environment steps so far in the run, held-out episodes left out."),
    "species": ("species", "Number of species."),
    "nodes_mean": ("nodes", "Mean number of a genome's hidden and output nodes."),
    "connections_mean": ("connections", "Mean number of a genome's enabled connections."),
    "nodes_best": ("nodes", "Hidden and output nodes of the best genome."),
    "connections_best": ("connections", "Enabled connections of the best genome."),
    "weight_change_mean": (
        "weight",
        "Mean \\|w after - w before\\| of an evaluation, over all connections of the population.",
    ),
    "failed_evaluations": (
        "genomes",
        "Evaluations so far that met an observation, reward or weight that was not finite.",
    ),
}
_INTEGERS = {"seed"} | {column.name for column in fields(Generation) if column.type is int}
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
    rows = [
        f"| `{field.name}` | {field.type} | {DOCUMENTATION[field.name][0] or '-'} "
        f"| {DOCUMENTATION[field.name][1]} |"
        for field in SCHEMA
    ]
    return "\n".join(["| column | type | unit | meaning |", "| --- | --- | --- | --- |", *rows])


# --- Metadata -----------------------------------------------------------------------------------


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
    digest: str
    """Of the trajectory: every generation's networks, returns and steps; no time, no host."""
    inputs: int
    outputs: int
    champion: Champion
    held_out: HeldOut
    engine: str
    """Which engine played the episodes; all return the same bits."""
    wall_seconds: float
    cpu_seconds: float
    """Of the process and its threads, not of worker processes."""
    provenance: Provenance


class Metadata(Model):
    """The JSON in a record's file metadata."""

    schema_version: int
    spec: dict[str, Any]
    """The resolved `RunSpec` without its seed."""
    spec_digest: str
    """SHA-256 in hex of that as canonical JSON."""
    budget: str | None
    seeds: tuple[SeedInfo, ...]


@dataclass(frozen=True, slots=True)
class Record:
    """A block of runs that differ in their seeds only."""

    spec: RunSpec
    """With the seed of the first run; `spec_of` gives the others'."""
    budget: str | None
    """The budget that the constants come from; None for config/base.yaml alone."""
    table: pa.Table
    """`SCHEMA`, sorted by seed and generation."""
    seeds: tuple[SeedInfo, ...]
    """By seed."""

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
        mine = _values(self.table, "seed") == seed
        return {name: _values(self.table, name)[mine] for name in COLUMNS}

    @property
    def spec_digest(self) -> str:
        """SHA-256 in hex of the specification without its seed."""
        return _spec_digest(self.spec)


def history_table(seed: int, history: Sequence[Generation]) -> pa.Table:
    """A run's rows."""
    columns = {name: [getattr(row, name) for row in history] for name in COLUMNS}
    columns["seed"] = [seed] * len(history)
    return pa.Table.from_arrays(
        [_array(columns[field.name], field.type) for field in SCHEMA], schema=SCHEMA
    )


# pyarrow imports all of pandas in pa.array and to_numpy, which takes longer than a short run.


def _array(values: list[float], kind: pa.DataType) -> pa.Array:
    content = np.array(values, dtype=kind.to_pandas_dtype())
    return pa.Array.from_buffers(kind, len(values), [None, pa.py_buffer(content)])


def _values(table: pa.Table, column: str) -> npt.NDArray[Any]:
    array = table[column].combine_chunks()
    kind = np.dtype(array.type.to_pandas_dtype())
    return np.frombuffer(array.buffers()[1], kind, len(array), array.offset * kind.itemsize)


def join(records: Iterable[Record]) -> Record:
    """One record of the runs of several, which share a specification and a budget."""
    records = sorted(records, key=lambda record: record.seeds[0].seed)
    first = records[0]
    assert {record.spec_digest for record in records} == {first.spec_digest}
    return Record(
        spec=first.spec,
        budget=first.budget,
        table=pa.concat_tables([record.table for record in records]).combine_chunks(),
        seeds=tuple(info for record in records for info in record.seeds),
    )


# --- Files --------------------------------------------------------------------------------------


def write_record(path: Path, record: Record, *, scratch: Path | None = None) -> None:
    """Write a record, as `write_atomically` does. Raises UserError where it cannot be written."""
    metadata = Metadata(
        schema_version=SCHEMA_VERSION,
        spec=_without_seed(record.spec),
        spec_digest=record.spec_digest,
        budget=record.budget,
        seeds=record.seeds,
    )
    text = _canonical(metadata.model_dump(mode="json"))
    buffer = io.BytesIO()
    with pq.ParquetWriter(buffer, SCHEMA, compression="zstd", use_dictionary=False) as writer:
        writer.write_table(record.table)
        writer.add_key_value_metadata(
            {"neol": text.decode(), "neol_digest": _digest(text, record.table)}
        )
    write_atomically(path, buffer.getvalue(), scratch=scratch)


def read_record(path: Path, spec: RunSpec | None = None) -> Record:
    """A record that is whole, and of the specification that is expected (its seed aside).

    Raises UserError, one line with the file and the way out, for any other file.
    """
    return parse_record(path, read_bounded(path, MAX_BYTES), spec)


def parse_record(path: Path, content: bytes, spec: RunSpec | None = None) -> Record:
    """The record that a file's content is, as by `read_record`; the path is for the error."""
    try:
        text, table = _parse(content)
    except Exception as error:  # whatever a foreign file makes a parser raise
        raise _no_record(path, error) from None
    stored = _stored_spec(path, text)
    if spec is not None and (difference := first_difference(stored, spec)):
        raise _unusable(path, f"of another specification: {difference}")
    try:
        return _validated(text, table)
    except ValidationError as error:
        root = Metadata if error.title == Metadata.__name__ else RunSpec
        raise _unusable(path, f"damaged: {one_line(error, root)}") from None
    except Exception as error:
        raise _unusable(path, f"damaged: {error}") from None


def read_spec(path: Path) -> dict[str, Any]:
    """The specification, without its seed, that a record's footer states, in a millisecond.

    Neither rows nor digests are looked at: `read_record` does that. Raises UserError for what is
    no record of this version.
    """
    return _stored_spec(path, _footer(path))


def read_footer(path: Path, spec: RunSpec) -> Metadata:
    """What a record's footer states of the runs of a specification (its seed aside), unverified.

    Raises UserError for what is no record of this version, or of another specification.
    """
    text = _footer(path)
    if difference := first_difference(_stored_spec(path, text), spec):
        raise _unusable(path, f"of another specification: {difference}")
    try:
        return Metadata.model_validate_json(text)
    except Exception as error:
        raise _unusable(path, f"damaged: {error}") from None


def first_difference(stored: dict[str, Any], expected: RunSpec) -> str | None:
    """Where a stored specification differs from another (seeds aside); None where they agree."""
    return _first_difference(stored, _without_seed(expected))


def _stored_spec(path: Path, text: bytes) -> dict[str, Any]:
    try:
        content = pydantic_core.from_json(text)
        version, spec = content["schema_version"], dict(content["spec"])
    except Exception as error:
        raise _no_record(path, error) from None
    if version != SCHEMA_VERSION:
        reason = f"its schema version is {version!r}, this neol reads {SCHEMA_VERSION}"
        raise _unusable(path, reason, "read it with the neol that wrote it, or run anew")
    return spec


def _footer(path: Path) -> bytes:
    """The metadata's JSON; nothing else of the file is read."""
    with open_regular(path) as file:
        try:
            return _text(pq.read_metadata(file))
        except Exception as error:
            raise _no_record(path, error) from None


def _no_record(path: Path, error: Exception) -> UserError:
    return _unusable(path, f"damaged or no record of neol's: {error}")


def _unusable(
    path: Path, reason: str, way_out: str = "restore it, or remove it and run anew"
) -> UserError:
    return UserError(f"{path}: {' '.join(reason.split())[:300]}; {way_out}")


def _parse(content: bytes) -> tuple[bytes, pa.Table]:
    """The metadata's JSON and the rows, vouched for by their digest."""
    file = pq.ParquetFile(pa.BufferReader(content))
    text = _text(file.metadata)
    if not file.schema_arrow.equals(SCHEMA):
        raise ValueError("its columns are others")
    if file.metadata.num_rows > min(MAX_ROWS, len(content)):  # a row takes more than a byte
        raise ValueError("it would unpack to far more than it is")
    table = file.read().combine_chunks()
    if _digest(text, table).encode() != file.metadata.metadata.get(b"neol_digest"):
        raise ValueError("its content does not match its digest")
    return text, table.replace_schema_metadata(None)


def _text(footer: pq.FileMetaData) -> bytes:
    metadata = footer.metadata or {}
    if b"neol" not in metadata:
        raise ValueError("its metadata have no key neol")
    text: bytes = metadata[b"neol"]
    return text


def _validated(text: bytes, table: pa.Table) -> Record:
    """The record, if rows and metadata tell the same story."""
    metadata = Metadata.model_validate_json(text)
    spec = RunSpec.model_validate_json(
        pydantic_core.to_json({**metadata.spec, "seed": metadata.seeds[0].seed})
    )
    record = Record(spec, metadata.budget, table, metadata.seeds)
    if metadata.spec_digest != record.spec_digest:
        raise ValueError("the specification does not match its digest")
    seeds, generations, best = (
        _values(table, name) for name in ("seed", "generation", "best_fitness")
    )
    begin = 0
    for info in metadata.seeds:
        end = begin + int(np.count_nonzero(seeds == info.seed))
        expected = np.arange(1, end - begin + 1)
        whole = (seeds[begin:end] == info.seed).all() and np.array_equal(
            generations[begin:end], expected
        )
        short = spec.evaluation.step_limit is None and end - begin < spec.generations
        if not whole or end == begin or short or end - begin > spec.generations:
            raise ValueError(f"the generations of seed {info.seed} are not complete")
        if info.champion.fitness != best[end - 1]:
            raise ValueError(f"the champion of seed {info.seed} is not that of its last generation")
        if len(info.held_out.returns) != spec.evaluation.held_out_episodes:
            raise ValueError(f"the held-out episodes of seed {info.seed} are not complete")
        check_genome(info.champion.genome(), info.inputs, info.outputs)
        begin = end
    if begin != len(seeds) or len({info.seed for info in metadata.seeds}) < len(metadata.seeds):
        raise ValueError("rows and metadata speak of different seeds")
    return record


def _digest(text: bytes, table: pa.Table) -> str:
    """SHA-256 in hex over the metadata's JSON and the columns, in the schema's order."""
    digest = hashlib.sha256(text)
    for name in SCHEMA.names:
        digest.update(_values(table, name).data)
    return digest.hexdigest()


def _without_seed(spec: RunSpec) -> dict[str, Any]:
    return spec.model_dump(mode="json", exclude={"seed"})


def _spec_digest(spec: RunSpec) -> str:
    return hashlib.sha256(_canonical(_without_seed(spec))).hexdigest()


def _first_difference(
    stored: dict[str, Any], expected: dict[str, Any], prefix: str = ""
) -> str | None:
    for key in sorted(stored.keys() | expected.keys()):
        old, new = stored.get(key), expected.get(key)
        if isinstance(old, dict) and isinstance(new, dict):
            if difference := _first_difference(old, new, f"{prefix}{key}."):
                return difference
        elif (key in stored, repr(old)) != (key in expected, repr(new)):
            there = repr(old) if key in stored else "missing"
            here = repr(new) if key in expected else "unknown"
            return f"{prefix}{key} is {there} there and {here} here"
    return None


def _canonical(content: Any) -> bytes:
    return json.dumps(content, sort_keys=True, separators=(",", ":"), allow_nan=False).encode()


if __name__ == "__main__":
    print(describe_columns())
