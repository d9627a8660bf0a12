"""Genomes as arrays, and their decoding into networks.

Node ids: inputs are 0 to I - 1, outputs I to I + O - 1, hidden nodes come after. A genome stores
its output and hidden nodes sorted by id, and its connections sorted by innovation number.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

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


@dataclass(slots=True)
class Innovations:
    """Historical markings: the same structural mutation in one generation gets the same numbers.

    Numbers only ever grow, so that they never collide, also after a checkpoint is restored.
    """

    next_innovation: int
    next_node: int
    _connections: dict[tuple[int, int], int] = field(default_factory=dict)
    _splits: dict[int, tuple[int, int, int]] = field(default_factory=dict)

    def begin_generation(self) -> None:
        """Forget which mutations have happened; the counters go on."""
        self._connections.clear()
        self._splits.clear()

    def connection(self, source: int, target: int) -> int:
        """The innovation number of a new connection in this generation."""
        if (source, target) not in self._connections:
            self._connections[source, target] = self.next_innovation
            self.next_innovation += 1
        return self._connections[source, target]

    def split(self, innovation: int) -> tuple[int, int, int]:
        """New node id and the innovation numbers into and out of it, for splitting a connection."""
        if innovation not in self._splits:
            self._splits[innovation] = (
                self.next_node,
                self.next_innovation,
                self.next_innovation + 1,
            )
            self.next_node += 1
            self.next_innovation += 2
        return self._splits[innovation]


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


def initial_innovations(inputs: int, outputs: int) -> Innovations:
    """The counters after generation 0's genes have taken their numbers."""
    return Innovations(next_innovation=inputs * outputs, next_node=inputs + outputs)


def decode(
    genomes: Sequence[Genome], inputs: int, outputs: int, network: Network
) -> tuple[Networks, npt.NDArray[np.int64]]:
    """The networks of a population, and where in each genome their weights come from.

    The second array, int64[E], gives for each connection of the batch its place among the
    genome's own connections: `encode_weights` writes learned weights back along it.
    Connections of a node are ordered by innovation number; disabled ones are left out.
    """
    computed = sum(len(genome.nodes) for genome in genomes)
    enabled = sum(int(np.count_nonzero(genome.connections["enabled"])) for genome in genomes)
    networks = Networks(
        inputs=inputs,
        outputs=outputs,
        activation=ACTIVATIONS[network.hidden_activation],
        sum_limit=network.sum_limit,
        node_offset=np.zeros(len(genomes) + 1, dtype=np.int64),
        bias=np.empty(computed),
        edge_offset=np.zeros(computed + 1, dtype=np.int64),
        source=np.empty(enabled, dtype=np.int64),
        weight=np.empty(enabled),
    )
    gene = np.empty(enabled, dtype=np.int64)
    node, edge = 0, 0
    for index, genome in enumerate(genomes):
        edge = _decode_genome(
            genome.nodes,
            genome.connections,
            inputs,
            outputs,
            node,
            edge,
            networks.bias,
            networks.edge_offset,
            networks.source,
            networks.weight,
            gene,
        )
        node += len(genome.nodes)
        networks.node_offset[index + 1] = node
    return networks, gene


def encode_weights(
    genomes: Sequence[Genome],
    networks: Networks,
    gene: npt.NDArray[np.int64],
    weight: npt.NDArray[np.float64],
) -> None:
    """Write learned weights back to the genomes they came from (Lamarckian, Section 4.1)."""
    bounds = networks.edge_bounds
    for genome, begin, end in zip(genomes, bounds[:-1], bounds[1:], strict=True):
        genome.connections["weight"][gene[begin:end]] = weight[begin:end]


@kernel
def node_index(nodes: npt.NDArray[np.void], id: int) -> int:
    """Where a node stands among a genome's nodes, by bisection; -1 where it does not."""
    low, high = 0, len(nodes)
    while low < high:
        middle = (low + high) // 2
        if nodes[middle].id < id:
            low = middle + 1
        else:
            high = middle
    return low if low < len(nodes) and nodes[low].id == id else -1


@kernel
def _decode_genome(
    nodes: npt.NDArray[np.void],
    connections: npt.NDArray[np.void],
    inputs: int,
    outputs: int,
    first_node: int,
    first_edge: int,
    bias: npt.NDArray[np.float64],
    edge_offset: npt.NDArray[np.int64],
    source: npt.NDArray[np.int64],
    weight: npt.NDArray[np.float64],
    gene: npt.NDArray[np.int64],
) -> int:
    """Write one genome's network into the batch's arrays; return the batch's next free edge."""
    count = len(nodes)
    from_node = np.full(len(connections), -1, dtype=np.int64)
    to_node = np.empty(len(connections), dtype=np.int64)
    incoming = np.zeros(count, dtype=np.int64)
    waits_for = np.zeros(count, dtype=np.int64)
    for c in range(len(connections)):
        if connections[c].enabled:
            to_node[c] = node_index(nodes, connections[c].target)
            incoming[to_node[c]] += 1
            if connections[c].source >= inputs:
                from_node[c] = node_index(nodes, connections[c].source)
                waits_for[to_node[c]] += 1

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
        for c in range(len(connections)):
            if from_node[c] == order[place]:
                target = to_node[c]
                waits_for[target] -= 1
                if waits_for[target] == 0 and target >= outputs:
                    order[queued] = target
                    queued += 1
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
