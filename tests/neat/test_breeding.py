"""Breeding: copies, siblings, and WM_MODE."""

import numpy as np
import pytest

from neol.neat.breeding import PARENTS, Rates, breed_all
from neol.neat.genome import Genome, Pool
from neol.neat.innovations import Innovations
from neol.neat.population import Population
from neol.neat.values import mutate_values
from tests.helpers.genomes import INPUTS, OUTPUTS, genome_of, neat_constants, stream

RATES = Rates.of(neat_constants())


def children_of(
    genomes: list[Genome],
    parents: list[tuple[int, int, bool]],
    rates: Rates,
    innovations: Innovations,
) -> Population:
    """Make a child for each pair of parents, or a copy for an elite."""
    rows = np.array(parents, dtype=PARENTS)
    pool = breed_all(Pool.of(genomes), rows, INPUTS, OUTPUTS, rates, innovations, stream())
    return Population(0, pool, np.full(len(parents), np.nan))


def test_a_genome_bred_with_itself_and_unmutated_is_copied() -> None:
    """Not even a disabled gene is drawn again, and copies share no memory."""
    rates = RATES._replace(add_connection=0.0, add_node=0.0, mutate_enabled=0.0)
    rates = rates._replace(weight=rates.weight._replace(mutate_rate=0.0, replace_rate=0.0))
    rates = rates._replace(bias=rates.bias._replace(mutate_rate=0.0, replace_rate=0.0))
    parent = genome_of([(i, i % INPUTS, 3, 1.0, False) for i in range(50)])
    child, _ = children_of([parent], [(0, 0, False)] * 2, rates, Innovations.begin(50, 5, 2))
    assert child.nodes.tolist() == parent.nodes.tolist()
    assert child.connections.tolist() == parent.connections.tolist()
    child.connections["weight"], child.nodes["bias"] = 5.0, 5.0
    assert parent.connections["weight"][0] == 1.0
    assert parent.nodes["bias"][0] == 0.0


def test_siblings_that_split_the_same_connection_get_the_same_genes() -> None:
    rates = RATES._replace(add_connection=0.0, add_node=1.0)
    parent = genome_of([(0, 0, 3, 0.7, True)])
    innovations = Innovations.begin(6, 5, 3)
    for child in children_of([parent], [(0, 0, False)] * 3, rates, innovations):
        assert child.nodes["id"].tolist() == [3, 4, 5]
        assert child.connections["innovation"].tolist() == [0, 6, 7]


@pytest.mark.parametrize("mode", ["off", "config", 0.3, 0.0, 1.0])
def test_weight_mutation_modes(mode: str | float) -> None:
    neat = neat_constants(weight_mutation=mode)
    weight = np.full(4000, 100.0)
    mutate_values(weight, Rates.of(neat).weight, stream())
    changed = np.mean(weight != 100.0)
    expected = {"off": 0.0, "config": neat.weight_mutate_rate + neat.weight_replace_rate}
    assert changed == pytest.approx(expected.get(str(mode), mode), abs=0.03)
    assert (weight[weight != 100.0] <= neat.weight_limit).all()
    replaced = np.mean(np.abs(weight) < 6.0)
    assert replaced == pytest.approx(neat.weight_replace_rate if mode == "config" else 0, abs=0.03)
