"""Damaged records, records of other runs and foreign files are refused in one line."""

import hashlib
import re
from collections.abc import Callable
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from neol.base.errors import UserError
from neol.run import record_file
from neol.run.record import Champion, Record
from neol.run.record_file import read_record
from neol.spec.run_spec import RunSpec
from tests.helpers.damage import Json, flipped, forge_record
from tests.helpers.refusal import refusal, survive
from tests.helpers.runs import run_spec
from tests.run.conftest import SPEC, same


def test_truncated_anywhere_is_refused(content: bytes, tmp_path: Path) -> None:
    path = tmp_path / "run.parquet"
    for length in [*range(0, len(content), 211), len(content) - 1]:
        path.write_bytes(content[:length])
        with pytest.raises(UserError, match=r"run\.parquet: .*; restore it, or remove it"):
            read_record(path)


@pytest.mark.slow
@settings(max_examples=300, deadline=None)
@given(data=st.data())
def test_damaged_anywhere_is_refused_or_the_same(
    data: st.DataObject,
    content: bytes,
    record: Record,
    tmp_path_factory: pytest.TempPathFactory,
) -> None:
    path = tmp_path_factory.getbasetemp() / "damaged.parquet"
    path.write_bytes(data.draw(flipped(content)))
    read = survive(lambda: read_record(path), says="damaged.parquet")
    # Some bytes have no effect, such as those of the writer's name.
    assert read is None or same(read, record)


def test_what_is_no_record_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "run.parquet"
    with pytest.raises(UserError, match=r"run\.parquet: cannot be read \(No such file"):
        read_record(path)
    path.write_bytes(b"PAR1 hello PAR1")
    with pytest.raises(UserError, match="damaged, or not a record"):
        read_record(path)
    pq.write_table(pa.table({"a": [1, 2]}), path)
    with pytest.raises(UserError, match="no key neol"):
        read_record(path)
    pq.write_table(pa.table({"a": [1]}).replace_schema_metadata({"neol": "{}"}), path)
    with pytest.raises(UserError, match="unexpected columns"):
        read_record(path)


def test_edited_rows_are_refused(path: Path) -> None:
    file = pq.ParquetFile(path)
    table = file.read()
    best = table["best_fitness"].to_numpy().copy()
    best[0] += 1.0
    edited = table.set_column(2, table.schema.field(2), pa.array(best))
    kept = {key: file.metadata.metadata[key] for key in (b"neol", b"neol_digest")}
    pq.write_table(edited.replace_schema_metadata(kept), path)
    with pytest.raises(UserError, match=r"run\.parquet: .*does not match its digest; restore"):
        read_record(path)


@pytest.mark.parametrize(
    ("expected", "difference"),
    [
        (run_spec(generations=4), "generations is 3 there and 4 here"),
        (run_spec(generations=3, population=9), "population is 8 there and 9 here"),
        (
            run_spec("oja", 0, "neat.elitism=1", generations=3),
            r"neat\.elitism is 2 there and 1 here",
        ),
    ],
)
def test_another_specification_is_refused(path: Path, expected: RunSpec, difference: str) -> None:
    with pytest.raises(
        UserError, match=rf"run\.parquet: of another specification: {difference}; restore it"
    ):
        read_record(path, expected)


@pytest.mark.parametrize(
    ("change", "difference"),
    [
        (dict.copy, None),
        (lambda spec: spec.update(population=9), "population is 9 there and 8 here"),
        (lambda spec: spec["evaluation"].update(episodes=1.0), "evaluation.episodes is 1.0 there"),
        (lambda spec: spec["neat"].pop("elitism"), "neat.elitism is missing there and 2 here"),
        (lambda spec: spec["evaluation"].pop("step_limit"), "evaluation.step_limit is missing"),
        (lambda spec: spec.update(new=1), "new is 1 there and unknown here"),
    ],
)
def test_the_specification_is_in_the_footer(
    path: Path, change: Callable[[Json], object], difference: str | None
) -> None:
    forge_record(path, lambda metadata, _: change(metadata["spec"]))
    found = record_file.first_difference(
        record_file.read_footer(path).spec, SPEC.model_copy(update={"seed": 99})
    )
    assert found == difference or (difference and found and found.startswith(difference))
    if difference:
        with pytest.raises(UserError, match=re.escape(f"another specification: {difference}")):
            read_record(path, SPEC)


def test_a_record_that_is_older_than_readings_is_of_the_first(path: Path, record: Record) -> None:
    forge_record(path, lambda metadata, _: metadata.pop("reading"))
    assert read_record(path).campaign == "first/smoke"
    assert record.campaign == "worked_example/smoke"


