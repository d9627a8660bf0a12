"""Log of repeated runs that agreed, from which a long verification continues."""

import re
from collections.abc import Iterable
from functools import cache
from pathlib import Path

from neol.base.errors import UserError
from neol.base.files import read_bounded, sha256
from neol.study.verification.replays import Run

MAX_BYTES = 2**26
LINE = re.compile(rb"^([0-9a-f]{64}) (\d+)$", re.MULTILINE)


class ReplayLog:
    """File with one line for each run: SHA-256 of its record's file, and its seed.

    A changed record therefore counts as a new one. Changes of code are not noticed: remove the
    file after them.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._sha256 = cache(sha256)

    def among(self, runs: Iterable[Run]) -> set[Run]:
        """Return the runs that are in the log. Raises UserError if it cannot be read."""
        if not self._path.exists():
            return set()
        content = read_bounded(self._path, MAX_BYTES)
        there = {(digest.decode(), int(seed)) for digest, seed in LINE.findall(content)}
        return {(path, seed) for path, seed in runs if (self._sha256(path), seed) in there}

    def add(self, run: Run) -> None:
        """Append a run. Raises UserError if the log cannot be written."""
        path, seed = run
        try:
            with self._path.open("a", encoding="utf-8") as file:
                file.write(f"{self._sha256(path)} {seed}\n")
        except OSError as error:
            raise UserError(
                f"{self._path}: cannot be written ({error.strerror}); choose another --log"
            ) from None
