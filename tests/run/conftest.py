"""A record of two tiny runs, made once for all tests, and its file."""

from pathlib import Path

import pytest

from neol.rollout.reference import ReferenceEngine
from neol.run.record import Record, join
from neol.run.record_file import write_record
from neol.run.runner import Label, _record_of
from neol.run.single import run_seed
from tests.helpers.runs import run_spec

SPEC = run_spec(generations=3)


@pytest.fixture(scope="session")
def record() -> Record:
    """Seeds 0 and 4 of a tiny CartPole run."""
    engine = ReferenceEngine(SPEC.task)
    seeds = [SPEC.model_copy(update={"seed": seed}) for seed in (0, 4)]
    made = [_record_of(run_seed(spec, engine), Label("smoke", "worked_example")) for spec in seeds]
    engine.close()
    return join(reversed(made))


@pytest.fixture(scope="session")
def content(record: Record, tmp_path_factory: pytest.TempPathFactory) -> bytes:
    path = tmp_path_factory.mktemp("record") / "run.parquet"
    write_record(path, record)
    return path.read_bytes()


@pytest.fixture
def path(content: bytes, tmp_path: Path) -> Path:
    (tmp_path / "run.parquet").write_bytes(content)
    return tmp_path / "run.parquet"


def same(one: Record, other: Record) -> bool:
    described = [(record.spec, record.campaign, record.seeds) for record in (one, other)]
    return described[0] == described[1] and one.table.equals(other.table)
