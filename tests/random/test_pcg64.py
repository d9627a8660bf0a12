import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from neol.random.pcg64 import below, new_state, next_double, seed_pcg64, standard_normals, uniform

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


@pytest.mark.parametrize("size", [0, 1, 2, 7, 1000])
def test_normals_are_those_of_the_polar_method(size: int) -> None:
    """Compare with a plain twin on numpy's stream; both use equally many numbers."""
    state = np.empty(4, dtype=np.uint64)
    seed_pcg64(np.uint64(3), state)
    numpy_random = np.random.default_rng(3)
    expected: list[float] = []
    while len(expected) < size:
        x, y = (2.0 * numpy_random.random(2) - 1.0).tolist()
        square = x * x + y * y
        if 0.0 < square < 1.0:
            scale = math.sqrt(-2.0 * math.log(square) / square)
            expected += [scale * x, scale * y]
    assert standard_normals(size, state).tolist() == expected[:size]
    assert next_double(state) == numpy_random.random()


def test_normals_are_normal() -> None:
    """Kolmogorov-Smirnov distance to the normal distribution, and no serial correlation."""
    normals = standard_normals(100_000, new_state(np.random.default_rng(1)))
    below_each = np.array([0.5 * math.erfc(-x / math.sqrt(2.0)) for x in np.sort(normals)])
    distance = np.abs(below_each - (np.arange(len(normals)) + 0.5) / len(normals)).max()
    assert distance < 1.95 / math.sqrt(len(normals))  # p = 0.001
    assert abs(np.corrcoef(normals[:-1], normals[1:])[0, 1]) < 0.0125


def test_whole_numbers_are_even() -> None:
    state = new_state(np.random.default_rng(2))
    counts = np.bincount([below(6, state) for _ in range(12_000)])
    assert len(counts) == 6
    assert ((counts - 2000) ** 2 / 2000).sum() < 20.5  # chi-squared, p = 0.001
