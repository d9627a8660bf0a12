"""EnvPool's stepping alone, under the actions of the networks of our engine's measurements.

EnvPool (Weng et al. 2022) steps a batch of environments in C++; here it has one thread. Beforehand
the networks play, and their actions are kept: an environment whose episode ends begins another one
with the next network. What is timed is the pool alone, stepped again from the same seed.
EnvPool is no dependency of neol: `make bench` installs it from benchmarks/requirements.lock.
"""

import time
from importlib.util import find_spec
from typing import Any, NamedTuple

import gymnasium
import numpy as np
import numpy.typing as npt

from benchmarks.measure import Measurement, Values
from benchmarks.trajectories import Recording
from neol.network.forward import Networks
from neol.spec.constants import Task

Array = npt.NDArray[np.float64]

AVAILABLE = find_spec("envpool") is not None
"""Whether EnvPool is installed; it has no wheel for Macs with an Intel processor."""


def batch_of(task: str) -> int:
    """Environments in a batch. A larger one does not lower the cost of a step."""
    return 512 if task == "cartpole" else 32


class Play(NamedTuple):
    """Actions of a pool of environments, call by call."""

    actions: npt.NDArray[Any]
    """Actions as numbers, [calls, environments], or as outputs, [calls, environments, outputs]."""
    steps: int
    """Environment steps; the other calls were resets."""


def envpool_measurement(recording: Recording) -> Measurement:
    """Prepare the measurement of microseconds per step, with resets, of one and of a batch."""
    task = recording.task
    single = play(task, recording.networks, 1, calls=recording.steps)
    many = play(task, recording.networks, batch_of(task.name), calls=task.max_steps)

    def both() -> Values:
        return {
            "envpool_single": seconds_of_envpool(task, single) / single.steps * 1e6,
            "envpool_batch": seconds_of_envpool(task, many) / many.steps * 1e6,
        }

    return both


def play(task: Task, networks: Networks, environments: int, calls: int) -> Play:
    """Play networks without hidden nodes in a pool and record the actions."""
    weight, bias = _matrices(networks)
    pool = _make_pool(task, environments)
    observation, _ = pool.reset()
    player = np.arange(environments)
    ended = np.zeros(environments, dtype=np.bool_)
    actions, steps = [], 0
    for _ in range(calls):
        chosen = player % networks.population
        sums = np.einsum("eoi,ei->eo", weight[chosen], observation) + bias[chosen]
        actions.append(_actions(pool.action_space, np.tanh(networks.activation_scale * sums)))
        observation, _, terminated, truncated, _ = pool.step(actions[-1])
        steps += int(np.count_nonzero(~ended))  # the call after an episode's end resets
        ended = terminated | truncated
        player += ended
    pool.close()
    return Play(np.array(actions), steps)


def seconds_of_envpool(task: Task, played: Play) -> float:
    """Return the CPU seconds of a pool that repeats the recorded actions."""
    pool = _make_pool(task, played.actions.shape[1])
    pool.reset()
    start = time.process_time()
    for actions in played.actions:
        pool.step(actions)
    seconds = time.process_time() - start
    pool.close()
    return seconds


def _make_pool(task: Task, environments: int) -> Any:
    import envpool

    return envpool.make(
        task.environment,
        env_type="gymnasium",
        num_envs=environments,
        num_threads=1,
        max_episode_steps=task.max_steps,
        seed=0,
    )


def _actions(space: Any, outputs: Array) -> npt.NDArray[Any]:
    """Return each environment's action: the largest output's index or the outputs, in its dtype."""
    if isinstance(space, gymnasium.spaces.Discrete):
        outputs = np.argmax(outputs, axis=1)
    actions: npt.NDArray[Any] = outputs.astype(space.dtype)
    return actions


def _matrices(networks: Networks) -> tuple[Array, Array]:
    """Return weights, float64[P, outputs, inputs], and biases, float64[P, outputs]."""
    nodes, shape = len(networks.bias), (networks.population, networks.outputs)
    assert nodes == np.prod(shape), "no hidden nodes"
    weight = np.zeros((nodes, networks.inputs))
    target = np.repeat(np.arange(nodes), np.diff(networks.edge_offset))
    weight[target, networks.source] = networks.weight
    return weight.reshape(*shape, networks.inputs), networks.bias.reshape(shape)
