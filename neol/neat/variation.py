"""Variation: crossover aligned by innovation numbers, and the mutations (paper's Algorithm 4)."""

import numpy as np
import numpy.typing as npt

from neol.kernel import kernel
from neol.neat.genome import CONNECTION, NODE, Genome, Innovations
from neol.spec import Neat


def crossover(
    id: int, parent: Genome, mate: Genome, neat: Neat, random: np.random.Generator
) -> Genome:
    """A child of two parents (CROSSOVERALIGNED, Algorithm 4, line 17).

    The child has the structure of the fitter parent (of equals, the smaller, then the older one);
    weight, bias and state of a gene that both have come from either with equal chance. A gene
    disabled in a parent stays disabled with `disable_rate` (Stanley & Miikkulainen 2002).
    """
    if _rank(mate) > _rank(parent):
        parent, mate = mate, parent
    child = parent.copy(id)
    if mate is not parent:
        genes = len(child.connections)
        _cross_connections(
            child.connections, mate.connections, neat.disable_rate, random.random((genes, 2))
        )
        _cross_nodes(child.nodes, mate.nodes, random.random(len(child.nodes)))
    return child


def _rank(genome: Genome) -> tuple[float, int, int]:
    return genome.fitness, -len(genome.connections), -genome.id


def mutate(
    genome: Genome,
    inputs: int,
    outputs: int,
    neat: Neat,
    innovations: Innovations,
    random: np.random.Generator,
) -> None:
    """Mutate a child in place (Algorithm 4, lines 18-27; removal as named in Section 3.1)."""
    chance = random.random(4)
    if chance[0] < neat.add_connection_rate:
        add_connection(genome, inputs, outputs, neat, innovations, random)
    if chance[1] < neat.add_node_rate:
        add_node(genome, innovations, random)
    if chance[2] < neat.remove_connection_rate:
        remove_connection(genome, random)
    if chance[3] < neat.remove_node_rate:
        remove_node(genome, outputs, random)
    mutate_enabled(genome, neat, random)
    mutate_weights(genome, neat, random)


def add_connection(
    genome: Genome,
    inputs: int,
    outputs: int,
    neat: Neat,
    innovations: Innovations,
    random: np.random.Generator,
) -> None:
    """Connect two random nodes, unless they are connected or it would close a cycle.

    Sources are inputs and hidden nodes, targets hidden nodes and outputs; disabled connections
    count as connections, so that enabling one can never close a cycle.
    """
    hidden = genome.nodes["id"][outputs:]
    place = random.integers(inputs + len(hidden))
    source = int(place) if place < inputs else int(hidden[place - inputs])
    target = int(genome.nodes["id"][random.integers(len(genome.nodes))])
    if source == target or is_connected(genome.connections, source, target):
        return
    if reaches(genome.connections, target, source):
        return
    weight = fresh_values(neat.weight_init_sd, neat.weight_limit, random, 1)[0]
    gene = (innovations.connection(source, target), source, target, weight, True)
    _insert(genome, [gene])


def add_node(genome: Genome, innovations: Innovations, random: np.random.Generator) -> None:
    """Split a random enabled connection: it is disabled, a node with bias 0 takes its place.

    The connection into the node has weight 1, the one out of it the old weight.
    """
    (enabled,) = np.nonzero(genome.connections["enabled"])
    if not len(enabled):
        return
    split = enabled[random.integers(len(enabled))]
    genome.connections["enabled"][split] = False
    innovation, source, target, weight, _ = genome.connections[split].item()
    node, into, out_of = innovations.split(innovation)
    index = int(np.searchsorted(genome.nodes["id"], node))
    genome.nodes = np.insert(genome.nodes, index, np.array((node, 0.0), dtype=NODE))
    _insert(genome, [(into, source, node, 1.0, True), (out_of, node, target, weight, True)])


def remove_connection(genome: Genome, random: np.random.Generator) -> None:
    """Remove a random connection."""
    if len(genome.connections):
        index = random.integers(len(genome.connections))
        genome.connections = np.delete(genome.connections, index)


