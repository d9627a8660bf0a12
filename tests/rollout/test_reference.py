"""The reference engine: Gymnasium's numbers, one episode at a time, in any order."""

import gymnasium
import numpy as np
import numpy.typing as npt
import pytest

from neol.base.errors import UserError
from neol.rollout import make_engine
from neol.rollout.environment import make_environment, network_size
from neol.rollout.reference import ReferenceEngine, Step
from neol.spec.configuration import load_configuration
from neol.spec.constants import Plasticity, Task
from tests.helpers.networks import outputs_of, random_networks

CONFIGURATION = load_configuration("smoke")
TASKS = ["cartpole", "lunar_lander", "hopper", "bipedal_walker"]


def task_of(name: str, max_steps: int = 60) -> Task:
    return CONFIGURATION.tasks[name].model_copy(update={"max_steps": max_steps})


def plasticity_of(rule: str, **changes: object) -> Plasticity:
    return Plasticity(
        **(CONFIGURATION.plasticity.model_dump() | {"rule": rule, "learning_rate": 0.25} | changes)
    )


def seeds_of(population: int, episodes: int = 1) -> npt.NDArray[np.uint64]:
    return np.arange(population * episodes, dtype=np.uint64).reshape(population, episodes)


@pytest.mark.parametrize("name", TASKS)
def test_returns_and_steps_are_gymnasiums(name: str) -> None:
    """Without plasticity an episode is Gymnasium's loop around the forward pass."""
    task = task_of(name)
    inputs, outputs = network_size(task)
    networks = random_networks(np.random.default_rng(0), 4, inputs, outputs)
    engine = ReferenceEngine(task)
    rollouts = engine.evaluate(networks, seeds_of(4), plasticity_of("none"))
    for index in range(4):
        environment = gymnasium.make(task.environment, max_episode_steps=task.max_steps)
        observation, _ = environment.reset(seed=index)
        total, steps, done = 0.0, 0, False
        while not done:
            out = outputs_of(networks, index, np.asarray(observation, dtype=np.float64))
            discrete = isinstance(environment.action_space, gymnasium.spaces.Discrete)
            action = int(out.argmax()) if discrete else np.clip(out, -1, 1).astype(np.float32)
            observation, reward, terminated, truncated, _ = environment.step(action)
            total, steps, done = total + float(reward), steps + 1, terminated or truncated
        assert rollouts.returns[index, 0] == total
        assert rollouts.steps[index, 0] == steps
    assert (rollouts.weight == networks.weight).all()
    assert not rollouts.failed.any()


@pytest.mark.parametrize("name", [*TASKS, "bipedal_walker_hardcore"])
def test_an_episode_is_a_function_of_seed_and_network(name: str) -> None:
    """The order of networks does not change any episode."""
    task = task_of(name)
    inputs, outputs = network_size(task)
    networks = random_networks(np.random.default_rng(1), 6, inputs, outputs)
    seeds, engine = seeds_of(6), ReferenceEngine(task)
    whole = engine.evaluate(networks, seeds, plasticity_of("oja"))
    bounds = networks.edge_bounds
    for index in np.random.default_rng(2).permutation(6):
        alone = engine.evaluate(
            networks.slice(index, index + 1), seeds[index : index + 1], plasticity_of("oja")
        )
        assert alone.returns[0] == whole.returns[index]
        assert alone.steps[0] == whole.steps[index]
        assert (alone.weight == whole.weight[bounds[index] : bounds[index + 1]]).all()


@pytest.mark.slow
def test_workers_return_the_same_bits() -> None:
    task = task_of("cartpole", max_steps=200)
    networks = random_networks(np.random.default_rng(3), 20, 4, 2)
    seeds = seeds_of(20, 2)
    expected = ReferenceEngine(task).evaluate(networks, seeds, plasticity_of("bcm"))
    engine = make_engine(task, "reference", workers=2)
    spread = engine.evaluate(networks, seeds, plasticity_of("bcm"))
    engine.close()
    for part in ("returns", "steps", "weight", "threshold", "failed"):
        assert (getattr(spread, part) == getattr(expected, part)).all()


