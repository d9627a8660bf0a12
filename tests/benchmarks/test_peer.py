"""The peer is the same algorithm: its plasticity and its network give the project's numbers."""

import gymnasium
import numpy as np
import pytest

from neol.network.forward import Networks, forward
from neol.network.plasticity import Learning, compiled
from neol.network.plasticity import learn as learn_in_a_kernel
from neol.spec.configuration import load_configuration
from neol.spec.run_spec import RunSpec

pytest.importorskip("neat", reason="neat-python is installed on demand: make bench")

from benchmarks import peer


def specification(method: str) -> RunSpec:
    return load_configuration("smoke").run_spec(
        task="cartpole",
        method=method,
        population=10,
        learning_rate=None if method.startswith("neat") else 2.5,
        generations=2,
        seed=0,
    )


def test_a_run_of_the_peer_plays_every_genome() -> None:
    result = peer.run_spec(specification("hebb"))
    assert 2 * 10 <= result.steps <= 2 * 10 * 200
    assert result.seconds > 0.0
    assert 0.0 < result.best_fitness <= 200.0


def test_the_peer_has_the_project_s_constants() -> None:
    config = peer.configuration(specification("neat"), gymnasium.make("CartPole-v1"))
    assert config.genome_config.weight_mutate_rate == 0.8
    assert config.genome_config.initial_connection == "full_direct"
    assert config.species_set_config.compatibility_threshold == 3.0
    off = peer.configuration(specification("hebb"), gymnasium.make("CartPole-v1"))
    assert off.genome_config.weight_mutate_rate == off.genome_config.bias_replace_rate == 0.0


@pytest.mark.parametrize("rule", ["hebb", "oja", "bcm"])
def test_the_peer_s_network_learns_as_the_project_s(rule: str) -> None:
    spec = specification(rule)
    config = peer.configuration(spec, gymnasium.make("CartPole-v1"))
    population = peer.neat.Population(config, seed=1)
    genome = next(iter(population.population.values()))
    network = peer.neat.nn.FeedForwardNetwork.create(genome, config)
    links = {node: list(links) for node, *_, links in network.node_evals}
    bias = np.array([genome.nodes[output].bias for output in range(2)])
    weight = np.array([w for output in range(2) for _, w in links[output]])
    source = np.array([-1 - key for output in range(2) for key, _ in links[output]])
    threshold = np.zeros(2)
    networks = Networks(
        inputs=4,
        outputs=2,
        activation=0,
        sum_limit=50.0,
        activation_scale=1.0,
        node_offset=np.array([0, 2]),
        bias=bias,
        edge_offset=np.array([0, 4, 8]),
        source=source,
        weight=weight,
    )
    learning = Learning(compiled(rule), 1.0, 0.1, 10.0, threshold)
    of_peer = {0: 0.0, 1: 0.0}
    for step in range(5):
        observation = np.random.default_rng(step).normal(size=4)
        values = np.array([*observation, 0.0, 0.0])
        forward(networks, 0, values)
        learn_in_a_kernel(networks, 0, learning, 0.3, values)
        outputs = network.activate(observation.tolist())
        peer.learn(network, spec.plasticity, 0.3, of_peer)
        assert outputs == pytest.approx(values[4:])
    learned = [w for output in range(2) for _, w in dict_of_links(network)[output]]
    assert learned == pytest.approx(weight.tolist())
    assert learned != [w for output in range(2) for _, w in links[output]]
    if rule == "bcm":  # the peer spares the others a threshold that they do not ask for
        assert list(of_peer.values()) == pytest.approx(threshold.tolist())
    peer.write_back(genome, network)
    assert genome.connections[-1, 0].weight == dict(dict_of_links(network)[0])[-1]


def dict_of_links(network: peer.Any) -> dict[int, list[tuple[int, float]]]:
    return {node: links for node, *_, links in network.node_evals}