def remove_node(genome: Genome, outputs: int, random: np.random.Generator) -> None:
    """Remove a random hidden node and its connections."""
    hidden = len(genome.nodes) - outputs
    if not hidden:
        return
    index = outputs + random.integers(hidden)
    node = genome.nodes["id"][index]
    touching = (genome.connections["source"] == node) | (genome.connections["target"] == node)
    genome.nodes = np.delete(genome.nodes, index)
    genome.connections = genome.connections[~touching]


def mutate_enabled(genome: Genome, neat: Neat, random: np.random.Generator) -> None:
    """Draw the state of a few connections anew."""
    chance = random.random(len(genome.connections))
    chosen = chance < neat.enabled_mutate_rate
    # The chance of a chosen one is uniform below the rate: its halves give the new state.
    genome.connections["enabled"][chosen] = chance[chosen] < neat.enabled_mutate_rate / 2


def mutate_weights(genome: Genome, neat: Neat, random: np.random.Generator) -> None:
    """Mutate weights and biases as WM_MODE says (Algorithm 4, lines 22-27).

    off: not at all. config: each is perturbed with its mutate rate, or replaced by a fresh one
    with its replace rate. A probability p: each is perturbed with p in place of both mutate
    rates, and none is replaced.
    """
    if neat.weight_mutation == "off":
        return
    if neat.weight_mutation == "config":
        weight_rates = neat.weight_mutate_rate, neat.weight_replace_rate
        bias_rates = neat.bias_mutate_rate, neat.bias_replace_rate
    else:
        weight_rates = bias_rates = neat.weight_mutation, 0.0
    for values, rates, power, sd, limit in (
        (
            genome.connections["weight"],
            weight_rates,
            neat.weight_mutate_power,
            neat.weight_init_sd,
            neat.weight_limit,
        ),
        (
            genome.nodes["bias"],
            bias_rates,
            neat.bias_mutate_power,
            neat.bias_init_sd,
            neat.bias_limit,
        ),
    ):
        chance, noise = random.random(len(values)), random.standard_normal(len(values))
        perturbed, touched = chance < rates[0], chance < rates[0] + rates[1]
        mutated = np.where(perturbed, values + power * noise, sd * noise)
        values[:] = np.where(touched, np.clip(mutated, -limit, limit), values)


def fresh_values(
    sd: float, limit: float, random: np.random.Generator, size: int
) -> npt.NDArray[np.float64]:
    """Fresh weights or biases: normal with mean 0, clipped to their limit."""
    return np.clip(sd * random.standard_normal(size), -limit, limit)


def _insert(genome: Genome, genes: list[tuple[int, int, int, float, bool]]) -> None:
    """Put connections where their innovation numbers belong."""
    new = np.array(genes, dtype=CONNECTION)
    index = np.searchsorted(genome.connections["innovation"], new["innovation"])
    genome.connections = np.insert(genome.connections, index, new)


@kernel
def is_connected(connections: npt.NDArray[np.void], source: int, target: int) -> bool:
    """Whether the connection exists, enabled or not."""
    for c in range(len(connections)):
        if connections[c].source == source and connections[c].target == target:
            return True
    return False


@kernel
def reaches(connections: npt.NDArray[np.void], start: int, goal: int) -> bool:
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
def _cross_connections(
    child: npt.NDArray[np.void],
    mate: npt.NDArray[np.void],
    disable_rate: float,
    chance: npt.NDArray[np.float64],
) -> None:
    m = 0
    for c in range(len(child)):
        while m < len(mate) and mate[m].innovation < child[c].innovation:
            m += 1
        if m == len(mate) or mate[m].innovation != child[c].innovation:
            continue
        if not (child[c].enabled and mate[m].enabled):
            child[c].enabled = chance[c, 1] >= disable_rate
        if chance[c, 0] < 0.5:
            child[c].weight = mate[m].weight


@kernel
def _cross_nodes(
    child: npt.NDArray[np.void], mate: npt.NDArray[np.void], chance: npt.NDArray[np.float64]
) -> None:
    m = 0
    for n in range(len(child)):
        while m < len(mate) and mate[m].id < child[n].id:
            m += 1
        if m < len(mate) and mate[m].id == child[n].id and chance[n] < 0.5:
            child[n].bias = mate[m].bias
