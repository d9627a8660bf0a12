"""Endings of a command: one line for a user's error, silence for a broken pipe."""

import contextlib
import os
import sys
from collections.abc import Iterator

from neol.base.errors import UserError

USER_ERROR, BROKEN_PIPE = 2, 141
"""Exit codes."""


def complain(line: str) -> None:
    """Print one line on standard error that says what is wrong."""
    print(f"neol: {line}", file=sys.stderr)


def discard_output() -> None:
    """Discard buffered output, because writing it at exit would fail again."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)


@contextlib.contextmanager
def exit_codes() -> Iterator[None]:
    """Turn a user's error into one line and exit code 2, a broken pipe into a quiet 141."""
    try:
        yield
        sys.stdout.flush()
    except UserError as error:
        complain(str(error))
        sys.exit(USER_ERROR)
    except BrokenPipeError:
        discard_output()
        sys.exit(BROKEN_PIPE)
