"""Reproduction: offspring counts, elites, parents (paper's Algorithm 4), and generation 0."""

import math

import numpy as np
import numpy.typing as npt

from neol.neat.genome import Genome, Innovations, initial_genome, initial_innovations
from neol.neat.species import SpeciesSet, adjusted_fitness, remove_stagnant
from neol.neat.variation import crossover, fresh_values, mutate
from neol.spec import Neat


class Reproduction:
    """Makes populations: the only place that hands out genome ids and innovation numbers."""

    def __init__(self, inputs: int, outputs: int, neat: Neat) -> None:
        self.inputs = inputs
        self.outputs = outputs
        self.neat = neat
        self.innovations: Innovations = initial_innovations(inputs, outputs)
        self.next_genome = 0

    def initial_population(self, size: int, random: np.random.Generator) -> list[Genome]:
        """Generation 0: minimal topologies with random weights (INITIALISEPOPULATION)."""
        neat, connections = self.neat, self.inputs * self.outputs
        return [
            initial_genome(
                self._new_id(),
                self.inputs,
                self.outputs,
                fresh_values(neat.weight_init_sd, neat.weight_limit, random, connections),
                fresh_values(neat.bias_init_sd, neat.bias_limit, random, self.outputs),
            )
            for _ in range(size)
        ]

    def reproduce(
        self, species_set: SpeciesSet, size: int, random: np.random.Generator
    ) -> list[Genome]:
        """The next population, of exactly `size` genomes, from speciated and evaluated parents."""
        self.innovations.begin_generation()
        remove_stagnant(species_set, self.neat)
        spawns = spawn_counts(adjusted_fitness(species_set, self.neat), size, self.neat)
        return [
            child
            for species, spawn in zip(species_set.species, spawns, strict=True)
            for child in self._offspring(species.members, int(spawn), random)
        ]

    def _offspring(
        self, members: list[Genome], spawn: int, random: np.random.Generator
    ) -> list[Genome]:
        """One species' part of the next population (Algorithm 4, lines 7-28)."""
        neat = self.neat
        children = [elite.copy(self._new_id()) for elite in members[: min(neat.elitism, spawn)]]
        parents = members[: math.ceil(neat.survival_threshold * len(members))]
        while len(children) < spawn:
            parent = mate = parents[random.integers(len(parents))]
            if random.random() < neat.crossover_rate:
                mate = parents[random.integers(len(parents))]
            child = crossover(self._new_id(), parent, mate, neat, random)
            mutate(child, self.inputs, self.outputs, neat, self.innovations, random)
            children.append(child)
        return children

    def _new_id(self) -> int:
        self.next_genome += 1
        return self.next_genome - 1


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
