"""Random networks for tests, and the outputs of one."""

import numpy as np

from neol.network.forward import ACTIVATIONS, Networks, forward


def random_networks(
    random: np.random.Generator,
    population: int,
    inputs: int,
    outputs: int,
    *,
    hidden: int = 6,
    activation: str = "tanh",
    sum_limit: float = 50.0,
    activation_scale: float = 1.0,
    weight_sd: float = 1.0,
) -> Networks:
    """Feed-forward networks with up to `hidden` hidden nodes and about half of all connections.

    Without hidden nodes every input is connected to every output.
    """
    node_offset, edge_offset = [0], [0]
    source: list[int] = []
    for _ in range(population):
        nodes = int(random.integers(hidden + 1)) + outputs
        for node in range(nodes):
            feeding = inputs + min(node, nodes - outputs)
            chosen = np.flatnonzero(random.random(feeding) < (0.5 if hidden else 1.0))
            source.extend(chosen.tolist())
            edge_offset.append(len(source))
        node_offset.append(node_offset[-1] + nodes)
    return Networks(
        inputs=inputs,
        outputs=outputs,
        activation=ACTIVATIONS[activation],
        sum_limit=sum_limit,
        activation_scale=activation_scale,
        node_offset=np.array(node_offset),
        bias=random.normal(size=node_offset[-1]),
        edge_offset=np.array(edge_offset),
        source=np.array(source, dtype=np.int64),
        weight=weight_sd * random.normal(size=len(source)),
    )


def outputs_of(networks: Networks, index: int, observation: np.ndarray) -> np.ndarray:
    first, last = networks.node_offset[index : index + 2]
    values = np.concatenate([observation, np.zeros(last - first)])
    forward(networks, index, values)
    return values[-networks.outputs :]


def one_node(weight: np.ndarray) -> Networks:
    """A network of one output, connected to as many inputs as there are weights."""
    return Networks(
        inputs=len(weight),
        outputs=1,
        activation=ACTIVATIONS["tanh"],
        sum_limit=50.0,
        activation_scale=1.0,
        node_offset=np.array([0, 1]),
        bias=np.zeros(1),
        edge_offset=np.array([0, len(weight)]),
        source=np.arange(len(weight)),
        weight=weight,
    )
