"""Records as files: Parquet with a digest of its content.

There is one row for each seed and generation. The file's metadata hold, under the key "neol", JSON
of class `RecordMetadata`, and under "neol_digest" the SHA-256 over that JSON and all columns.
"""

import hashlib
import io
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pydantic_core
from pydantic import FailFast, ValidationError

from neol.base.errors import UserError, one_line
from neol.base.files import files_below, open_regular, read_bounded, write_atomically
from neol.neat.genome import check_genome
from neol.run.record import SCHEMA, Record, SeedInfo, column_values
from neol.spec.readings import FIRST_READING
from neol.spec.run_spec import RunSpec, canonical_json, complete
from neol.spec.sources import by_dotted_key
from neol.spec.types import Label, Model, Name

SCHEMA_VERSION = 1
MAX_RECORD_BYTES = 2**28
MAX_ROWS = 10_000_000
MAX_METADATA_BYTES = 2**24
"""Several hundred seeds; a reader takes up to 25 times as much memory."""
SEED_BYTES = 2**15
"""Metadata of a run without its held-out returns; up to 21,000 bytes in the shipped records."""
RETURN_BYTES = len(",-2.2250738585072014e-308")
"""The longest number and its comma."""


class RecordMetadata(Model):
    """The JSON in a record's file metadata."""

    schema_version: int
    spec: dict[str, Any]
    """Resolved `RunSpec` without its seed."""
    spec_digest: str
    """SHA-256 in hex of `spec` as canonical JSON."""
    budget: Name | None
    reading: Label | None = FIRST_READING
    """Label of the reading; missing in records that are older than readings."""
    seeds: Annotated[tuple[SeedInfo, ...], FailFast()]


def write_record(path: Path, record: Record, *, scratch: Path | None = None) -> None:
    """Write a record by `write_atomically`. Raises UserError if it cannot be written."""
    metadata = RecordMetadata(
        schema_version=SCHEMA_VERSION,
        spec=record.spec.without_seed(),
        spec_digest=record.spec.digest(),
        budget=record.budget,
        reading=record.reading,
        seeds=record.seeds,
    )
    text = canonical_json(metadata.model_dump(mode="json"))
    if len(text) > MAX_METADATA_BYTES:
        raise UserError(f"{path}: would be too large for one record; give it fewer seeds")
    buffer = io.BytesIO()
    with pq.ParquetWriter(buffer, SCHEMA, compression="zstd", use_dictionary=False) as writer:
        writer.write_table(record.table)
        writer.add_key_value_metadata(
            {"neol": text.decode(), "neol_digest": _digest(text, record.table)}
        )
    write_atomically(path, buffer.getvalue(), scratch=scratch)


def most_seeds(spec: RunSpec) -> int:
    """Return how many seeds fit into one record, unless champions are unusually large."""
    seed = SEED_BYTES + RETURN_BYTES * spec.evaluation.held_out_episodes
    return MAX_METADATA_BYTES // seed


def read_record(path: Path, spec: RunSpec | None = None) -> Record:
    """Read and verify a record; `spec` is its expected specification, apart from the seed.

    Raises UserError for any other file: one line with the file and how to fix it.
    """
    return parse_record(path, read_bounded(path, MAX_RECORD_BYTES), spec)


def parse_record(path: Path, content: bytes, spec: RunSpec | None = None) -> Record:
    """Parse a file's content as `read_record` does; the path is for the error message."""
    try:
        text, table = _parse(content)
    except Exception as error:  # a foreign file may make a parser raise anything
        raise _no_record(path, error) from None
    stored = _stored_spec(path, text)
    if spec is not None and (difference := first_difference(stored, spec)):
        raise _unusable(path, f"of another specification: {difference}")
    try:
        return _validated(text, table)
    except ValidationError as error:
        root = RecordMetadata if error.title == RecordMetadata.__name__ else RunSpec
        raise _unusable(path, f"damaged: {one_line(error, root)}") from None
    except Exception as error:
        raise _unusable(path, f"damaged: {error}") from None


def records_below(folder: Path) -> Iterator[Path]:
    """Yield the records in a folder and below it, sorted, without work in progress."""
    for path in sorted(files_below(folder, "*.parquet"), key=Path.as_posix):
        if not any(part.endswith(".partial") for part in path.relative_to(folder).parts[:-1]):
            yield path


