import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from neol.random.seed_sequence import spawned_words


def numpy_word(seed: int, key: list[int]) -> int:
    return int(np.random.SeedSequence(seed, spawn_key=key).generate_state(1, np.uint64)[0])


@settings(deadline=None)  # the first call compiles
@given(
    st.one_of(st.sampled_from([0, 2**32 - 1, 2**32, 2**64 - 1, 2**64]), st.integers(0, 2**200)),
    st.integers(1, 6).flatmap(
        lambda k: st.lists(st.lists(st.integers(0, 2**32 - 1), min_size=k, max_size=k), min_size=1)
    ),
)
def test_words_are_numpys(seed: int, keys: list[list[int]]) -> None:
    words = spawned_words(seed, np.array(keys, dtype=np.uint32))
    assert words.tolist() == [numpy_word(seed, key) for key in keys]


def test_a_population_has_seeds_of_its_own() -> None:
    keys = np.array([(2, 7, genome, episode) for genome in range(300) for episode in range(3)])
    words = spawned_words(5, keys.astype(np.uint32))
    assert words.tolist() == [numpy_word(5, key) for key in keys.tolist()]
    assert len(set(words.tolist())) == len(words)
