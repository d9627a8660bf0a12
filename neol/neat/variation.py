"""Variation: crossover aligned by innovation numbers, and the mutations (paper's Algorithm 4).

`nodes` and `connections` are a genome's arrays, NODE[n] and CONNECTION[c]; `random` is the state of
a random stream, uint64[4] (see neol.pcg64).
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from neol.constants import Neat
from neol.kernel import kernel
from neol.neat.genome import CONNECTION, NODE, Pool
from neol.neat.innovations import Innovations, connection_number, split_node
from neol.neat.values import Values, draw_values, mutate_values
from neol.pcg64 import State, below, next_double

Genes = npt.NDArray[np.void]

PARENTS = np.dtype([("fitter", np.int64), ("other", np.int64), ("elite", np.bool_)], align=True)
"""Of one child, by their places. An elite is no child but its parent's copy."""


class Rates(NamedTuple):
    """The constants of variation."""

    disable: float
    add_connection: float
    add_node: float
    remove_connection: float
    remove_node: float
    mutate_enabled: float
    weight: Values
    bias: Values

    @classmethod
    def of(cls, neat: Neat) -> "Rates":
        """The configured rates; those of weights and biases follow WM_MODE (lines 22-27).

        off: none is mutated. config: each is perturbed with its mutate rate, or replaced by a
        fresh one with its replace rate. A probability p: each is perturbed with p in place of
        both mutate rates, and none is replaced.
        """
        weight_rates = neat.weight_mutate_rate, neat.weight_replace_rate
        bias_rates = neat.bias_mutate_rate, neat.bias_replace_rate
        if neat.weight_mutation != "config":
            p = 0.0 if neat.weight_mutation == "off" else neat.weight_mutation
            weight_rates = bias_rates = p, 0.0
        return cls(
            neat.disable_rate,
            neat.add_connection_rate,
            neat.add_node_rate,
            neat.remove_connection_rate,
            neat.remove_node_rate,
            neat.enabled_mutate_rate,
            Values(neat.weight_init_sd, neat.weight_limit, *weight_rates, neat.weight_mutate_power),
            Values(neat.bias_init_sd, neat.bias_limit, *bias_rates, neat.bias_mutate_power),
        )


def breed_all(
    pool: Pool,
    parents: npt.NDArray[np.void],
    inputs: int,
    outputs: int,
    rates: Rates,
    innovations: Innovations,
    random: State,
) -> Pool:
    """The children of PARENTS[n], whose places are those in a pool: a pool of n genomes."""
    fitter, offsets = parents["fitter"], np.zeros((2, len(parents) + 1), dtype=np.int64)
    # A child has at most one node and three connections more than its fitter parent.
    most_nodes = np.sum(np.diff(pool.node_offset)[fitter] + 1)
    most_connections = np.sum(np.diff(pool.connection_offset)[fitter] + 3)
    children = Pool(
        np.empty(most_nodes, dtype=NODE),
        offsets[0],
        np.empty(most_connections, dtype=CONNECTION),
        offsets[1],
    )
    _breed_all(pool, parents, inputs, outputs, rates, innovations, random, children)
    return children._replace(
        nodes=children.nodes[: children.node_offset[-1]],
        connections=children.connections[: children.connection_offset[-1]],
    )


@kernel
def _breed_all(
    pool: Pool,
    parents: npt.NDArray[np.void],
    inputs: int,
    outputs: int,
    rates: Rates,
    innovations: Innovations,
    random: State,
    children: Pool,
) -> None:
    """Write the children of PARENTS[n], by their places in a pool, into the pool `children`."""
    nodes, node_offset, connections, connection_offset = children
    for child in range(len(parents)):
        one_nodes, one_connections = genome_in(pool, parents[child].fitter)
        if parents[child].elite:
            child_nodes, child_connections = one_nodes, one_connections
        else:
            other_nodes, other_connections = genome_in(pool, parents[child].other)
            child_nodes, child_connections = breed(
                one_nodes,
                one_connections,
                other_nodes,
                other_connections,
                parents[child].fitter != parents[child].other,
                inputs,
                outputs,
                rates,
                innovations,
                random,
            )
        node_offset[child + 1] = node_offset[child] + len(child_nodes)
        nodes[node_offset[child] : node_offset[child + 1]] = child_nodes
        connection_offset[child + 1] = connection_offset[child] + len(child_connections)
        connections[connection_offset[child] : connection_offset[child + 1]] = child_connections


@kernel
def genome_in(pool: Pool, place: int) -> tuple[Genes, Genes]:
    """Nodes and connections of one of a pool's genomes."""
    node, connection = pool.node_offset, pool.connection_offset
    return (
        pool.nodes[node[place] : node[place + 1]],
        pool.connections[connection[place] : connection[place + 1]],
    )


@kernel
def breed(
    fitter_nodes: Genes,
    fitter_connections: Genes,
    other_nodes: Genes,
    other_connections: Genes,
    crossed: bool,
    inputs: int,
    outputs: int,
    rates: Rates,
    innovations: Innovations,
    random: State,
) -> tuple[Genes, Genes]:
    """A child's nodes and connections (lines 17-27; removal as named in Section 3.1).

    Not `crossed` if both parents are the same genome: the child begins as its copy.
    """
    nodes, connections = fitter_nodes.copy(), fitter_connections.copy()
    if crossed:
        crossover(nodes, connections, other_nodes, other_connections, rates.disable, random)
    if next_double(random) < rates.add_connection:
        connections = add_connection(
            nodes, connections, inputs, outputs, rates.weight, innovations, random
        )
    if next_double(random) < rates.add_node:
        nodes, connections = add_node(nodes, connections, innovations, random)
    if next_double(random) < rates.remove_connection:
        connections = remove_connection(connections, random)
    if next_double(random) < rates.remove_node:
        nodes, connections = remove_node(nodes, connections, outputs, random)
    mutate_enabled(connections, rates.mutate_enabled, random)
    mutate_values(connections["weight"], rates.weight, random)
    mutate_values(nodes["bias"], rates.bias, random)
    return nodes, connections


