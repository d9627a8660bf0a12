"""Champions for other programs: their networks, with the weights that an episode begins with."""

import contextlib
from typing import Literal

import gymnasium
import numpy as np

from neol.champions.player import Player
from neol.rollout.reference import make_environment
from neol.spec.observations import names
from neol.spec.types import Model


class Discrete(Model):
    """The action is the first of the largest outputs."""

    kind: Literal["discrete"] = "discrete"
    start: int
    """Of the actions' numbers: the action is this plus the output's place."""


class Continuous(Model):
    """The action is all outputs, clipped."""

    kind: Literal["continuous"] = "continuous"
    low: tuple[float, ...]
    high: tuple[float, ...]
    dtype: str
    """Of numpy: what the environment takes; its reward may depend on it."""


class Node(Model):
    """Its activity is activation(scale * clip(bias + weights * sources)), summed in this order."""

    activation: Literal["tanh", "relu", "sigmoid", "identity"]
    bias: float
    sources: tuple[int, ...]
    """Places among all activities: the inputs', then the nodes' in their order."""
    weights: tuple[float, ...]


class Exported(Model):
    """A network that plays a task. All numbers are exact: the shortest that read back the same."""

    format: Literal["neol-network"] = "neol-network"
    version: Literal[1] = 1
    task: str
    environment: str
    """Gymnasium id."""
    method: str
    seed: int
    fitness: float
    inputs: tuple[str, ...]
    """What each entry of an observation is."""
    outputs: tuple[str, ...]
    action: Discrete | Continuous
    sum_limit: float
    """A node's sum is clipped to +- this."""
    activation_scale: float
    """And then multiplied by this."""
    nodes: tuple[Node, ...]
    """In an order in which they can be computed; the last ones are the outputs."""


def export(player: Player) -> Exported:
    """A champion's network."""
    spec, network = player.spec, player.network
    inputs, outputs = names(spec.task, network.inputs, network.outputs)
    count = len(network.bias)
    nodes = []
    for node in range(count):
        incoming = slice(*network.edge_offset[node : node + 2])
        is_output = node >= count - network.outputs
        nodes.append(
            Node(
                activation="tanh" if is_output else spec.network.hidden_activation,
                bias=float(network.bias[node]),
                sources=tuple(network.source[incoming].tolist()),
                weights=tuple(network.weight[incoming].tolist()),
            )
        )
    return Exported(
        task=spec.task.name,
        environment=spec.task.environment,
        method=spec.method,
        seed=spec.seed,
        fitness=player.genome.fitness,
        inputs=inputs,
        outputs=outputs,
        action=_action(player),
        sum_limit=network.sum_limit,
        activation_scale=network.activation_scale,
        nodes=tuple(nodes),
    )


def to_json(player: Player) -> bytes:
    """The network as `Exported` in JSON."""
    return export(player).model_dump_json(indent=1).encode() + b"\n"


def _action(player: Player) -> Discrete | Continuous:
    with contextlib.closing(make_environment(player.spec.task)) as environment:
        space = environment.action_space
    if isinstance(space, gymnasium.spaces.Discrete):
        return Discrete(start=int(space.start))
    assert isinstance(space, gymnasium.spaces.Box)
    # Outputs are within +-1, so that is no other bound than an infinite one.
    low, high = np.maximum(space.low, -1.0), np.minimum(space.high, 1.0)
    return Continuous(low=tuple(low.tolist()), high=tuple(high.tolist()), dtype=str(space.dtype))
