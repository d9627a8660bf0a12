"""Offspring counts, elites and parents; whole populations against a plain twin."""

from dataclasses import astuple, replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from neol.neat.innovations import Innovations
from neol.neat.population import Population
from neol.neat.reproduction import Reproduction, spawn_counts
from neol.neat.species import SpeciesSet, adjusted_fitness, remove_stagnant, speciate
from tests.helpers.genomes import INPUTS, OUTPUTS, assert_sound, neat_constants
from tests.neat.plain_reproduction import PlainGenome, PlainReproduction


@given(
    adjusted=st.lists(st.floats(0, 1e6), min_size=1, max_size=40),
    size=st.integers(2, 300),
    minimum=st.integers(1, 4),
    elitism=st.integers(0, 4),
)
def test_spawn_counts_sum_to_the_population_size(
    adjusted: list[float], size: int, minimum: int, elitism: int
) -> None:
    neat = neat_constants(min_species_size=minimum, elitism=elitism)
    spawn = spawn_counts(np.array(adjusted), size, neat)
    assert spawn.sum() == size
    least = max(minimum, elitism)
    if least * len(adjusted) <= size:
        assert (spawn >= least).all()
    assert (spawn >= 0).all()


@pytest.mark.parametrize(
    ("adjusted", "size", "expected"),
    [
        ([3.0, 1.0], 8, [6, 2]),
        ([0.0, 0.0], 8, [4, 4]),
        ([1.0, 1.0, 1.0], 10, [4, 3, 3]),
        ([100.0, 0.0, 0.0], 10, [6, 2, 2]),
        ([5.0, 1.0, 2.0], 5, [3, 0, 2]),
        ([5.0, 1.0], 3, [3, 0]),
    ],
)
def test_spawn_counts_by_hand(adjusted: list[float], size: int, expected: list[int]) -> None:
    neat = neat_constants(min_species_size=2, elitism=2)
    assert spawn_counts(np.array(adjusted), size, neat).tolist() == expected


def evolve(generations: int, size: int = 30, **changes: object) -> tuple[Population, Innovations]:
    """Evolve a few generations with the sum of weights as fitness."""
    neat = neat_constants(**changes)
    reproduction = Reproduction(INPUTS, OUTPUTS, neat)
    species_set, innovations = SpeciesSet(), reproduction.first_innovations()
    population = reproduction.initial_population(size, np.random.default_rng(0))
    for generation in range(generations):
        population = replace(
            population, fitness=np.array([g.connections["weight"].sum() for g in population])
        )
        species_set = speciate(population, species_set, neat)
        random = np.random.default_rng(generation)
        population, innovations = reproduction.reproduce(
            population, species_set, innovations, random
        )
        assert len(population) == size
        for genome in population:
            assert_sound(genome)
    ids = [genome.id for genome in population]
    assert len(set(ids)) == len(ids)
    return population, innovations


@pytest.mark.parametrize("size", [2, 3, 30])
def test_populations_keep_their_size_and_soundness(size: int) -> None:
    evolve(12, size, compatibility_threshold=1.0, add_node_rate=0.5)


def test_elites_are_copied_unchanged() -> None:
    neat = neat_constants(elitism=2)
    reproduction, species_set = Reproduction(INPUTS, OUTPUTS, neat), SpeciesSet()
    population = reproduction.initial_population(20, np.random.default_rng(0))
    population = replace(population, fitness=np.arange(20.0))
    species_set = speciate(population, species_set, neat)
    best = [s.members[:2] for s in species_set.species]
    random = np.random.default_rng(1)
    children, _ = reproduction.reproduce(
        population, species_set, reproduction.first_innovations(), random
    )
    for elites in best:
        for elite in [population[place] for place in elites]:
            assert any(
                child.connections.tolist() == elite.connections.tolist()
                and child.nodes.tolist() == elite.nodes.tolist()
                for child in children
            )


def test_only_survivors_become_parents() -> None:
    """With all mutation off, children carry only weights of the best fifth."""
    neat = neat_constants(
        compatibility_threshold=1e9,
        weight_mutation="off",
        add_connection_rate=0.0,
        add_node_rate=0.0,
        survival_threshold=0.2,
    )
    reproduction, species_set = Reproduction(INPUTS, OUTPUTS, neat), SpeciesSet()
    population = reproduction.initial_population(20, np.random.default_rng(0))
    population = replace(population, fitness=np.arange(20.0))
    species_set = speciate(population, species_set, neat)
    random = np.random.default_rng(1)
    children, _ = reproduction.reproduce(
        population, species_set, reproduction.first_innovations(), random
    )
    fittest = [population[place] for place in range(16, 20)]
    allowed = {w for genome in fittest for w in genome.connections["weight"]}
    assert {w for child in children for w in child.connections["weight"]} <= allowed


