"""Genomes as arrays, and their decoding into networks.

Node ids: inputs are 0 to I - 1, outputs I to I + O - 1, hidden nodes come after. A genome stores
its output and hidden nodes sorted by id, and its connections sorted by innovation number.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from neol.kernel import kernel
from neol.network import ACTIVATIONS, Networks
from neol.spec import Network

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
    """One individual. Its arrays are its own: nobody else writes to them."""

    id: int
    nodes: npt.NDArray[np.void]
    """NODE[n], sorted by id: outputs first, then hidden nodes."""
    connections: npt.NDArray[np.void]
    """CONNECTION[c], sorted by innovation number, without a cycle."""
    fitness: float = field(default=np.nan)
    """Mean return of its last evaluation; NaN before."""

    def copy(self, id: int) -> "Genome":
        """The same genes under another id, not yet evaluated."""
        return Genome(id, self.nodes.copy(), self.connections.copy())


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


def join(
    genes: Sequence[npt.NDArray[np.void]],
) -> tuple[npt.NDArray[np.void], npt.NDArray[np.int64]]:
    """Many genomes' genes end to end, and where each genome's begin: int64[P+1].

    As bytes: np.concatenate would take ten times as long to find a common type of all records.
    """
    offset = np.zeros(len(genes) + 1, dtype=np.int64)
    np.cumsum([len(part) for part in genes], out=offset[1:])
    return np.concatenate([part.view(np.uint8) for part in genes]).view(genes[0].dtype), offset


def split(genes: npt.NDArray[np.void], offset: npt.NDArray[np.int64]) -> list[npt.NDArray[np.void]]:
    """Each genome's own part of genes that were joined."""
    bounds = offset.tolist()
    return [genes[begin:end] for begin, end in pairwise(bounds)]


def decode(
    genomes: Sequence[Genome], inputs: int, outputs: int, network: Network
) -> tuple[Networks, npt.NDArray[np.int64]]:
    """The networks of a population, and where in each genome their weights come from.

    The second array, int64[E], gives for each connection of the batch its place among the
    genome's own connections: `encode_weights` writes learned weights back along it.
    Connections of a node are ordered by innovation number; disabled ones are left out.
    """
    nodes, node_offset = join([genome.nodes for genome in genomes])
    connections, connection_offset = join([genome.connections for genome in genomes])
    enabled = int(np.count_nonzero(connections["enabled"]))
    networks = Networks(
        inputs=inputs,
        outputs=outputs,
        activation=ACTIVATIONS[network.hidden_activation],
        sum_limit=network.sum_limit,
        node_offset=node_offset,
        bias=np.empty(len(nodes)),
        edge_offset=np.zeros(len(nodes) + 1, dtype=np.int64),
        source=np.empty(enabled, dtype=np.int64),
        weight=np.empty(enabled),
    )
    gene = np.empty(enabled, dtype=np.int64)
    _decode(
        nodes,
        node_offset,
        connections,
        connection_offset,
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
    genomes: Sequence[Genome],
    networks: Networks,
    gene: npt.NDArray[np.int64],
    weight: npt.NDArray[np.float64],
) -> None:
    """Write learned weights back to the genomes they came from (Lamarckian, Section 4.1)."""
    bounds = networks.edge_bounds.tolist()
    for genome, begin, end in zip(genomes, bounds[:-1], bounds[1:], strict=True):
        _encode_genome(genome.connections, begin, end, gene, weight)


@kernel
def _encode_genome(
    connections: npt.NDArray[np.void],
    begin: int,
    end: int,
    gene: npt.NDArray[np.int64],
    weight: npt.NDArray[np.float64],
) -> None:
    for edge in range(begin, end):
        connections[gene[edge]].weight = weight[edge]


@kernel
def _decode(
    nodes: npt.NDArray[np.void],
    node_offset: npt.NDArray[np.int64],
    connections: npt.NDArray[np.void],
    connection_offset: npt.NDArray[np.int64],
    inputs: int,
    outputs: int,
    bias: npt.NDArray[np.float64],
    edge_offset: npt.NDArray[np.int64],
    source: npt.NDArray[np.int64],
    weight: npt.NDArray[np.float64],
    gene: npt.NDArray[np.int64],
) -> None:
    """Write each genome's network into the batch's arrays."""
    index_of = np.empty(nodes["id"].max() + 1, dtype=np.int64)
    edge = 0
    for genome in range(len(node_offset) - 1):
        edge = _decode_genome(
            nodes[node_offset[genome] : node_offset[genome + 1]],
            connections[connection_offset[genome] : connection_offset[genome + 1]],
            inputs,
            outputs,
            index_of,
            node_offset[genome],
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
            gene[place] = c
    return edge
