"""Species: compatibility distance, speciation, stagnation and fitness sharing (Algorithm 3)."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from neol.base.kernel import kernel
from neol.neat.genome import Genome, Pool
from neol.neat.population import Population
from neol.spec.constants import Neat

Fitness = npt.NDArray[np.float64]
"""Fitness of a population's genomes, float64[P], or of its species, float64[S]."""


class Species(NamedTuple):
    """Genomes that are close to one representative."""

    id: int
    representative: Genome
    """Copy of the founder, or of the genome nearest to the last representative."""
    best_fitness: float = -np.inf
    """Best fitness of any member so far."""
    stagnant: int = 0
    """Generations since `best_fitness` last rose."""
    members: npt.NDArray[np.int64] = np.empty(0, dtype=np.int64)
    """Places of this generation's members in the population, sorted by fitness."""


class SpeciesSet(NamedTuple):
    """All species of a run, oldest first, and the id of the next one."""

    species: tuple[Species, ...] = ()
    next_id: int = 0


def distance(one: Genome, other: Genome, neat: Neat) -> float:
    """Compatibility distance delta = c1 (E + D) / N + c3 mean|w - w'| (Algorithm 3, line 3).

    E + D counts the connections that only one genome has; the mean is over matching connections.
    N is the number of matching connections (at least 1), or with `larger_genome` the larger
    genome's number of connections.
    `all_genes` is the distance of neat-python 0.92 (see NeatConstants).
    """
    return float(distances(Pool.of([one]), other, neat)[0])


def distances(pool: Pool, representative: Genome, neat: Neat) -> npt.NDArray[np.float64]:
    """Return the distance of each genome of a pool to a representative, float64[P]."""
    found = np.empty(len(pool.connection_offset) - 1)
    if neat.distance == "all_genes":
        _distances_of_all_genes(
            pool,
            representative.nodes,
            representative.connections,
            neat.disjoint_coefficient,
            neat.weight_coefficient,
            found,
        )
        return found
    _distances(
        pool.connections,
        pool.connection_offset,
        representative.connections,
        neat.disjoint_coefficient,
        neat.weight_coefficient,
        neat.distance_normaliser == "larger_genome",
        found,
    )
    return found


def speciate(population: Population, species_set: SpeciesSet, neat: Neat) -> SpeciesSet:
    """Assign each genome to the nearest species within the threshold (Algorithm 3, lines 1-8).

    A species keeps its representative, or takes the genome nearest to it as the next one; a genome
    far from all representatives founds a new species. Of equally near species the oldest wins.
    Members are sorted by fitness, then age; empty species are removed.
    """
    species, next_id = list(species_set.species), species_set.next_id
    if neat.representative == "nearest":
        species = _choose_representatives(population, species, neat)
    nearest = np.full(len(population), np.inf)
    home = np.zeros(len(population), dtype=np.int64)

    def offer(index: int, first: int) -> None:
        """Move genomes from `first` on to this species if it is nearer than their own."""
        offered = distances(population.pool, species[index].representative, neat)
        nearer = offered < nearest
        nearer[:first] = False
        nearest[nearer] = offered[nearer]
        home[nearer] = index

    for index in range(len(species)):
        offer(index, first=0)
    for place in range(len(population)):
        if nearest[place] > neat.compatibility_threshold:
            species.append(Species(next_id, population[place].copy()))
            next_id += 1
            offer(len(species) - 1, first=place)

    best_first = np.argsort(-population.fitness, kind="stable")
    alive = []
    for index, each in enumerate(species):
        members = best_first[home[best_first] == index]
        if len(members):
            best = float(population.fitness[members[0]])
            stagnant = 0 if best > each.best_fitness else each.stagnant + 1
            best = max(best, each.best_fitness)
            alive.append(each._replace(best_fitness=best, stagnant=stagnant, members=members))
    return SpeciesSet(tuple(alive), next_id)


def _choose_representatives(
    population: Population, species: list[Species], neat: Neat
) -> list[Species]:
    """Give each species, the oldest first, the nearest genome that is still free."""
    free, chosen = np.ones(len(population), dtype=np.bool_), []
    for each in species:
        away = distances(population.pool, each.representative, neat)
        place = int(np.argmin(np.where(free, away, np.inf)))
        free[place] = False
        chosen.append(each._replace(representative=population[place].copy()))
    return chosen


