"""How a command ends: one line for a user's error, silence where nobody reads on."""

import contextlib
import os
import sys
from collections.abc import Iterator

from neol.base.errors import UserError

USER_ERROR, BROKEN_PIPE = 2, 141
"""Exit codes."""


def complain(line: str) -> None:
    """Say on the console what is wrong, in one line."""
    print(f"neol: {line}", file=sys.stderr)


def discard_output() -> None:
    """Let nothing that is left at exit be written: that would fail again."""
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
