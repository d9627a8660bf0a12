"""Repetition of drawn runs: as many as are asked for, or as there is time for."""

import math
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from neol.study.verification import replays
from neol.study.verification.replay_log import ReplayLog
from neol.study.verification.replays import Coverage, Replay, Run


@dataclass
class Repetition:
    """Runs drawn to be repeated, and what their replays amount to so far.

    Runs in the log are not drawn, and those that agree to their end are added to it.
    """

    cells: Mapping[Run, str]
    """The cell of each run that may be drawn."""
    count: int
    """Largest number of runs to repeat."""
    seed: int
    generations: int | None = None
    """Number of first generations to repeat of each run; None for all."""
    deadline: float = math.inf
    """Time of `time.monotonic` at which it ends."""
    log: ReplayLog | None = None

    drawn: list[Run] = field(init=False)
    before: int = field(init=False)
    """Number of runs that the log had before."""
    repeated: int = field(init=False, default=0)
    """Number of repeated runs, also in part."""
    generations_done: int = field(init=False, default=0)

    def __post_init__(self) -> None:
        self._whole = self.log.among(self.cells) if self.log else set()
        self.before = len(self._whole)
        order = replays.draw(self.cells, self.seed)
        self.drawn = [run for run in order if run not in self._whole][: self.count]

    def runs(self) -> Iterator[Run]:
        """Yield the drawn runs until the deadline."""
        for run in self.drawn:
            if time.monotonic() >= self.deadline:
                return
            yield run

    def repeat(self, run: Run) -> Replay:
        """Repeat a run and count it."""
        replay = replays.attempt(replays.replay, run, self.generations, self.deadline)
        self.repeated += replay.played
        self.generations_done += replay.generations
        if replay.whole:
            self._whole.add(run)
            if self.log and not replay.problem:
                self.log.add(run)
        return replay

    def coverage(self) -> Coverage:
        """Return the coverage by runs that were repeated to their end, now or before."""
        return replays.coverage(self.cells, self._whole)


def repeat_champion(run: Run) -> Replay:
    """Repeat the held-out episodes of a run's champion."""
    return replays.attempt(replays.replay_champion, run)
