"""Variation: crossover aligned by innovation numbers, and mutations (paper's Algorithm 4).

`nodes` and `connections` are a genome's arrays, NODE[n] and CONNECTION[c]; `random` is the state of
a random stream, uint64[4] (see neol.random.pcg64).
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from neol.base.kernel import kernel
from neol.neat.innovations import Innovations, connection_number, split_node
from neol.neat.values import ValueRates, draw_values
from neol.random.pcg64 import State, below, next_double

Genes = npt.NDArray[np.void]
RANDOM_PARENT, STANLEY, REDRAW_IF_DISABLED = range(3)


class Flags(NamedTuple):
    """How crossover sets whether a matching gene is enabled in the child."""

    rule: int
    disable_rate: float


@kernel
def crossover(
    nodes: Genes,
    connections: Genes,
    other_nodes: Genes,
    other_connections: Genes,
    flags: Flags,
    random: State,
) -> None:
    """Cross a copy of the fitter parent with the other parent (CROSSOVERALIGNED, line 17).

    The child keeps the structure of the fitter parent; weight or bias of a matching gene come from
    either parent with equal chance, and `flags` decide whether it is enabled.
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
            connections[c].enabled = inherited_flag(
                connections[c].enabled, other_connections[o].enabled, flags, random
            )
            ours, theirs = connections[c].weight, other_connections[o].weight
            connections[c].weight = theirs if next_double(random) < 0.5 else ours
    o = 0
    for n in range(len(nodes)):
        while o < len(other_nodes) and other_nodes[o].id < nodes[n].id:
            o += 1
        if o == len(other_nodes):
            break
        if other_nodes[o].id == nodes[n].id:
            ours, theirs = nodes[n].bias, other_nodes[o].bias
            nodes[n].bias = theirs if next_double(random) < 0.5 else ours


@kernel
def inherited_flag(one: bool, other: bool, flags: Flags, random: State) -> bool:
    """Whether a gene is enabled in the child, given its state in both parents.

    `RANDOM_PARENT` is neat-python's rule before 1.0, `STANLEY` that of Stanley & Miikkulainen
    (2002); NeatConstants.crossover_enabled describes each.
    """
    if one and other:
        return True
    if flags.rule == REDRAW_IF_DISABLED:
        return next_double(random) >= flags.disable_rate
    enabled = one if one == other or next_double(random) < 0.5 else other
    if flags.rule == STANLEY and next_double(random) < flags.disable_rate:
        return False
    return enabled


@kernel
def add_connection(
    nodes: Genes,
    connections: Genes,
    inputs: int,
    outputs: int,
    weight: ValueRates,
    innovations: Innovations,
    random: State,
) -> Genes:
    """Connect two random nodes (line 19) unless they are connected or a cycle would result.

    Sources are inputs and hidden nodes, targets hidden nodes and outputs; disabled connections
    count as connections, so that enabling one can never close a cycle.
    """
    source = below(inputs + len(nodes) - outputs, random)
    if source >= inputs:
        source = nodes[outputs + source - inputs].id
    target = nodes[below(len(nodes), random)].id
    if is_connected(connections, source, target) or reaches(nodes, connections, target, source):
        return connections
    innovation = connection_number(innovations, source, target)
    value = np.empty(1)
    draw_values(value, weight, random)
    return _with_gene(connections, innovation, source, target, value[0])


@kernel
def add_node(
    nodes: Genes,
    connections: Genes,
    bias: ValueRates,
    draws_bias: bool,
    innovations: Innovations,
    random: State,
) -> tuple[Genes, Genes]:
    """Split a random enabled connection (line 21): disable it and put a node in its place.

    The node gets bias 0 or a drawn one, its incoming connection weight 1, its outgoing connection
    the old weight.
    """
    enabled = np.flatnonzero(connections["enabled"])
    if len(enabled) == 0:
        return nodes, connections
    split = connections[enabled[below(len(enabled), random)]]
    split.enabled = False
    node, source, target = split_node(innovations, split.innovation), split.source, split.target
    # A new node has the highest id so far, so it comes last.
    longer = np.empty(len(nodes) + 1, dtype=nodes.dtype)
    longer[:-1] = nodes
    longer[-1].id = node
    value = np.zeros(1)
    if draws_bias:
        draw_values(value, bias, random)
    longer[-1].bias = value[0]
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
    """Set each connection to enabled or disabled at random, with probability `rate`."""
    for c in range(len(connections)):
        chance = next_double(random)
        if chance < rate:
            # Below the rate the number is uniform: each half gives one of the two states.
            connections[c].enabled = chance < rate / 2


@kernel
def is_connected(connections: Genes, source: int, target: int) -> bool:
    """Whether the connection exists, enabled or not."""
    for c in range(len(connections)):
        if connections[c].source == source and connections[c].target == target:
            return True
    return False


@kernel
def reaches(nodes: Genes, connections: Genes, start: int, goal: int) -> bool:
    """Whether a path along connections, enabled or not, leads from one node to another."""
    reached = np.zeros(nodes[-1].id + 1, dtype=np.bool_)
    reached[start] = grows = True
    while grows and not reached[goal]:
        grows = False
        for c in range(len(connections)):
            if reached[connections[c].source] and not reached[connections[c].target]:
                reached[connections[c].target] = grows = True
    return bool(reached[goal])


@kernel
def _with_gene(
    connections: Genes, innovation: int, source: int, target: int, weight: float
) -> Genes:
    """Return the connections with a new enabled one, sorted in by its innovation number."""
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
