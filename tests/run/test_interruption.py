"""Kills at any moment, signals, two runs at once: no file is lost or half-written.

`NEOL_KILLS=1 pytest tests/run/test_interruption.py` kills at other random moments.
"""

import os
import random
import signal
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, NoReturn

import pytest

from neol.run import workspace
from neol.run.evolution import Evolution
from neol.run.record_file import read_record
from tests.helpers.children import (
    BLOCK,
    SHORT,
    Child,
    Prepare,
    assert_finishes,
    die_before_file_operation,
    ended,
    undisturbed,
)
from tests.helpers.command import neol
from tests.helpers.runs import names, result

pytestmark = pytest.mark.usefixtures("own_folder")


# --- Kills at every step of every write ---------------------------------------------------------


def die_within_write(number: int) -> Prepare:
    """Kill the process when half of its nth temporary file is written."""
    left = number

    class Half:
        def __init__(self, file: Any) -> None:
            self.file = file

        def __enter__(self) -> Any:
            return self

        def __exit__(self, *_: object) -> None:
            self.file.close()

        def __getattr__(self, name: str) -> Any:
            return getattr(self.file, name)

        def write(self, content: bytes) -> None:
            nonlocal left
            left -= 1
            if left == 0:
                self.file.write(content[: len(content) // 2])
                self.file.flush()
                os.kill(os.getpid(), signal.SIGKILL)
            self.file.write(content)

    def prepare() -> None:
        opened = Path.open
        Path.open = lambda path, *how, **kw: (  # type: ignore[method-assign, assignment]
            Half(opened(path, *how)) if path.suffix == ".tmp" else opened(path, *how, **kw)
        )

    return prepare


@pytest.mark.slow
@pytest.mark.parametrize(
    ("dies", "least"), [(die_before_file_operation, 25), (die_within_write, 6)]
)
def test_killed_at_every_step_of_every_write(dies: Callable[[int], Prepare], least: int) -> None:
    expected = undisturbed(SHORT)
    number = 1
    while True:
        status, lines = ended(SHORT, dies(number))
        assert lines == []
        if status == 0:
            break
        assert status == -signal.SIGKILL
        assert_finishes(SHORT, expected)
        Path("run.parquet").unlink()
        number += 1
    assert number > least


# --- Kills at random moments --------------------------------------------------------------------

MANY = BLOCK + "--generations 20 --seed 0-2 --checkpoint-every 4"


def log_generations() -> None:
    """Log a line for each computed generation."""
    step = Evolution.step
    log = os.open("generations", os.O_WRONLY | os.O_APPEND | os.O_CREAT)

    def logged(self: Evolution, engine: Any) -> Any:
        row = step(self, engine)
        os.write(log, f"{self.spec.seed} {row.generation}\n".encode())
        return row

    Evolution.step = logged  # type: ignore[method-assign]


def computed() -> list[tuple[int, int]]:
    """Return the computed generations in order, as (seed, generation)."""
    lines = Path("generations").read_text().splitlines() if Path("generations").exists() else []
    return [(int(seed), int(generation)) for seed, generation in map(str.split, lines)]


def repeated(before: list[tuple[int, int]], after: list[tuple[int, int]]) -> int:
    """Count the generations of an attempt that earlier attempts had computed already."""
    return len(set(before) & set(after))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("sent", "stops", "most"), [(signal.SIGKILL, 50, 4), (signal.SIGTERM, 10, 1)]
)
def test_stopped_at_random_moments(sent: signal.Signals, stops: int, most: int) -> None:
    chance = random.Random(int(os.environ.get("NEOL_KILLS", "0")))
    expected = undisturbed(MANY)
    begin = time.perf_counter()
    neol(MANY)
    seconds = time.perf_counter() - begin
    hits, repeats = 0, []
    while hits < stops:
        Path("run.parquet").unlink()
        status = None
        while status != 0:
            before = computed()
            child = Child(MANY, log_generations)
            if hits < stops:
                time.sleep(chance.uniform(0, 0.6 * seconds))
                os.kill(child.pid, sent)
            status, lines = child.end()
            repeats.append(repeated(before, computed()[len(before) :]))
            if status != 0:
                hits += 1
                if sent == signal.SIGKILL:
                    assert (status, lines) == (-sent, [])
                elif status == 143:
                    assert len(lines) == 1
                    assert lines[0].startswith("neol: terminated: ")
                else:
                    assert (status, lines) == (-sent, [])  # it had not begun
        Path("generations").unlink()
        assert_finishes(MANY, expected)
    assert max(repeats) <= most


def test_terminated_when_all_is_done_is_done(monkeypatch: pytest.MonkeyPatch) -> None:
    def stopped(*_arguments: object, **_options: object) -> NoReturn:
        raise KeyboardInterrupt

    monkeypatch.setattr(workspace.shutil, "rmtree", stopped)
    assert neol(SHORT).exit_code == 0
    monkeypatch.undo()


# --- Two at once --------------------------------------------------------------------------------


@pytest.mark.slow
def test_two_on_the_same_output() -> None:
    expected = undisturbed(MANY)
    first = Child(MANY)
    while not any(Path().glob("*.partial/seed_*")):
        time.sleep(0.001)
    os.kill(first.pid, signal.SIGSTOP)
    status, (line,) = ended(MANY.replace("--resume", ""))
    assert status == 2
    assert line.startswith("neol: run.parquet.partial: another process is running this; wait")
    second = Child(MANY)
    line = os.read(second.said, 1000).decode()
    reason = "run.parquet.partial: another process is running this; waiting for it"
    assert line == f"neol: note: {reason}\n"
    os.kill(first.pid, signal.SIGCONT)
    assert first.end() == second.end() == (0, [])
    assert names(Path()) == ["run.parquet"]
    assert result(read_record(Path("run.parquet"))) == expected
