"""The cache of compiled kernels: where it lies, and whom it trusts.

Numba unpickles the files of its cache, so whoever can write there runs code here. A cache that
cannot be trusted, read or written costs the time to compile, never the work.
"""

import contextlib
import hashlib
import os
import shutil
import stat
import tempfile
import time
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import numba
from numba.core.caching import FunctionCache

from neol.base.files import cache_folder, temporary_cache_folder

UNUSED_SECONDS = 30 * 24 * 3600
"""Time after which an unused cache is removed."""
MARK = ".made-by-neol"
"""A file in each folder of kernels; only a folder that has it is ever removed."""


class KernelCache(FunctionCache):
    """Numba's cache of a function, which does without where files cannot be read or written."""

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return what was compiled for a signature; None where that is not there or damaged.

        The index of a damaged cache is emptied, so that what is compiled next can be kept.
        """
        try:
            return super().load_overload(sig, target_context)  # type: ignore[no-untyped-call]
        except Exception:  # unpickling damaged files can raise anything
            with contextlib.suppress(OSError):
                self.flush()  # type: ignore[no-untyped-call]
            return None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep what was compiled, if the disk and its quota allow."""
        with contextlib.suppress(Exception):  # it reads the index, which may be damaged
            super().save_overload(sig, data)  # type: ignore[no-untyped-call]


@cache
def source_digest() -> str:
    """Return a hex digest of all sources with compiled code and of the compiler's version."""
    digest = hashlib.sha256(numba.__version__.encode())
    for path in sorted(Path(__file__).parents[1].rglob("*.py")):
        text = path.read_bytes()
        if any(mark in text for mark in (b"neol.base.kernel", b"numba", b"@rule")):
            digest.update(text)
    return digest.hexdigest()[:16]


def kernel_folder() -> Path | None:
    """Return a writable folder for this source digest; None if there is no place for one.

    Numba checks only the file of a cached kernel for changes, not those of the kernels that it
    calls; a folder for each state of the sources makes a stale kernel impossible. If the folder
    chosen by NUMBA_CACHE_DIR cannot be written or trusted, the user's cache is used, then one in
    the system's temporary folder, then a new one that is not found again.
    """
    chosen = os.environ.get("NUMBA_CACHE_DIR")
    for base in (Path(chosen) if chosen else None, cache_folder(), temporary_cache_folder()):
        if base is None:
            continue
        folder = base.absolute() / f"kernels-{source_digest()}"
        with contextlib.suppress(OSError):
            _make_private(folder)
            if _only_ours(folder):
                (folder / MARK).touch()
                os.utime(folder)  # mark as used
                _remove_unused(base)
                return folder
    with contextlib.suppress(OSError):
        return Path(tempfile.mkdtemp(prefix="neol-kernels-"))
    return None


def _make_private(folder: Path) -> None:
    """Make a folder, and those around it that are missing, for this user alone."""
    for each in (*reversed(folder.parents), folder):
        with contextlib.suppress(FileExistsError):
            each.mkdir(mode=0o700)


def _only_ours(folder: Path) -> bool:
    """Whether the folder is this user's and nobody else can write in it or put another there."""
    if folder.stat().st_uid != os.getuid() or folder.stat().st_mode & 0o022:
        return False
    return all(_is_safe(each) for each in _leading_to(folder))


def _leading_to(folder: Path) -> Iterator[Path]:
    """Yield the folders that lead to a folder by its name, and by its name without links."""
    yield from {*folder.parents, *folder.resolve().parents}


def _is_safe(folder: Path) -> bool:
    """Whether only this user or the administrator can rename what lies in a folder.

    In a sticky one, such as /tmp, others can add but not rename. In a container, the administrator
    may have another number than 0.
    """
    status = folder.stat()
    shared = status.st_mode & 0o022 and not status.st_mode & stat.S_ISVTX
    return status.st_uid in (os.getuid(), Path(folder.anchor).stat().st_uid) and not shared


def _remove_unused(base: Path) -> None:
    for folder in base.glob("kernels-*"):
        with contextlib.suppress(OSError):  # another process has removed it, or it is not ours
            unused = time.time() - folder.stat().st_mtime > UNUSED_SECONDS
            ours = (folder / MARK).is_file() and folder.stat().st_uid == os.getuid()
            if unused and ours:
                shutil.rmtree(folder, ignore_errors=True)
