"""The reference engine: Gymnasium's environments in a plain loop, which defines correct results.

It runs any environment with a flat Box observation and a Discrete or Box action.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import gymnasium
import numpy as np
import numpy.typing as npt

from neol.base.interruption import stop_if_asked
from neol.network.forward import Networks, forward
from neol.network.plasticity import compiled, learn
from neol.network.rules import NO_RULE
from neol.rollout.engine import Rollouts, learning_of
from neol.rollout.environment import Environment
from neol.spec.constants import Plasticity, Task


@dataclass(frozen=True, slots=True)
class Step:
    """One step of an episode, after learning. Its arrays are reused: copy what you keep."""

    values: npt.NDArray[np.float64]
    """float64[I + M]: the observation before the action, then the activities of other nodes."""
    action: Any
    """Action as passed to the environment."""
    reward: float
    weight: npt.NDArray[np.float64]
    """float64[E]."""
    threshold: npt.NDArray[np.float64]
    """float64[M]."""


Observer = Callable[[Step], None]


class ReferenceEngine:
    """Engine that steps Gymnasium's environment; an episode depends on seed and network alone."""

    name = "reference"

    def __init__(self, task: Task, render_mode: str | None = None) -> None:
        self._environment = Environment(task, render_mode)

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
        """Play one episode of a single network, step by step; return its return, NaN if it failed.

        It equals the episode in `evaluate`, unless the network learns in its first steps only.
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
        """Render the environment in the engine's render mode."""
        return self._environment.render()

    @property
    def steps_per_second(self) -> float:
        """Speed of the environment, for films."""
        return self._environment.frames_per_second

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
        """Play one episode (Algorithm 2, lines 3-14); give its return, NaN if it failed, and steps.

        The network learns in place, in the first `plastic_steps` steps or in all.
        """
        first, last = networks.node_offset[genome : genome + 2]
        values = np.empty(networks.inputs + last - first)
        networks = networks._replace(weight=weight)
        learning = learning_of(plasticity, threshold)
        observation = self._environment.reset(seed)
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
            observation, reward, done = self._environment.step(action)
            total += reward
            finite = learn(networks, genome, learning, reward, values)
            if observe is not None:
                observe(Step(values, action, reward, weight, threshold))
            if not (math.isfinite(total) and finite):
                return math.nan, steps
        return total, steps

    def _action(self, outputs: npt.NDArray[np.float64]) -> Any:
        """Return the largest output's index, or outputs clipped to the bounds (Section 4.1)."""
        space = self._environment.action_space
        if isinstance(space, gymnasium.spaces.Discrete):
            return int(space.start) + int(np.argmax(outputs))
        return np.clip(outputs, space.low, space.high).astype(space.dtype)

    def close(self) -> None:
        self._environment.close()
