"""Commands in children forked from this process, which have imported and compiled all they need.

So most of their life is work.
"""

import os
import shlex
import shutil
import signal
import sys
import traceback
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NoReturn

from neol.cli import app
from neol.run.record_file import read_record
from tests.helpers.command import neol
from tests.helpers.runs import names, result

BLOCK = (
    "run --task cartpole --method oja --population 8 --learning-rate 0.25 --budget smoke --quiet "
    "--resume --output run.parquet "
)
EVERY = 2
SHORT = BLOCK + f"--generations 5 --seed 0-1 --checkpoint-every {EVERY}"

Prepare = Callable[[], None]


@dataclass
class Child:
    """A command in a process of its own."""

    command: str
    prepare: Prepare = lambda: None
    pid: int = field(init=False)
    said: int = field(init=False)
    """The pipe with its standard error."""

    def __post_init__(self) -> None:
        self.said, write = os.pipe()
        self.pid = os.fork()
        if self.pid == 0:
            self._live(write)
        os.close(write)

    def _live(self, write: int) -> NoReturn:
        status = 99
        try:
            os.dup2(write, 2)
            sys.stderr = os.fdopen(2, "w", buffering=1)
            self.prepare()
            app(shlex.split(self.command))
        except SystemExit as end:
            status = int(end.code or 0)
        except BaseException:
            traceback.print_exc()
        finally:
            os._exit(status)

    def end(self) -> tuple[int, list[str]]:
        """Wait for the end; return the status (as subprocess does) and lines of standard error."""
        with os.fdopen(self.said) as said:
            lines = said.read().splitlines()
        _, status = os.waitpid(self.pid, 0)
        return os.waitstatus_to_exitcode(status), lines


def ended(command: str, prepare: Prepare = lambda: None) -> tuple[int, list[str]]:
    return Child(command, prepare).end()


def undisturbed(command: str) -> object:
    """Return the result of the undisturbed command; running it here compiles its kernels."""
    Path("whole").mkdir()
    assert neol(command.replace("run.parquet", "whole/run.parquet")).exit_code == 0
    made = result(read_record(Path("whole/run.parquet")))
    shutil.rmtree("whole")
    return made


def assert_finishes(command: str, expected: object) -> None:
    """Check that the same command continues to the same record and leaves no other file."""
    assert ended(command) == (0, [])
    assert names(Path()) == ["run.parquet"]
    assert result(read_record(Path("run.parquet"))) == expected


def die_before_file_operation(number: int) -> Prepare:
    """Kill the process before it opens, makes, renames or removes a file here for the nth time."""
    here, left = str(Path.cwd()), number

    def watch(event: str, arguments: tuple[Any, ...]) -> None:
        nonlocal left
        changes = event in {"open", "os.mkdir", "os.rename", "os.remove", "os.rmdir"}
        if changes and str(arguments[0]).startswith(("run.parquet", "lock", here)):
            left -= 1
            if left == 0:
                os.kill(os.getpid(), signal.SIGKILL)

    return lambda: sys.addaudithook(watch)
