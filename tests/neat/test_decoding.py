"""Decoding genomes into networks, against a plain twin."""

import math

import numpy as np
from hypothesis import given, settings

from neol.neat.decoding import decode, encode_weights
from neol.neat.genome import Genome, Pool
from neol.neat.innovations import Innovations
from neol.neat.population import Population
from neol.spec.configuration import load_configuration
from tests.helpers.genomes import INPUTS, OUTPUTS, genome_of, populations
from tests.helpers.networks import outputs_of

NETWORK = load_configuration("smoke").network
OBSERVATION = np.array([0.3, -1.2, 2.0])


def plain_outputs(genome: Genome) -> list[float]:
    """Compute activities by recursion over the genes, connections in order of innovation."""
    bias = dict(genome.nodes.tolist())

    def activity(node: int) -> float:
        if node < INPUTS:
            return float(OBSERVATION[node])
        total = bias[node]
        for _, source, target, weight, enabled in genome.connections.tolist():
            if target == node and enabled:
                total += weight * activity(source)
        return math.tanh(min(max(total, -50.0), 50.0))

    return [activity(output) for output in range(INPUTS, INPUTS + OUTPUTS)]


@given(populations)
@settings(max_examples=60, deadline=None)
def test_a_decoded_network_computes_what_the_genes_say(
    grown: tuple[list[Genome], Innovations],
) -> None:
    networks, _ = decode(Pool.of(grown[0]), INPUTS, OUTPUTS, NETWORK)
    assert networks.population == len(grown[0])
    for index, genome in enumerate(grown[0]):
        assert outputs_of(networks, index, OBSERVATION).tolist() == plain_outputs(genome)


@given(populations)
@settings(max_examples=30, deadline=None)
def test_weights_go_back_to_the_genes_they_came_from(
    grown: tuple[list[Genome], Innovations],
) -> None:
    population = Population.of(grown[0])
    networks, gene = decode(population.pool, INPUTS, OUTPUTS, NETWORK)
    encode_weights(population.pool, gene, networks.weight + 1.0)
    for genome, before in zip(population, grown[0], strict=True):
        old, enabled = before.connections["weight"], before.connections["enabled"]
        assert (genome.connections["weight"] == np.where(enabled, old + 1.0, old)).all()


def test_a_network_by_hand() -> None:
    """0 -> 6 -> 5 -> 3, 1 -> 3 disabled, 2 -> 4: node 6 comes before node 5."""
    genome = genome_of(
        [
            (0, 0, 6, 0.1, True),
            (1, 1, 3, 0.2, False),
            (2, 6, 5, 0.3, True),
            (3, 5, 3, 0.4, True),
            (4, 2, 4, 0.5, True),
        ],
        hidden=[5, 6],
    )
    networks, gene = decode(Pool.of([genome]), INPUTS, OUTPUTS, NETWORK)
    assert networks.node_offset.tolist() == [0, 4]
    assert networks.edge_offset.tolist() == [0, 1, 2, 3, 4]  # nodes 6, 5, 3, 4
    assert networks.source.tolist() == [0, 3, 4, 2]
    assert networks.weight.tolist() == [0.1, 0.3, 0.4, 0.5]
    assert gene.tolist() == [0, 2, 3, 4]
