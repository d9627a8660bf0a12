"""From a run's seed to every random stream.

Each stream is a `numpy.random.SeedSequence` with a spawn key of its own, so any episode of any
run can be replayed alone, and no stream depends on how much another was used.
"""

from enum import IntEnum

import numpy as np
import numpy.typing as npt


class Stream(IntEnum):
    """What a random stream is for: the first entry of its spawn key."""

    INITIAL = 0
    REPRODUCTION = 1
    EPISODE = 2
    HELD_OUT = 3


def generator(seed: int, stream: Stream, *key: int) -> np.random.Generator:
    """The random generator of one stream, for instance of one generation's reproduction."""
    return np.random.Generator(np.random.PCG64(_sequence(seed, stream, *key)))


def episode_seeds(
    seed: int, generation: int, population: int, episodes: int
) -> npt.NDArray[np.uint64]:
    """Environment seeds of a generation: uint64[population, episodes].

    They depend on the run's seed, the generation, the genome's place in the population and the
    episode, not on the method: all methods meet the same episodes.
    """
    return np.array(
        [
            [
                _word(seed, Stream.EPISODE, generation, genome, episode)
                for episode in range(episodes)
            ]
            for genome in range(population)
        ],
        dtype=np.uint64,
    )


def held_out_seeds(seed: int, episodes: int) -> npt.NDArray[np.uint64]:
    """Environment seeds of the champion's held-out episodes: uint64[1, episodes].

    Disjoint from training: another stream of the same seed.
    """
    words = [_word(seed, Stream.HELD_OUT, episode) for episode in range(episodes)]
    return np.array([words], dtype=np.uint64)


def _sequence(seed: int, stream: Stream, *key: int) -> np.random.SeedSequence:
    return np.random.SeedSequence(seed, spawn_key=(int(stream), *key))


def _word(seed: int, stream: Stream, *key: int) -> np.uint64:
    word: np.uint64 = _sequence(seed, stream, *key).generate_state(1, np.uint64)[0]
    return word
