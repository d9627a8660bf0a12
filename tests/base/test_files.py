"""Atomic writing and bounded reading of files."""

import errno
import os
import pwd
import stat
from collections.abc import Callable
from pathlib import Path

import pytest

from neol.base.errors import UserError
from neol.base.files import (
    cache_folder,
    files_below,
    read_bounded,
    sha256,
    temporary_cache_folder,
    write_atomically,
)


def test_written_is_read(tmp_path: Path) -> None:
    write_atomically(tmp_path / "a", b"old")
    write_atomically(tmp_path / "a", b"new")
    assert read_bounded(tmp_path / "a", 3) == b"new"
    assert [path.name for path in tmp_path.iterdir()] == ["a"]


@pytest.mark.parametrize("whom", [stat.S_ISDIR, lambda _mode: True], ids=["folder", "all"])
def test_what_a_file_system_cannot_flush_is_written(
    whom: Callable[[int], bool], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    flush = os.fsync

    def refuse(handle: int) -> None:
        if whom(os.fstat(handle).st_mode):
            raise OSError(errno.EINVAL, "Invalid argument")
        flush(handle)

    monkeypatch.setattr(os, "fsync", refuse)
    write_atomically(tmp_path / "a", b"new")
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == {"a": b"new"}


@pytest.mark.parametrize("works", [True, False])
def test_a_rename_that_worked_and_reports_that_it_did_not(
    works: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    rename = Path.replace

    def stale(path: Path, target: Path) -> None:
        if works:
            rename(path, target)
        raise OSError(errno.ESTALE, "Stale file handle")

    write_atomically(tmp_path / "a", b"old")
    monkeypatch.setattr(Path, "replace", stale)
    if works:
        write_atomically(tmp_path / "a", b"new")
    else:
        with pytest.raises(UserError, match=r"cannot be written \(Stale file handle\); choose"):
            write_atomically(tmp_path / "a", b"new")
    expected = {"a": b"new" if works else b"old"}
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == expected


def test_a_full_disk_leaves_the_old_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(_: int) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    write_atomically(tmp_path / "a", b"old")
    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(UserError, match=r"a: cannot be written \(No space left on device\)"):
        write_atomically(tmp_path / "a", b"new")
    assert [path.name for path in tmp_path.iterdir()] == ["a"]
    assert (tmp_path / "a").read_bytes() == b"old"


def test_an_interrupt_leaves_the_old_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupt(_: int) -> None:
        raise KeyboardInterrupt

    write_atomically(tmp_path / "a", b"old")
    monkeypatch.setattr(os, "fsync", interrupt)
    with pytest.raises(KeyboardInterrupt):
        write_atomically(tmp_path / "a", b"new")
    assert [path.name for path in tmp_path.iterdir()] == ["a"]


def test_a_folder_that_is_none(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(UserError, match="cannot be written"):
        write_atomically(tmp_path / "file" / "a", b"")
    with pytest.raises(UserError, match="cannot be read"):
        read_bounded(tmp_path / "file" / "a", 1)


def test_a_folder_that_is_not_there_is_made(tmp_path: Path) -> None:
    write_atomically(tmp_path / "runs" / "a", b"new")
    assert (tmp_path / "runs" / "a").read_bytes() == b"new"


def test_two_writers_at_once_do_not_meet(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    flush, path = os.fsync, tmp_path / "a"

    def write_meanwhile(_: int) -> None:
        monkeypatch.setattr(os, "fsync", flush)
        write_atomically(path, b"other")
        assert path.read_bytes() == b"other"

    monkeypatch.setattr(os, "fsync", write_meanwhile)
    write_atomically(path, b"one")
    assert path.read_bytes() == b"one"
    assert [each.name for each in tmp_path.iterdir()] == ["a"]


@pytest.mark.parametrize("read", [sha256, lambda path: read_bounded(path, 9)])
def test_only_regular_files_are_read(read: Callable[[Path], object], tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")  # which would block for ever
    (tmp_path / "loop").symlink_to(tmp_path / "loop")
    for path in (tmp_path / "pipe", tmp_path / "loop", tmp_path, Path("/dev/zero")):
        with pytest.raises(UserError, match=r"cannot be read \(.+\); check its name"):
            read(path)


def test_too_large_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(b"four")
    with pytest.raises(UserError, match="larger than 3 bytes"):
        read_bounded(tmp_path / "a", 3)


def test_links_are_followed_but_not_around(tmp_path: Path) -> None:
    (tmp_path / "elsewhere" / "b").mkdir(parents=True)
    (tmp_path / "elsewhere" / "b" / "x.parquet").touch()
    (tmp_path / "results" / "a").mkdir(parents=True)
    (tmp_path / "results" / "desk").symlink_to(tmp_path / "elsewhere")
    (tmp_path / "results" / "a" / "up").symlink_to(tmp_path / "results")
    (tmp_path / "elsewhere" / "back").symlink_to(tmp_path / "results")
    (tmp_path / "results" / "nowhere.parquet").symlink_to(tmp_path / "gone")
    found = [path.relative_to(tmp_path) for path in files_below(tmp_path / "results", "*.parquet")]
    assert found == [Path("results/desk/b/x.parquet"), Path("results/nowhere.parquet")]


def test_a_user_without_a_home_has_a_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    monkeypatch.setenv("HOME", str(tmp_path))
    assert cache_folder().is_relative_to(tmp_path)
    monkeypatch.delenv("HOME")
    monkeypatch.setattr(pwd, "getpwuid", {}.__getitem__)
    assert cache_folder() == temporary_cache_folder()
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert cache_folder() == tmp_path / "neol"
