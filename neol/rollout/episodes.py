"""Algorithm 2 in compiled code: networks play episodes of a world and learn in them.

A world is a NamedTuple of numbers and arrays with kernels as methods (see `World`). The loop is
written once, here, and compiled into the `play` of each class of worlds with its `reset` and
`step` inlined; each of these has its cache beside its own class, and loads nothing of the others.
"""

import math
from typing import NamedTuple, Protocol

import numpy as np
import numpy.typing as npt
from numba import types
from numba.extending import overload_method, register_jitable

from neol.network.forward import forward
from neol.network.plasticity import learn
from neol.random.pcg64 import State, seed_pcg64

Floats = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int64]


class World(Protocol):
    """An environment in compiled code: a NamedTuple with these kernels as methods."""

    def reset(self, random: State, observation: Floats) -> None:
        """Begin an episode with draws from a random stream and write the first observation."""

    def step(self, outputs: Floats, observation: Floats) -> tuple[float, bool]:
        """Act by a network's outputs: reward, and whether the episode ended."""

    def play(self, batch: "Batch", begin: int, end: int) -> None:
        """Let networks begin to end of a batch play: play_batch(self, batch, begin, end)."""


@overload_method(types.BaseNamedTuple, "reset")
def _reset(self, random, observation):  # type: ignore[no-untyped-def]  # noqa: ARG001
    method = self.instance_class.reset
    return lambda self, random, observation: method(self, random, observation)


@overload_method(types.BaseNamedTuple, "step")
def _step(self, outputs, observation):  # type: ignore[no-untyped-def]  # noqa: ARG001
    method = self.instance_class.step
    return lambda self, outputs, observation: method(self, outputs, observation)


class Batch(NamedTuple):
    """What `play_batch` reads and then what it writes; comments name where a field is explained."""

    # neol.network.forward.Networks
    inputs: int
    outputs: int
    activation: int
    sum_limit: float
    node_offset: Integers
    bias: Floats
    edge_offset: Integers
    source: Integers
    inherited_weight: Floats
    # neol.spec.constants.Task and Plasticity
    max_steps: int
    rule: int
    rate: float
    threshold_rate: float
    weight_limit: float
    write_back: bool
    seeds: npt.NDArray[np.uint64]
    # neol.rollout.engine.Rollouts
    returns: Floats
    steps: Integers
    weight: Floats
    threshold: Floats
    failed: npt.NDArray[np.bool_]


@register_jitable
def play_batch(world: World, batch: Batch, begin: int, end: int) -> None:
    """Let networks begin to end of a batch play their episodes in a world, one after the other."""
    for genome in range(begin, end):
        first, last = batch.node_offset[genome], batch.node_offset[genome + 1]
        for episode in range(batch.seeds.shape[1]):
            if not batch.write_back:
                for edge in range(batch.edge_offset[first], batch.edge_offset[last]):
                    batch.weight[edge] = batch.inherited_weight[edge]
            for node in range(first, last):
                batch.threshold[node] = 0.0
            seed = batch.seeds[genome, episode]
            total, steps = play_episode(world, batch, first, last, seed)
            batch.returns[genome, episode] = total
            batch.steps[genome, episode] = steps
            if math.isnan(total):
                batch.failed[genome] = True
                break


@register_jitable
def play_episode(
    world: World, batch: Batch, first: int, last: int, seed: np.uint64
) -> tuple[float, int]:
    """One episode (Algorithm 2, lines 3-14): its return, NaN if it failed, and its steps."""
    random = np.empty(4, dtype=np.uint64)
    observation = np.empty(batch.inputs)
    values = np.empty(batch.inputs + last - first)
    outputs = values[len(values) - batch.outputs :]
    seed_pcg64(seed, random)
    world.reset(random, observation)
    total = 0.0
    steps = 0
    while steps < batch.max_steps:
        for i in range(batch.inputs):
            if not math.isfinite(observation[i]):
                return math.nan, steps
            values[i] = observation[i]
        forward(
            first,
            last,
            batch.bias,
            batch.edge_offset,
            batch.source,
            batch.weight,
            batch.inputs,
            batch.outputs,
            batch.activation,
            batch.sum_limit,
            values,
        )
        reward, terminated = world.step(outputs, observation)
        total += reward
        steps += 1
        finite = learn(
            first,
            last,
            batch.edge_offset,
            batch.source,
            batch.weight,
            batch.threshold,
            batch.inputs,
            batch.rule,
            batch.rate * reward,
            batch.threshold_rate,
            batch.weight_limit,
            values,
        )
        if not (math.isfinite(total) and finite):
            return math.nan, steps
        if terminated:
            break
    return total, steps
