import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from neol.rollout.pcg64 import next_double, seed_pcg64, uniform

EDGES = [0, 1, 2**32 - 1, 2**32, 2**63, 2**64 - 1]


def assert_same_stream(seed: int) -> None:
    state = np.empty(4, dtype=np.uint64)
    seed_pcg64(np.uint64(seed), state)
    bit_generator = np.random.PCG64(np.random.SeedSequence(seed))
    assert numpy_state(bit_generator) == state.tolist()
    numpy_random = np.random.Generator(bit_generator)
    assert [next_double(state) for _ in range(5)] == numpy_random.random(5).tolist()
    expected = numpy_random.uniform(low=-0.05, high=0.05, size=4)
    assert [uniform(-0.05, 0.05, state) for _ in range(4)] == expected.tolist()
    assert numpy_state(bit_generator) == state.tolist()


def numpy_state(bit_generator: np.random.PCG64) -> list[int]:
    words = bit_generator.state["state"]
    return [half for name in ("state", "inc") for half in divmod(words[name], 2**64)]


def test_thousands_of_seeds_and_the_edges() -> None:
    seeds = np.random.default_rng(1).integers(2**64, size=3000, dtype=np.uint64)
    for seed in [*EDGES, *range(100), *seeds.tolist()]:
        assert_same_stream(seed)


@settings(deadline=None)  # the first call compiles
@given(st.integers(0, 2**64 - 1))
def test_any_seed(seed: int) -> None:
    assert_same_stream(seed)


def test_a_long_stream() -> None:
    state = np.empty(4, dtype=np.uint64)
    seed_pcg64(np.uint64(7), state)
    expected = np.random.Generator(np.random.PCG64(np.random.SeedSequence(7))).random(100_000)
    assert np.array_equal([next_double(state) for _ in range(len(expected))], expected)
