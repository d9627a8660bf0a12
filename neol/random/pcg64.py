"""The random stream of numpy's Generator(PCG64(SeedSequence(s))), in compiled code.

Gymnasium's env.reset(seed=s) uses it, and so does NEAT's variation. It is a 128-bit linear
congruential generator with O'Neill's XSL-RR output. Its state here is uint64[4]: state high,
state low, increment high, increment low.
"""

import math

import numpy as np
import numpy.typing as npt

from neol.base.kernel import kernel
from neol.random.seed_sequence import POOL_SIZE, generate_state, mix_entropy

State = npt.NDArray[np.uint64]

MULTIPLIER_HIGH, MULTIPLIER_LOW = np.uint64(2549297995355413924), np.uint64(4865540595714422341)
ONE, TOP, MASK = np.uint64(1), np.uint64(63), np.uint64(63)
HALF, LOW_HALF = np.uint64(32), np.uint64(0xFFFFFFFF)
UNUSED, ROTATION = np.uint64(11), np.uint64(58)


@kernel
def _high_product(a: np.uint64, b: np.uint64) -> np.uint64:
    """Return the high half of the 128-bit product of two 64-bit words."""
    a_high, a_low, b_high, b_low = a >> HALF, a & LOW_HALF, b >> HALF, b & LOW_HALF
    middle = a_high * b_low + ((a_low * b_low) >> HALF)
    carry = a_low * b_high + (middle & LOW_HALF)
    return a_high * b_high + (middle >> HALF) + (carry >> HALF)


@kernel
def _add(state: State, high: np.uint64, low: np.uint64) -> None:
    state[1] += low
    state[0] += high + np.uint64(state[1] < low)


@kernel
def _advance(state: State) -> None:
    high, low = state[0], state[1]
    state[0] = _high_product(low, MULTIPLIER_LOW) + high * MULTIPLIER_LOW + low * MULTIPLIER_HIGH
    state[1] = low * MULTIPLIER_LOW
    _add(state, state[2], state[3])


@kernel
def seed_pcg64(seed: np.uint64, state: State) -> None:
    """Set the state to that of PCG64(SeedSequence(seed))."""
    entropy = np.zeros(POOL_SIZE, dtype=np.uint32)
    entropy[0] = np.uint32(seed & LOW_HALF)
    entropy[1] = np.uint32(seed >> HALF)
    pool = np.empty(POOL_SIZE, dtype=np.uint32)
    words = np.empty(4, dtype=np.uint64)
    mix_entropy(entropy, pool)
    generate_state(pool, words)
    state[0] = state[1] = np.uint64(0)
    state[2] = (words[2] << ONE) | (words[3] >> TOP)
    state[3] = (words[3] << ONE) | ONE
    _advance(state)
    _add(state, words[0], words[1])
    _advance(state)


def new_state(random: np.random.Generator) -> State:
    """Return the state of a new stream, seeded by a number drawn from another stream."""
    state = np.empty(4, dtype=np.uint64)
    seed_pcg64(random.integers(2**64, dtype=np.uint64), state)
    return state


@kernel
def next_double(state: State) -> float:
    """Return the next number of Generator.random(), in [0, 1)."""
    _advance(state)
    rotation = state[0] >> ROTATION
    word = state[0] ^ state[1]
    word = (word >> rotation) | (word << ((-rotation) & MASK))
    return np.float64(word >> UNUSED) * (1.0 / 9007199254740992.0)


@kernel
def uniform(low: float, high: float, state: State) -> float:
    """Return the next number of Generator.uniform(low, high)."""
    return low + (high - low) * next_double(state)


@kernel
def below(limit: int, state: State) -> int:
    """Draw an integer from 0 to limit - 1 with 53 random bits; `limit` must be far below 2^53."""
    return int(limit * next_double(state))


@kernel
def standard_normals(size: int, state: State) -> npt.NDArray[np.float64]:
    """Draw independent standard normal numbers, float64[size], by Marsaglia's polar method.

    They differ from those of Generator.standard_normal().
    """
    points = np.empty(((size + 1) // 2, 2))
    square = np.empty(len(points))
    accepted = 0
    while accepted < len(points):
        x = 2.0 * next_double(state) - 1.0
        y = 2.0 * next_double(state) - 1.0
        points[accepted, 0], points[accepted, 1], square[accepted] = x, y, x * x + y * y
        # The next point overwrites one outside the circle, which is cheaper than a branch.
        accepted += 0.0 < square[accepted] < 1.0
    for i in range(len(points)):
        scale = math.sqrt(-2.0 * math.log(square[i]) / square[i])
        points[i, 0] *= scale
        points[i, 1] *= scale
    return points.reshape(-1)[:size]
