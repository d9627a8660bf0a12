"""Export of champions to other programs: their networks, with the initial weights of an episode."""

import contextlib
from typing import Literal

import gymnasium
import numpy as np

from neol.champions.player import Player
from neol.rollout.environment import make_environment
from neol.spec.observations import names
from neol.spec.types import Model


class Discrete(Model):
    """The action is the index of the largest output; of equals the first."""

    kind: Literal["discrete"] = "discrete"
    start: int
    """Number of the first action: the action is this plus the output's index."""


class Continuous(Model):
    """The action is all outputs, clipped."""

    kind: Literal["continuous"] = "continuous"
    low: tuple[float, ...]
    high: tuple[float, ...]
    dtype: str
    """Numpy dtype of the action; the environment's reward may depend on it."""


class Node(Model):
    """A node with activity activation(scale * clip(bias + weights * sources)), summed in order."""

    activation: Literal["tanh", "relu", "sigmoid", "identity"]
    bias: float
    sources: tuple[int, ...]
    """Places among all activities: first the inputs, then the nodes in their order."""
    weights: tuple[float, ...]


class Exported(Model):
    """A network that plays a task. Numbers are exact: the shortest that read back equal."""

    format: Literal["neol-network"] = "neol-network"
    version: Literal[1] = 1
    task: str
    environment: str
    """Gymnasium id."""
    method: str
    seed: int
    fitness: float
    inputs: tuple[str, ...]
    """Name of each entry of an observation."""
    outputs: tuple[str, ...]
    action: Discrete | Continuous
    sum_limit: float
    """A node's sum is clipped to +- this."""
    activation_scale: float
    """Factor of the clipped sum."""
    nodes: tuple[Node, ...]
    """Nodes in topological order; the last ones are the outputs."""


def export(player: Player) -> Exported:
    """Return a champion's network for export."""
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
    """Return the network as JSON of class `Exported`."""
    return export(player).model_dump_json(indent=1).encode() + b"\n"


def _action(player: Player) -> Discrete | Continuous:
    with contextlib.closing(make_environment(player.spec.task)) as environment:
        space = environment.action_space
    if isinstance(space, gymnasium.spaces.Discrete):
        return Discrete(start=int(space.start))
    assert isinstance(space, gymnasium.spaces.Box)
    # Outputs are within +-1, so this bound acts like an infinite one.
    low, high = np.maximum(space.low, -1.0), np.minimum(space.high, 1.0)
    return Continuous(low=tuple(low.tolist()), high=tuple(high.tolist()), dtype=str(space.dtype))
