"""Species: compatibility distance, speciation, stagnation and fitness sharing (Algorithm 3)."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from neol.kernel import kernel
from neol.neat.genome import Genome
from neol.spec import Neat


@dataclass(slots=True)
class Species:
    """Genomes that are close to one representative."""

    id: int
    representative: Genome
    """A copy of the genome that founded the species; it stays for the species' life."""
    best_fitness: float = -np.inf
    """Best fitness of a member so far."""
    stagnant: int = 0
    """Generations since `best_fitness` last rose."""
    members: list[Genome] = field(default_factory=list)
    """This generation's members, best first."""


@dataclass(slots=True)
class SpeciesSet:
    """All species of a run, by age, and the id that the next one gets."""

    species: list[Species] = field(default_factory=list)
    next_id: int = 0


def distance(one: Genome, other: Genome, neat: Neat) -> float:
    """Compatibility distance delta = c1 (E + D) / N + c3 mean|w - w'| (Algorithm 3, line 3).

    E + D counts the connections that only one has; the mean runs over those that both have. N is
    their number (at least 1), or with `larger_genome` the larger genome's number of connections.
    """
    matching, difference = _match(one.connections, other.connections)
    sizes = len(one.connections), len(other.connections)
    unmatched = sum(sizes) - 2 * matching
    normaliser = matching if neat.distance_normaliser == "matching" else max(sizes)
    mean_difference = difference / max(matching, 1)
    return (
        neat.disjoint_coefficient * unmatched / max(normaliser, 1)
        + neat.weight_coefficient * mean_difference
    )


def speciate(population: Sequence[Genome], species_set: SpeciesSet, neat: Neat) -> None:
    """Assign each genome to the nearest species within the threshold (Algorithm 3, lines 1-8).

    Species keep their representatives from generation to generation; a genome far from all of
    them founds a new species. Of equally near species the oldest wins. Members are sorted by
    fitness, then age; empty species die out.
    """
    for species in species_set.species:
        species.members = []
    for genome in population:
        distances = [distance(genome, s.representative, neat) for s in species_set.species]
        nearest = int(np.argmin(distances)) if distances else 0
        if distances and distances[nearest] <= neat.compatibility_threshold:
            species_set.species[nearest].members.append(genome)
        else:
            founder = genome.copy(genome.id)
            species_set.species.append(Species(species_set.next_id, founder, members=[genome]))
            species_set.next_id += 1
    species_set.species = [species for species in species_set.species if species.members]
    for species in species_set.species:
        species.members.sort(key=lambda genome: (-genome.fitness, genome.id))
        best = species.members[0].fitness
        species.stagnant = 0 if best > species.best_fitness else species.stagnant + 1
        species.best_fitness = max(best, species.best_fitness)


def remove_stagnant(species_set: SpeciesSet, neat: Neat) -> None:
    """Remove species stagnant for more than G_stag generations (Algorithm 3, lines 7-8).

    The `species_elitism` best species, and at least the best one, are spared.
    """
    ranked = sorted(species_set.species, key=lambda s: (-s.members[0].fitness, s.id))
    spared = {species.id for species in ranked[: max(neat.species_elitism, 1)]}
    species_set.species = [
        species
        for species in species_set.species
        if species.id in spared or species.stagnant <= neat.max_stagnation
    ]


def adjusted_fitness(species_set: SpeciesSet, neat: Neat) -> npt.NDArray[np.float64]:
    """Explicit fitness sharing: F_adj of each species, float64[S] (Algorithm 3, line 9).

    Fitness is shifted by its minimum, so that shares are never negative. With `stanley` a
    species' members share their summed fitness, F_adj = sum(f / |s|); `literal` takes the
    paper's formula, the mean of f / |s|, which divides by the size twice.
    """
    fitness = [np.array([g.fitness for g in s.members]) for s in species_set.species]
    minimum = min(values.min() for values in fitness)
    shared = [(values - minimum) / len(values) for values in fitness]
    total = np.sum if neat.sharing == "stanley" else np.mean
    return np.array([total(values) for values in shared])


@kernel
def _match(one: npt.NDArray[np.void], other: npt.NDArray[np.void]) -> tuple[int, float]:
    """How many innovation numbers both have, and the summed difference of those weights."""
    matching, difference = 0, 0.0
    i, j = 0, 0
    while i < len(one) and j < len(other):
        if one[i].innovation == other[j].innovation:
            matching += 1
            difference += abs(one[i].weight - other[j].weight)
            i += 1
            j += 1
        elif one[i].innovation < other[j].innovation:
            i += 1
        else:
            j += 1
    return matching, difference
