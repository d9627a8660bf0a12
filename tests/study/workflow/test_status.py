"""Status of a campaign: every state of a job."""

import dataclasses
from collections.abc import Iterator
from pathlib import Path

import pytest

from neol.run.record_file import read_record, write_record
from neol.run.runner import run_block
from neol.run.workspace import finished_path, partial_folder
from neol.study.campaign.jobs import Job
from neol.study.workflow import status
from neol.study.workflow.outlook import Status
from neol.study.workflow.status import Folder, JobStatus
from tests.helpers.runs import killer
from tests.study.workflow.conftest import finish, job, log


def status_of(folder: Folder, of: Job) -> JobStatus:
    return next(s for s in folder.job_statuses() if s.job.record == of.record)


def test_a_record_is_done(folder: Folder) -> None:
    finish(job(folder))
    status = Status(folder.job_statuses())
    assert status.states() == {"done": 3, "missing": 93}
    assert status.cells == (1, 32)
    assert [run.spec.seed for run in status.finished] == [0, 1, 2]
    assert {(run.best_fitness, run.held_out) for run in status.finished} == {(7.0, 6.0)}


def test_a_record_that_must_be_made_anew_is_missing(folder: Folder) -> None:
    """The record does not count if its seeds differ from the job's, as in `Job.reason`."""
    fewer, more, other = (job(folder, place=place) for place in range(3))
    finish(fewer, seeds=2)
    finish(dataclasses.replace(more, seeds=range(4)), seeds=4)
    finish(job(folder, place=3), output=other.record)
    for each, why in ((fewer, "other seeds"), (more, "other seeds"), (other, "another spec")):
        assert why in (each.reason() or "")
        assert status_of(folder, each).states["missing"] == 3
    assert Status(folder.job_statuses()).finished == []


def test_a_block_under_way(folder: Folder) -> None:
    """The first run is done, the second has a checkpoint, the third has not begun."""
    this, seen = job(folder), []

    def look(seed: int, generation: object) -> None:
        seen.append(status_of(folder, this))
        killer(1, 2, KeyboardInterrupt)(seed, generation)  # type: ignore[arg-type]

    this.record.parent.mkdir(parents=True)
    with pytest.raises(KeyboardInterrupt):
        run_block(
            this.spec, this.seeds, this.record, checkpoint_every=1, budget="smoke",
            engine="reference", on_generation=look,
        )  # fmt: skip
    assert [(s.seed, s.generation) for s in seen] == [(0, 1), (0, 2), (1, 1), (1, 2)]
    assert seen[2].states == {"done": 1, "running": 1, "missing": 1}
    assert seen[2].runs_left == 1.5
    assert status_of(folder, this).states == {"done": 1, "interrupted": 1, "missing": 1}


def test_a_block_that_ends_during_the_look(folder: Folder, monkeypatch: pytest.MonkeyPatch) -> None:
    this = job(folder)
    partial = partial_folder(this.record)
    finish(this, seeds=1, output=finished_path(partial, 0))
    exists, path = Path.exists, finished_path(partial, 0)

    def end(self: Path) -> bool:
        there = exists(self)
        if self == path and there:
            finish(this)
            path.unlink()
            partial.rmdir()
        return there

    monkeypatch.setattr(Path, "exists", end)
    assert status_of(folder, this).states == {"done": 3}


def test_a_record_that_comes_and_goes(folder: Folder, monkeypatch: pytest.MonkeyPatch) -> None:
    def vanish(path: Path) -> None:
        raise FileNotFoundError(2, "gone", str(path))

    this = job(folder)
    finish(this)
    monkeypatch.setattr(status, "read_footer", vanish)
    assert status_of(folder, this).reason == f"{this.record}: appears and disappears"


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("Traceback (most recent call last):\n  File\nMemoryError: no\n", "MemoryError: no"),
        ("neol: x.parquet: cannot be written\n\n", "neol: x.parquet: cannot be written"),
        ("Traceback (most recent call last):\n  File\nKeyboardInterrupt\n", ""),
        ("neol: terminated: what is done is kept\n", ""),
        ("neol: note: the reference engine plays CartPole-v1: no compiler\n", ""),
        ("neol: note: x.partial: another process is running this; waiting for it\n", ""),
        ("a warning\n", ""),
        ("", ""),
    ],
)
def test_a_log_that_ends_in_an_error(folder: Folder, text: str, reason: str) -> None:
    this = job(folder)
    log(this, text)
    assert status_of(folder, this).reason == reason
    assert status_of(folder, this).state == ("failed" if reason else "missing")
    finish(this)
    assert status_of(folder, this).states == {"done": 3}


def test_each_trial_has_a_log_of_its_own(folder: Folder) -> None:
    first = job(folder, part="sensitivity")
    trial = f"rare_mutation/smoke/sensitivity/baseline/cartpole_{first.spec.method}"
    assert str(first.record).endswith(f"/results/{trial}.parquet")
    assert str(first.log).endswith(f"/logs/{trial}.log")
    log(first, "neol: no\n")
    assert [s.job for s in folder.job_statuses() if s.state == "failed"] == [first]


def test_a_time_that_is_none_fails_its_job_only(folder: Folder) -> None:
    this, other = job(folder), job(folder, place=1)
    finish(this)
    finish(other)
    record = read_record(this.record)
    foreign = record.seeds[0].provenance.model_copy(update={"time": "yesterday"})
    changed = tuple(info.model_copy(update={"provenance": foreign}) for info in record.seeds)
    write_record(this.record, dataclasses.replace(record, seeds=changed))
    assert "'yesterday' is not a time" in status_of(folder, this).reason
    assert status_of(folder, other).state == "done"


def test_a_record_that_cannot_be_used_has_failed(folder: Folder) -> None:
    this, other = job(folder), job(folder, place=1)
    finish(this)
    finish(other)
    this.record.write_bytes(b"no record")
    assert status_of(folder, this).state == "failed"
    assert "seeds_000-002.parquet: damaged" in status_of(folder, this).reason
    assert status_of(folder, other).state == "done"


def test_a_record_is_read_once(folder: Folder, monkeypatch: pytest.MonkeyPatch) -> None:
    finish(job(folder))
    before = folder.job_statuses()
    monkeypatch.setattr(status, "read_footer", None)
    assert folder.job_statuses() == before


def test_looking_changes_nothing(folder: Folder) -> None:
    this = job(folder)
    with pytest.raises(KeyboardInterrupt):
        this.record.parent.mkdir(parents=True)
        run_block(
            this.spec, this.seeds, this.record, budget="smoke", engine="reference",
            on_generation=killer(1, 1, KeyboardInterrupt),
        )  # fmt: skip
    root = folder.path.parent.parent

    def tree() -> Iterator[tuple[Path, int, bytes]]:
        for path in sorted(root.rglob("*")):
            yield path, path.stat().st_mtime_ns, path.read_bytes() if path.is_file() else b""

    before = list(tree())
    assert status_of(folder, this).state == "interrupted"
    assert list(tree()) == before
