"""Genomes as arrays, and the check that a genome is well-formed.

Node ids: inputs are 0 to I - 1, outputs I to I + O - 1, hidden nodes follow. A genome stores its
output and hidden nodes sorted by id, and its connections sorted by innovation number.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from graphlib import CycleError, TopologicalSorter
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from neol.base.kernel import record_dtype

NODE = record_dtype(np.dtype([("id", np.int64), ("bias", np.float64)]))
CONNECTION = record_dtype(
    np.dtype(
        [
            ("innovation", np.int64),
            ("source", np.int64),
            ("target", np.int64),
            ("weight", np.float64),
            ("enabled", np.bool_),
        ],
        align=True,
    )
)
MAX_INPUTS = 2**20
"""Far more than a task has: a file that states more is not believed."""
MAX_NODE_ID = 2**24
"""Limit of node ids, because decoding keeps a table of them; runs stay far below it."""


@dataclass(slots=True)
class Genome:
    """One individual. In a population its arrays are views of the population's pool."""

    id: int
    nodes: npt.NDArray[np.void]
    """NODE[n], sorted by id: outputs first, then hidden nodes."""
    connections: npt.NDArray[np.void]
    """CONNECTION[c], sorted by innovation number, acyclic."""
    fitness: float = field(default=np.nan)
    """Mean return of the last evaluation; NaN before the first."""

    def copy(self) -> "Genome":
        """Return a copy with its own arrays."""
        return Genome(self.id, self.nodes.copy(), self.connections.copy(), self.fitness)


def initial_genome(
    id: int,
    inputs: int,
    outputs: int,
    weight: npt.NDArray[np.float64],
    bias: npt.NDArray[np.float64],
) -> Genome:
    """Return a genome of the first generation: inputs connected to outputs, no hidden nodes.

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
    """Genes of P genomes, concatenated."""

    nodes: npt.NDArray[np.void]
    """NODE[M]."""
    node_offset: npt.NDArray[np.int64]
    """int64[P + 1]: genome i has the nodes [node_offset[i]:node_offset[i + 1]]."""
    connections: npt.NDArray[np.void]
    """CONNECTION[C]."""
    connection_offset: npt.NDArray[np.int64]
    """int64[P + 1]: the same for connections."""

    @classmethod
    def of(cls, genomes: Sequence[Genome]) -> "Pool":
        """Copy the genes of some genomes into a pool."""
        nodes = [np.empty(0, dtype=NODE), *(genome.nodes for genome in genomes)]
        connections = [np.empty(0, dtype=CONNECTION), *(genome.connections for genome in genomes)]
        return cls(
            np.concatenate(nodes),
            np.cumsum([len(part) for part in nodes]),
            np.concatenate(connections),
            np.cumsum([len(part) for part in connections]),
        )


def check_genome(genome: Genome, inputs: int, outputs: int) -> None:
    """Raise ValueError, which says what is wrong, unless the genome is well-formed.

    That is: nodes and connections sorted and distinct, all outputs present, no dangling
    connection, no cycle, only finite numbers.
    """
    if not (0 <= inputs <= MAX_INPUTS and 0 <= outputs <= len(genome.nodes)):
        raise ValueError(f"genome {genome.id}: {inputs} inputs and {outputs} outputs cannot be")
    nodes, connections = genome.nodes, genome.connections
    hidden = nodes["id"][outputs:]
    sources = np.concatenate([np.arange(inputs), hidden])
    for what, holds in {
        "nodes are not in order": (np.diff(nodes["id"]) > 0).all(),
        "a node id is too large": (nodes["id"] < MAX_NODE_ID).all(),
        "output nodes are missing": np.array_equal(
            nodes["id"][:outputs], np.arange(inputs, inputs + outputs)
        ),
        "connections are not in order": (np.diff(connections["innovation"]) > 0).all()
        and (connections["innovation"] >= 0).all(),
        "a connection comes from nowhere": np.isin(connections["source"], sources).all(),
        "a connection leads nowhere": np.isin(connections["target"], nodes["id"]).all(),
        "a number is not finite": np.isfinite(nodes["bias"]).all()
        and np.isfinite(connections["weight"]).all(),
    }.items():
        if not holds:
            raise ValueError(f"genome {genome.id}: {what}")
    order = TopologicalSorter[int]()
    for source, target in connections[["source", "target"]].tolist():
        order.add(target, source)
    try:
        order.prepare()
    except CycleError:
        raise ValueError(f"genome {genome.id}: its connections form a cycle") from None
