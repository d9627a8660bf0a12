"""Genomes as arrays, and their decoding into networks.

Node ids: inputs are 0 to I - 1, outputs I to I + O - 1, hidden nodes come after. A genome stores
its output and hidden nodes sorted by id, and its connections sorted by innovation number.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from neol.base.kernel import kernel
from neol.network.forward import ACTIVATIONS, Networks
from neol.spec.constants import Network

NODE = np.dtype([("id", np.int64), ("bias", np.float64)])
CONNECTION = np.dtype(
    [
        ("innovation", np.int64),
        ("source", np.int64),
        ("target", np.int64),
        ("weight", np.float64),
        ("enabled", np.bool_),
    ],
    align=True,
)


@dataclass(slots=True)
class Genome:
    """One individual. In a population its arrays are views of the population's pool."""

    id: int
    nodes: npt.NDArray[np.void]
    """NODE[n], sorted by id: outputs first, then hidden nodes."""
    connections: npt.NDArray[np.void]
    """CONNECTION[c], sorted by innovation number, without a cycle."""
    fitness: float = field(default=np.nan)
    """Mean return of its last evaluation; NaN before."""

    def copy(self) -> "Genome":
        """The same genome, its arrays its own."""
        return Genome(self.id, self.nodes.copy(), self.connections.copy(), self.fitness)


def initial_genome(
    id: int,
    inputs: int,
    outputs: int,
    weight: npt.NDArray[np.float64],
    bias: npt.NDArray[np.float64],
) -> Genome:
    """A genome of generation 0: every input connected to every output, nothing hidden.

    `weight` is float64[outputs * inputs], ordered by output, then input; `bias` float64[outputs].
    """
    nodes = np.zeros(outputs, dtype=NODE)
    nodes["id"] = np.arange(inputs, inputs + outputs)
    nodes["bias"] = bias
    connections = np.zeros(inputs * outputs, dtype=CONNECTION)
    connections["innovation"] = np.arange(inputs * outputs)
    connections["source"] = np.tile(np.arange(inputs), outputs)
    connections["target"] = np.repeat(nodes["id"], inputs)
    connections["weight"] = weight
    connections["enabled"] = True
    return Genome(id, nodes, connections)


class Pool(NamedTuple):
    """The genes of P genomes, end to end."""

    nodes: npt.NDArray[np.void]
    """NODE[M]."""
    node_offset: npt.NDArray[np.int64]
    """int64[P + 1]: genome i has the nodes node_offset[i] to node_offset[i + 1]."""
    connections: npt.NDArray[np.void]
    """CONNECTION[C]."""
    connection_offset: npt.NDArray[np.int64]
    """int64[P + 1]: and the connections connection_offset[i] to connection_offset[i + 1]."""

    @classmethod
    def of(cls, genomes: Sequence[Genome]) -> "Pool":
        """Copies of these genomes' genes."""
        nodes = [np.empty(0, dtype=NODE), *(genome.nodes for genome in genomes)]
        connections = [np.empty(0, dtype=CONNECTION), *(genome.connections for genome in genomes)]
        return cls(
            np.concatenate(nodes),
            np.cumsum([len(part) for part in nodes]),
            np.concatenate(connections),
            np.cumsum([len(part) for part in connections]),
        )


