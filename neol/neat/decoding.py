"""Decoding of genomes into networks, and writing learned weights back (Section 4.1)."""

import numpy as np
import numpy.typing as npt

from neol.base.kernel import kernel
from neol.neat.genome import Pool
from neol.network.forward import ACTIVATIONS, Networks
from neol.spec.constants import Network


def decode(
    pool: Pool, inputs: int, outputs: int, network: Network
) -> tuple[Networks, npt.NDArray[np.int64]]:
    """Return the networks of a pool's genomes, and the places of their weights in the pool.

    The second array, int64[E], gives for each connection of the networks its place among the
    pool's connections; `encode_weights` uses it to write learned weights back. Connections of a
    node are ordered by innovation number; disabled ones are omitted.
    """
    room = len(pool.connections)
    source, weight = np.empty(room, dtype=np.int64), np.empty(room)
    gene = np.empty(room, dtype=np.int64)
    bias, edge_offset = np.empty(len(pool.nodes)), np.zeros(len(pool.nodes) + 1, dtype=np.int64)
    _decode(pool, inputs, outputs, bias, edge_offset, source, weight, gene)
    enabled = edge_offset[-1]
    networks = Networks(
        inputs=inputs,
        outputs=outputs,
        activation=ACTIVATIONS[network.hidden_activation],
        sum_limit=network.sum_limit,
        activation_scale=network.activation_scale,
        node_offset=pool.node_offset,
        bias=bias,
        edge_offset=edge_offset,
        source=source[:enabled],
        weight=weight[:enabled],
    )
    return networks, gene[:enabled]


def encode_weights(
    pool: Pool, gene: npt.NDArray[np.int64], weight: npt.NDArray[np.float64]
) -> None:
    """Write learned weights back to the genes they came from (Lamarckian, Section 4.1)."""
    pool.connections["weight"][gene] = weight


@kernel
def _decode(
    pool: Pool,
    inputs: int,
    outputs: int,
    bias: npt.NDArray[np.float64],
    edge_offset: npt.NDArray[np.int64],
    source: npt.NDArray[np.int64],
    weight: npt.NDArray[np.float64],
    gene: npt.NDArray[np.int64],
) -> None:
    """Write each genome's network into the batch's arrays."""
    nodes, node_offset, connections, connection_offset = pool
    number_of = np.empty(nodes["id"].max() + 1, dtype=np.int64)
    number_of[:inputs] = np.arange(inputs)
    for genome in range(len(node_offset) - 1):
        first_node, last_node = node_offset[genome], node_offset[genome + 1]
        first_gene, last_gene = connection_offset[genome], connection_offset[genome + 1]
        _decode_genome(
            nodes[first_node:last_node],
            connections[first_gene:last_gene],
            inputs,
            outputs,
            number_of,
            first_gene,
            bias[first_node:],
            edge_offset[first_node:],
            source,
            weight,
            gene,
        )


@kernel
def _decode_genome(
    nodes: npt.NDArray[np.void],
    connections: npt.NDArray[np.void],
    inputs: int,
    outputs: int,
    number_of: npt.NDArray[np.int64],
    first_gene: int,
    bias: npt.NDArray[np.float64],
    edge_offset: npt.NDArray[np.int64],
    source: npt.NDArray[np.int64],
    weight: npt.NDArray[np.float64],
    gene: npt.NDArray[np.int64],
) -> None:
    """Write one genome's network into the batch's arrays; bias and edge_offset start at its nodes.

    Nodes are numbered: inputs first, then the others in the genome's order. `number_of` is scratch
    space for these numbers by id.
    """
    size = inputs + len(nodes)
    for number in range(inputs, size):
        number_of[nodes[number - inputs].id] = number
    enabled = _enabled(connections)
    sources, targets = np.empty_like(enabled), np.empty_like(enabled)
    incoming = np.zeros(size, dtype=np.int64)
    for edge in range(len(enabled)):
        connection = connections[enabled[edge]]
        sources[edge], targets[edge] = number_of[connection.source], number_of[connection.target]
        incoming[targets[edge]] += 1

    position, next_edge = np.arange(size), np.empty(size, dtype=np.int64)
    order = _topological_order(sources, targets, inputs, outputs, size)
    for place in range(len(order)):
        node = order[place]
        position[node] = inputs + place
        bias[place] = nodes[node - inputs].bias
        next_edge[node] = edge_offset[place]
        edge_offset[place + 1] = edge_offset[place] + incoming[node]
    for edge in range(len(enabled)):
        place = next_edge[targets[edge]]
        next_edge[targets[edge]] += 1
        source[place] = position[sources[edge]]
        weight[place] = connections[enabled[edge]].weight
        gene[place] = first_gene + enabled[edge]


@kernel
def _enabled(connections: npt.NDArray[np.void]) -> npt.NDArray[np.int64]:
    """Return the places of the enabled connections; no branch, since flags are hard to predict."""
    places, count = np.empty(len(connections), dtype=np.int64), 0
    for c in range(len(connections)):
        places[count] = c
        count += connections[c].enabled
    return places[:count]


@kernel
def _topological_order(
    source: npt.NDArray[np.int64],
    target: npt.NDArray[np.int64],
    inputs: int,
    outputs: int,
    size: int,
) -> npt.NDArray[np.int64]:
    """Return the numbers of the hidden nodes in topological order, then those of the outputs.

    Kahn's algorithm: a hidden node is queued when all its sources are placed. Outputs feed no
    other node, so they follow in their own order.
    """
    waits_for = np.zeros(size, dtype=np.int64)
    # The connections out of a node, as a linked list: its first one, and each one's next.
    first_out, next_out = np.full(size, -1, dtype=np.int64), np.empty_like(source)
    for edge in range(len(source)):
        waits_for[target[edge]] += source[edge] >= inputs
        next_out[edge] = first_out[source[edge]]
        first_out[source[edge]] = edge

    order = np.empty(size - inputs, dtype=np.int64)
    hidden = inputs + outputs  # number of the first hidden node
    queued = 0
    for node in range(hidden, size):
        if waits_for[node] == 0:
            order[queued] = node
            queued += 1
    for place in range(size - hidden):
        edge = first_out[order[place]]
        while edge >= 0:
            node = target[edge]
            waits_for[node] -= 1
            if waits_for[node] == 0 and node >= hidden:
                order[queued] = node
                queued += 1
            edge = next_out[edge]
    order[size - hidden :] = np.arange(inputs, hidden)
    return order
