"""neat-python 0.92 evolves while our engine plays the episodes.

So nothing but NEAT differs from a run of ours. `make agreement` installs the library, in a folder
of its own beside the environment.
"""

import random
from collections.abc import Iterator
from typing import Any

import gymnasium
import numpy as np

from neol.neat.decoding import decode
from neol.neat.genome import CONNECTION, NODE, Genome, Pool
from neol.network.forward import Networks
from neol.random.seeds import episode_seeds
from neol.rollout.engine import Engine
from neol.rollout.environment import network_size
from neol.spec.run_spec import RunSpec

Generation = tuple[float, float, int, float, float]
"""Best and mean fitness, species, mean nodes (hidden and outputs), mean enabled connections."""


def evolve(spec: RunSpec, engine: Engine) -> Iterator[Generation]:
    """A run of the library with a specification's constants, generation by generation."""
    from benchmarks import peer

    environment = gymnasium.make(spec.task.environment)
    config = peer.configuration(spec, environment)
    environment.close()
    random.seed(spec.seed)
    population = peer.neat.Population(config)
    done: list[Generation] = []

    def evaluate(genomes: list[tuple[int, Any]], config: Any) -> None:
        del config
        size, episodes = len(genomes), spec.evaluation.episodes
        seeds = episode_seeds(spec.seed, len(done) + 1, size, episodes)
        played = networks([genome for _, genome in genomes], spec)
        fitness = engine.evaluate(played, seeds, spec.plasticity).returns.mean(axis=1)
        for (_, genome), value in zip(genomes, fitness.tolist(), strict=True):
            genome.fitness = value
        species = len(population.species.species)
        sizes = np.mean([genome.size() for _, genome in genomes], axis=0)
        done.append((float(fitness.max()), float(fitness.mean()), species, *sizes))

    for _ in range(spec.generations):
        population.run(evaluate, 1)
        yield done[-1]


def networks(genomes: list[Any], spec: RunSpec) -> Networks:
    """The library's genomes as networks that our engine plays."""
    inputs, outputs = network_size(spec.task)
    translated = [translate(genome, inputs, outputs) for genome in genomes]
    return decode(Pool.of(translated), inputs, outputs, spec.network)[0]


def translate(genome: Any, inputs: int, outputs: int) -> Genome:
    """A genome of the library as one of ours, which computes the same.

    The library lets an output feed a hidden node. Our outputs feed nothing: a hidden node with the
    output's bias and connections takes its place as a source.
    """
    feeding = {source for source, _ in genome.connections if 0 <= source < outputs}
    beyond = max(genome.nodes) + 1

    def number(key: int) -> int:
        return -1 - key if key < 0 else inputs + key

    def source_number(key: int) -> int:
        return number(beyond + key if key in feeding else key)

    biases = {number(key): node.bias for key, node in genome.nodes.items()}
    biases |= {source_number(key): genome.nodes[key].bias for key in feeding}
    links = [
        (source_number(source), place, gene.weight, gene.enabled)
        for (source, target), gene in genome.connections.items()
        for place in {number(target), source_number(target)}
    ]
    nodes = np.array(sorted(biases.items()), dtype=NODE)
    connections = np.array(
        [(innovation, *link) for innovation, link in enumerate(links)], dtype=CONNECTION
    )
    return Genome(0, nodes, connections)
