"""Random streams derived from a run's seed.

Each stream is a `numpy.random.SeedSequence` with its own spawn key, so any episode of any run can
be replayed alone, and no stream depends on how much another one was used.
"""

from enum import IntEnum

import numpy as np
import numpy.typing as npt

from neol.random.seed_sequence import spawned_words


class Stream(IntEnum):
    """Purpose of a random stream: the first entry of its spawn key."""

    INITIAL = 0
    REPRODUCTION = 1
    EPISODE = 2
    HELD_OUT = 3


def generator(seed: int, stream: Stream, *key: int) -> np.random.Generator:
    """Return the random generator of one stream, for instance of one generation's reproduction."""
    sequence = np.random.SeedSequence(seed, spawn_key=(int(stream), *key))
    return np.random.Generator(np.random.PCG64(sequence))


def episode_seeds(
    seed: int, generation: int, population: int, episodes: int
) -> npt.NDArray[np.uint64]:
    """Return the environment seeds of a generation: uint64[population, episodes].

    They depend only on the run's seed, the generation, the genome's place in the population and
    the episode, so all methods play the same episodes.
    """
    keys = np.empty((population, episodes, 4), dtype=np.uint32)
    keys[..., 0] = Stream.EPISODE
    keys[..., 1] = generation
    keys[..., 2] = np.arange(population)[:, np.newaxis]
    keys[..., 3] = np.arange(episodes)
    return spawned_words(seed, keys.reshape(-1, 4)).reshape(population, episodes)


def held_out_seeds(seed: int, episodes: int) -> npt.NDArray[np.uint64]:
    """Return the environment seeds of the champion's held-out episodes: uint64[1, episodes].

    They come from another stream of the run's seed than those of training.
    """
    keys = np.empty((episodes, 2), dtype=np.uint32)
    keys[:, 0] = Stream.HELD_OUT
    keys[:, 1] = np.arange(episodes)
    return spawned_words(seed, keys).reshape(1, episodes)
