"""Environments that misbehave in some episodes; a file controls one of them."""

import os
import signal
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np

from neol.rollout.engine import Engine
from neol.rollout.parallel import ProcessEngine
from neol.rollout.reference import ReferenceEngine
from neol.spec.constants import Task

TROUBLE = "NEOL_TEST_TROUBLE"
"""Names a file that holds `raise`, `shorten` or `die`."""


class Troubled(gymnasium.Env[Any, Any]):
    """Six steps of noise, and trouble in the third step of an episode in a hundred."""

    action_space = gymnasium.spaces.Discrete(2)
    observation_space = gymnasium.spaces.Box(-1.0, 1.0, (3,), np.float64)

    def reset(self, *, seed: int | None = None, options: Any = None) -> Any:
        super().reset(seed=seed)
        self.left = 6
        self.bad = self.np_random.random() > 0.99
        return self.np_random.uniform(-1.0, 1.0, 3), {}

    def step(self, action: Any) -> Any:
        self.left -= 1
        if self.bad and self.left == 3 and Path(os.environ[TROUBLE]).exists():
            match Path(os.environ[TROUBLE]).read_text():
                case "die":
                    os.kill(os.getpid(), signal.SIGKILL)
                case "shorten":
                    return np.zeros(2), 1.0, False, False, {}
                case _:
                    raise ZeroDivisionError("no\nluck")
        return self.np_random.uniform(-1.0, 1.0, 3), float(action), self.left == 0, False, {}


gymnasium.register("Troubled-v0", Troubled)
TASK = Task(name="troubled", environment="Troubled-v0", max_steps=10, fresh_world=True)


def reference_engine() -> Engine:
    """Make an engine in a worker, which imports this module and so registers the environment."""
    return ReferenceEngine(TASK)


def make_engine(_task: Task, _choice: str, workers: int) -> Engine:
    """Replacement for the function of neol.rollout."""
    if workers == 1:
        return reference_engine()
    return ProcessEngine(reference_engine, "reference", workers)


class Treacherous(gymnasium.Env[Any, Any]):
    """Environment that works for some seeds; for others a value becomes NaN at the third step."""

    action_space = gymnasium.spaces.Discrete(2)
    observation_space = gymnasium.spaces.Box(-1.0, 1.0, (3,), np.float64)

    def __init__(self, poison: str = "observation", share: float = 0.5) -> None:
        self.poison, self.share = poison, share

    def reset(self, *, seed: int | None = None, options: Any = None) -> Any:
        super().reset(seed=seed)
        self.left = 6
        self.bad = self.np_random.random() < self.share
        return self._observation(), {}

    def step(self, action: Any) -> Any:
        self.left -= 1
        observation, reward = self._observation(), float(action == 1)
        if self.bad and self.left == 3:
            if self.poison == "observation":
                observation[1] = np.nan
            else:
                reward = np.nan
        return observation, reward, self.left == 0, False, {}

    def _observation(self) -> Any:
        return self.np_random.uniform(-1.0, 1.0, 3)


class Image(Treacherous):
    observation_space = gymnasium.spaces.Box(0, 255, (8, 8, 3), np.uint8)


for name, kind, settings in (
    ("NaNObservation-v0", Treacherous, {"poison": "observation"}),
    ("NaNReward-v0", Treacherous, {"poison": "reward"}),
    ("NaNAlways-v0", Treacherous, {"share": 1.0}),
    ("Image-v0", Image, {}),
):
    gymnasium.register(name, kind, kwargs=settings, max_episode_steps=10)