def test_what_has_no_specification_is_refused(path: Path) -> None:
    forge_record(path, _other_version)
    with pytest.raises(UserError, match="its schema version is 2"):
        record_file.read_footer(path)
    for content in (b"", b"PAR1", path.read_bytes()[:-9]):
        path.write_bytes(content)
        with pytest.raises(UserError, match=r"run\.parquet: damaged, or not a record"):
            record_file.read_footer(path)


def test_a_footer_says_what_its_runs_came_to(path: Path, record: Record) -> None:
    footer = record_file.read_footer(path)
    assert (footer.spec, footer.seeds) == (SPEC.without_seed(), record.seeds)


def test_a_footer_that_is_at_odds_with_itself_is_refused(path: Path) -> None:
    forge_record(path, lambda metadata, _: metadata.update(seeds="none"))
    with pytest.raises(UserError, match=r"run\.parquet: damaged: "):
        record_file.read_footer(path)


def _other_version(metadata: Json, _: Json) -> None:
    metadata["schema_version"] = 2


def _edited_spec(metadata: Json, _: Json) -> None:
    metadata["spec"]["population"] = 9


def _impossible_spec(metadata: Json, _: Json) -> None:
    metadata["spec"]["population"] = -1


def _swapped_seeds(metadata: Json, _: Json) -> None:
    metadata["seeds"].reverse()


def _missing_seed(metadata: Json, _: Json) -> None:
    del metadata["seeds"][1]


def _missing_generation(_: Json, rows: Json) -> None:
    for column in rows.values():
        del column[1]


def _missing_last_generation(_: Json, rows: Json) -> None:
    for column in rows.values():
        del column[5]


def _raised_fitness(_: Json, rows: Json) -> None:
    rows["best_fitness"][2] += 100.0


def _broken_champion(metadata: Json, _: Json) -> None:
    metadata["seeds"][0]["champion"]["connections"][0][1] = 99


def _missing_held_out(metadata: Json, _: Json) -> None:
    metadata["seeds"][0]["held_out"]["returns"].pop()


def _unknown_key(metadata: Json, _: Json) -> None:
    metadata["extra"] = 1


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (_other_version, "its schema version is 2, this neol reads 1; read it with the neol"),
        (_edited_spec, "specification does not match its digest"),
        (_impossible_spec, "population"),
        (_swapped_seeds, "generations of seed 4 are not complete"),
        (_missing_seed, "list different seeds"),
        (_missing_generation, "generations of seed 0 are not complete"),
        (_missing_last_generation, "generations of seed 4 are not complete"),
        (_raised_fitness, "champion of seed 0 is not that of its last generation"),
        (_broken_champion, "a connection comes from nowhere"),
        (_missing_held_out, "held-out episodes of seed 0 are not complete"),
        (_unknown_key, "extra"),
    ],
)
def test_a_record_at_odds_with_itself_is_refused_though_sealed(
    path: Path,
    change: Callable[[Json, Json], None],
    reason: str,
) -> None:
    forge_record(path, change)
    assert re.search(reason, refusal(read_record, path))


def test_an_honest_seal_passes(path: Path, record: Record) -> None:
    forge_record(path, lambda *_: None)
    assert same(read_record(path), record)


def test_the_digest_covers_metadata_and_rows(record: Record) -> None:
    digests = {
        record_file._digest(b"{}", record.table),
        record_file._digest(b"{ }", record.table),
        record_file._digest(b"{}", record.table.slice(1)),
        hashlib.sha256(b"{}").hexdigest(),
    }
    assert len(digests) == 4


def test_a_stated_size_is_not_believed(content: bytes, tmp_path: Path) -> None:
    path = tmp_path / "run.parquet"
    for inputs in (2 * 10**8, -1):
        path.write_bytes(content)
        forge_record(path, lambda metadata, _, n=inputs: metadata["seeds"][0].update(inputs=n))
        assert "inputs and 2 outputs cannot be" in refusal(read_record, path)


def test_of_a_million_errors_only_the_first_is_kept() -> None:
    champion = {"id": 1, "fitness": 0.0, "nodes": [0] * 1000, "connections": [[]] * 1000}
    with pytest.raises(ValidationError) as raised:
        Champion.model_validate(champion)
    assert raised.value.error_count() < 10


def test_metadata_beyond_all_measure_are_not_parsed(
    content: bytes, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "run.parquet"
    path.write_bytes(content)
    record = read_record(path)
    monkeypatch.setattr(record_file, "MAX_METADATA_BYTES", 1000)
    assert "its metadata are larger than 1000 bytes" in refusal(read_record, path)
    assert "give it fewer seeds" in refusal(record_file.write_record, path, record)
