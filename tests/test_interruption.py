"""Kills at any moment, signals, a full disk, a read-only folder: nothing is lost or half-written.

The commands run in children forked from this process, which have imported and compiled all that
they need, so that most of their life is work.
"""

import os
import random
import resource
import shlex
import shutil
import signal
import subprocess
import sys
import time
import traceback
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NoReturn

import pytest

from neol import partial
from neol.cli import app
from neol.evolution import Evolution
from neol.records import read_record
from tests.test_cli import neol
from tests.test_run import names, result

BLOCK = (
    "run --task cartpole --method oja --population 8 --learning-rate 0.25 --budget smoke --quiet "
    "--resume --output run.parquet "
)
EVERY = 2
SHORT = BLOCK + f"--generations 5 --seed 0-1 --checkpoint-every {EVERY}"

Prepare = Callable[[], None]


@pytest.fixture(autouse=True)
def _folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


@dataclass
class Child:
    """A command in a process of its own."""

    command: str
    prepare: Prepare = lambda: None
    pid: int = field(init=False)
    said: int = field(init=False)
    """The pipe with its standard error."""

    def __post_init__(self) -> None:
        self.said, write = os.pipe()
        self.pid = os.fork()
        if self.pid == 0:
            self._live(write)
        os.close(write)

    def _live(self, write: int) -> NoReturn:
        status = 99
        try:
            os.dup2(write, 2)
            sys.stderr = os.fdopen(2, "w", buffering=1)
            self.prepare()
            app(shlex.split(self.command))
        except SystemExit as end:
            status = int(end.code or 0)
        except BaseException:
            traceback.print_exc()
        finally:
            os._exit(status)

    def end(self) -> tuple[int, list[str]]:
        """Wait for it: its status, as of subprocess, and the lines on standard error."""
        with os.fdopen(self.said) as said:
            lines = said.read().splitlines()
        _, status = os.waitpid(self.pid, 0)
        return os.waitstatus_to_exitcode(status), lines


def ended(command: str, prepare: Prepare = lambda: None) -> tuple[int, list[str]]:
    return Child(command, prepare).end()


def undisturbed(command: str) -> object:
    """What the command comes to when nothing happens to it; runs it here, which warms it up."""
    Path("whole").mkdir()
    assert neol(command.replace("run.parquet", "whole/run.parquet")).exit_code == 0
    made = result(read_record(Path("whole/run.parquet")))
    shutil.rmtree("whole")
    return made


def assert_finishes(command: str, expected: object) -> None:
    """The same command goes on to the same record, and leaves nothing else."""
    assert ended(command) == (0, [])
    assert names(Path()) == ["run.parquet"]
    assert result(read_record(Path("run.parquet"))) == expected


# --- Kills at every step of every write ---------------------------------------------------------


def die_before_file_operation(number: int) -> Prepare:
    """Kill the process before it opens, makes, renames or removes a file here for the nth time."""
    here, left = str(Path.cwd()), number

    def watch(event: str, arguments: tuple[Any, ...]) -> None:
        nonlocal left
        changes = event in {"open", "os.mkdir", "os.rename", "os.remove", "os.rmdir"}
        if changes and str(arguments[0]).startswith(("run.parquet", "lock", here)):
            left -= 1
            if left == 0:
                os.kill(os.getpid(), signal.SIGKILL)

    return lambda: sys.addaudithook(watch)


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
    """Write a line for each generation that is computed."""
    step = Evolution.step
    log = os.open("generations", os.O_WRONLY | os.O_APPEND | os.O_CREAT)

    def logged(self: Evolution, engine: Any) -> Any:
        row = step(self, engine)
        os.write(log, f"{self.spec.seed} {row.generation}\n".encode())
        return row

    Evolution.step = logged  # type: ignore[method-assign]


def computed() -> list[tuple[int, int]]:
    """Each generation that was computed, in order, as (seed, generation)."""
    lines = Path("generations").read_text().splitlines() if Path("generations").exists() else []
    return [(int(seed), int(generation)) for seed, generation in map(str.split, lines)]


