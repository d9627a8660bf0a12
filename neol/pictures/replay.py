"""Replay of a champion's held-out episodes, compared with its record."""

import contextlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from neol.base.files import write_atomically
from neol.champions.player import Player
from neol.pictures.film import film
from neol.rollout.reference import ReferenceEngine


@dataclass(frozen=True, slots=True)
class Replayed:
    """A held-out episode with its recorded and its replayed return; NaN where it failed."""

    episode: int
    """Number of the episode, from 0."""
    steps: int
    recorded: float
    replayed: float

    @property
    def agrees(self) -> bool:
        """Whether both returns are equal, bit for bit."""
        return repr(self.recorded) == repr(self.replayed)  # NaN is NaN


def play_again(
    player: Player, episodes: range, *, gif: Path | None = None, human: bool = False
) -> Iterator[Replayed]:
    """Play some held-out episodes, in a window if `human`, and film the first one into `gif`.

    Raises UserError if the film cannot be made or written.
    """
    render_mode = "human" if human else None
    with contextlib.closing(ReferenceEngine(player.spec.task, render_mode)) as engine:
        for episode in episodes:
            seed = player.held_out_seeds[episode]
            if gif and episode == episodes[0]:
                filmed = film(player, seed)
                write_atomically(gif, filmed.gif)
                trace = filmed.trace
            else:
                trace = player.play(seed, engine=engine)
            recorded = player.recorded_returns[episode]
            yield Replayed(episode, len(trace), recorded, trace.episode_return)
