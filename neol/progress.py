"""The progress of a run, for people: one live line on a terminal, now and then a plain one else."""

import time
from collections.abc import Sequence
from types import TracebackType
from typing import Self

from rich.console import Console
from rich.live import Live

from neol.evolution import Generation

PLAIN_SECONDS = 5.0
"""Plain lines come no oftener; the last one always comes."""


class Progress:
    """Shows each generation that it is called with, on standard error. A context manager."""

    def __init__(self, seeds: Sequence[int], generations: int) -> None:
        self._seeds = seeds
        self._generations = generations
        self._console = Console(stderr=True, highlight=False)
        self._live = Live(console=self._console, transient=True)
        self._line = ""
        self._waiting = False
        self._printed = -float("inf")
        # Speed is measured from the first generation on: that one also pays for start-up.
        self._begin = 0.0
        self._calls = 0
        self._steps = 0
        self._last = (-1, 0)

    def __call__(self, seed: int, generation: Generation) -> None:
        now = time.monotonic()
        before = self._last[1] if self._last[0] == seed else 0
        self._last = seed, generation.env_steps
        self._calls += 1
        if self._calls == 1:
            self._begin = now
        else:
            self._steps += generation.env_steps - before
        self._line = self._describe(seed, generation, now - self._begin)
        if self._console.is_terminal:
            self._live.update(self._line)
        elif now - self._printed >= PLAIN_SECONDS:
            self._print()
            self._printed = now
        else:
            self._waiting = True

    def __enter__(self) -> Self:
        if self._console.is_terminal:
            self._live.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self._live.stop()
        if self._waiting:
            self._print()

    def _print(self) -> None:
        self._console.print(self._line, markup=False, soft_wrap=True)
        self._waiting = False

    def _describe(self, seed: int, generation: Generation, seconds: float) -> str:
        place = self._seeds.index(seed)
        of = f" ({place + 1} of {len(self._seeds)})" if len(self._seeds) > 1 else ""
        parts = [
            f"seed {seed}{of}",
            f"generation {generation.generation}/{self._generations}",
            f"best {generation.best_fitness:.1f}",
            f"mean {generation.mean_fitness:.1f}",
            f"species {generation.species}",
        ]
        if self._calls > 1 and seconds > 0.0:
            ahead = len(self._seeds) - place
            left = ahead * self._generations - generation.generation
            parts.append(f"{self._steps / seconds:,.0f} steps/s")
            parts.append(f"{_duration(left * seconds / (self._calls - 1))} left")
        return "  ".join(parts)


def _duration(seconds: float) -> str:
    minutes, second = divmod(round(seconds), 60)
    hours, minute = divmod(minutes, 60)
    return f"{hours}:{minute:02}:{second:02}" if hours else f"{minute}:{second:02}"
