"""How every compiled function of neol is made: two decorators, one cache."""

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
"""A cache that no process has opened for so long is removed."""

Function = TypeVar("Function", bound=Callable[..., object])


def kernel(function: Function) -> Function:
    """Compile a function to machine code that holds no GIL, cached on disk.

    No fast math and no threads inside: a kernel rounds as its Python source does. The source
    stays reachable as `function.py_func`, the plain twin that the tests compare with.

    A kernel that Python calls writes into arrays it is given, and returns none: numba calls
    Python to make a returned array or tuple, and where a signal's handler (Ctrl-C) raises in
    there, it crashes.
    """
    return _compiled(function, in_loop=False)


def loop_kernel(function: Function) -> Function:
    """Compile a function as a `kernel` that allocates no array, for the loop over steps.

    It becomes part of its callers' code, and it counts no references to arrays, which its caller
    keeps alive. Numba would count them for every array in a NamedTuple, at every use of it: that
    took half of a CartPole step.
    """
    return _compiled(function, in_loop=True)


def _compiled(function: Function, in_loop: bool) -> Function:
    """Both options are always given: one that is not is inherited from a caller in compilation."""
    options: dict[str, Any] = {"forceinline": in_loop, "_nrt": not in_loop}
    compile_ = numba.njit(cache=True, nogil=True, error_model="numpy", **options)
    return cast(Function, compile_(function))


@cache
def source_digest() -> str:
    """Hex digest of all sources of neol that hold compiled code, and of the compiler's version."""
    digest = hashlib.sha256(numba.__version__.encode())
    for path in sorted(Path(__file__).parents[1].rglob("*.py")):
        text = path.read_bytes()
        if any(mark in text for mark in (b"neol.base.kernel", b"numba", b"@rule")):
            digest.update(text)
    return digest.hexdigest()[:16]


def _cache_folder() -> Path:
    """A writable folder of this source digest's own.

    Numba asks only whether the file of a cached kernel has changed, not the files of the
    kernels that it calls; a folder for each state of the sources makes a stale kernel impossible.
    Where the user's cache cannot be written, one in the system's temporary folder serves. Only a
    folder that nobody else can write does: numba unpickles what it finds in it.
    """
    chosen = Path(os.environ.get("NUMBA_CACHE_DIR") or cache_folder())
    for base in (chosen, temporary_cache_folder()):
        folder = base / f"kernels-{source_digest()}"
        with contextlib.suppress(OSError):
            folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            if _only_ours(folder):
                os.utime(folder)  # in use now; fails where nothing can be written
                _remove_unused(base)
                return folder
    return Path(tempfile.mkdtemp(prefix="neol-kernels-"))


def _only_ours(folder: Path) -> bool:
    """Whether it and the folder around it are this user's, and nobody else may write in it."""
    owners = {path.lstat().st_uid for path in (folder, folder.parent)}
    return owners == {os.getuid()} and not folder.lstat().st_mode & (stat.S_IWGRP | stat.S_IWOTH)


def _remove_unused(base: Path) -> None:
    for folder in base.glob("kernels-*"):
        with contextlib.suppress(FileNotFoundError):  # another process was faster
            if time.time() - folder.stat().st_mtime > UNUSED_SECONDS:
                shutil.rmtree(folder, ignore_errors=True)


numba.config.CACHE_DIR = str(_cache_folder())  # type: ignore[attr-defined]
