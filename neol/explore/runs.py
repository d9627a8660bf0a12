"""What is played of the records: each is read once, and each champion loaded once."""

from functools import lru_cache
from pathlib import Path

from neol.champions.player import Player, load_champion
from neol.errors import UserError
from neol.record import Record
from neol.records import read_record


@lru_cache(maxsize=64)
def load_record(path: Path) -> Record:
    """A record, read and verified; the latest stay in memory. Raises UserError."""
    return read_record(path)


@lru_cache(maxsize=16)
def load_player(path: Path, seed: int) -> Player:
    """The champion of a run, loaded once. Raises UserError."""
    return load_champion(path, seed)


def episode_seed(player: Player, episode: int) -> int:
    """The seed of a held-out episode of a player's record. Raises UserError beyond the last one."""
    seeds = player.held_out_seeds
    if not 0 <= episode < len(seeds):
        raise UserError(f"episode {episode}: the record has 0 to {len(seeds) - 1}")
    return seeds[episode]
