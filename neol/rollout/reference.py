"""The reference engine: Gymnasium's own environments in a plain loop. It defines the truth.

It runs any environment with a flat Box observation and a Discrete or Box action.
"""

import math
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import gymnasium
import numpy as np
import numpy.typing as npt

from neol.base.errors import UserError
from neol.base.interruption import stop_if_asked
from neol.network.forward import Networks, forward
from neol.network.plasticity import compiled, learn
from neol.network.rules import NO_RULE
from neol.rollout.engine import Rollouts, learning_of
from neol.spec.constants import Plasticity, Task


@dataclass(frozen=True, slots=True)
class Step:
    """One step of an episode, after learning. Its arrays go on changing: copy what is to stay."""

    values: npt.NDArray[np.float64]
    """float64[I + M]: the observation that was acted on, then the activities of the other nodes."""
    action: Any
    """As the environment got it."""
    reward: float
    weight: npt.NDArray[np.float64]
    """float64[E]."""
    threshold: npt.NDArray[np.float64]
    """float64[M]."""


Observer = Callable[[Step], None]


def make_environment(task: Task, render_mode: str | None = None) -> gymnasium.Env[Any, Any]:
    """A new Gymnasium environment of a task, limited to the task's steps.

    Raises UserError where the id is unknown or the spaces are not a network's.
    """
    rendered = {} if render_mode is None else {"render_mode": render_mode}
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=".*out of date.*", category=DeprecationWarning)
        warnings.filterwarnings("ignore", message=".*render_modes.*")
        try:
            environment = gymnasium.make(
                task.environment,
                max_episode_steps=task.max_steps,
                disable_env_checker=True,
                **rendered,
            )
        except Exception as error:  # the environment is not ours, nor what it draws with
            reason = " ".join(str(error).split())[:200]
            raise UserError(
                f"task {task.name}: no environment {task.environment}: {reason}"
            ) from None
    observation, action = environment.observation_space, environment.action_space
    if not (isinstance(observation, gymnasium.spaces.Box) and len(observation.shape) == 1):
        raise UserError(
            f"task {task.name}: {task.environment} observes {observation}; "
            "a network needs a flat Box (one dimension)"
        )
    flat_box = isinstance(action, gymnasium.spaces.Box) and len(action.shape) == 1
    if not (flat_box or isinstance(action, gymnasium.spaces.Discrete)):
        raise UserError(
            f"task {task.name}: {task.environment} acts by {action}; "
            "a network needs a Discrete or a flat Box action"
        )
    return environment


def network_size(task: Task) -> tuple[int, int]:
    """The numbers of inputs and outputs that a task's networks have."""
    environment = make_environment(task)
    observation, action = environment.observation_space, environment.action_space
    environment.close()
    assert observation.shape is not None
    if isinstance(action, gymnasium.spaces.Discrete):
        return observation.shape[0], int(action.n)
    assert action.shape is not None
    return observation.shape[0], action.shape[0]


class ReferenceEngine:
    """Steps Gymnasium's own environment; an episode is a function of seed and network alone."""

    name = "reference"

    def __init__(self, task: Task, render_mode: str | None = None) -> None:
        self._task = task
        self._render_mode = render_mode
        self._environment = make_environment(task, render_mode)

    def evaluate(
        self, networks: Networks, seeds: npt.NDArray[np.uint64], plasticity: Plasticity
    ) -> Rollouts:
        population, episodes = seeds.shape
        rollouts = Rollouts.begin(networks, seeds)
        for genome in range(population):
            edges = slice(*networks.edge_bounds[genome : genome + 2])
            nodes = slice(*networks.node_offset[genome : genome + 2])
            for episode in range(episodes):
                stop_if_asked()
                if not plasticity.write_back:
                    rollouts.weight[edges] = networks.weight[edges]
                rollouts.threshold[nodes] = 0.0
                total, steps = self._episode(
                    networks,
                    genome,
                    int(seeds[genome, episode]),
                    plasticity,
                    rollouts.weight,
                    rollouts.threshold,
                )
                rollouts.returns[genome, episode] = total
                rollouts.steps[genome, episode] = steps
                if math.isnan(total):
                    rollouts.failed[genome] = True
                    break
        return rollouts

    def watch(
        self,
        network: Networks,
        seed: int,
        plasticity: Plasticity,
        observe: Observer,
        plastic_steps: int | None = None,
    ) -> float:
        """One episode of a single network, step by step: its return, NaN if it failed.

        The same episode as in `evaluate`, unless the network learns in its first steps only.
        """
        total, _ = self._episode(
            network,
            0,
            seed,
            plasticity,
            network.weight.copy(),
            np.zeros_like(network.bias),
            observe,
            plastic_steps,
        )
        return total

    def render(self) -> Any:
        """What the environment now looks like, in the engine's render mode."""
        return self._environment.render()

    @property
    def steps_per_second(self) -> float:
        """The environment's own speed, for films."""
        return float(self._environment.metadata.get("render_fps", 30))

    def _episode(
        self,
        networks: Networks,
        genome: int,
        seed: int,
        plasticity: Plasticity,
        weight: npt.NDArray[np.float64],
        threshold: npt.NDArray[np.float64],
        observe: Observer | None = None,
        plastic_steps: int | None = None,
    ) -> tuple[float, int]:
        """One episode (Algorithm 2, lines 3-14): its return, NaN if it failed, and its steps.

        Learns in place, in the first `plastic_steps` steps or in all.
        """
        first, last = networks.node_offset[genome : genome + 2]
        values = np.empty(networks.inputs + last - first)
        networks = networks._replace(weight=weight)
        learning = learning_of(plasticity, threshold)
        if self._task.fresh_world:
            self._environment.close()
            self._environment = make_environment(self._task, self._render_mode)
        try:
            observation, _ = self._environment.reset(seed=seed)
        except Exception as error:
            raise self._failure(error, f"reset with seed {seed}") from error
        total, steps, done = 0.0, 0, False
        while not done:
            if steps == plastic_steps:
                learning = learning._replace(rule=compiled(NO_RULE))
            if not np.isfinite(observation).all():
                return math.nan, steps
            values[: networks.inputs] = observation
            forward(networks, genome, values)
            action = self._action(values[-networks.outputs :])
            steps += 1
            try:
                observation, reward, terminated, truncated, _ = self._environment.step(action)
                reward = float(reward)
            except Exception as error:
                place = f"in step {steps} of the episode with seed {seed}"
                raise self._failure(error, place) from error
            total += reward
            done = terminated or truncated
            finite = learn(networks, genome, learning, reward, values)
            if observe is not None:
                observe(Step(values, action, reward, weight, threshold))
            if not (math.isfinite(total) and finite):
                return math.nan, steps
        return total, steps

    def _failure(self, error: Exception, place: str) -> UserError:
        """What to say where the environment, which is not ours, raises."""
        what = f"{type(error).__name__}: {' '.join(str(error).split())[:200]}"
        return UserError(
            f"{self._task.environment} raised {what} ({place}); mend it, then go on with --resume"
        )

    def _action(self, outputs: npt.NDArray[np.float64]) -> Any:
        """Argmax of discrete actions, else outputs clipped to the action's bounds (Section 4.1)."""
        space = self._environment.action_space
        if isinstance(space, gymnasium.spaces.Discrete):
            return int(space.start) + int(np.argmax(outputs))
        assert isinstance(space, gymnasium.spaces.Box)
        return np.clip(outputs, space.low, space.high).astype(space.dtype)

    def close(self) -> None:
        self._environment.close()