def remove_stagnant(species_set: SpeciesSet, fitness: Fitness, neat: Neat) -> SpeciesSet:
    """Remove species stagnant for more than G_stag generations (Algorithm 3, lines 7-8).

    The `species_elitism` best species stay, and always the best one.
    """
    ranked = sorted(species_set.species, key=lambda s: (-fitness[s.members[0]], s.id))
    spared = {species.id for species in ranked[: max(neat.species_elitism, 1)]}
    stay = (s for s in species_set.species if s.id in spared or s.stagnant <= neat.max_stagnation)
    return species_set._replace(species=tuple(stay))


def adjusted_fitness(species_set: SpeciesSet, fitness: Fitness, neat: Neat) -> Fitness:
    """Return F_adj of each species, float64[S], by explicit fitness sharing (Algorithm 3, line 9).

    Fitness is shifted by its minimum, so that shares are never negative. With `stanley`,
    F_adj = sum(f / |s|); `literal` is the paper's formula, the mean of f / |s|, which divides by
    the species' size twice.
    """
    of_species = [fitness[species.members] for species in species_set.species]
    minimum = min(values.min() for values in of_species)
    shared = [(values - minimum) / len(values) for values in of_species]
    total = np.sum if neat.sharing == "stanley" else np.mean
    return np.array([total(values) for values in shared])


@kernel
def _distances(
    connections: npt.NDArray[np.void],
    offset: npt.NDArray[np.int64],
    representative: npt.NDArray[np.void],
    c1: float,
    c3: float,
    by_larger_genome: bool,
    distances: npt.NDArray[np.float64],
) -> None:
    for genome in range(len(distances)):
        matching, difference = 0, 0.0
        i, end, j = offset[genome], offset[genome + 1], 0
        while i < end and j < len(representative):
            if connections[i].innovation == representative[j].innovation:
                matching += 1
                difference += abs(connections[i].weight - representative[j].weight)
                i += 1
                j += 1
            elif connections[i].innovation < representative[j].innovation:
                i += 1
            else:
                j += 1
        size = end - offset[genome]
        unmatched = size + len(representative) - 2 * matching  # E + D
        n = max(size, len(representative)) if by_larger_genome else matching
        distances[genome] = c1 * unmatched / max(n, 1) + c3 * difference / max(matching, 1)


@kernel
def _distances_of_all_genes(
    pool: Pool,
    representative_nodes: npt.NDArray[np.void],
    representative: npt.NDArray[np.void],
    c1: float,
    c3: float,
    distances: npt.NDArray[np.float64],
) -> None:
    """Write the distances of neat-python 0.92: a sum over nodes plus one over connections."""
    all_nodes, node_offset, all_connections, connection_offset = pool
    for genome in range(len(distances)):
        nodes = all_nodes[node_offset[genome] : node_offset[genome + 1]]
        matching, difference, j = 0, 0.0, 0
        for i in range(len(nodes)):
            while j < len(representative_nodes) and representative_nodes[j].id < nodes[i].id:
                j += 1
            if j < len(representative_nodes) and representative_nodes[j].id == nodes[i].id:
                matching += 1
                difference += abs(nodes[i].bias - representative_nodes[j].bias)
        unmatched = len(nodes) + len(representative_nodes) - 2 * matching
        larger = max(len(nodes), len(representative_nodes))
        distances[genome] = (c1 * unmatched + c3 * difference) / max(larger, 1)

        connections = all_connections[connection_offset[genome] : connection_offset[genome + 1]]
        matching, difference, j = 0, 0.0, 0
        for i in range(len(connections)):
            gene = connections[i]
            while j < len(representative) and representative[j].innovation < gene.innovation:
                j += 1
            if j < len(representative) and representative[j].innovation == gene.innovation:
                matching += 1
                difference += abs(gene.weight - representative[j].weight)
                difference += gene.enabled != representative[j].enabled
        unmatched = len(connections) + len(representative) - 2 * matching
        larger = max(len(connections), len(representative))
        distances[genome] += (c1 * unmatched + c3 * difference) / max(larger, 1)
