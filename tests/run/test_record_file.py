"""Records as files: reading returns what was written; columns are documented."""

from pathlib import Path

import pyarrow.parquet as pq

from neol.rollout.reference import ReferenceEngine
from neol.run import record_file
from neol.run.evolution import COLUMNS
from neol.run.record import SCHEMA, Record, SeedInfo, describe_columns
from neol.run.record_file import read_record
from neol.run.single import run_seed
from neol.spec.configuration import ROOT
from tests.run.conftest import SPEC, same


def test_read_is_what_was_written(path: Path, record: Record) -> None:
    read = read_record(path, SPEC.model_copy(update={"seed": 99}))
    assert same(read, record)
    assert read.spec_of(4) == SPEC.model_copy(update={"seed": 4})
    assert read.table["seed"].to_pylist() == [0, 0, 0, 4, 4, 4]
    assert read.table["generation"].to_pylist() == [1, 2, 3, 1, 2, 3]
    assert [info.seed for info in read.seeds] == [0, 4]


def test_columns_are_documented(path: Path) -> None:
    assert SCHEMA.names == ["seed", *COLUMNS]
    stored = pq.read_schema(path)
    assert stored.field("env_steps").metadata[b"unit"] == b"steps"
    assert describe_columns() in (ROOT / "docs" / "records.md").read_text()


def test_metadata_are_documented() -> None:
    text = (ROOT / "docs" / "records.md").read_text()
    for model in (record_file.RecordMetadata, SeedInfo):
        for name in model.model_fields:
            assert f"`{name}`" in text


def test_time_and_host_are_in_no_trajectory_digest(record: Record) -> None:
    engine = ReferenceEngine(SPEC.task)
    again = run_seed(SPEC, engine)
    engine.close()
    assert again.digest == record.seeds[0].digest
    assert again.past.wall_seconds != record.seeds[0].wall_seconds
