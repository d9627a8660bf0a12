"""Records as files: Parquet that vouches for itself.

Rows are generations, one per seed. The file's metadata hold, under the key "neol", a JSON of class
`RecordMetadata`, and under "neol_digest" the SHA-256 over that JSON and all columns.
"""

import hashlib
import io
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pydantic_core
from pydantic import ValidationError

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


class RecordMetadata(Model):
    """The JSON in a record's file metadata."""

    schema_version: int
    spec: dict[str, Any]
    """The resolved `RunSpec` without its seed."""
    spec_digest: str
    """SHA-256 in hex of that as canonical JSON."""
    budget: Name | None
    reading: Label | None = FIRST_READING
    """Left out by records that are older than readings."""
    seeds: tuple[SeedInfo, ...]


def write_record(path: Path, record: Record, *, scratch: Path | None = None) -> None:
    """Write a record, as `write_atomically` does. Raises UserError where it cannot be written."""
    metadata = RecordMetadata(
        schema_version=SCHEMA_VERSION,
        spec=record.spec.without_seed(),
        spec_digest=record.spec.digest(),
        budget=record.budget,
        reading=record.reading,
        seeds=record.seeds,
    )
    text = canonical_json(metadata.model_dump(mode="json"))
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
    return parse_record(path, read_bounded(path, MAX_RECORD_BYTES), spec)


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
        root = RecordMetadata if error.title == RecordMetadata.__name__ else RunSpec
        raise _unusable(path, f"damaged: {one_line(error, root)}") from None
    except Exception as error:
        raise _unusable(path, f"damaged: {error}") from None


def records_below(folder: Path) -> Iterator[Path]:
    """The records in a folder and those below it, sorted; work in progress left out."""
    for path in sorted(files_below(folder, "*.parquet"), key=Path.as_posix):
        if not any(part.endswith(".partial") for part in path.relative_to(folder).parts[:-1]):
            yield path


def read_spec(path: Path) -> dict[str, Any]:
    """The specification, without its seed, that a record's footer states, in a millisecond.

    Neither rows nor digests are looked at: `read_record` does that. Raises UserError for what is
    no record of this version.
    """
    return _stored_spec(path, _footer(path))


def read_footer(path: Path) -> RecordMetadata:
    """All that a record's footer states, unverified, as by `read_spec`."""
    text = _footer(path)
    _stored_spec(path, text)
    try:
        return RecordMetadata.model_validate_json(text)
    except Exception as error:
        raise _unusable(path, f"damaged: {error}") from None


def first_difference(stored: dict[str, Any], expected: RunSpec) -> str | None:
    """Where a stored specification differs from another (seeds aside); None where they agree."""
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
    return UserError(f"{path}: {' '.join(reason.split())[:300].rstrip('.')}; {way_out}")


def _parse(content: bytes) -> tuple[bytes, pa.Table]:
    """The metadata's JSON and the rows, vouched for by their digest."""
    file = pq.ParquetFile(pa.BufferReader(content))
    text = _text(file.metadata)
    if not file.schema_arrow.equals(SCHEMA):
        raise ValueError("its columns are others")
    if file.metadata.num_rows > min(MAX_ROWS, len(content)):  # a row takes more than a byte
        raise ValueError("it would unpack to far more than it is")
    table = file.read(use_threads=False).combine_chunks()
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
        raise ValueError("rows and metadata speak of different seeds")
    return record


def _digest(text: bytes, table: pa.Table) -> str:
    """SHA-256 in hex over the metadata's JSON and the columns, in the schema's order."""
    digest = hashlib.sha256(text)
    for name in SCHEMA.names:
        digest.update(column_values(table, name).data)
    return digest.hexdigest()
