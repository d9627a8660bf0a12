"""Reproduction: offspring counts, elites, parents (paper's Algorithm 4), and generation 0."""

import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from neol.neat.genome import Genome, initial_genome, join, split
from neol.neat.innovations import Innovations
from neol.neat.species import SpeciesSet, adjusted_fitness, remove_stagnant
from neol.neat.values import fresh_values
from neol.neat.variation import Rates, breed_all
from neol.pcg64 import State, new_state
from neol.spec import Neat


class Reproduction:
    """Makes populations: the only place that hands out genome ids and innovation numbers."""

    def __init__(self, inputs: int, outputs: int, neat: Neat) -> None:
        self.inputs = inputs
        self.outputs = outputs
        self.neat = neat
        self.rates = Rates.of(neat)
        # Generation 0's genes have taken the first numbers.
        self.innovations = Innovations.begin(inputs * outputs, inputs + outputs)
        self.next_genome = 0

    def initial_population(self, size: int, random: np.random.Generator) -> list[Genome]:
        """Generation 0: minimal topologies with random weights (INITIALISEPOPULATION)."""
        rates, state = self.rates, new_state(random)
        return [
            initial_genome(
                self._new_id(),
                self.inputs,
                self.outputs,
                fresh_values(self.inputs * self.outputs, rates.weight, state),
                fresh_values(self.outputs, rates.bias, state),
            )
            for _ in range(size)
        ]

    def reproduce(
        self, species_set: SpeciesSet, size: int, random: np.random.Generator
    ) -> list[Genome]:
        """The next population, of exactly `size` genomes, from speciated and evaluated parents."""
        self.innovations = self.innovations.next_generation(size)
        remove_stagnant(species_set, self.neat)
        spawns = spawn_counts(adjusted_fitness(species_set, self.neat), size, self.neat)
        state = new_state(random)
        return [
            child
            for species, spawn in zip(species_set.species, spawns, strict=True)
            for child in self._offspring(species.members, int(spawn), random, state)
        ]

    def _offspring(
        self, members: list[Genome], spawn: int, random: np.random.Generator, state: State
    ) -> list[Genome]:
        """One species' part of the next population (Algorithm 4, lines 7-28).

        `random` draws the parents, `state` is the stream of their children's variation.
        """
        neat = self.neat
        elites = [elite.copy(self._new_id()) for elite in members[: min(neat.elitism, spawn)]]
        parents = fittest_first(members[: math.ceil(neat.survival_threshold * len(members))])
        pairs = random.integers(len(parents), size=(spawn - len(elites), 2))
        alone = random.random(len(pairs)) >= neat.crossover_rate
        pairs[alone, 1] = pairs[alone, 0]
        nodes, connections = breed_all(
            *join([parent.nodes for parent in parents]),
            *join([parent.connections for parent in parents]),
            np.sort(pairs),
            self.inputs,
            self.outputs,
            self.rates,
            self.innovations,
            state,
        )
        children = zip(split(*nodes), split(*connections), strict=True)
        return elites + [Genome(self._new_id(), *genes) for genes in children]

    def _new_id(self) -> int:
        self.next_genome += 1
        return self.next_genome - 1


def fittest_first(parents: Sequence[Genome]) -> list[Genome]:
    """Parents in the order in which they give their children the structure.

    The fitter one does; of equals the smaller, then the older one.
    """
    return sorted(parents, key=lambda genome: (-genome.fitness, len(genome.connections), genome.id))


def spawn_counts(adjusted: npt.NDArray[np.float64], size: int, neat: Neat) -> npt.NDArray[np.int64]:
    """Offspring of each species, int64[S], summing to `size` exactly (Algorithm 4, lines 1-4).

    spawn(s) = max(min_species_size, round(P F(s) / A)), where no species gets less than its
    elites. What is then too many comes off the species furthest above their exact shares,
    what is missing goes to those furthest below; of equals the older species first. Where even
    the minima exceed P, the species with the least shares get nothing.
    """
    total = adjusted.sum()
    even = np.full(len(adjusted), size / len(adjusted))
    share = size * adjusted / total if total > 0.0 else even
    minimum = max(neat.min_species_size, neat.elitism)
    alive = np.zeros(len(adjusted), dtype=np.bool_)
    alive[np.argsort(-share, kind="stable")[: max(size // max(minimum, 1), 1)]] = True
    minima = np.where(alive, min(minimum, size), 0)
    spawn = np.where(alive, np.maximum(minima, np.rint(share).astype(np.int64)), 0)
    while spawn.sum() > size:
        surplus = np.where(spawn > minima, spawn - share, -np.inf)
        spawn[np.argmax(surplus)] -= 1
    while spawn.sum() < size:
        deficit = np.where(alive, share - spawn, -np.inf)
        spawn[np.argmax(deficit)] += 1
    return spawn
