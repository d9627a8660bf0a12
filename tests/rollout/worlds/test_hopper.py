import gymnasium
import numpy as np
import pytest

from neol.rollout.worlds.hopper import environment as hopper
from tests.helpers.stepwise import Array, Slot, compare_episode

STANDING = np.array(  # found by a random search: a linear policy that stands for 1,000 steps
    [
        [0.2, -0.9, -2.2, -0.9, -0.5, 1.4, 0.6, 0.3, -0.6, -0.9, 0.6],
        [-0.4, -0.3, 1.9, -1.0, -0.3, -0.2, -0.7, -1.4, 1.3, -1.4, -0.9],
        [0.3, -1.2, -0.2, 0.1, -0.2, -0.1, -1.4, -0.5, 1.3, 1.4, -0.6],
    ]
)

pytestmark = pytest.mark.filterwarnings("ignore:.*out of date.*:DeprecationWarning")


def stand(observation: Array) -> Array:
    return np.clip(STANDING @ observation, -1.0, 1.0)


@pytest.mark.slow
def test_equal_to_gymnasium_at_every_step() -> None:
    environment = gymnasium.make("Hopper-v4")
    simulation = hopper.Simulation()
    slot = Slot(simulation.world, 11)
    random = np.random.default_rng(1)
    for policy, seeds in {
        lambda _: random.uniform(-1, 1, 3): range(100),
        lambda _: random.choice([-1.0, 1.0], 3): range(100, 130),
        lambda _: np.zeros(3): range(10),
        lambda _: np.ones(3): range(10),
        lambda observation: np.tanh(random.normal(size=(3, 11)) @ observation): range(30),
    }.items():
        for seed in seeds:
            compare_episode(slot, environment, seed, policy)
    for seed in range(4):
        steps = compare_episode(slot, environment, seed, stand)
        assert steps == 1000, "to the limit of steps"


def test_an_episode_depends_on_nothing_beside_it() -> None:
    """Another simulation that steps in turns with the first changes none of its bits."""
    simulation, other = hopper.Simulation(), hopper.Simulation()
    slot, beside = Slot(simulation.world, 11), Slot(other.world, 11)
    environment = gymnasium.make("Hopper-v4")
    beside.reset(6)

    def disturbed(observed: Array) -> Array:
        beside.step(np.ones(3))
        return stand(observed)

    assert compare_episode(slot, environment, 5, disturbed) == 1000
