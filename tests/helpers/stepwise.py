"""Comparison of a compiled environment with Gymnasium's, step by step."""

from collections.abc import Callable
from typing import Any

import gymnasium
import numpy as np
import numpy.typing as npt

from neol.random.pcg64 import seed_pcg64
from neol.rollout.episodes import World

Array = npt.NDArray[np.float64]


class Slot:
    """One slot of a world, called from Python."""

    def __init__(self, world: World, inputs: int, number: int = 0) -> None:
        self._world = world
        self._number = number
        self._playing = np.array([number])
        self._rows = np.full((number + 1, inputs), np.nan)
        self._reward = np.empty(number + 1)
        self._ended = np.empty(number + 1, dtype=np.bool_)
        self.observation: Array = self._rows[number]

    def reset(self, seed: int) -> None:
        """Begin the episode of a seed."""
        random = np.empty(4, dtype=np.uint64)
        seed_pcg64(np.uint64(seed), random)
        self._world.reset(self._number, random, self._rows)

    def step(self, outputs: Array) -> tuple[float, bool]:
        """Take a step by a network's outputs; return the reward and whether the episode ended."""
        rows = np.tile(outputs, (self._number + 1, 1))
        self._world.step(self._playing, rows, self._rows, self._reward, self._ended)
        return self._reward[self._number].item(), self._ended[self._number].item()


def compare_episode(
    slot: Slot,
    environment: gymnasium.Env[Any, Any],
    seed: int,
    policy: Callable[[Array], Array],
) -> int:
    """Play one episode on both sides, assert equal bits at every step; return its length."""
    space = environment.action_space
    slot.reset(seed)
    expected, _ = environment.reset(seed=seed)
    assert slot.observation.tolist() == expected.tolist()
    steps, done = 0, False
    while not done:
        outputs = policy(slot.observation)
        discrete = isinstance(space, gymnasium.spaces.Discrete)
        action = int(np.argmax(outputs)) if discrete else outputs.astype(space.dtype)
        reward, terminated = slot.step(outputs)
        expected, expected_reward, end, limit, _ = environment.step(action)
        assert slot.observation.tolist() == expected.tolist()
        assert (reward, terminated) == (float(expected_reward), end)
        steps += 1
        done = end or limit
    return steps