def read_footer(path: Path) -> RecordMetadata:
    """Return the metadata in a record's footer; takes a millisecond.

    It checks neither rows nor digests; `read_record` does. Raises UserError for a file that is not
    a record of this version.
    """
    text = _footer(path)
    _stored_spec(path, text)
    try:
        return RecordMetadata.model_validate_json(text)
    except Exception as error:
        raise _unusable(path, f"damaged: {error}") from None


def first_difference(stored: dict[str, Any], expected: RunSpec) -> str | None:
    """Return the first difference between a stored and an expected specification, or None."""
    there, here = by_dotted_key(complete(stored)), by_dotted_key(complete(expected.without_seed()))
    for key in sorted(there.keys() | here.keys()):
        old = repr(there[key]) if key in there else "missing"
        new = repr(here[key]) if key in here else "unknown"
        if old != new:
            return f"{key} is {old} there and {new} here"
    return None


def _stored_spec(path: Path, text: bytes) -> dict[str, Any]:
    try:
        content = pydantic_core.from_json(text)
        version, spec = content["schema_version"], dict(content["spec"])
    except Exception as error:
        raise _no_record(path, error) from None
    if version != SCHEMA_VERSION:
        reason = f"its schema version is {version!r}, this neol reads {SCHEMA_VERSION}"
        raise _unusable(path, reason, "read it with the neol that wrote it, or run again")
    return spec


def _footer(path: Path) -> bytes:
    """Return the metadata's JSON; the rest of the file is not read."""
    with open_regular(path) as file:
        try:
            return _text(pq.read_metadata(file))
        except Exception as error:
            raise _no_record(path, error) from None


def _no_record(path: Path, error: Exception) -> UserError:
    return _unusable(path, f"damaged, or not a record of neol: {error}")


def _unusable(
    path: Path, reason: str, way_out: str = "restore it, or remove it and run again"
) -> UserError:
    return UserError(f"{path}: {' '.join(reason.split())[:300].rstrip('.')}; {way_out}")


def _parse(content: bytes) -> tuple[bytes, pa.Table]:
    """Return the metadata's JSON and the rows, verified by their digest."""
    file = pq.ParquetFile(pa.BufferReader(content))
    text = _text(file.metadata)
    if not file.schema_arrow.equals(SCHEMA):
        raise ValueError("unexpected columns")
    if file.metadata.num_rows > min(MAX_ROWS, len(content)):  # every row takes more than a byte
        raise ValueError("it would unpack to far more than its own size")
    table = file.read(use_threads=False).combine_chunks()
    if _digest(text, table).encode() != file.metadata.metadata.get(b"neol_digest"):
        raise ValueError("its content does not match its digest")
    return text, table.replace_schema_metadata(None)


def _text(footer: pq.FileMetaData) -> bytes:
    metadata = footer.metadata or {}
    if b"neol" not in metadata:
        raise ValueError("its metadata have no key neol")
    text: bytes = metadata[b"neol"]
    if len(text) > MAX_METADATA_BYTES:
        raise ValueError(f"its metadata are larger than {MAX_METADATA_BYTES} bytes")
    return text


def _validated(text: bytes, table: pa.Table) -> Record:
    """Return the record. Raises ValueError if rows and metadata do not agree."""
    metadata = RecordMetadata.model_validate_json(text)
    spec = RunSpec.model_validate_json(
        pydantic_core.to_json({**metadata.spec, "seed": metadata.seeds[0].seed})
    )
    record = Record(spec, metadata.budget, metadata.reading, table, metadata.seeds)
    if metadata.spec_digest != record.spec.digest():
        raise ValueError("the specification does not match its digest")
    seeds, generations, best = (
        column_values(table, name) for name in ("seed", "generation", "best_fitness")
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
        raise ValueError("rows and metadata list different seeds")
    return record


def _digest(text: bytes, table: pa.Table) -> str:
    """Return the SHA-256 in hex over the metadata's JSON and the columns, in the schema's order."""
    digest = hashlib.sha256(text)
    for name in SCHEMA.names:
        digest.update(column_values(table, name).data)
    return digest.hexdigest()
