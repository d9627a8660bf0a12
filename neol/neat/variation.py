"""Variation: crossover aligned by innovation numbers, and the mutations (paper's Algorithm 4)."""

import numpy as np
import numpy.typing as npt

from neol.kernel import kernel
from neol.neat.genome import NODE, Genome, Innovations
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
    innovation = innovations.connection(source, target)
    genome.connections = _with_gene(genome.connections, innovation, source, target, weight)


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
    # A node of this generation has the highest id so far, so it comes last.
    genome.nodes = np.append(genome.nodes, np.array((node, 0.0), dtype=NODE))
    genome.connections = _with_gene(genome.connections, into, source, node, 1.0)
    genome.connections = _with_gene(genome.connections, out_of, node, target, weight)


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
    weight, bias = genome.connections["weight"], genome.nodes["bias"]
    _perturb(
        weight,
        *weight_rates,
        neat.weight_mutate_power,
        neat.weight_init_sd,
        neat.weight_limit,
        random.random(len(weight)),
        random.standard_normal(len(weight)),
    )
    _perturb(
        bias,
        *bias_rates,
        neat.bias_mutate_power,
        neat.bias_init_sd,
        neat.bias_limit,
        random.random(len(bias)),
        random.standard_normal(len(bias)),
    )


def fresh_values(
    sd: float, limit: float, random: np.random.Generator, size: int
) -> npt.NDArray[np.float64]:
    """Fresh weights or biases: normal with mean 0, clipped to their limit."""
    return np.clip(sd * random.standard_normal(size), -limit, limit)


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


@kernel
def _with_gene(
    connections: npt.NDArray[np.void], innovation: int, source: int, target: int, weight: float
) -> npt.NDArray[np.void]:
    """The connections with one more, enabled, where its innovation number belongs."""
    longer = np.empty(len(connections) + 1, dtype=connections.dtype)
    c = len(connections)
    while c > 0 and connections[c - 1].innovation > innovation:
        longer[c] = connections[c - 1]
        c -= 1
    longer[:c] = connections[:c]
    longer[c].innovation = innovation
    longer[c].source = source
    longer[c].target = target
    longer[c].weight = weight
    longer[c].enabled = True
    return longer


@kernel
def _perturb(
    values: npt.NDArray[np.float64],
    mutate_rate: float,
    replace_rate: float,
    power: float,
    sd: float,
    limit: float,
    chance: npt.NDArray[np.float64],
    noise: npt.NDArray[np.float64],
) -> None:
    """Perturb or replace some values in place; `chance` is uniform, `noise` standard normal."""
    for i in range(len(values)):
        if chance[i] >= mutate_rate + replace_rate:
            continue
        if chance[i] < mutate_rate:
            mutated = values[i] + power * noise[i]
        else:
            mutated = sd * noise[i]
        values[i] = min(max(mutated, -limit), limit)
