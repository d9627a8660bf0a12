"""Files: atomic writing, bounded reading, and the folder of the cache."""

import contextlib
import errno
import hashlib
import os
import secrets
import stat
import tempfile
from collections.abc import Iterator
from io import BufferedReader
from pathlib import Path

import platformdirs

from neol.base.errors import UserError

NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
NOT_SUPPORTED = (errno.EINVAL, errno.ENOTSUP, errno.ENOSYS)
"""Errors of file systems that cannot flush: CIFS and WSL refuse folders."""


def write_atomically(path: Path, content: bytes, *, scratch: Path | None = None) -> None:
    """Write a file so that any reader, after any crash, finds the old content or the new one.

    The content goes first to a temporary file in the folder `scratch` on the same file system, by
    default beside the path; a killed process leaves that file behind. Of several writers the last
    one wins. Missing folders are made. Raises UserError where writing fails (no right, no space).
    """
    temporary = (scratch or path.parent) / f".{path.name}.{secrets.token_hex(4)}.tmp"
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with temporary.open("xb") as file:
            file.write(content)
            file.flush()
            _flush(file.fileno())
        _rename(temporary, path, content)
        with contextlib.suppress(OSError):  # the file is there; only a loss of power could undo it
            _flush_folder(path.parent)
    except BaseException as error:  # also an interrupt: leave no half-written file
        with contextlib.suppress(OSError):
            temporary.unlink()
        if not isinstance(error, OSError):
            raise
        remedy = "free some space or " if error.errno in NO_ROOM else ""
        raise UserError(
            f"{path}: cannot be written ({error.strerror}); {remedy}choose another place"
        ) from None


def replace_between(text: str, begin: str, end: str, new: str) -> str:
    """Replace everything between two markers of a page that is generated in part."""
    before, _, rest = text.partition(begin)
    _, marker, after = rest.partition(end)
    assert marker, f"no {begin} ... {end}"
    return f"{before}{begin}{new}{end}{after}"


def open_regular(path: Path) -> BufferedReader:
    """Open a regular file for reading.

    Raises UserError for a missing file and for any other kind: a pipe would block, a device may
    never end.
    """
    try:
        file = open(path, "rb", opener=_without_blocking)  # noqa: SIM115
    except (OSError, ValueError) as error:  # a name may hold a null character
        raise _unreadable(path, getattr(error, "strerror", error)) from None
    if stat.S_ISREG(os.fstat(file.fileno()).st_mode):
        return file
    file.close()
    raise _unreadable(path, "not a regular file")


def read_bounded(path: Path, limit: int) -> bytes:
    """Return the content of a file of at most `limit` bytes. Raises UserError without one."""
    with open_regular(path) as file:
        try:
            content = file.read(limit + 1)
        except OSError as error:
            raise _unreadable(path, error.strerror) from None
    if len(content) > limit:
        raise UserError(f"{path}: larger than {limit} bytes, so not a file of neol")
    return content


def sha256(path: Path) -> str:
    """Return the SHA-256 in hex of a file's content. Raises UserError without a file."""
    with open_regular(path) as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def cache_folder() -> Path:
    """Return the user's cache folder; a user without a home gets a temporary one."""
    with contextlib.suppress(RuntimeError):  # a container's unknown user has no home
        return platformdirs.user_cache_path("neol")
    return temporary_cache_folder()


def temporary_cache_folder() -> Path:
    """Return the cache folder in the system's temporary folder; another user may have made it."""
    return Path(tempfile.gettempdir(), f"neol-{os.getuid()}")


def files_below(folder: Path, pattern: str, above: tuple[Path, ...] = ()) -> Iterator[Path]:
    """Yield the files in a folder and below it whose names match a pattern like `*.parquet`.

    Links are followed, except those to a folder in `above`, which would loop for ever. Raises
    OSError for a folder that cannot be read.
    """
    here = folder.resolve()
    if here in above:
        return
    for path in sorted(folder.iterdir()):
        if path.match(pattern):
            yield path
        if path.is_dir():
            yield from files_below(path, pattern, (*above, here))


def _unreadable(path: Path, reason: object) -> UserError:
    return UserError(f"{path}: cannot be read ({reason}); check its name and permissions")


def _without_blocking(path: str, flags: int) -> int:
    return os.open(path, flags | os.O_NONBLOCK)


def _flush(handle: int) -> None:
    """Flush a file or folder to disk, where that is supported."""
    try:
        os.fsync(handle)
    except OSError as error:
        if error.errno not in NOT_SUPPORTED:
            raise


def _rename(temporary: Path, path: Path, content: bytes) -> None:
    """Rename a file. NFS may report failure after success: the content of `path` decides."""
    try:
        temporary.replace(path)
    except OSError:
        if temporary.exists() or not path.is_file() or path.read_bytes() != content:
            raise


def _flush_folder(folder: Path) -> None:
    """Flush a folder to disk, so that a rename in it survives a loss of power."""
    handle = os.open(folder, os.O_RDONLY)
    try:
        _flush(handle)
    finally:
        os.close(handle)
