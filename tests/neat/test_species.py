"""Distance, speciation, stagnation and sharing, computed by hand and by a plain twin."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from neol.neat.genome import Genome
from neol.neat.innovations import Innovations
from neol.neat.population import Population
from neol.neat.species import (
    Species,
    SpeciesSet,
    adjusted_fitness,
    distance,
    remove_stagnant,
    speciate,
)
from neol.spec.constants import Neat
from tests.helpers.genomes import genome_of, neat_constants, populations

NEAT = neat_constants(disjoint_coefficient=1.0, weight_coefficient=0.5)

ONE = genome_of([(0, 0, 3, 1.0, True), (1, 1, 3, 2.0, True), (2, 2, 3, 0.0, True)])
OTHER = genome_of(
    [(0, 0, 3, 2.0, True), (2, 2, 3, 3.0, False), (3, 0, 4, 9.0, True), (5, 1, 4, 9.0, True)]
)


def test_distance_by_hand() -> None:
    # matching 0 and 2, |1 - 2| and |0 - 3|: mean 2; unmatched 1, 3 and 5
    assert distance(ONE, OTHER, NEAT) == 1.0 * 3 / 2 + 0.5 * 2.0
    larger = neat_constants(distance_normaliser="larger_genome")
    assert distance(ONE, OTHER, larger) == 1.0 * 3 / 4 + 0.5 * 2.0


def test_distance_of_all_genes_by_hand() -> None:
    """neat-python 0.92: nodes 3 and 4 match, 5 and 6 do not; the flags of gene 2 differ."""
    one = genome_of(ONE.connections.tolist(), hidden=[5])
    other = genome_of(OTHER.connections.tolist(), hidden=[6, 7])
    one.nodes["bias"], other.nodes["bias"] = [1.0, 0.0, 5.0], [0.5, 3.0, 0.0, 0.0]
    nodes = (1.0 * 3 + 0.5 * (0.5 + 3.0)) / 4
    connections = (1.0 * 3 + 0.5 * (1.0 + 3.0 + 1.0)) / 4
    found = distance(one, other, neat_constants(distance="all_genes"))
    assert found == pytest.approx(nodes + connections, rel=1e-15)


def test_distance_without_a_matching_gene() -> None:
    assert distance(ONE, genome_of([(9, 0, 3, 1.0, True)]), NEAT) == 4.0
    assert distance(ONE, genome_of([]), NEAT) == 3.0
    assert distance(genome_of([]), genome_of([]), NEAT) == 0.0


@given(populations)
@settings(max_examples=30, deadline=None)
def test_distance_is_symmetric_and_zero_to_itself(
    grown: tuple[list[Genome], Innovations],
) -> None:
    one, other = grown[0][:2]
    assert distance(one, other, NEAT) == distance(other, one, NEAT) >= 0.0
    assert distance(one, one, NEAT) == 0.0


def plain_distance(one: Genome, other: Genome, neat: Neat) -> float:
    """Compute the distance gene by gene (Algorithm 3, line 3)."""
    if neat.distance == "all_genes":
        return plain_distance_of_all_genes(one, other, neat)
    ours, theirs = (
        {int(gene["innovation"]): float(gene["weight"]) for gene in genome.connections}
        for genome in (one, other)
    )
    matching = sorted(ours.keys() & theirs.keys())
    larger = max(len(ours), len(theirs))
    n = larger if neat.distance_normaliser == "larger_genome" else len(matching)
    unmatched = neat.disjoint_coefficient * len(ours.keys() ^ theirs.keys())
    difference = neat.weight_coefficient * sum(abs(ours[each] - theirs[each]) for each in matching)
    return unmatched / max(n, 1) + difference / max(len(matching), 1)


def plain_distance_of_all_genes(one: Genome, other: Genome, neat: Neat) -> float:
    """Compute the distance of neat-python 0.92."""
    total = 0.0
    for ours, theirs in (
        [{int(id): (float(bias), 0.0) for id, bias in each.nodes} for each in (one, other)],
        [
            {int(c["innovation"]): (float(c["weight"]), float(c["enabled"])) for c in genes}
            for genes in (one.connections, other.connections)
        ],
    ):
        difference = 0.0
        for key in sorted(ours.keys() & theirs.keys()):
            value, flag = (abs(a - b) for a, b in zip(ours[key], theirs[key], strict=True))
            difference = difference + value + flag
        unmatched = neat.disjoint_coefficient * len(ours.keys() ^ theirs.keys())
        larger = max(len(ours), len(theirs), 1)
        total += (unmatched + neat.weight_coefficient * difference) / larger
    return total


def plain_species(genomes: list[Genome], founders: list[Genome], neat: Neat) -> list[int]:
    """Assign genomes one after the other; new founders join the list."""
    homes, left = [], list(genomes)
    if neat.representative == "nearest":
        for place, last in enumerate(founders):
            away = [plain_distance(genome, last, neat) for genome in left]
            founders[place] = left.pop(away.index(min(away)))
    for genome in genomes:
        offered = [plain_distance(genome, founder, neat) for founder in founders]
        if not offered or min(offered) > neat.compatibility_threshold:
            founders.append(genome)
            offered.append(0.0)
        homes.append(offered.index(min(offered)))
    return homes


@given(
    populations,
    st.sampled_from([0.5, 1.5, 3.0]),
    st.sampled_from(["connections", "all_genes"]),
    st.sampled_from(["matching", "larger_genome"]),
    st.sampled_from(["founder", "nearest"]),
)
@settings(max_examples=30, deadline=None)
def test_speciation_is_that_of_a_plain_twin(
    grown: tuple[list[Genome], Innovations],
    threshold: float,
    genes: str,
    normaliser: str,
    representative: str,
) -> None:
    genomes, _ = grown
    neat = neat_constants(
        compatibility_threshold=threshold,
        distance=genes,
        distance_normaliser=normaliser,
        representative=representative,
    )
    species_set, founders = SpeciesSet(), list[Genome]()
    for generation in (genomes[: len(genomes) // 2], genomes[::-1]):
        generation = [replace(genome, id=id) for id, genome in enumerate(generation)]
        population = Population.of(generation)
        population = replace(population, fitness=np.zeros(len(generation)))
        species_set = speciate(population, species_set, neat)
        homes = plain_species(generation, founders, neat)
        assert dict(members_of(species_set)) == {
            id: [place for place, home in enumerate(homes) if home == id] for id in set(homes)
        }


def weighted(weights: list[float], fitness: list[float] | None = None) -> Population:
    """Return genomes of a single connection with these weights."""
    genomes = [genome_of([(0, 0, 3, weight, True)], id=i) for i, weight in enumerate(weights)]
    population = Population.of(genomes)
    return replace(population, fitness=np.array(fitness or [0.0] * len(weights)))


def members_of(species_set: SpeciesSet) -> list[tuple[int, list[int]]]:
    """Return each species' id and its members' places."""
    return [(species.id, species.members.tolist()) for species in species_set.species]


def test_speciation_keeps_representatives_and_takes_the_nearest() -> None:
    species_set = SpeciesSet()
    # threshold 3.0 is a weight difference of 6
    species_set = speciate(weighted([0.0, 5.9, 20.0], [1.0, 3.0, 2.0]), species_set, NEAT)
    assert members_of(species_set) == [(0, [1, 0]), (1, [2])]

    # 6.5 is within reach of genome 1 but not of the representative, genome 0
    species_set = speciate(weighted([6.5, -1.0, 14.1]), species_set, NEAT)
    assert members_of(species_set) == [(0, [1]), (1, [2]), (2, [0])]

    # 10.2 lies between the second and the third species, nearer to the third
    species_set = speciate(weighted([10.2]), species_set, NEAT)
    assert members_of(species_set) == [(2, [0])]
    species_set = speciate(weighted([99.0]), species_set, NEAT)
    assert members_of(species_set) == [(3, [0])], "ids of dead species do not come back"


def test_the_nearest_genome_can_become_the_next_representative() -> None:
    neat = neat_constants(
        disjoint_coefficient=1.0, weight_coefficient=0.5, representative="nearest"
    )
    species_set = SpeciesSet()
    species_set = speciate(weighted([0.0, 20.0]), species_set, neat)
    # 9.0 and 14.0 are the nearest to 0.0 and to 20.0
    species_set = speciate(weighted([12.0, 9.0, 14.0]), species_set, neat)
    assert [s.representative.connections["weight"][0] for s in species_set.species] == [9.0, 14.0]
    assert members_of(species_set) == [(0, [1]), (1, [0, 2])]
    # both are nearest to 8.0, which the older one takes
    species_set = speciate(weighted([8.0, 1.0]), species_set, neat)
    assert [s.representative.connections["weight"][0] for s in species_set.species] == [8.0, 1.0]


def test_of_equally_near_species_the_oldest_wins() -> None:
    species_set = SpeciesSet()
    species_set = speciate(weighted([0.0, 10.0]), species_set, NEAT)
    species_set = speciate(weighted([5.0, 9.0]), species_set, NEAT)
    assert members_of(species_set) == [(0, [0]), (1, [1])]


def test_a_representative_is_a_copy() -> None:
    founders = weighted([0.0])
    species_set = SpeciesSet()
    species_set = speciate(founders, species_set, NEAT)
    founders.pool.connections["weight"] = 100.0
    species_set = speciate(weighted([1.0]), species_set, NEAT)
    assert members_of(species_set) == [(0, [0])]


def test_members_are_sorted_by_fitness_then_age() -> None:
    species_set = SpeciesSet()
    species_set = speciate(weighted([0.0] * 4, [1.0, 3.0, 3.0, 2.0]), species_set, NEAT)
    assert members_of(species_set) == [(0, [1, 2, 3, 0])]


def test_stagnation_counts_generations_without_a_better_best() -> None:
    species_set = SpeciesSet()
    counts = []
    for fitness in (1.0, 1.0, 0.5, 2.0, 2.0):
        species_set = speciate(weighted([0.0], [fitness]), species_set, NEAT)
        counts.append(species_set.species[0].stagnant)
    assert counts == [0, 1, 2, 0, 1]


def species_of(id: int, members: list[int], stagnant: int = 0) -> Species:
    return Species(id, ONE, stagnant=stagnant, members=np.array(members))


@pytest.mark.parametrize(("elitism", "left"), [(0, [2, 3]), (1, [2, 3]), (2, [2, 3, 4])])
def test_stagnant_species_go_but_the_best_stay(elitism: int, left: list[int]) -> None:
    species_set = SpeciesSet(
        (
            species_of(1, [0], stagnant=21),
            species_of(2, [1], stagnant=20),
            species_of(3, [2], stagnant=99),
            species_of(4, [3], stagnant=50),
        )
    )
    fitness = np.array([1.0, 0.5, 9.0, 2.0])
    left_over = remove_stagnant(
        species_set, fitness, neat_constants(max_stagnation=20, species_elitism=elitism)
    )
    assert [s.id for s in left_over.species] == left


def test_sharing_by_hand() -> None:
    species_set = SpeciesSet((species_of(0, [0, 1, 3]), species_of(1, [2])))
    fitness = np.array([4.0, 2.0, -2.0, 0.0])
    # shifted by -2: 6, 4, 2 and 0
    stanley = adjusted_fitness(species_set, fitness, neat_constants(sharing="stanley"))
    assert np.allclose(stanley, [4.0, 0.0])
    literal = adjusted_fitness(species_set, fitness, neat_constants(sharing="literal"))
    assert np.allclose(literal, [4.0 / 3.0, 0.0])