def repeated(before: list[tuple[int, int]], after: list[tuple[int, int]]) -> int:
    """How many generations an attempt computed that those before had computed already."""
    return len(set(before) & set(after))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("sent", "stops", "most"), [(signal.SIGKILL, 50, 4), (signal.SIGTERM, 10, 1)]
)
def test_stopped_at_random_moments(sent: signal.Signals, stops: int, most: int) -> None:
    chance = random.Random(0)
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

    monkeypatch.setattr(partial.shutil, "rmtree", stopped)
    assert neol(SHORT).exit_code == 0
    monkeypatch.undo()


# --- Two at once --------------------------------------------------------------------------------


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


# --- Nowhere to write ---------------------------------------------------------------------------


def limited(size: int) -> Prepare:
    """No file of this process may get larger."""
    return lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))


def assert_refused(command: str, reason: str, prepare: Prepare = lambda: None) -> str:
    """The command ends in one line, whose file it returns; all that is there is whole."""
    status, lines = ended(command, prepare)
    assert (status, len(lines)) == (2, 1)
    (line,) = lines
    path, told, _ = line.removeprefix("neol: ").partition(f": cannot be written ({reason}); free ")
    assert told, line
    for file in Path("run.parquet.partial").glob("*"):
        assert file.suffix in {".npz", ".parquet"} or file.name == "lock"
        if file.suffix == ".parquet":
            read_record(file)
    return Path(path.split()[-1]).name


@pytest.mark.parametrize(
    ("checkpoints", "room", "file"),
    [(2, 0, "seed_000000.npz"), (99, 0, "seed_000000.parquet"), (99, -200, "run.parquet")],
)
def test_a_file_that_cannot_grow(checkpoints: int, room: int, file: str) -> None:
    """As on a full disk, at a checkpoint, at a seed's record, at the block's."""
    command = SHORT.replace(f"--checkpoint-every {EVERY}", f"--checkpoint-every {checkpoints}")
    expected = undisturbed(command)
    neol(command)
    size = Path("run.parquet").stat().st_size + room if room else 0
    Path("run.parquet").unlink()
    assert assert_refused(command, "File too large", limited(size)) == file
    assert_finishes(command, expected)


@pytest.fixture
def full_disk(tmp_path: Path) -> Iterator[Path]:
    """A file system of 64 KiB, where we may mount one."""
    folder = tmp_path / "disk"
    folder.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", folder]
    if shutil.which("mount") is None or subprocess.run(mount, capture_output=True).returncode:
        pytest.skip("only root can mount")
    yield folder
    subprocess.run(["umount", "--lazy", folder], check=True)


def test_a_disk_that_is_full(full_disk: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    expected = undisturbed(SHORT)
    monkeypatch.chdir(full_disk)
    files = []
    for pages in range(1, 16):
        Path("filler").write_bytes(bytes((15 - pages) * 4096))
        if ended(SHORT)[0] == 0:
            break
        files.append(assert_refused(SHORT, "No space left on device"))
        Path("filler").unlink()
        assert_finishes(SHORT, expected)
        Path("run.parquet").unlink()
    assert {"seed_000000.npz", "seed_000001.npz"} <= set(files)


def powerless() -> None:
    """Root may write anywhere, so become somebody else."""
    if os.geteuid() == 0:
        os.setgid(65534)
        os.setuid(65534)


@pytest.mark.parametrize("begun", [False, True])
def test_a_read_only_folder(begun: bool, tmp_path: Path) -> None:
    expected = undisturbed(SHORT)
    if begun:
        ended(SHORT, die_before_file_operation(20))
    for folder in (tmp_path, *tmp_path.glob("*.partial")):
        folder.chmod(0o555)
    status, lines = ended(SHORT, powerless)
    for folder in (tmp_path, *tmp_path.glob("*.partial")):
        folder.chmod(0o755)
    assert status == 2
    (line,) = lines
    assert line.startswith("neol: run.parquet.partial: cannot be made (Permission denied)")
    assert_finishes(SHORT, expected)