def test_write_back_carries_weights_from_episode_to_episode() -> None:
    task = task_of("cartpole", max_steps=200)
    networks = random_networks(np.random.default_rng(4), 1, 4, 2)
    engine = ReferenceEngine(task)

    def final_weight(write_back: bool, seeds: list[int]) -> npt.NDArray[np.float64]:
        return engine.evaluate(
            networks,
            np.array([seeds], dtype=np.uint64),
            plasticity_of("hebb", write_back=write_back),
        ).weight

    assert (final_weight(False, [1, 2]) == final_weight(False, [2])).all()
    assert (final_weight(True, [1, 2]) != final_weight(False, [2])).any()


def test_a_watched_episode_is_the_same_episode() -> None:
    task = task_of("cartpole", max_steps=200)
    network = random_networks(np.random.default_rng(7), 1, 4, 2)
    engine, plasticity = ReferenceEngine(task), plasticity_of("bcm")
    expected = engine.evaluate(network, np.array([[9]], dtype=np.uint64), plasticity)
    watched: list[tuple[float, npt.NDArray[np.float64], npt.NDArray[np.float64]]] = []

    def observe(step: Step) -> None:
        watched.append((step.reward, step.weight.copy(), step.threshold.copy()))

    assert engine.watch(network, 9, plasticity, observe) == expected.returns[0, 0]
    rewards, weights, thresholds = zip(*watched, strict=True)
    assert len(rewards) == expected.steps[0, 0]
    assert sum(rewards) == expected.returns[0, 0]
    assert (weights[-1] == expected.weight).all()
    assert (thresholds[-1] == expected.threshold).all()

    watched.clear()
    engine.watch(network, 9, plasticity, observe, plastic_steps=5)
    assert (watched[4][1] == weights[4]).all(), "learns in the first five steps"
    assert (watched[-1][1] == weights[4]).all(), "and no longer"
    assert (watched[-1][1] != weights[-1]).any()


class Broken(gymnasium.Env[npt.NDArray[np.float32], int]):
    """Ends after five steps; before that, `broken` becomes something that is not finite."""

    observation_space = gymnasium.spaces.Box(-1, 1, (2,))
    action_space = gymnasium.spaces.Discrete(2)

    def __init__(self, broken: str) -> None:
        self.broken = broken

    def reset(self, *, seed=None, options=None):  # type: ignore[no-untyped-def]
        self.steps = 0
        return np.ones(2, dtype=np.float32), {}

    def step(self, action):  # type: ignore[no-untyped-def]
        self.steps += 1
        now = self.steps == 3
        observation = np.full(2, np.nan if now and self.broken == "observation" else 1.0)
        reward = {"reward": np.inf if now else 1.0, "sum": 1e308}.get(self.broken, 1.0)
        return observation.astype(np.float32), reward, self.steps == 5, False, {}


@pytest.mark.parametrize(
    ("broken", "steps"), [("observation", 3), ("reward", 3), ("sum", 2), ("none", 5)]
)
def test_what_is_not_finite_fails_its_network_alone(broken: str, steps: int) -> None:
    gymnasium.register("Broken-v0", Broken, kwargs={"broken": broken})
    task = Task(name="broken", environment="Broken-v0", max_steps=9, fresh_world=False)
    networks = random_networks(np.random.default_rng(5), 2, 2, 2)
    rollouts = ReferenceEngine(task).evaluate(networks, seeds_of(2, 2), plasticity_of("oja"))
    gymnasium.registry.pop("Broken-v0")
    assert rollouts.failed.tolist() == [broken != "none"] * 2
    assert rollouts.steps[0, 0] == steps
    if broken != "none":
        assert np.isnan(rollouts.returns).all()
        assert rollouts.steps[0, 1] == 0, "a failed network plays no further episode"


def test_environments_without_networks_are_refused() -> None:
    for environment, reason in (
        ("Nowhere-v0", "no environment Nowhere-v0"),
        ("FrozenLake-v1", "a network needs a flat Box"),
        ("CarRacing-v3", "a network needs a flat Box"),
    ):
        task = Task(name="t", environment=environment, max_steps=9, fresh_world=True)
        with pytest.raises(UserError, match=reason):
            make_environment(task)


def test_continuous_actions_stay_within_their_bounds() -> None:
    task = Task(name="p", environment="Pendulum-v1", max_steps=20, fresh_world=False)
    networks = random_networks(np.random.default_rng(6), 3, 3, 1, weight_sd=100.0)
    rollouts = ReferenceEngine(task).evaluate(networks, seeds_of(3), plasticity_of("none"))
    assert (rollouts.steps == 20).all()
