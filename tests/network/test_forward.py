"""The forward pass against a plain twin, and slices of a batch."""

import math

import numpy as np
import pytest

from neol.network.forward import ACTIVATIONS, Networks
from tests.helpers.networks import outputs_of, random_networks


def plain_outputs(networks: Networks, index: int, observation: np.ndarray) -> list[float]:
    """Compute the forward pass node by node with Python's floats."""
    hidden = {
        "tanh": math.tanh,
        "relu": lambda total: max(total, 0.0),
        "sigmoid": lambda total: 1.0 / (1.0 + math.exp(-total)),
        "identity": lambda total: total,
    }[sorted(ACTIVATIONS, key=ACTIVATIONS.__getitem__)[networks.activation]]
    first, last = networks.node_offset[index : index + 2]
    values = observation.tolist()
    for node in range(first, last):
        total = networks.bias[node].item()
        for edge in range(networks.edge_offset[node], networks.edge_offset[node + 1]):
            total += networks.weight[edge].item() * values[networks.source[edge]]
        total = min(max(total, -networks.sum_limit), networks.sum_limit)
        total *= networks.activation_scale
        values.append(math.tanh(total) if node >= last - networks.outputs else hidden(total))
    return values[-networks.outputs :]


@pytest.mark.parametrize("scale", [1.0, 2.5])
@pytest.mark.parametrize("activation", ACTIVATIONS)
def test_forward_equals_its_plain_twin(activation: str, scale: float) -> None:
    random = np.random.default_rng(1)
    networks = random_networks(
        random, 40, inputs=5, outputs=3, activation=activation, activation_scale=scale
    )
    for index in range(networks.population):
        observation = random.normal(scale=3.0, size=5)
        expected = plain_outputs(networks, index, observation)
        assert outputs_of(networks, index, observation).tolist() == expected


def test_sums_are_clipped() -> None:
    networks = random_networks(np.random.default_rng(2), 1, inputs=1, outputs=1, hidden=0)
    networks.weight[:] = 1e9
    assert outputs_of(networks, 0, np.array([1.0]))[0] == math.tanh(50.0)
    clipped = random_networks(
        np.random.default_rng(2), 1, inputs=1, outputs=1, hidden=0, sum_limit=0.25
    )
    clipped.weight[:] = -1e9
    assert outputs_of(clipped, 0, np.array([1.0]))[0] == math.tanh(-0.25)


def test_a_slice_is_a_batch_of_its_own() -> None:
    random = np.random.default_rng(3)
    networks = random_networks(random, 9, inputs=4, outputs=2)
    observation = random.normal(size=4)
    for begin, end in ((0, 9), (2, 5), (8, 9), (4, 4)):
        part = networks.slice(begin, end)
        assert part.population == end - begin
        for index in range(begin, end):
            assert (
                outputs_of(part, index - begin, observation).tolist()
                == outputs_of(networks, index, observation).tolist()
            )
