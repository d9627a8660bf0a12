"""Crossover and mutation: hand-made genomes, and properties of grown ones."""

import numpy as np
import pytest
from hypothesis import given, settings

from neol.neat.genome import Genome, Innovations
from neol.neat.reproduction import Reproduction
from neol.neat.variation import add_connection, add_node, crossover, mutate_weights, reaches
from tests.neat.genomes import (
    INPUTS,
    OUTPUTS,
    assert_sound,
    genome_of,
    grow,
    neat_constants,
    populations,
)

NEAT = neat_constants()


def rng(seed: int = 0) -> np.random.Generator:
    return np.random.default_rng(seed)


@given(populations)
@settings(max_examples=60, deadline=None)
def test_genomes_stay_sound(grown: tuple[list[Genome], Reproduction]) -> None:
    population, reproduction = grown
    for genome in population:
        assert_sound(genome)
        assert genome.nodes["id"].max() < reproduction.innovations.next_node
        if len(genome.connections):
            highest = genome.connections["innovation"].max()
            assert highest < reproduction.innovations.next_innovation


@given(populations)
@settings(max_examples=60, deadline=None)
def test_an_innovation_number_means_one_connection(
    grown: tuple[list[Genome], Reproduction],
) -> None:
    meaning: dict[int, tuple[int, int]] = {}
    for genome in grown[0]:
        for innovation, source, target, _, _ in genome.connections.tolist():
            assert meaning.setdefault(innovation, (source, target)) == (source, target)


@given(populations)
@settings(max_examples=60, deadline=None)
def test_genes_of_a_child_come_from_its_parents(
    grown: tuple[list[Genome], Reproduction],
) -> None:
    population, _ = grown
    for genome in population:
        genome.fitness = float(genome.id % 3)
    parent, mate = population[:2]
    child = crossover(999, parent, mate, NEAT, rng())
    fitter = max((parent, mate), key=lambda g: (g.fitness, -len(g.connections), -g.id))
    structure = ["innovation", "source", "target"]
    assert (child.connections[structure] == fitter.connections[structure]).all()
    assert (child.nodes["id"] == fitter.nodes["id"]).all()
    weights = {
        (gene["innovation"], gene["weight"]) for g in (parent, mate) for gene in g.connections
    }
    assert {(gene["innovation"], gene["weight"]) for gene in child.connections} <= weights
    biases = {(node["id"], node["bias"]) for g in (parent, mate) for node in g.nodes}
    assert {(node["id"], node["bias"]) for node in child.nodes} <= biases


def test_crossover_by_hand() -> None:
    """Matching genes mix, the fitter parent's others stay, the weaker parent's others go."""
    fitter = genome_of(
        [(0, 0, 3, 1.0, True), (1, 1, 3, 2.0, True), (4, 2, 3, 3.0, True)], id=1, fitness=2.0
    )
    weaker = genome_of(
        [(0, 0, 3, -1.0, True), (2, 2, 4, -2.0, True), (4, 2, 3, -3.0, True)], id=2, fitness=1.0
    )
    seen = set()
    for seed in range(40):
        child = crossover(9, weaker, fitter, NEAT, rng(seed))
        assert child.id == 9
        assert np.isnan(child.fitness)
        assert child.connections["innovation"].tolist() == [0, 1, 4]
        assert child.connections["weight"][1] == 2.0
        seen.add((child.connections["weight"][0], child.connections["weight"][2]))
    assert seen == {(a, b) for a in (1.0, -1.0) for b in (3.0, -3.0)}


def test_of_equally_fit_parents_the_smaller_gives_the_structure() -> None:
    small = genome_of([(0, 0, 3, 1.0, True)], id=7)
    large = genome_of([(0, 0, 3, 1.0, True), (1, 1, 3, 1.0, True)], id=1)
    assert len(crossover(9, large, small, NEAT, rng()).connections) == 1
    assert len(crossover(9, small, large, NEAT, rng()).connections) == 1


def test_a_gene_disabled_in_a_parent_is_disabled_in_most_children() -> None:
    on = genome_of([(0, 0, 3, 1.0, True)], id=1, fitness=1.0)
    off = genome_of([(0, 0, 3, 1.0, False)], id=2)
    children = [crossover(9, on, off, NEAT, rng(seed)) for seed in range(2000)]
    disabled = np.mean([not child.connections["enabled"][0] for child in children])
    assert disabled == pytest.approx(0.75, abs=0.04)


