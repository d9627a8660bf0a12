"""EnvPool is given the same work: networks play in it, and are timed in the same episodes again."""

import gymnasium
import numpy as np
import pytest

from benchmarks.networks import initial_topology
from neol.network.forward import Networks, forward
from neol.rollout import make_engine
from neol.rollout.environment import network_size
from neol.spec.configuration import load_configuration
from neol.spec.run_spec import RunSpec

pytest.importorskip("envpool", reason="EnvPool is installed on demand: make bench")

from benchmarks import envpool_steps


@pytest.fixture
def spec() -> RunSpec:
    return load_configuration("smoke").run_spec(
        task="cartpole", method="neat", population=5, learning_rate=None, generations=1, seed=0
    )


@pytest.fixture
def networks(spec: RunSpec) -> Networks:
    return initial_topology(spec, make_engine(spec.task, "fast"), network_size(spec.task), 2)


def test_the_same_actions_lead_through_the_same_episodes(spec: RunSpec, networks: Networks) -> None:
    played, again = (envpool_steps.play(spec.task, networks, 3, calls=400) for _ in range(2))
    assert played.actions.shape == (400, 3)
    assert np.array_equal(played.actions, again.actions)
    assert 3 * 400 * 0.9 < played.steps == again.steps < 3 * 400, "some calls were resets"
    assert envpool_steps.seconds_of_envpool(spec.task, played) > 0.0


def test_networks_act_in_envpool_as_in_our_engine(networks: Networks) -> None:
    observation = np.random.default_rng(0).normal(size=(5, 4))
    weight, bias = envpool_steps._matrices(networks)
    sums = np.einsum("eoi,ei->eo", weight, observation) + bias
    for p in range(networks.population):
        values = np.concatenate([observation[p], np.empty(2)])
        forward(networks, p, values)
        assert np.tanh(networks.activation_scale * sums[p]) == pytest.approx(values[4:])


def test_actions_are_the_space_s_own() -> None:
    outputs = np.array([[0.1, -0.5], [-0.3, 0.9]])
    discrete = envpool_steps._actions(gymnasium.spaces.Discrete(2), outputs)
    assert discrete.tolist() == [0, 1]
    box = envpool_steps._actions(gymnasium.spaces.Box(-1.0, 1.0, (2,), np.float32), outputs)
    assert box.dtype == np.float32
    assert box.shape == (2, 2)
