"""Whether a genome that came from a file is one: everything that the kernels rely on."""

from graphlib import CycleError, TopologicalSorter

import numpy as np

from neol.neat.genome import Genome

MAX_NODE_ID = 2**24
"""Decoding keeps a table of ids; no run comes near so many nodes."""


def check_genome(genome: Genome, inputs: int, outputs: int) -> None:
    """Raise ValueError, saying what is wrong, unless the genome is well-formed.

    Nodes and connections sorted and distinct, all outputs there, no dangling connection, no
    cycle, only finite numbers.
    """
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
