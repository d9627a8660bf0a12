"""Files that are whole or not there: atomic writing, bounded reading; the cache's folder."""

import contextlib
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


def write_atomically(path: Path, content: bytes, *, scratch: Path | None = None) -> None:
    """Write a file so that any reader, after any crash, finds the old content or the new one.

    It is first written under another name, in the folder `scratch` of the same file system or else
    beside itself; a killed process leaves that behind. Of several writers the last one wins. A
    folder that is not there is made. Raises UserError where it cannot be written: no right, no
    space.
    """
    temporary = (scratch or path.parent) / f".{path.name}.{secrets.token_hex(4)}.tmp"
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with temporary.open("xb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        temporary.replace(path)
        _flush_folder(path.parent)
    except BaseException as error:  # also an interrupt: nothing half-written stays behind
        with contextlib.suppress(OSError):
            temporary.unlink()
        if not isinstance(error, OSError):
            raise
        raise UserError(
            f"{path}: cannot be written ({error.strerror}); free some space or choose another place"
        ) from None


def open_regular(path: Path) -> BufferedReader:
    """Open a regular file for reading: a pipe would block, a device may never end.

    Raises UserError where there is none.
    """
    try:
        file = open(path, "rb", opener=_without_blocking)  # noqa: SIM115
    except (OSError, ValueError) as error:  # a name from a file may hold a zero
        raise _unreadable(path, getattr(error, "strerror", error)) from None
    if stat.S_ISREG(os.fstat(file.fileno()).st_mode):
        return file
    file.close()
    raise _unreadable(path, "no regular file")


def read_bounded(path: Path, limit: int) -> bytes:
    """The content of a file of at most `limit` bytes. Raises UserError where there is none."""
    with open_regular(path) as file:
        try:
            content = file.read(limit + 1)
        except OSError as error:
            raise _unreadable(path, error.strerror) from None
    if len(content) > limit:
        raise UserError(f"{path}: larger than {limit} bytes, so not a file of neol's")
    return content


def sha256(path: Path) -> str:
    """SHA-256 in hex of a file's content. Raises UserError where there is none."""
    with open_regular(path) as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def cache_folder() -> Path:
    """The user's folder for what can be made again; a user without a home has a temporary one."""
    with contextlib.suppress(RuntimeError):  # no home, as a container's unknown user
        return platformdirs.user_cache_path("neol")
    return temporary_cache_folder()


def temporary_cache_folder() -> Path:
    """The same in the system's temporary folder, where others may have made it."""
    return Path(tempfile.gettempdir(), f"neol-{os.getuid()}")


def files_below(folder: Path, pattern: str, above: tuple[Path, ...] = ()) -> Iterator[Path]:
    """What lies in a folder or below it under a name like `*.parquet`; links are followed.

    A link to one of the folders `above` it would lead around for ever and is not. Raises OSError
    for a folder that cannot be read.
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
    return UserError(f"{path}: cannot be read ({reason}); check its name and its rights")


def _without_blocking(path: str, flags: int) -> int:
    return os.open(path, flags | os.O_NONBLOCK)


def _flush_folder(folder: Path) -> None:
    """Make a rename outlast a loss of power."""
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
