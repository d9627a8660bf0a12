"""Step by step, an environment in compiled code against Gymnasium's own."""

from collections.abc import Callable
from typing import Any

import gymnasium
import numpy as np
import numpy.typing as npt

from neol.random.pcg64 import seed_pcg64
from neol.rollout.episodes import World

Array = npt.NDArray[np.float64]


def compare_episode(
    world: World,
    environment: gymnasium.Env[Any, Any],
    seed: int,
    policy: Callable[[Array], Array],
) -> int:
    """Play one episode on both sides, asserting equal bits at every step: its length."""
    space = environment.action_space
    assert environment.observation_space.shape is not None
    observation = np.empty(environment.observation_space.shape)
    random = np.empty(4, dtype=np.uint64)
    seed_pcg64(np.uint64(seed), random)
    world.reset(random, observation)
    expected, _ = environment.reset(seed=seed)
    assert observation.tolist() == expected.tolist()
    steps, done = 0, False
    while not done:
        outputs = policy(observation)
        discrete = isinstance(space, gymnasium.spaces.Discrete)
        action = int(np.argmax(outputs)) if discrete else outputs.astype(space.dtype)
        reward, terminated = world.step(outputs, observation)
        expected, expected_reward, end, limit, _ = environment.step(action)
        assert observation.tolist() == expected.tolist()
        assert (reward, terminated) == (float(expected_reward), end)
        steps += 1
        done = end or limit
    return steps
