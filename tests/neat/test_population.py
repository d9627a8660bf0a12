"""Populations: genomes kept end to end."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings

from neol.neat.genome import CONNECTION, NODE, Genome
from neol.neat.innovations import Innovations
from neol.neat.population import Population
from tests.helpers.genomes import genome_of, populations


@given(populations)
@settings(max_examples=20, deadline=None)
def test_a_population_holds_its_genomes(grown: tuple[list[Genome], Innovations]) -> None:
    population = Population.of(grown[0])
    assert len(population) == len(grown[0])
    for genome, expected in zip(population, grown[0], strict=True):
        assert (genome.nodes.dtype, genome.connections.dtype) == (NODE, CONNECTION)
        assert genome.id == expected.id
        assert genome.nodes.tolist() == expected.nodes.tolist()
        assert genome.connections.tolist() == expected.connections.tolist()


def test_a_genome_is_a_view_and_its_copy_is_not() -> None:
    population = Population.of([genome_of([(0, 0, 3, 1.0, True)], id=i) for i in (4, 5)])
    population = replace(population, fitness=np.array([1.0, 2.0]))
    copy = population[1].copy()
    population[1].connections["weight"] = 7.0
    assert population.pool.connections["weight"].tolist() == [1.0, 7.0]
    assert (copy.id, copy.fitness, copy.connections["weight"].tolist()) == (5, 2.0, [1.0])


def test_ids_follow_each_other() -> None:
    with pytest.raises(ValueError, match="ids"):
        Population.of([genome_of([], id=3), genome_of([], id=5)])
