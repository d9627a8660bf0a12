"""Compilation of neol's kernels: two decorators, one cache."""

import contextlib
import hashlib
import os
import shutil
import stat
import tempfile
import time
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, cast

import numba

from neol.base.files import cache_folder, temporary_cache_folder

UNUSED_SECONDS = 30 * 24 * 3600
"""Time after which an unused cache is removed."""

Function = TypeVar("Function", bound=Callable[..., object])


def kernel(function: Function) -> Function:
    """Compile a function to machine code that releases the GIL, cached on disk.

    It uses neither fast math nor threads, so a kernel rounds as its Python source does. The source
    stays available as `function.py_func`, the plain twin that the tests compare with.

    A kernel that Python calls writes into given arrays and returns none: numba calls Python to
    make a returned array or tuple, and crashes if a signal handler (Ctrl-C) raises there.
    """
    return _compiled(function, in_loop=False)


def loop_kernel(function: Function) -> Function:
    """Compile a function as a `kernel` that allocates no array, for the loop over steps.

    It is inlined into its callers and counts no references to arrays, which its caller keeps alive.
    Numba would count them for every array of a NamedTuple at every use, which took half of a
    CartPole step.
    """
    return _compiled(function, in_loop=True)


def _compiled(function: Function, in_loop: bool) -> Function:
    """Compile with both options set, because an omitted one is inherited from a caller."""
    options: dict[str, Any] = {"forceinline": in_loop, "_nrt": not in_loop}
    compile_ = numba.njit(cache=True, nogil=True, error_model="numpy", **options)
    return cast(Function, compile_(function))


@cache
def source_digest() -> str:
    """Return a hex digest of all sources with compiled code and of the compiler's version."""
    digest = hashlib.sha256(numba.__version__.encode())
    for path in sorted(Path(__file__).parents[1].rglob("*.py")):
        text = path.read_bytes()
        if any(mark in text for mark in (b"neol.base.kernel", b"numba", b"@rule")):
            digest.update(text)
    return digest.hexdigest()[:16]


def _cache_folder() -> Path:
    """Return a writable folder for this source digest.

    Numba checks only the file of a cached kernel for changes, not those of the kernels that it
    calls; a folder for each state of the sources makes a stale kernel impossible. If the user's
    cache cannot be written, one in the system's temporary folder is used. Nobody else may have
    write access to the folder, because numba unpickles its files.
    """
    chosen = Path(os.environ.get("NUMBA_CACHE_DIR") or cache_folder())
    for base in (chosen, temporary_cache_folder()):
        folder = base / f"kernels-{source_digest()}"
        with contextlib.suppress(OSError):
            folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            if _only_ours(folder):
                os.utime(folder)  # mark as used; fails without write access
                _remove_unused(base)
                return folder
    return Path(tempfile.mkdtemp(prefix="neol-kernels-"))


def _only_ours(folder: Path) -> bool:
    """Whether a folder and its parent belong to this user and nobody else may write in it."""
    owners = {path.lstat().st_uid for path in (folder, folder.parent)}
    return owners == {os.getuid()} and not folder.lstat().st_mode & (stat.S_IWGRP | stat.S_IWOTH)


def _remove_unused(base: Path) -> None:
    for folder in base.glob("kernels-*"):
        with contextlib.suppress(FileNotFoundError):  # another process has removed it
            if time.time() - folder.stat().st_mtime > UNUSED_SECONDS:
                shutil.rmtree(folder, ignore_errors=True)


numba.config.CACHE_DIR = str(_cache_folder())  # type: ignore[attr-defined]
