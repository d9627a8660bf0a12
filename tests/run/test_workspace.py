"""Only one process at a time works on an output, and others can see that."""

import fcntl
import signal
import time
from pathlib import Path

import pytest

from neol.base.errors import UserError
from neol.base.interruption import Terminated, interruptible
from neol.run.workspace import is_running, partial_folder, remove_if_complete
from tests.helpers.runs import block, killer, names


def test_two_processes_do_not_run_the_same_block(tmp_path: Path) -> None:
    partial = tmp_path / "run.parquet.partial"
    partial.mkdir()
    with (partial / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        with pytest.raises(UserError, match="another process is running this"):
            block(tmp_path / "run.parquet")
    assert block(tmp_path / "run.parquet").seeds[0].seed == 0


def test_a_signal_ends_the_wait_for_another_process(tmp_path: Path) -> None:
    partial = partial_folder(tmp_path / "run.parquet")
    partial.mkdir()
    with (partial / "lock").open("w") as lock, interruptible():
        fcntl.flock(lock, fcntl.LOCK_EX)
        signal.raise_signal(signal.SIGTERM)
        with pytest.raises(Terminated):
            block(tmp_path / "run.parquet", resume=True)


def test_a_block_is_running_while_a_process_holds_its_folder(tmp_path: Path) -> None:
    partial = partial_folder(tmp_path / "run.parquet")
    seen: list[bool] = []
    assert not is_running(partial)
    with pytest.raises(KeyboardInterrupt):
        block(
            tmp_path / "run.parquet",
            on_generation=lambda seed, done: (
                seen.append(is_running(partial)),
                killer(1, 2, KeyboardInterrupt)(seed, done),
            ),
        )
    assert seen == [True] * 6
    assert names(partial) == ["lock", "seed_000000.parquet", "seed_000001.npz"]
    assert not is_running(partial)


def test_looking_whether_a_block_is_running_keeps_none_from_starting(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    partial = partial_folder(tmp_path / "run.parquet")
    partial.mkdir()
    with (partial / "lock").open("w") as looker:
        fcntl.flock(looker, fcntl.LOCK_SH)
        monkeypatch.setattr(time, "sleep", lambda _: fcntl.flock(looker, fcntl.LOCK_UN))
        block(tmp_path / "run.parquet", seeds=(0,))
    assert names(tmp_path) == ["run.parquet"]


def test_kept_seeds_make_a_lost_record_again(tmp_path: Path) -> None:
    output = tmp_path / "run.parquet"
    made = block(output, keep_partial=True)
    remove_if_complete(tmp_path / "other.parquet")
    assert names(partial_folder(output)) == [
        "lock",
        "seed_000000.parquet",
        "seed_000001.parquet",
    ]
    output.unlink()
    remove_if_complete(output)
    again = block(output, resume=True, keep_partial=True)
    assert again.seeds == made.seeds  # time of day and cost included
    remove_if_complete(output)
    assert names(tmp_path) == ["run.parquet"]
