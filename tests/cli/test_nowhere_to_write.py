"""A full disk, a read-only folder: one line, and nothing is lost or half-written."""

import os
import resource
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from neol.run.record_file import read_record
from tests.helpers.children import (
    EVERY,
    SHORT,
    Prepare,
    assert_finishes,
    die_before_file_operation,
    ended,
    undisturbed,
)
from tests.helpers.command import neol

pytestmark = pytest.mark.usefixtures("own_folder")


def limited(size: int) -> Prepare:
    """No file of this process may get larger."""
    return lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))


def assert_refused(command: str, reason: str, prepare: Prepare = lambda: None) -> str:
    """Check that a command ends in one line and leaves whole files; return that line's file."""
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


@pytest.mark.slow
@pytest.mark.parametrize(
    ("checkpoints", "room", "file"),
    [(2, 0, "seed_000000.npz"), (99, 0, "seed_000000.parquet"), (99, -200, "run.parquet")],
)
def test_a_file_that_cannot_grow(checkpoints: int, room: int, file: str) -> None:
    """Files cannot grow at a checkpoint, at a seed's record, at the block's record."""
    command = SHORT.replace(f"--checkpoint-every {EVERY}", f"--checkpoint-every {checkpoints}")
    expected = undisturbed(command)
    neol(command)
    size = Path("run.parquet").stat().st_size + room if room else 0
    Path("run.parquet").unlink()
    assert assert_refused(command, "File too large", limited(size)) == file
    assert_finishes(command, expected)


@pytest.fixture
def full_disk(tmp_path: Path) -> Iterator[Path]:
    """Mount a file system of 64 KiB, if permitted."""
    folder = tmp_path / "disk"
    folder.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", folder]
    if shutil.which("mount") is None or subprocess.run(mount, capture_output=True).returncode:
        pytest.skip("only root can mount")
    yield folder
    subprocess.run(["umount", "--lazy", folder], check=True)


@pytest.mark.slow
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


@pytest.mark.slow
@pytest.mark.skipif(not Path("/dev/full").exists(), reason="a system without a full device")
@pytest.mark.parametrize("command", ["config", "--version"])
def test_a_disk_that_is_full_behind_what_is_printed(command: str) -> None:
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            [sys.executable, "-m", "neol", command], stdout=full, stderr=subprocess.PIPE, text=True
        )
    line = "neol: standard output: No space left on device; fix that or choose another place\n"
    assert (done.returncode, done.stderr) == (2, line)


def powerless() -> None:
    """Become another user, because root may write anywhere."""
    if os.geteuid() == 0:
        os.setgid(65534)
        os.setuid(65534)


@pytest.mark.slow
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
