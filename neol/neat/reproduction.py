"""Reproduction: offspring counts, elites, parents (Algorithm 4), and the first generation."""

import math

import numpy as np
import numpy.typing as npt

from neol.neat.breeding import PARENTS, Rates, breed_all
from neol.neat.genome import MAX_NODE_ID, initial_genome
from neol.neat.innovations import Innovations
from neol.neat.population import Population
from neol.neat.species import SpeciesSet, adjusted_fitness
from neol.neat.values import draw_values
from neol.random.pcg64 import new_state
from neol.spec.constants import Neat


class Reproduction:
    """Maker of populations, for networks of one size by one set of constants."""

    def __init__(self, inputs: int, outputs: int, neat: Neat) -> None:
        self.inputs = inputs
        self.outputs = outputs
        self.neat = neat
        self.rates = Rates.of(neat)

    def first_innovations(self) -> Innovations:
        """Return the numbers that follow those of the first generation's genes."""
        return Innovations.begin(
            self.inputs * self.outputs,
            self.inputs + self.outputs,
            by_endpoints=self.neat.innovation == "endpoints",
        )

    def initial_population(self, size: int, random: np.random.Generator) -> Population:
        """Make the first generation: minimal topologies, random weights (INITIALISEPOPULATION)."""
        weight, bias = np.empty(self.inputs * self.outputs), np.empty(self.outputs)
        state, genomes = new_state(random), []
        for id in range(size):
            draw_values(weight, self.rates.weight, state)
            draw_values(bias, self.rates.bias, state)
            genome = initial_genome(id, self.inputs, self.outputs, weight, bias)
            if self.neat.innovation == "endpoints":
                genes = genome.connections
                genes["innovation"] = genes["target"] * MAX_NODE_ID + genes["source"]
            genomes.append(genome)
        return Population.of(genomes)

    def reproduce(
        self,
        population: Population,
        species_set: SpeciesSet,
        innovations: Innovations,
        random: np.random.Generator,
    ) -> tuple[Population, Innovations]:
        """Make the next population, of the same size, from a speciated and evaluated one.

        `random` draws the parents and seeds the stream of their children's variation. The
        innovation numbers of the children come with them.
        """
        size = len(population)
        innovations = innovations.next_generation(size)
        adjusted = adjusted_fitness(species_set, population.fitness, self.neat)
        spawns = spawn_counts(adjusted, size, self.neat).tolist()
        state = new_state(random)
        parents = [
            self._parents(population, species.members, spawn, random)
            for species, spawn in zip(species_set.species, spawns, strict=True)
        ]
        pool = breed_all(
            population.pool,
            np.concatenate(parents),
            self.inputs,
            self.outputs,
            self.rates,
            innovations,
            state,
        )
        children = Population(population.first_id + size, pool, np.full(size, np.nan))
        return children, innovations

    def _parents(
        self,
        population: Population,
        members: npt.NDArray[np.int64],
        spawn: int,
        random: np.random.Generator,
    ) -> npt.NDArray[np.void]:
        """Choose the parents of a species' offspring: PARENTS[spawn], elites first.

        (Algorithm 4, lines 7-16)
        """
        neat = self.neat
        elites = members[: min(neat.elitism, spawn)]
        survivors = members[: math.ceil(neat.survival_threshold * len(members))]
        candidates = fittest_first(population, survivors)
        pairs = random.integers(len(candidates), size=(spawn - len(elites), 2))
        alone = random.random(len(pairs)) >= neat.crossover_rate
        pairs[alone, 1] = pairs[alone, 0]
        if neat.equal_parents == "smaller":
            pairs.sort(axis=1)
        else:
            first, second = population.fitness[candidates[pairs]].T
            pairs[first < second] = pairs[first < second, ::-1]
        parents = np.zeros(spawn, dtype=PARENTS)
        parents["elite"][: len(elites)] = True
        parents["fitter"] = np.concatenate([elites, candidates[pairs[:, 0]]])
        parents["other"] = np.concatenate([elites, candidates[pairs[:, 1]]])
        return parents


def fittest_first(population: Population, places: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
    """Sort genomes by the order in which they pass their structure on to a child.

    The fitter parent comes first; of equals the smaller, then the older one, or the first of two
    drawn where `equal_parents` is random.
    """
    connections = np.diff(population.pool.connection_offset)
    keys = places, connections[places], -population.fitness[places]  # lexsort: last key first
    return places[np.lexsort(keys)]


def spawn_counts(adjusted: npt.NDArray[np.float64], size: int, neat: Neat) -> npt.NDArray[np.int64]:
    """Return the offspring of each species, int64[S], with sum `size` (Algorithm 4, lines 1-4).

    spawn(s) = max(min_species_size, round(P F(s) / A)), and at least the species' elites. A
    surplus is taken from the species furthest above their exact shares, a deficit given to those
    furthest below; of equals the older species first. If even the minima exceed P, the species
    with the smallest shares get none.
    """
    total = adjusted.sum()
    even = np.full(len(adjusted), size / len(adjusted))
    share = size * adjusted / total if total > 0.0 else even
    minimum = neat.places_kept
    alive = np.zeros(len(adjusted), dtype=np.bool_)
    alive[np.argsort(-share, kind="stable")[: max(size // minimum, 1)]] = True
    minima = np.where(alive, min(minimum, size), 0)
    spawn = np.where(alive, np.maximum(minima, np.rint(share).astype(np.int64)), 0)
    while spawn.sum() > size:
        surplus = np.where(spawn > minima, spawn - share, -np.inf)
        spawn[np.argmax(surplus)] -= 1
    while spawn.sum() < size:
        deficit = np.where(alive, share - spawn, -np.inf)
        spawn[np.argmax(deficit)] += 1
    return spawn
