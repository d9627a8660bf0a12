"""A network as a graph: layers derived from its connections, and places of its nodes in a picture.

A node is a position as in `neol.network.forward.Networks`: inputs, hidden nodes, outputs.
"""

import statistics
from dataclasses import dataclass

import numpy as np

from neol.champions.player import Player
from neol.neat.decoding import decode
from neol.neat.genome import Pool
from neol.network.forward import Networks

Edge = tuple[int, int]
"""Source and target node of a connection."""


@dataclass(frozen=True, slots=True)
class Graph:
    """Content of a picture of a champion's network."""

    places: dict[int, tuple[float, float]]
    """x and y of each node, from 0 to 1; hidden nodes without an enabled connection have none."""
    enabled: list[Edge]
    """Enabled connections in the order of the network's weights."""
    disabled: list[Edge]
    """Disabled connections between nodes that have a place."""


def graph(player: Player) -> Graph:
    """Return the graph of a champion's network."""
    network, genes = player.network, player.genome.connections
    pool = Pool.of([player.genome])
    _, gene = decode(pool, network.inputs, network.outputs, player.spec.network)
    enabled = edges(network)
    first_output = network.inputs + len(network.bias) - network.outputs
    node_of_id = {node: node for node in range(network.inputs)}
    node_of_id |= {network.inputs + k: first_output + k for k in range(network.outputs)}
    ids = zip(genes["source"][gene].tolist(), genes["target"][gene].tolist(), strict=True)
    for pair, edge in zip(ids, enabled, strict=True):
        node_of_id |= zip(pair, edge, strict=True)
    off = genes[~genes["enabled"]]
    disabled = [
        (node_of_id[source], node_of_id[target])
        for source, target in zip(off["source"].tolist(), off["target"].tolist(), strict=True)
        if {source, target} <= node_of_id.keys()
    ]
    return Graph(_places(network, enabled), enabled, disabled)


def edges(network: Networks) -> list[Edge]:
    """Return the connections of a single network, in the order of its weights."""
    nodes = network.inputs + np.arange(len(network.bias))
    targets = np.repeat(nodes, np.diff(network.edge_offset))
    return list(zip(network.source.tolist(), targets.tolist(), strict=True))


def layers(network: Networks) -> list[list[int]]:
    """Return the nodes of a single network by depth: inputs, hidden layers, outputs.

    A hidden node is one layer behind its deepest source; outputs share the last layer.
    """
    nodes = network.inputs + len(network.bias)
    first_output = nodes - network.outputs
    depth = [0] * network.inputs + [1] * (nodes - network.inputs)
    for source, target in edges(network):  # by target, in topological order
        depth[target] = max(depth[target], depth[source] + 1)
    last = max(depth[:first_output]) + 1
    depth[first_output:] = [last] * network.outputs
    return [[node for node in range(nodes) if depth[node] == each] for each in range(last + 1)]


def _places(network: Networks, enabled: list[Edge]) -> dict[int, tuple[float, float]]:
    """Place each layer in a column; a hidden node is about as high as its sources."""
    touched = {node for edge in enabled for node in edge}
    first, *hidden, last = layers(network)
    shown = [[node for node in layer if node in touched] for layer in hidden]
    columns = [first, *filter(None, shown), last]
    places: dict[int, tuple[float, float]] = {}

    def height(node: int) -> float:
        feeding = [places[source][1] for source, target in enabled if target == node]
        return statistics.fmean(feeding or [0.5])

    for column, nodes in enumerate(columns):
        outer = nodes in (first, last)
        # Hidden nodes alternate between the rows, so that fewer lines cross them.
        shift = 0.0 if outer else (-1) ** column * 0.2
        for row, node in enumerate(nodes if outer else sorted(nodes, key=height, reverse=True)):
            places[node] = column / (len(columns) - 1), 1 - (row + 0.5 + shift) / len(nodes)
    return places
