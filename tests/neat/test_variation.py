"""Crossover and mutation of hand-made genomes, and properties of evolved genomes."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings

from neol.neat.breeding import Rates
from neol.neat.genome import Genome
from neol.neat.innovations import Innovations, connection_number, split_node
from neol.neat.values import draw_values, mutate_values
from neol.neat.variation import (
    Genes,
    add_connection,
    add_node,
    mutate_enabled,
    reaches,
    remove_connection,
    remove_node,
)
from tests.helpers.genomes import (
    INPUTS,
    OUTPUTS,
    assert_sound,
    cross,
    genome_of,
    grow,
    in_order,
    neat_constants,
    populations,
    stream,
)
from tests.neat.plain_reproduction import Connection, PlainGenome

NEAT = neat_constants()
RATES = Rates.of(NEAT)


@given(populations)
@settings(max_examples=60, deadline=None)
def test_genomes_stay_sound(grown: tuple[list[Genome], Innovations]) -> None:
    population, innovations = grown
    for genome in population:
        assert_sound(genome)
        assert genome.nodes["id"].max() < innovations.next_node
        if len(genome.connections) and not innovations.by_endpoints:
            highest = genome.connections["innovation"].max()
            assert highest < innovations.next_innovation


@given(populations)
@settings(max_examples=60, deadline=None)
def test_an_innovation_number_means_one_connection(
    grown: tuple[list[Genome], Innovations],
) -> None:
    meaning: dict[int, tuple[int, int]] = {}
    for genome in grown[0]:
        for innovation, source, target, _, _ in genome.connections.tolist():
            assert meaning.setdefault(innovation, (source, target)) == (source, target)


@given(populations)
@settings(max_examples=60, deadline=None)
def test_genes_of_a_child_come_from_its_parents(
    grown: tuple[list[Genome], Innovations],
) -> None:
    population, _ = grown
    for genome in population:
        genome.fitness = float(genome.id % 3)
    parent, mate = population[:2]
    child = cross(parent, mate, NEAT)
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
    """Matching genes mix; other genes of the fitter parent stay, those of the weaker are lost."""
    fitter = genome_of(
        [(0, 0, 3, 1.0, True), (1, 1, 3, 2.0, True), (4, 2, 3, 3.0, True)], id=1, fitness=2.0
    )
    weaker = genome_of(
        [(0, 0, 3, -1.0, True), (2, 2, 4, -2.0, True), (4, 2, 3, -3.0, True)], id=2, fitness=1.0
    )
    seen = set()
    for seed in range(40):
        child = cross(weaker, fitter, NEAT, seed)
        assert child.connections["innovation"].tolist() == [0, 1, 4]
        assert child.connections["weight"][1] == 2.0
        seen.add((child.connections["weight"][0], child.connections["weight"][2]))
    assert seen == {(a, b) for a in (1.0, -1.0) for b in (3.0, -3.0)}


def test_of_equally_fit_parents_the_smaller_gives_the_structure() -> None:
    small = genome_of([(0, 0, 3, 1.0, True)], id=7)
    large = genome_of([(0, 0, 3, 1.0, True), (1, 1, 3, 1.0, True)], id=1)
    assert in_order([large, small]) == [small, large]
    assert len(cross(large, small, NEAT).connections) == 1
    older, fitter = genome_of([(0, 0, 3, 1.0, True)], id=6), genome_of([], id=8, fitness=0.1)
    assert in_order([large, small, older, fitter]) == [fitter, older, small, large]


@pytest.mark.parametrize(
    ("rule", "of_one", "of_both"),
    [
        ("random_parent", 0.5, 1.0),
        ("stanley", 0.75 + 0.25 * 0.5, 1.0),
        ("redraw_if_disabled", 0.75, 0.75),
    ],
)
@pytest.mark.parametrize("fitter_is_disabled", [False, True])
def test_how_often_a_gene_is_disabled_in_the_child(
    rule: str, of_one: float, of_both: float, fitter_is_disabled: bool
) -> None:
    """Count genes disabled in one parent, in both, and in neither."""
    neat = neat_constants(crossover_enabled=rule, disable_rate=0.75, enabled_mutate_rate=0.0)

    def disabled(*enabled: bool) -> float:
        one, other = (
            genome_of([(0, 0, 3, 1.0, flag)], id=id, fitness=-float(id))
            for id, flag in enumerate(enabled)
        )
        children = [cross(one, other, neat, seed) for seed in range(2000)]
        return float(np.mean([not child.connections["enabled"][0] for child in children]))

    assert disabled(not fitter_is_disabled, fitter_is_disabled) == pytest.approx(of_one, abs=0.04)
    assert disabled(False, False) == pytest.approx(of_both, abs=0.04)
    assert disabled(True, True) == 0.0


def test_the_same_mutation_in_one_generation_gets_the_same_numbers() -> None:
    innovations = Innovations.begin(innovation=10, node=5, children=2)
    assert split_node(innovations, 0) == split_node(innovations, 0) == 5
    assert connection_number(innovations, 1, 5) == connection_number(innovations, 1, 5) == 10
    assert connection_number(innovations, 5, 3) == 11
    assert connection_number(innovations, 2, 3) == connection_number(innovations, 2, 3) == 12
    assert connection_number(innovations, 1, 5) == 10
    assert split_node(innovations, 1) == 6
    assert (innovations.next_innovation, innovations.next_node) == (13, 7)
    innovations = innovations.next_generation(1)
    assert split_node(innovations, 0) == 7
    assert connection_number(innovations, 2, 3) == 13


def test_a_connection_may_be_known_by_its_endpoints_for_the_whole_run() -> None:
    innovations = Innovations.begin(innovation=10, node=5, children=2, by_endpoints=True)
    first = connection_number(innovations, 2, 3)
    assert (split_node(innovations, 0), split_node(innovations, 0)) == (5, 6), "two nodes"
    innovations = innovations.next_generation(1)
    assert connection_number(innovations, 2, 3) == first != connection_number(innovations, 3, 2)
    assert split_node(innovations, 0) == 7


def test_more_mutations_than_there_is_room_for_are_refused() -> None:
    innovations = Innovations.begin(innovation=10, node=5, children=1)
    split_node(innovations, 0)
    with pytest.raises(IndexError):
        split_node(innovations, 1)
    for source in range(3):
        connection_number(innovations, source, 3)
    with pytest.raises(IndexError):
        connection_number(innovations, 3, 3)


def split(genome: Genome, seed: int = 0, *, draws_bias: bool = False) -> tuple[Genes, Genes]:
    """Return nodes and connections of a genome with one more node."""
    innovations = Innovations.begin(6, 5, 1)
    bias = Rates.of(NEAT).bias
    return add_node(
        genome.nodes, genome.connections.copy(), bias, draws_bias, innovations, stream(seed)
    )


def test_add_node_splits_a_connection() -> None:
    genome = genome_of([(0, 0, 3, 0.7, True)])
    nodes, connections = split(genome)
    assert connections.tolist() == [
        (0, 0, 3, 0.7, False),
        (6, 0, 5, 1.0, True),
        (7, 5, 3, 0.7, True),
    ]
    assert nodes.tolist() == [(3, 0.0), (4, 0.0), (5, 0.0)]


def test_add_node_needs_an_enabled_connection() -> None:
    genome = genome_of([(0, 0, 3, 0.7, False)])
    nodes, _ = split(genome)
    assert len(nodes) == OUTPUTS


def test_the_bias_of_a_new_node_may_be_drawn() -> None:
    genome = genome_of([(0, 0, 3, 0.7, True)])
    drawn = [split(genome, seed, draws_bias=True)[0]["bias"].tolist() for seed in range(500)]
    assert all(biases[:2] == [0.0, 0.0] for biases in drawn)
    assert np.std([biases[2] for biases in drawn]) == pytest.approx(NEAT.bias_init_sd, rel=0.1)


def test_removal() -> None:
    """A removed node takes its connections along; a genome without hidden nodes stays."""
    genome = genome_of(
        [(0, 0, 5, 1.0, True), (1, 5, 3, 2.0, False), (2, 1, 4, 3.0, True)], hidden=[5]
    )
    nodes, connections = remove_node(genome.nodes, genome.connections, OUTPUTS, stream())
    assert nodes["id"].tolist() == [3, 4]
    assert connections.tolist() == [(2, 1, 4, 3.0, True)]
    assert len(remove_node(nodes, connections, OUTPUTS, stream())[0]) == OUTPUTS
    left = {
        tuple(remove_connection(genome.connections, stream(seed))["innovation"].tolist())
        for seed in range(40)
    }
    assert left == {(0, 1), (0, 2), (1, 2)}
    assert len(remove_connection(connections[:0], stream())) == 0


def test_add_connection_never_closes_a_cycle_nor_doubles_one() -> None:
    """0 -> 5 -> 6 -> 3: of all targets from 6, node 5 is forbidden, disabled or not."""
    chain = [(0, 0, 5, 1.0, True), (1, 5, 6, 1.0, False), (2, 6, 3, 1.0, True)]
    added = set()
    for seed in range(300):
        genome = genome_of(chain, hidden=[5, 6])
        genome.connections = add_connection(
            genome.nodes,
            genome.connections,
            INPUTS,
            OUTPUTS,
            RATES.weight,
            Innovations.begin(3, 7, 1),
            stream(seed),
        )
        assert_sound(genome)
        added |= {(int(g["source"]), int(g["target"])) for g in genome.connections[3:]}
    every = {(s, t) for s in (0, 1, 2, 5, 6) for t in (3, 4, 5, 6) if s != t}
    assert added == every - {(0, 5), (5, 6), (6, 3), (6, 5)}


def test_reaches() -> None:
    chain = genome_of([(0, 0, 5, 1.0, True), (1, 6, 3, 1.0, True), (2, 5, 6, 1.0, False)], [5, 6])
    assert reaches(chain.nodes, chain.connections, 5, 3)
    assert reaches(chain.nodes, chain.connections, 5, 5)
    assert not reaches(chain.nodes, chain.connections, 6, 5)


@given(populations)
@settings(max_examples=30, deadline=None)
def test_reaching_is_that_of_a_plain_twin(grown: tuple[list[Genome], Innovations]) -> None:
    """Compare all pairs of nodes, inputs included, of each genome."""
    for genome in grown[0]:
        plain = PlainGenome({}, {n: Connection(s, t, w) for n, s, t, w, _ in genome.connections})
        every = [*range(INPUTS), *genome.nodes["id"].tolist()]
        for start, goal in itertools.product(every, every):
            reached = reaches(genome.nodes, genome.connections, start, goal)
            assert reached == plain.leads(start, goal)


def test_a_perturbation_has_the_power_of_the_configuration() -> None:
    neat = neat_constants(weight_mutation=1.0)
    weight = np.full(4000, 2.0)
    mutate_values(weight, Rates.of(neat).weight, stream())
    change = weight - 2.0
    assert change.std() == pytest.approx(neat.weight_mutate_power, rel=0.05)
    assert change.mean() == pytest.approx(0.0, abs=0.03)


def test_fresh_values_have_the_spread_and_the_limit_of_the_configuration() -> None:
    rates = RATES.weight._replace(init_sd=2.0, limit=3.0)
    values = np.empty(4000)
    draw_values(values, rates, stream())
    assert np.abs(values).max() == 3.0
    assert np.mean(np.abs(values) < 2.0) == pytest.approx(0.683, abs=0.03)


def test_enabled_flags_are_drawn_anew_at_their_rate() -> None:
    connections = genome_of([(i, i % INPUTS, 3, 1.0, True) for i in range(4000)]).connections
    mutate_enabled(connections, 0.4, stream())
    assert np.mean(connections["enabled"]) == pytest.approx(0.8, abs=0.03)


def test_growing_is_deterministic() -> None:
    one, other = grow(3, NEAT, 10)[0], grow(3, NEAT, 10)[0]
    for a, b in zip(one, other, strict=True):
        assert (a.connections == b.connections).all()
        assert (a.nodes == b.nodes).all()
