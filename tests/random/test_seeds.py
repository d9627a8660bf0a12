"""Streams of a run: equal to numpy's, disjoint, and the same for every method."""

import numpy as np

from neol.random.seeds import Stream, episode_seeds, generator, held_out_seeds


def test_seeds_are_numpys_spawned_sequences() -> None:
    seeds = episode_seeds(7, generation=3, population=4, episodes=2)
    assert seeds.shape == (4, 2)
    for genome in range(4):
        for episode in range(2):
            key = (Stream.EPISODE, 3, genome, episode)
            sequence = np.random.SeedSequence(7, spawn_key=key)
            assert seeds[genome, episode] == sequence.generate_state(1, np.uint64)[0]
    held_out = held_out_seeds(7, 5)
    sequence = np.random.SeedSequence(7, spawn_key=(Stream.HELD_OUT, 4))
    assert held_out[0, 4] == sequence.generate_state(1, np.uint64)[0]


def test_no_seed_comes_twice() -> None:
    training = [episode_seeds(seed, g, 50, 2) for seed in range(3) for g in range(1, 21)]
    held_out = [held_out_seeds(seed, 100) for seed in range(3)]
    words = np.concatenate([array.ravel() for array in training + held_out])
    assert len(np.unique(words)) == len(words)


def test_seeds_of_a_population_are_a_prefix_of_those_of_a_larger_one() -> None:
    assert (episode_seeds(1, 1, 5, 1) == episode_seeds(1, 1, 9, 3)[:5, :1]).all()


def test_generators_are_streams_of_their_own() -> None:
    draws = {
        generator(seed, stream, *key).random()
        for seed in (0, 1)
        for stream, key in ((Stream.INITIAL, ()), *((Stream.REPRODUCTION, (g,)) for g in (1, 2)))
    }
    assert len(draws) == 6
    assert generator(0, Stream.INITIAL).random() == generator(0, Stream.INITIAL).random()
