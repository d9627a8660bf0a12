"""The boundary to Gymnasium's environments: everything that they return is checked here.

Values that pass have the types and the shape that the environment declares. They may be NaN or
infinite, which fails a network's evaluation, not the run. They may also leave the declared bounds,
as those of BipedalWalker do now and then.
"""

import importlib
import math
import os
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
"""NumPy's kinds of dtypes: bool and integers, and these with real numbers."""


def make_environment(task: Task, render_mode: str | None = None) -> gymnasium.Env[Any, Any]:
    """Make a Gymnasium environment of a task, limited to the task's steps.

    Raises UserError if the id is unknown, the constructor raises, or the spaces do not fit a
    network.
    """
    if uses_mujoco(task):
        import_mujoco()
    rendered = {} if render_mode is None else {"render_mode": render_mode}
    with warnings.catch_warnings():
        # Libraries below the environment warn; as errors (PYTHONWARNINGS=error) that would end it.
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


def uses_mujoco(task: Task) -> bool:
    """Whether MuJoCo simulates a task, by Gymnasium's registry."""
    registered = gymnasium.registry.get(task.environment)
    return registered is not None and "mujoco" in str(registered.entry_point)


def import_mujoco() -> None:
    """Import MuJoCo, if need be without the library in MUJOCO_GL, since a run draws nothing."""
    try:
        importlib.import_module("mujoco")
    except Exception:
        if (chosen := os.environ.get("MUJOCO_GL")) is None:
            raise
        os.environ["MUJOCO_GL"] = "disable"
        try:
            importlib.import_module("mujoco")
        finally:
            os.environ["MUJOCO_GL"] = chosen


def network_size(task: Task) -> tuple[int, int]:
    """Return the numbers of inputs and outputs of a task's networks."""
    environment = Environment(task)
    environment.close()
    action = environment.action_space
    outputs = action.n if isinstance(action, gymnasium.spaces.Discrete) else action.shape[0]
    return environment.observation_space.shape[0], int(outputs)


class Environment:
    """A task's environment with a check of everything that it returns.

    Values that contradict Gymnasium's interface or the declared spaces, and exceptions of the
    environment, become a UserError that names the environment, the episode and the step.
    """

    def __init__(self, task: Task, render_mode: str | None = None) -> None:
        self._task = task
        self._render_mode = render_mode
        self._gymnasium = make_environment(task, render_mode)
        space = self._gymnasium.observation_space
        assert isinstance(space, gymnasium.spaces.Box)
        self.observation_space = space
        self.action_space: Any = self._gymnasium.action_space
        """Space of actions, Discrete or Box."""
        self._shape = space.shape
        self._kinds = INTEGERS if space.dtype.kind in INTEGERS else NUMBERS
        self._seed, self._steps = 0, 0

    def reset(self, seed: int) -> npt.NDArray[np.generic]:
        """Begin the episode of a seed, in a new world if the task requires it.

        Returns the first observation, [I] real numbers.
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
        """Take a step; return observation ([I] real numbers), reward, and whether it was the last.

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
        """Render the environment in its render mode."""
        return self._gymnasium.render()

    @property
    def frames_per_second(self) -> float:
        """Declared frame rate of the environment; 30 if it declares none."""
        declared = self._gymnasium.metadata.get("render_fps", 30)
        if not (isinstance(declared, (int, float)) and 0 < declared < math.inf):
            raise UserError(
                f"{self._task.environment} declares render_fps = {reprlib.repr(declared)} in its "
                "metadata; it must be a number above 0"
            )
        return float(declared)

    def close(self) -> None:
        """Release its resources. A failure here is only a note, because all episodes are done."""
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
        if isinstance(reward, float):  # the common case, of Python or NumPy
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
    """Print a note once, not for each episode."""
    print(f"{NOTICE}{line}", file=sys.stderr)
