"""Breeding: children from parents by crossover and random mutations.

`nodes` and `connections` are a genome's arrays, NODE[n] and CONNECTION[c]; `random` is the state of
a random stream, uint64[4] (see neol.random.pcg64).
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from neol.base.kernel import kernel, record_dtype
from neol.neat.genome import CONNECTION, NODE, Pool
from neol.neat.innovations import Innovations
from neol.neat.values import ValueRates, mutate_values
from neol.neat.variation import (
    RANDOM_PARENT,
    REDRAW_IF_DISABLED,
    STANLEY,
    Flags,
    Genes,
    add_connection,
    add_node,
    crossover,
    mutate_enabled,
    remove_connection,
    remove_node,
)
from neol.random.pcg64 import State, next_double
from neol.spec.constants import Neat

PARENTS = record_dtype(
    np.dtype([("fitter", np.int64), ("other", np.int64), ("elite", np.bool_)], align=True)
)
"""Places of one child's parents; an elite is copied unchanged."""


FLAG_RULES = {
    "random_parent": RANDOM_PARENT,
    "stanley": STANLEY,
    "redraw_if_disabled": REDRAW_IF_DISABLED,
}


class Rates(NamedTuple):
    """Constants of variation."""

    flags: Flags
    add_connection: float
    add_node: float
    remove_connection: float
    remove_node: float
    mutate_enabled: float
    weight: ValueRates
    bias: ValueRates
    draws_new_bias: bool

    @classmethod
    def of(cls, neat: Neat) -> "Rates":
        """Return the configured rates; those of weights and biases follow WM_MODE (lines 22-27).

        off: no value is mutated. config: each is perturbed with its mutate rate, or replaced by a
        new one with its replace rate. A probability p: each is perturbed with p, which replaces
        both mutate rates, and none is replaced.
        """
        weight_rates = neat.weight_mutate_rate, neat.weight_replace_rate
        bias_rates = neat.bias_mutate_rate, neat.bias_replace_rate
        if neat.weight_mutation != "config":
            p = 0.0 if neat.weight_mutation == "off" else neat.weight_mutation
            weight_rates = bias_rates = p, 0.0
        return cls(
            Flags(FLAG_RULES[neat.crossover_enabled], neat.disable_rate),
            neat.add_connection_rate,
            neat.add_node_rate,
            neat.remove_connection_rate,
            neat.remove_node_rate,
            neat.enabled_mutate_rate,
            ValueRates(
                neat.weight_init_sd, neat.weight_limit, *weight_rates, neat.weight_mutate_power
            ),
            ValueRates(neat.bias_init_sd, neat.bias_limit, *bias_rates, neat.bias_mutate_power),
            neat.new_node_bias == "drawn",
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
    """Return a pool of n genomes: the children of PARENTS[n], which are places in a pool."""
    fitter, offsets = parents["fitter"], np.zeros((2, len(parents) + 1), dtype=np.int64)
    # A child has at most one node and three connections more than its fitter parent.
    most_nodes = int(np.sum(np.diff(pool.node_offset)[fitter] + 1))
    most_connections = int(np.sum(np.diff(pool.connection_offset)[fitter] + 3))
    children = Pool(
        _room(most_nodes, NODE), offsets[0], _room(most_connections, CONNECTION), offsets[1]
    )
    _breed_all(pool, parents, inputs, outputs, rates, innovations, random, children)
    return children._replace(
        nodes=children.nodes[: children.node_offset[-1]],
        connections=children.connections[: children.connection_offset[-1]],
    )


def _room(rows: int, dtype: np.dtype[np.void]) -> npt.NDArray[np.void]:
    """Return an array of at least `rows` rows, rounded up to a power of two.

    If sizes changed with every generation, malloc would ask the system for new pages each time;
    a repeated size reuses those of the last but one generation.
    """
    return np.empty(2 ** rows.bit_length(), dtype=dtype)


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
    """Write the children of PARENTS[n], which are places in a pool, into the pool `children`."""
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
    """Return the nodes and connections of one of a pool's genomes."""
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
    """Return a child's nodes and connections (lines 17-27; removal as named in Section 3.1).

    `crossed` is false if both parents are the same genome: the child then starts as its copy.
    """
    nodes, connections = fitter_nodes.copy(), fitter_connections.copy()
    if crossed:
        crossover(nodes, connections, other_nodes, other_connections, rates.flags, random)
    if next_double(random) < rates.add_connection:
        connections = add_connection(
            nodes, connections, inputs, outputs, rates.weight, innovations, random
        )
    if next_double(random) < rates.add_node:
        nodes, connections = add_node(
            nodes, connections, rates.bias, rates.draws_new_bias, innovations, random
        )
    if next_double(random) < rates.remove_connection:
        connections = remove_connection(connections, random)
    if next_double(random) < rates.remove_node:
        nodes, connections = remove_node(nodes, connections, outputs, random)
    mutate_enabled(connections, rates.mutate_enabled, random)
    mutate_values(connections["weight"], rates.weight, random)
    mutate_values(nodes["bias"], rates.bias, random)
    return nodes, connections