@kernel
def crossover(
    nodes: Genes,
    connections: Genes,
    other_nodes: Genes,
    other_connections: Genes,
    disable_rate: float,
    random: State,
) -> None:
    """Cross a copy of the fitter parent with the other (CROSSOVERALIGNED, line 17).

    The child keeps the structure of the fitter parent; weight, bias and state of a gene that both
    have come from either with equal chance. A gene disabled in a parent is disabled in the child
    with `disable_rate` (Stanley & Miikkulainen 2002).
    """
    o = 0
    for c in range(len(connections)):
        while o < len(other_connections) and (
            other_connections[o].innovation < connections[c].innovation
        ):
            o += 1
        if o == len(other_connections):
            break
        if other_connections[o].innovation == connections[c].innovation:
            if not (connections[c].enabled and other_connections[o].enabled):
                connections[c].enabled = next_double(random) >= disable_rate
            if next_double(random) < 0.5:
                connections[c].weight = other_connections[o].weight
    o = 0
    for n in range(len(nodes)):
        while o < len(other_nodes) and other_nodes[o].id < nodes[n].id:
            o += 1
        if o == len(other_nodes):
            break
        if other_nodes[o].id == nodes[n].id and next_double(random) < 0.5:
            nodes[n].bias = other_nodes[o].bias


@kernel
def add_connection(
    nodes: Genes,
    connections: Genes,
    inputs: int,
    outputs: int,
    weight: Values,
    innovations: Innovations,
    random: State,
) -> Genes:
    """Connect two random nodes (line 19), unless they are connected or it would close a cycle.

    Sources are inputs and hidden nodes, targets hidden nodes and outputs; disabled connections
    count as connections, so that enabling one can never close a cycle.
    """
    source = below(inputs + len(nodes) - outputs, random)
    if source >= inputs:
        source = nodes[outputs + source - inputs].id
    target = nodes[below(len(nodes), random)].id
    if is_connected(connections, source, target) or reaches(connections, target, source):
        return connections
    innovation = connection_number(innovations, source, target)
    value = np.empty(1)
    draw_values(value, weight, random)
    return _with_gene(connections, innovation, source, target, value[0])


@kernel
def add_node(
    nodes: Genes, connections: Genes, innovations: Innovations, random: State
) -> tuple[Genes, Genes]:
    """Split a random enabled connection (line 21): it is disabled, a node takes its place.

    The node has bias 0, the connection into it weight 1, the one out of it the old weight.
    """
    enabled = np.flatnonzero(connections["enabled"])
    if len(enabled) == 0:
        return nodes, connections
    split = connections[enabled[below(len(enabled), random)]]
    split.enabled = False
    node, source, target = split_node(innovations, split.innovation), split.source, split.target
    # A node of this generation has the highest id so far, so it comes last.
    longer = np.empty(len(nodes) + 1, dtype=nodes.dtype)
    longer[:-1] = nodes
    longer[-1].id = node
    longer[-1].bias = 0.0
    into = connection_number(innovations, source, node)
    out_of = connection_number(innovations, node, target)
    weight = split.weight
    connections = _with_gene(connections, into, source, node, 1.0)
    return longer, _with_gene(connections, out_of, node, target, weight)


@kernel
def remove_connection(connections: Genes, random: State) -> Genes:
    """Remove a random connection."""
    if len(connections) == 0:
        return connections
    kept: Genes = connections[np.arange(len(connections)) != below(len(connections), random)]
    return kept


@kernel
def remove_node(
    nodes: Genes, connections: Genes, outputs: int, random: State
) -> tuple[Genes, Genes]:
    """Remove a random hidden node and its connections."""
    if len(nodes) == outputs:
        return nodes, connections
    node = nodes[outputs + below(len(nodes) - outputs, random)].id
    apart = (connections["source"] != node) & (connections["target"] != node)
    return nodes[nodes["id"] != node], connections[apart]


@kernel
def mutate_enabled(connections: Genes, rate: float, random: State) -> None:
    """Draw the state of a few connections anew."""
    for c in range(len(connections)):
        chance = next_double(random)
        if chance < rate:
            # The chance is uniform below the rate: its halves give the new state.
            connections[c].enabled = chance < rate / 2


@kernel
def is_connected(connections: Genes, source: int, target: int) -> bool:
    """Whether the connection exists, enabled or not."""
    for c in range(len(connections)):
        if connections[c].source == source and connections[c].target == target:
            return True
    return False


@kernel
def reaches(connections: Genes, start: int, goal: int) -> bool:
    """Whether a path along connections, enabled or not, leads from one node to another."""
    reached = {start}
    grows = True
    while grows and goal not in reached:
        grows = False
        for c in range(len(connections)):
            if connections[c].source in reached and connections[c].target not in reached:
                reached.add(connections[c].target)
                grows = True
    return goal in reached


@kernel
def _with_gene(
    connections: Genes, innovation: int, source: int, target: int, weight: float
) -> Genes:
    """The connections with one more, enabled, where its innovation number belongs."""
    place = len(connections)
    while place > 0 and connections[place - 1].innovation > innovation:
        place -= 1
    longer = np.empty(len(connections) + 1, dtype=connections.dtype)
    longer[:place] = connections[:place]
    longer[place + 1 :] = connections[place:]
    longer[place].innovation = innovation
    longer[place].source = source
    longer[place].target = target
    longer[place].weight = weight
    longer[place].enabled = True
    return longer
