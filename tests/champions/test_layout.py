"""Layers, edges and places of evolved networks."""

import numpy as np

from neol.champions.layout import edges, graph, layers
from neol.champions.player import Player
from neol.neat.decoding import decode
from neol.neat.genome import CONNECTION, NODE, Genome, Pool
from neol.rollout.environment import network_size
from neol.spec.configuration import load_configuration
from neol.spec.observations import NAMES, names
from tests.helpers.runs import run_spec

CONFIGURATION = load_configuration("paper")


def player(*connections: tuple[int, int, bool], hidden: int) -> Player:
    """Return a champion with inputs 0 and 1, outputs 2 and 3 and hidden nodes from 4 on."""
    nodes = np.array([(id_, 0.0) for id_ in range(2, 4 + hidden)], dtype=NODE)
    genes = np.array(
        [(number, a, b, 1.0, on) for number, (a, b, on) in enumerate(connections)], dtype=CONNECTION
    )
    genome, spec = Genome(0, nodes, genes, 1.0), run_spec()
    network, _ = decode(Pool.of([genome]), 2, 2, spec.network)
    return Player(spec, genome, network, (1.0,))


DIAMOND = player(
    (0, 4, True),  # ids 4 and 5 one after the other, 6 feeds nothing, 7 is disabled
    (4, 5, True),
    (5, 2, True),
    (1, 3, True),
    (5, 6, True),
    (1, 7, False),
    (7, 3, False),
    (0, 2, False),
    hidden=4,
)


def test_a_layer_is_behind_all_that_feed_it() -> None:
    network = DIAMOND.network
    depth = {node: at for at, layer in enumerate(layers(network)) for node in layer}
    assert sorted(depth) == list(range(8))
    assert all(depth[source] < depth[target] for source, target in edges(network))
    assert layers(network)[0] == [0, 1]
    assert layers(network)[-1] == [6, 7], "outputs alone, also behind what feeds nothing"


def test_edges_are_in_the_order_of_the_weights() -> None:
    network = DIAMOND.network
    targets = [target for _, target in edges(network)]
    assert [source for source, _ in edges(network)] == network.source.tolist()
    assert targets == sorted(targets)


def test_disabled_genes_are_known_and_untouched_nodes_left_out() -> None:
    shown = graph(DIAMOND)
    assert len(shown.places) == 7, "the node that only disabled genes touch has no place"
    assert shown.disabled == [(0, 6)], "of the disabled genes, those between nodes with a place"
    assert {node for edge in shown.enabled for node in edge} <= shown.places.keys()
    assert len(set(shown.places.values())) == len(shown.places)
    assert [shown.places[node][0] for node in (0, 1, 6, 7)] == [0, 0, 1, 1]
    assert all(0 <= x <= 1 and 0 <= y <= 1 for x, y in shown.places.values())


def test_without_hidden_nodes_there_are_two_layers() -> None:
    assert layers(player((0, 2, True), hidden=0).network) == [[0, 1], [2, 3]]


def test_all_of_the_papers_tasks_have_names() -> None:
    for task in CONFIGURATION.tasks.values():
        inputs, outputs = NAMES[task.environment]
        assert (len(inputs), len(outputs)) == network_size(task)
        assert len(set(inputs)) == len(inputs)
        assert names(task, len(inputs), len(outputs)) == (inputs, outputs)


def test_other_tasks_count() -> None:
    task = CONFIGURATION.tasks["cartpole"].model_copy(update={"environment": "Acrobot-v1"})
    assert names(task, 2, 1) == (("input 1", "input 2"), ("output 1",))
