"""Gymnasium's environments, which are not ours: made, and checked in all that they return.

This is the one boundary. What passes it has the types and the shape that the environment declares;
only numbers that are not finite pass too, which fail a network's evaluation and not the run.
"""

import math
import reprlib
import sys
import warnings
from functools import cache
from typing import Any

import gymnasium
import numpy as np
import numpy.typing as npt

from neol.base.errors import FOREIGN, NOTICE, UserError, described
from neol.spec.constants import Task

INTEGERS, NUMBERS = "biu", "biuf"
"""NumPy's kinds of dtypes: bool and integers, and with them the real numbers."""


def make_environment(task: Task, render_mode: str | None = None) -> gymnasium.Env[Any, Any]:
    """A new Gymnasium environment of a task, limited to the task's steps.

    Raises UserError where the id is unknown, its constructor raises, or the spaces are not a
    network's.
    """
    rendered = {} if render_mode is None else {"render_mode": render_mode}
    with warnings.catch_warnings():
        # Of libraries below the environment: made errors (PYTHONWARNINGS=error) they would end it.
        warnings.simplefilter("ignore", DeprecationWarning)
        warnings.filterwarnings("ignore", message=".*render_modes.*")
        try:
            environment = gymnasium.make(
                task.environment,
                max_episode_steps=task.max_steps,
                disable_env_checker=True,
                **rendered,
            )
            observation, action = environment.observation_space, environment.action_space
        except gymnasium.error.Error as error:
            reason = " ".join(str(error).split())
            raise UserError(
                f"task {task.name}: no environment {task.environment}: {reason}"
            ) from None
        except FOREIGN as error:
            raise UserError(
                f"task {task.name}: {task.environment} cannot be made: {described(error)}"
            ) from error
    if not _is_flat(observation):
        raise UserError(
            f"task {task.name}: {task.environment} observes {observation}; "
            "a network needs a flat Box (one dimension) of one number at least"
        )
    if not (_is_flat(action) or isinstance(action, gymnasium.spaces.Discrete)):
        raise UserError(
            f"task {task.name}: {task.environment} acts by {action}; "
            "a network needs a Discrete or a flat Box action"
        )
    return environment


def network_size(task: Task) -> tuple[int, int]:
    """The numbers of inputs and outputs that a task's networks have."""
    environment = Environment(task)
    environment.close()
    action = environment.action_space
    outputs = action.n if isinstance(action, gymnasium.spaces.Discrete) else action.shape[0]
    return environment.observation_space.shape[0], int(outputs)


class Environment:
    """A task's environment whose every answer is checked.

    An answer that is not as Gymnasium's interface and the declared spaces have it, and whatever
    the environment raises, is a UserError that names the environment, the episode and its step.
    """

    def __init__(self, task: Task, render_mode: str | None = None) -> None:
        self._task = task
        self._render_mode = render_mode
        self._gymnasium = make_environment(task, render_mode)
        space = self._gymnasium.observation_space
        assert isinstance(space, gymnasium.spaces.Box)
        self.observation_space = space
        self.action_space: Any = self._gymnasium.action_space
        """Discrete or Box."""
        self._shape = space.shape
        self._kinds = INTEGERS if space.dtype.kind in INTEGERS else NUMBERS
        self._seed, self._steps = 0, 0

    def reset(self, seed: int) -> npt.NDArray[np.generic]:
        """Begin the episode of a seed, in a new world where the task asks for it.

        Returns its first observation, [I] real numbers.
        """
        if self._task.fresh_world:
            self.close()
            self._gymnasium = make_environment(self._task, self._render_mode)
        self._seed, self._steps = seed, 0
        try:
            returned: Any = self._gymnasium.reset(seed=seed)
        except FOREIGN as error:
            raise self._failure(f"raised {described(error)}") from error
        if not (isinstance(returned, tuple) and len(returned) == 2):
            raise self._wrong("from reset", returned, "an observation and a dictionary")
        observation, info = returned
        self._check_info(info)
        return self._checked(observation)

    def step(self, action: Any) -> tuple[npt.NDArray[np.generic], float, bool]:
        """Take a step: the next observation, [I] real numbers, the reward, whether it was the last.

        The numbers may be NaN or infinite.
        """
        self._steps += 1
        try:
            observation, reward, terminated, truncated, info = self._gymnasium.step(action)
        except FOREIGN as error:
            raise self._failure(f"raised {described(error)}") from error
        self._check_info(info)
        terminated = self._flag("terminated", terminated)
        truncated = self._flag("truncated", truncated)
        return self._checked(observation), self._number(reward), terminated or truncated

    def render(self) -> Any:
        """What the environment now looks like, in its render mode."""
        return self._gymnasium.render()

    @property
    def frames_per_second(self) -> float:
        """The speed at which it asks to be shown; 30 where it does not say."""
        declared = self._gymnasium.metadata.get("render_fps", 30)
        if not (isinstance(declared, (int, float)) and 0 < declared < math.inf):
            raise UserError(
                f"{self._task.environment} declares render_fps = {reprlib.repr(declared)} in its "
                "metadata; it must be a number above 0"
            )
        return float(declared)

    def close(self) -> None:
        """Release what it holds. An environment that fails in that has done its work: a notice."""
        try:
            self._gymnasium.close()
        except FOREIGN as error:
            _notice(f"{self._task.environment} raised {described(error)} as it was closed")

    def _checked(self, observation: Any) -> npt.NDArray[np.generic]:
        array = self._as_array("the observation", observation)
        if array.shape != self._shape or array.dtype.kind not in self._kinds:
            raise self._wrong("the observation", observation, self.observation_space)
        return array

    def _number(self, reward: Any) -> float:
        if isinstance(reward, float):  # of Python or NumPy, so most are
            return float(reward)
        array = self._as_array("the reward", reward)
        if array.shape or array.dtype.kind not in NUMBERS:
            raise self._wrong("the reward", reward, "a number")
        return float(array)

    def _flag(self, name: str, value: Any) -> bool:
        if isinstance(value, bool):
            return value
        array = self._as_array(f"{name} =", value)
        if array.shape or array.dtype.kind != "b":
            raise self._wrong(f"{name} =", value, "True or False")
        return bool(array)

    def _check_info(self, info: Any) -> None:
        if not isinstance(info, dict):
            raise self._wrong("the info", info, "a dictionary")

    def _as_array(self, name: str, value: Any) -> npt.NDArray[np.generic]:
        try:
            return np.asarray(value)
        except FOREIGN as error:  # such as a list of lists of several lengths
            raise self._failure(f"returned {name} {_shown(value)}: {described(error)}") from error

    def _wrong(self, name: str, value: Any, wanted: object) -> UserError:
        return self._failure(f"returned {name} {_shown(value)}, not {wanted}")

    def _failure(self, what: str) -> UserError:
        place = f"in step {self._steps}" if self._steps else "in reset"
        return UserError(
            f"{self._task.environment} {what} ({place} of the episode with seed {self._seed}); "
            "fix it, then continue with --resume"
        )


def _is_flat(space: object) -> bool:
    return isinstance(space, gymnasium.spaces.Box) and len(space.shape) == 1 and space.shape[0] > 0


def _shown(value: object) -> str:
    kind = type(value).__name__
    if isinstance(value, np.ndarray):
        kind += f" of {value.dtype}, shape {value.shape}"
    return f"{reprlib.repr(value)} ({kind})"


@cache
def _notice(line: str) -> None:
    """Say it once, not for each episode."""
    print(f"{NOTICE}{line}", file=sys.stderr)
