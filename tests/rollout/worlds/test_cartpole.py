import gymnasium
import numpy as np

from neol.rollout.worlds import cartpole
from tests.helpers.stepwise import Array, Slot, compare_episode


def balance(observation: Array) -> Array:
    return np.array([0.0, observation @ [0.1, 0.3, 1.0, 0.3]])


def drift(observation: Array) -> Array:
    return np.array([0.05, observation @ [0.0, 0.0, 1.0, 0.4]])


def test_equal_to_gymnasium_at_every_step() -> None:
    environment = gymnasium.make("CartPole-v1")
    world = cartpole.Simulation(slots=2).world
    slot = Slot(world, 4, number=1)
    random = np.random.default_rng(1)
    for policy, seeds in {
        lambda _: random.uniform(-1, 1, 2): range(300),
        lambda _: np.array([0.0, 1.0]): range(100),
        lambda _: np.array([1.0, 0.0]): range(100),
        lambda _: np.zeros(2): [0, 2**32, 2**64 - 1],  # a tie pushes to the left
    }.items():
        for seed in seeds:
            compare_episode(slot, environment, seed, policy)
    for seed in range(30):
        steps = compare_episode(slot, environment, seed, balance)
        assert steps == 500, "to the limit of steps"
        steps = compare_episode(slot, environment, seed, drift)
        assert steps < 500 and abs(world.state[1, 0]) > cartpole.POSITION_LIMIT, "out of bounds"
