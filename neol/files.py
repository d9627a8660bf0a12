"""Files that are whole or not there: atomic writing, bounded reading."""

import contextlib
import os
from pathlib import Path

from neol.errors import UserError


def write_atomically(path: Path, content: bytes) -> None:
    """Write a file so that any reader, after any crash, finds the old content or the new one.

    Raises UserError where it cannot be written: no right, no space.
    """
    temporary = path.with_name(f".{path.name}.tmp")
    try:
        with temporary.open("wb") as file:
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


def read_bounded(path: Path, limit: int) -> bytes:
    """The content of a file of at most `limit` bytes. Raises UserError where there is none."""
    try:
        with path.open("rb") as file:
            content = file.read(limit + 1)
    except OSError as error:
        raise UserError(f"{path}: cannot be read ({error.strerror})") from None
    if len(content) > limit:
        raise UserError(f"{path}: larger than {limit} bytes, so not a file of neol's")
    return content


def _flush_folder(folder: Path) -> None:
    """Make a rename outlast a loss of power."""
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