def test_a_child_shares_no_memory_with_its_parent() -> None:
    parent = genome_of([(0, 0, 3, 1.0, True)], fitness=1.0)
    child = crossover(9, parent, parent, NEAT, rng())
    child.connections["weight"] = 5.0
    child.nodes["bias"] = 5.0
    assert parent.connections["weight"][0] == 1.0
    assert parent.nodes["bias"][0] == 0.0


def test_the_same_mutation_in_one_generation_gets_the_same_numbers() -> None:
    innovations = Innovations(next_innovation=10, next_node=5)
    assert innovations.split(0) == innovations.split(0) == (5, 10, 11)
    assert innovations.connection(2, 3) == innovations.connection(2, 3) == 12
    assert innovations.split(1) == (6, 13, 14)
    innovations.begin_generation()
    assert innovations.split(0) == (7, 15, 16)
    assert innovations.connection(2, 3) == 17


def test_add_node_splits_a_connection() -> None:
    genome = genome_of([(0, 0, 3, 0.7, True)])
    add_node(genome, Innovations(next_innovation=6, next_node=5), rng())
    assert genome.connections.tolist() == [
        (0, 0, 3, 0.7, False),
        (6, 0, 5, 1.0, True),
        (7, 5, 3, 0.7, True),
    ]
    assert genome.nodes.tolist() == [(3, 0.0), (4, 0.0), (5, 0.0)]


def test_add_node_needs_an_enabled_connection() -> None:
    genome = genome_of([(0, 0, 3, 0.7, False)])
    add_node(genome, Innovations(next_innovation=6, next_node=5), rng())
    assert len(genome.nodes) == OUTPUTS


def test_add_connection_never_closes_a_cycle_nor_doubles_one() -> None:
    """0 -> 5 -> 6 -> 3: of all targets from 6, node 5 is forbidden, disabled or not."""
    chain = [(0, 0, 5, 1.0, True), (1, 5, 6, 1.0, False), (2, 6, 3, 1.0, True)]
    added = set()
    for seed in range(300):
        genome = genome_of(chain, hidden=[5, 6])
        innovations = Innovations(next_innovation=3, next_node=7)
        add_connection(genome, INPUTS, OUTPUTS, NEAT, innovations, rng(seed))
        assert_sound(genome)
        added |= {(int(g["source"]), int(g["target"])) for g in genome.connections[3:]}
    every = {(s, t) for s in (0, 1, 2, 5, 6) for t in (3, 4, 5, 6) if s != t}
    assert added == every - {(0, 5), (5, 6), (6, 3), (6, 5)}


def test_reaches() -> None:
    chain = genome_of([(0, 0, 5, 1.0, True), (1, 6, 3, 1.0, True), (2, 5, 6, 1.0, False)], [5, 6])
    assert reaches(chain.connections, 5, 3)
    assert reaches(chain.connections, 5, 5)
    assert not reaches(chain.connections, 6, 5)


@pytest.mark.parametrize("mode", ["off", "config", 0.3, 0.0, 1.0])
def test_weight_mutation_modes(mode: str | float) -> None:
    neat = neat_constants(weight_mutation=mode)
    connections = [(i, i % INPUTS, 3, 100.0, True) for i in range(4000)]
    genome = genome_of(connections)
    mutate_weights(genome, neat, rng())
    weight = genome.connections["weight"]
    changed = np.mean(weight != 100.0)
    expected = {"off": 0.0, "config": neat.weight_mutate_rate + neat.weight_replace_rate}
    assert changed == pytest.approx(expected.get(str(mode), mode), abs=0.03)
    assert (weight[weight != 100.0] <= neat.weight_limit).all()
    replaced = np.mean(np.abs(weight) < 6.0)
    assert replaced == pytest.approx(neat.weight_replace_rate if mode == "config" else 0, abs=0.03)


def test_a_perturbation_has_the_power_of_the_configuration() -> None:
    neat = neat_constants(weight_mutation=1.0)
    genome = genome_of([(i, i % INPUTS, 3, 2.0, True) for i in range(4000)])
    mutate_weights(genome, neat, rng())
    change = genome.connections["weight"] - 2.0
    assert change.std() == pytest.approx(neat.weight_mutate_power, rel=0.05)
    assert change.mean() == pytest.approx(0.0, abs=0.03)


def test_growing_is_deterministic() -> None:
    one, other = grow(3, NEAT, 10)[0], grow(3, NEAT, 10)[0]
    for a, b in zip(one, other, strict=True):
        assert (a.connections == b.connections).all()
        assert (a.nodes == b.nodes).all()
