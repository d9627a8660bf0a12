"""Progress of a command: a live picture on a terminal, otherwise a line every few seconds."""

import time
from collections.abc import Sequence
from types import TracebackType
from typing import Self

from rich.console import Console, RenderableType
from rich.live import Live
from rich.text import Text

from neol.run.evolution import Generation

PLAIN_SECONDS = 5.0
"""Shortest time between two plain lines; the last line is always printed."""
START_UP = 2
"""Generations whose time does not count: the first compiles episodes, the second breeding."""


class Display:
    """Context manager that shows the state of a task, each time in place of the last.

    Without a console it writes to standard error.
    """

    def __init__(self, console: Console | None = None) -> None:
        self._console = console or Console(stderr=True, highlight=False)
        self._live = Live(console=self._console, transient=True)
        self._line = ""
        self._shown = ""
        self._printed = -float("inf")

    def show(self, line: str, picture: RenderableType | None = None) -> None:
        """Show the state as a line; a terminal shows the picture instead, if there is one."""
        self._line = line
        if self._console.is_terminal:
            self._live.update(Text(line) if picture is None else picture)
        elif time.monotonic() - self._printed >= PLAIN_SECONDS:
            self._print()

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
        if self._console.is_terminal:
            self._live.stop()
        else:
            self._print()

    def _print(self) -> None:
        if self._line != self._shown:
            self._console.print(self._line, markup=False, soft_wrap=True)
            self._shown, self._printed = self._line, time.monotonic()


class Progress(Display):
    """Display of a block's runs; it is called with each generation."""

    def __init__(self, seeds: Sequence[int], generations: int) -> None:
        super().__init__()
        self._seeds = seeds
        self._generations = generations
        self._begin = 0.0
        self._calls = 0
        self._steps = 0
        self._last = (-1, 0)

    def __call__(self, seed: int, generation: Generation) -> None:
        now = time.monotonic()
        before = self._last[1] if self._last[0] == seed else 0
        self._last = seed, generation.env_steps
        self._calls += 1
        if self._calls <= START_UP:
            self._begin = now
        else:
            self._steps += generation.env_steps - before
        self.show(self._describe(seed, generation, now - self._begin))

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
        if self._calls > START_UP and seconds > 0.0:
            ahead = len(self._seeds) - place
            left = ahead * self._generations - generation.generation
            parts.append(f"{self._steps / seconds:,.0f} steps/s")
            parts.append(f"{duration(left * seconds / (self._calls - START_UP))} left")
        return "  ".join(parts)


def duration(seconds: float) -> str:
    """Format a duration as 1:02:03, or 2:03 below an hour."""
    minutes, second = divmod(round(seconds), 60)
    hours, minute = divmod(minutes, 60)
    return f"{hours}:{minute:02}:{second:02}" if hours else f"{minute}:{second:02}"