def decode(
    pool: Pool, inputs: int, outputs: int, network: Network
) -> tuple[Networks, npt.NDArray[np.int64]]:
    """The networks of a pool's genomes, and where in the pool their weights come from.

    The second array, int64[E], gives for each connection of the networks its place among the
    pool's: `encode_weights` writes learned weights back along it. Connections of a node are
    ordered by innovation number; disabled ones are left out.
    """
    enabled = int(np.count_nonzero(pool.connections["enabled"]))
    networks = Networks(
        inputs=inputs,
        outputs=outputs,
        activation=ACTIVATIONS[network.hidden_activation],
        sum_limit=network.sum_limit,
        node_offset=pool.node_offset,
        bias=np.empty(len(pool.nodes)),
        edge_offset=np.zeros(len(pool.nodes) + 1, dtype=np.int64),
        source=np.empty(enabled, dtype=np.int64),
        weight=np.empty(enabled),
    )
    gene = np.empty(enabled, dtype=np.int64)
    _decode(
        pool,
        inputs,
        outputs,
        networks.bias,
        networks.edge_offset,
        networks.source,
        networks.weight,
        gene,
    )
    return networks, gene


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
    index_of = np.empty(pool.nodes["id"].max() + 1, dtype=np.int64)
    edge = 0
    for genome in range(len(pool.node_offset) - 1):
        first_node, last_node = pool.node_offset[genome], pool.node_offset[genome + 1]
        first_gene, last_gene = pool.connection_offset[genome], pool.connection_offset[genome + 1]
        edge = _decode_genome(
            pool.nodes[first_node:last_node],
            pool.connections[first_gene:last_gene],
            inputs,
            outputs,
            index_of,
            first_node,
            first_gene,
            edge,
            bias,
            edge_offset,
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
    index_of: npt.NDArray[np.int64],
    first_node: int,
    first_gene: int,
    first_edge: int,
    bias: npt.NDArray[np.float64],
    edge_offset: npt.NDArray[np.int64],
    source: npt.NDArray[np.int64],
    weight: npt.NDArray[np.float64],
    gene: npt.NDArray[np.int64],
) -> int:
    """Write one genome's network into the batch's arrays; return the batch's next free edge.

    `index_of` is room for where among the genome's nodes an id stands; each genome fills its own.
    """
    count = len(nodes)
    for node in range(count):
        index_of[nodes[node].id] = node
    from_node = np.full(len(connections), -1, dtype=np.int64)
    to_node = np.empty(len(connections), dtype=np.int64)
    incoming = np.zeros(count, dtype=np.int64)
    waits_for = np.zeros(count, dtype=np.int64)
    # The connections out of a node, as a linked list: its first one, and each one's next.
    first_out = np.full(count, -1, dtype=np.int64)
    next_out = np.empty(len(connections), dtype=np.int64)
    for c in range(len(connections)):
        if connections[c].enabled:
            to_node[c] = index_of[connections[c].target]
            incoming[to_node[c]] += 1
            if connections[c].source >= inputs:
                from_node[c] = index_of[connections[c].source]
                waits_for[to_node[c]] += 1
                next_out[c] = first_out[from_node[c]]
                first_out[from_node[c]] = c

    # Kahn's algorithm: hidden nodes queue up as soon as all that feeds them has its place.
    # Outputs feed nothing, so they simply follow in their own order.
    order = np.empty(count, dtype=np.int64)
    queued = 0
    for node in range(outputs, count):
        if waits_for[node] == 0:
            order[queued] = node
            queued += 1
    position = np.empty(count, dtype=np.int64)
    for place in range(count - outputs):
        position[order[place]] = place
        c = first_out[order[place]]
        while c >= 0:
            target = to_node[c]
            waits_for[target] -= 1
            if waits_for[target] == 0 and target >= outputs:
                order[queued] = target
                queued += 1
            c = next_out[c]
    for output in range(outputs):
        order[queued + output] = output
        position[output] = queued + output

    next_edge = np.empty(count, dtype=np.int64)
    edge = first_edge
    for place in range(count):
        node = order[place]
        bias[first_node + place] = nodes[node].bias
        edge_offset[first_node + place] = edge
        next_edge[node] = edge
        edge += incoming[node]
    edge_offset[first_node + count] = edge
    for c in range(len(connections)):
        if connections[c].enabled:
            place = next_edge[to_node[c]]
            next_edge[to_node[c]] += 1
            feeds = from_node[c]
            source[place] = connections[c].source if feeds < 0 else inputs + position[feeds]
            weight[place] = connections[c].weight
            gene[place] = first_gene + c
    return edge