def test_numbers_only_grow() -> None:
    """Each generation adds connections and nodes, and all of them have new numbers."""
    found = [evolve(count, add_connection_rate=0.9, add_node_rate=0.9) for count in range(6)]
    for (_, before), (population, after) in pairwise(found):
        genes = np.concatenate([genome.connections for genome in population])
        assert genes["innovation"].max() == after.next_innovation - 1 >= before.next_innovation
        nodes = np.concatenate([genome.nodes for genome in population])
        assert nodes["id"].max() == after.next_node - 1 >= before.next_node
    assert [population.first_id for population, _ in found] == [30 * count for count in range(6)]


BUSY = {
    "weight_init_sd": 1.3,
    "bias_init_sd": 0.7,
    "weight_limit": 2.0,
    "bias_limit": 1.5,
    "bias_replace_rate": 0.1,
    "enabled_mutate_rate": 0.1,
    "add_connection_rate": 0.8,
    "add_node_rate": 0.6,
    "remove_connection_rate": 0.2,
    "remove_node_rate": 0.15,
    "crossover_rate": 0.8,
    "survival_threshold": 0.6,
    "max_stagnation": 3,
}
"""Constants with all kinds of mutation and parents, often."""


SWITCHES = [
    {"crossover_enabled": "random_parent"},
    {"innovation": "endpoints", "equal_parents": "random", "distance": "all_genes"},
    {"crossover_enabled": "redraw_if_disabled", "new_node_bias": "drawn"},
    {"crossover_enabled": "stanley", "enabled_mutate_rate": 0.0},
]


@pytest.mark.parametrize("switches", SWITCHES, ids=lambda switches: "-".join(map(str, switches)))
@pytest.mark.parametrize(("size", "threshold"), [(7, 1.0), (40, 3.0)])
@pytest.mark.parametrize("weight_mutation", ["off", "config", 0.3])
def test_populations_are_those_of_a_plain_twin(
    weight_mutation: str | float, size: int, threshold: float, switches: dict[str, object]
) -> None:
    """Compare every bit of every gene, and the counts of random and innovation numbers.

    Populations are few genomes in many species, and many genomes in few species.
    """
    constants = BUSY | {"weight_mutation": weight_mutation, "compatibility_threshold": threshold}
    neat = neat_constants(**constants | switches)
    reproduction = Reproduction(INPUTS, OUTPUTS, neat)
    twin = PlainReproduction(INPUTS, OUTPUTS, neat)
    random, twin_random, chance = (np.random.default_rng(seed) for seed in (0, 0, 1))
    species_set, innovations = SpeciesSet(), reproduction.first_innovations()
    population = reproduction.initial_population(size, random)
    expected = twin.initial_population(size, twin_random)
    assert genes(population) == plain_genes(expected)
    for _ in range(15):
        population = replace(population, fitness=chance.integers(8, size=size).astype(float))
        for genome, fitness in zip(expected, population.fitness.tolist(), strict=True):
            genome.fitness = fitness
        species_set = speciate(population, species_set, neat)
        species_set = remove_stagnant(species_set, population.fitness, neat)
        members = [species.members.tolist() for species in species_set.species]
        adjusted = adjusted_fitness(species_set, population.fitness, neat).tolist()
        population, innovations = reproduction.reproduce(
            population, species_set, innovations, random
        )
        expected = twin.reproduce(expected, members, adjusted, twin_random)
        assert genes(population) == plain_genes(expected)
        assert innovations.next_innovation == twin.next_innovation
        assert innovations.next_node == twin.next_node
        assert random.bit_generator.state == twin_random.bit_generator.state
    assert max(len(genome.biases) for genome in expected) > OUTPUTS, "hidden nodes"


def genes(population: Population) -> list[object]:
    return [(genome.nodes.tolist(), genome.connections.tolist()) for genome in population]


def plain_genes(population: list[PlainGenome]) -> list[object]:
    """Return the genes in the order of the arrays."""
    return [
        (
            sorted(genome.biases.items()),
            [(number, *astuple(gene)) for number, gene in sorted(genome.connections.items())],
        )
        for genome in population
    ]
