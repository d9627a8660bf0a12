"""Workspace of a block: the folder beside an output that holds its parts until it is complete.

Only one process at a time can claim it.
"""

import contextlib
import fcntl
import itertools
import os
import shutil
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import IO

from neol.base.errors import NOTICE, UserError
from neol.base.interruption import stop_if_asked


def partial_folder(output: Path) -> Path:
    """Return the workspace of an output."""
    return output.with_name(f"{output.name}.partial")


def finished_path(workspace: Path, seed: int) -> Path:
    """Return the path of a finished seed's record."""
    return workspace / f"seed_{seed:06}.parquet"


def checkpoint_path(workspace: Path, seed: int) -> Path:
    """Return the path of an unfinished seed's checkpoint."""
    return finished_path(workspace, seed).with_suffix(".npz")


def remove_if_complete(output: Path) -> None:
    """Remove the workspace of an output that exists."""
    if output.exists():
        shutil.rmtree(partial_folder(output), ignore_errors=True)


@contextlib.contextmanager
def claim(output: Path, *, wait: bool, keep: bool = False) -> Iterator[Path]:
    """Make an output's workspace and lock it against other processes.

    At the end it is removed if it holds no work, or if the output is complete and `keep` is false.
    """
    workspace = partial_folder(output)
    lock = workspace / "lock"
    while True:
        try:
            workspace.mkdir(parents=True, exist_ok=True)
            file = lock.open("w")
        except OSError as error:
            raise UserError(
                f"{workspace}: cannot be made ({error.strerror}); choose another output"
            ) from None
        with file:
            _lock(file, workspace, wait)
            if not _is(file, lock):
                continue  # the process that held it has removed it
            try:
                yield workspace
            finally:
                if not any(workspace.glob("seed_*")):
                    shutil.rmtree(workspace, ignore_errors=True)
                elif not keep:
                    remove_if_complete(output)
            return


def _lock(file: IO[str], workspace: Path, wait: bool) -> None:
    """Lock a file by the operating system, which releases the lock when the process ends."""
    for attempt in itertools.count(1):
        stop_if_asked()
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            if attempt == 4:  # `is_running` may hold the lock for an instant
                line = f"{workspace}: another process is running this"
                if not wait:
                    raise UserError(f"{line}; wait for it or choose another output") from None
                print(f"{NOTICE}{line}; waiting for it", file=sys.stderr, flush=True)
            time.sleep(0.05)
        except OSError:
            return  # the file system has no locks
        else:
            return


def _is(file: IO[str], path: Path) -> bool:
    """Whether a path still names an open file."""
    try:
        return os.path.samestat(os.fstat(file.fileno()), path.stat())
    except FileNotFoundError:
        return False


def is_running(workspace: Path) -> bool:
    """Whether a process has locked a workspace; always false on a file system without locks."""
    try:
        with (workspace / "lock").open() as file:
            fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    except OSError:
        return False
    return False
