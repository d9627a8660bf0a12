"""Endings of a command that is interrupted, terminated or no longer read."""

import os
import re
import signal
import time
from pathlib import Path

import pytest

from neol.cli.progress import Progress
from neol.run.record_file import read_record
from tests.helpers.command import TINY, neol, refused, start
from tests.helpers.runs import killer, names, result

pytestmark = pytest.mark.usefixtures("own_folder")


def test_an_interrupt_says_how_to_go_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    command = f"run {TINY} --output a.parquet"
    with monkeypatch.context() as patch:
        patch.setattr(Progress, "__call__", lambda _, *told: killer(0, 2, KeyboardInterrupt)(*told))
        stopped = neol(command)
    assert stopped.exit_code == 130
    line = stopped.stderr.splitlines()[-1]
    assert line.startswith("neol: interrupted: progress is kept in a.parquet.partial")
    assert "--resume" in line
    assert "a.parquet.partial: has an interrupted run; continue with --resume" in refused(command)
    assert neol(f"{command} --resume").exit_code == 0
    neol(f"run {TINY} --output whole.parquet")
    assert result(read_record(tmp_path / "a.parquet")) == result(
        read_record(tmp_path / "whole.parquet")
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    ("sent", "status", "workers"),
    [
        (signal.SIGINT, 130, 2),
        (signal.SIGTERM, 143, 1),
        (signal.SIGHUP, 143, 2),
        (signal.SIGXCPU, 143, 1),
    ],
)
def test_signals_keep_a_checkpoint(
    sent: signal.Signals, status: int, workers: int, tmp_path: Path
) -> None:
    endless = f"run {TINY} --seed 0-1 --generations 100000 --checkpoint-every 1 --output a.parquet"
    process = start(f"{endless} --workers {workers}", tmp_path)
    kept = tmp_path / "a.parquet.partial" / "seed_000000.npz"
    while not kept.exists() and process.poll() is None:
        time.sleep(0.02)
    os.killpg(process.pid, sent)  # as a terminal does: workers get it too
    stdout, stderr = process.communicate(timeout=60)
    assert process.returncode == status
    assert stdout == ""
    assert "Traceback" not in stderr
    assert re.fullmatch(
        r"neol: (interrupted|terminated): .* kept in a\.parquet\.partial; .* --resume .*",
        stderr.splitlines()[-1],
    )
    assert names(tmp_path) == ["a.parquet.partial", "lock", "seed_000000.npz"]


def test_a_path_that_the_system_refuses_is_one_line() -> None:
    assert "aaa: File name too long; fix that" in refused(f"verify {'a' * 300}")


def test_ctrl_c_is_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupt(_self: Path) -> bool:
        raise KeyboardInterrupt

    monkeypatch.setattr(Path, "exists", interrupt)
    outcome = neol("verify a.parquet")
    assert (outcome.exit_code, outcome.stdout) == (130, "")
    assert outcome.stderr == "neol: interrupted\n"


def test_who_reads_no_further_is_told_nothing(tmp_path: Path) -> None:
    process = start("config --budget smoke", tmp_path)
    assert process.stdout is not None and process.stderr is not None
    process.stdout.close()
    assert process.stderr.read() == ""
    assert process.wait() == 141
    process.stderr.close()


@pytest.mark.slow
def test_piped_output_is_plain_lines(tmp_path: Path) -> None:
    process = start(f"run {TINY} --seed 0,1 --output a.parquet", tmp_path)
    stdout, stderr = process.communicate(timeout=60)
    assert process.returncode == 0
    assert "\x1b" not in stdout + stderr
    first, *_, last = stderr.splitlines()
    assert first.startswith("seed 0 (1 of 2)  generation 1/3  best ")
    assert last.startswith("seed 1 (2 of 2)  generation 3/3  best ")
    assert last.endswith(" steps/s  0:00 left")
    assert stdout.startswith("a.parquet: written (")
