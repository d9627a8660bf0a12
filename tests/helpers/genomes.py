"""Genomes for tests: hand-made ones, and random ones as hypothesis strategies."""

import numpy as np
from hypothesis import strategies as st

from neol.neat.breeding import Rates, breed
from neol.neat.genome import CONNECTION, NODE, Genome, Pool
from neol.neat.innovations import Innovations
from neol.neat.population import Population
from neol.neat.reproduction import Reproduction, fittest_first
from neol.neat.variation import crossover
from neol.random.pcg64 import State, new_state
from neol.spec.configuration import load_configuration
from neol.spec.constants import Neat

INPUTS, OUTPUTS = 3, 2


def neat_constants(**changes: object) -> Neat:
    """NEAT's constants from config/base.yaml, with changes."""
    neat = load_configuration("smoke").neat.model_dump() | {"weight_mutation": "config"}
    return Neat(**(neat | changes))


def genome_of(
    connections: list[tuple[int, int, int, float, bool]],
    hidden: list[int] | None = None,
    id: int = 0,
    fitness: float = 0.0,
) -> Genome:
    """A genome with INPUTS inputs, OUTPUTS outputs and these (innovation, source, target, ...)."""
    ids = [*range(INPUTS, INPUTS + OUTPUTS), *(hidden or [])]
    nodes = np.array([(node, 0.0) for node in ids], dtype=NODE)
    return Genome(id, nodes, np.array(connections, dtype=CONNECTION), fitness)


def stream(seed: int = 0) -> State:
    """The state of a random stream."""
    return new_state(np.random.default_rng(seed))


def in_order(genomes: list[Genome]) -> list[Genome]:
    """Sort genomes by `fittest_first`, in which a lower place means an older genome."""
    genomes = sorted(genomes, key=lambda genome: genome.id)
    population = Population(0, Pool.of(genomes), np.array([genome.fitness for genome in genomes]))
    return [genomes[place] for place in fittest_first(population, np.arange(len(genomes)))]


def cross(one: Genome, other: Genome, neat: Neat, seed: int = 0) -> Genome:
    """Make a child of two parents by crossover alone."""
    fitter, weaker = in_order([one, other])
    child = fitter.copy()
    crossover(
        child.nodes,
        child.connections,
        weaker.nodes,
        weaker.connections,
        Rates.of(neat).flags,
        stream(seed),
    )
    return child


def grow(seed: int, neat: Neat, rounds: int) -> tuple[list[Genome], Innovations]:
    """Six genomes after rounds of crossover and mutation with random fitness."""
    random = np.random.default_rng(seed)
    reproduction = Reproduction(INPUTS, OUTPUTS, neat)
    population = list(reproduction.initial_population(6, random))
    innovations = reproduction.first_innovations()
    state = new_state(random)
    for _ in range(rounds):
        innovations = innovations.next_generation(len(population))
        for genome in population:
            genome.fitness = float(random.integers(3))
        children = []
        for parent in population:
            mate = population[random.integers(len(population))]
            fitter, other = in_order([parent, mate])
            nodes, connections = breed(
                fitter.nodes,
                fitter.connections,
                other.nodes,
                other.connections,
                fitter is not other,
                INPUTS,
                OUTPUTS,
                reproduction.rates,
                innovations,
                state,
            )
            children.append(Genome(population[-1].id + 1 + len(children), nodes, connections))
        population = children
    return population, innovations


populations = st.builds(
    grow,
    seed=st.integers(0, 2**32 - 1),
    neat=st.builds(
        neat_constants,
        remove_connection_rate=st.sampled_from([0.0, 0.4]),
        remove_node_rate=st.sampled_from([0.0, 0.4]),
        add_node_rate=st.sampled_from([0.2, 0.9]),
        enabled_mutate_rate=st.sampled_from([0.01, 0.3]),
        weight_mutation=st.sampled_from(["off", "config", 0.3]),
        innovation=st.sampled_from(["generation", "endpoints"]),
    ),
    rounds=st.integers(0, 25),
)


def assert_sound(genome: Genome) -> None:
    """Sorted, without duplicates, dangling edges, or a cycle (disabled connections included)."""
    innovations, ids = genome.connections["innovation"], genome.nodes["id"]
    assert (np.diff(innovations) > 0).all()
    assert (np.diff(ids) > 0).all()
    assert ids[:OUTPUTS].tolist() == list(range(INPUTS, INPUTS + OUTPUTS))
    sources, targets = genome.connections["source"], genome.connections["target"]
    edges = list(zip(sources.tolist(), targets.tolist(), strict=True))
    assert len(set(edges)) == len(edges)
    hidden, outputs = set(ids[OUTPUTS:].tolist()), set(ids[:OUTPUTS].tolist())
    assert all(source in hidden or source < INPUTS for source, _ in edges)
    assert all(target in hidden | outputs for _, target in edges)
    ready = set(range(INPUTS))
    while grown := {
        node
        for node in (hidden | outputs) - ready
        if all(s in ready for s, t in edges if t == node)
    }:
        ready |= grown
    assert hidden | outputs <= ready, "a cycle"
