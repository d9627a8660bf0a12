"""The core against a new Gymnasium environment per episode; one simulation plays them all."""

import ctypes
from collections.abc import Callable
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.envs.box2d.bipedal_walker import BipedalWalkerHeuristics
from gymnasium.envs.box2d.lunar_lander import heuristic

from neol.random.pcg64 import seed_pcg64
from neol.rollout.worlds.box2d import environment
from neol.rollout.worlds.box2d.library import PATHS, available_paths, chosen_path
from tests.helpers.stepwise import Array, Slot, compare_episode

LANDER, WALKER, HARDCORE = "LunarLander-v3", "BipedalWalker-v3", "BipedalWalkerHardcore-v3"
SIZES = {LANDER: (4, 8), WALKER: (4, 24), HARDCORE: (4, 24)}

Policy = Callable[[Array], Array]


def heuristic_policy(peer: gymnasium.Env[Any, Any]) -> Policy:
    """Gymnasium's demonstration policy: it lands, or walks to the end."""
    if isinstance(peer.action_space, gymnasium.spaces.Discrete):
        return lambda observation: np.eye(4)[heuristic(peer.unwrapped, observation)]
    walker = BipedalWalkerHeuristics()
    return lambda observation: walker.step_heuristic(observation).astype(np.float64)


def policies(task: str, random: np.random.Generator) -> dict[str, Policy]:
    constant = random.uniform(-1, 1, 4)
    weight = random.normal(size=SIZES[task])
    return {
        "random": lambda _: random.uniform(-1, 1, 4),
        "saturated": lambda _: random.choice([-1.0, 1.0], 4),
        "nothing": lambda _: np.zeros(4),
        "constant": lambda _: constant,
        "linear": lambda observation: np.tanh(weight @ observation),
    }


class Alone(Slot):
    """Group of the core with one slot."""

    def __init__(self, library: ctypes.CDLL, task: str) -> None:
        self._simulation = environment.Simulation(library, task, chosen_path(library), 1)
        self.group = self._simulation.world.group
        super().__init__(self._simulation.world, SIZES[task][1])


def play(library: ctypes.CDLL, task: str, episodes: range, limit: int) -> None:
    """Episodes of the policies in turn, a heuristic one among each six."""
    slot = Alone(library, task)
    for seed in episodes:
        peer = gymnasium.make(task, max_episode_steps=limit, disable_env_checker=True)
        choices = policies(task, np.random.default_rng(seed))
        choices["heuristic"] = heuristic_policy(peer)
        policy = list(choices.values())[seed % len(choices)]
        compare_episode(slot, peer, seed, policy)


@pytest.mark.slow
def test_lunar_lander_equals_gymnasium(library: ctypes.CDLL) -> None:
    play(library, LANDER, range(360), 1000)


@pytest.mark.slow
@pytest.mark.parametrize("task", [WALKER, HARDCORE])
def test_bipedal_walker_equals_gymnasium(library: ctypes.CDLL, task: str) -> None:
    play(library, task, range(300), 80)


@pytest.mark.slow
@pytest.mark.parametrize(("task", "seeds"), [(LANDER, 12), (WALKER, 5), (HARDCORE, 7)])
def test_whole_episodes_of_heuristics(library: ctypes.CDLL, task: str, seeds: int) -> None:
    """Landings; walks to the far end, over obstacles, to the limit of steps."""
    slot = Alone(library, task)
    lengths = []
    for seed in range(seeds):
        peer = gymnasium.make(task, disable_env_checker=True)
        lengths.append(compare_episode(slot, peer, seed, heuristic_policy(peer)))
    assert max(lengths) > (200 if task == LANDER else 1500)


def hover(observation: Array) -> Array:
    """Gymnasium's lander heuristic, aimed at a point above the pad."""
    x, y, x_speed, y_speed, angle, turn, *_ = observation
    tilt = 0.5 * (np.clip(0.5 * x + x_speed, -0.4, 0.4) - angle) - turn
    lift = 0.5 * (0.7 - y) - 0.5 * y_speed
    return np.array([0.05, tilt, max(lift, 0.0), -tilt])


def stand(_: Array) -> Array:
    """Policy whose legs stay apart."""
    return np.array([0.7, 0.1, -0.4, -0.2])


@pytest.mark.parametrize(("task", "policy"), [(LANDER, hover), (WALKER, stand), (HARDCORE, stand)])
def test_an_episode_to_the_limit(library: ctypes.CDLL, task: str, policy: Policy) -> None:
    slot = Alone(library, task)
    peer = gymnasium.make(task, disable_env_checker=True)
    assert peer.spec is not None
    steps = compare_episode(slot, peer, 1, policy)
    assert steps == peer.spec.max_episode_steps


@pytest.mark.parametrize("task", SIZES)
def test_an_episode_depends_on_nothing_beside_it(library: ctypes.CDLL, task: str) -> None:
    """Another simulation that steps in turns with the first changes none of its bits."""
    slot, other = Alone(library, task), Alone(library, task)
    random = np.random.default_rng(0)
    other.reset(6)

    def disturbed(_: Array) -> Array:
        other.step(random.uniform(-1, 1, 4))
        return random.uniform(-1, 1, 4)

    peer = gymnasium.make(task, max_episode_steps=100, disable_env_checker=True)
    compare_episode(slot, peer, 1, disturbed)


@pytest.mark.slow
@pytest.mark.parametrize("path", PATHS)
def test_a_failed_assertion_of_box2d_ends_its_own_episode_alone(
    library: ctypes.CDLL, path: str
) -> None:
    if path not in available_paths(library):
        pytest.skip(f"this machine has no {path}")
    simulation = environment.Simulation(library, WALKER, path, slots=20)
    world = simulation.world
    slots, alone = np.arange(20), Alone(library, WALKER)
    outputs, observation = np.tile(stand(np.empty(0)), (20, 1)), np.empty((20, 24))
    reward, ended = np.empty(20), np.empty(20, dtype=np.bool_)
    random = np.empty(4, dtype=np.uint64)
    for slot in slots:
        seed_pcg64(np.uint64(slot), random)
        world.reset(slot, random, observation)
    for step in range(30):
        outputs[step % 3 * 5, 1] = np.nan if step >= 15 else 0.1
        world.step(slots, outputs, observation, reward, ended)
        failed = ended & np.isnan(reward) & np.isnan(observation[:, 0])
        assert failed.tolist() == ended.tolist()
        slots = slots[~ended[slots]]
    assert sorted(set(range(20)) - set(slots.tolist())) == [0, 5, 10]
    for slot in slots:
        alone.reset(slot)
        for _ in range(30):
            last, _ = alone.step(outputs[slot])
        assert alone.observation.tolist() == observation[slot].tolist()
        assert last == reward[slot]
    world.reset(5, random, observation)
    world.step(np.array([5]), np.zeros_like(outputs), observation, reward, ended)
    assert np.isfinite(observation[5]).all() and not ended[5]


@pytest.mark.parametrize("task", [LANDER, WALKER])
def test_the_physics_alone_goes_where_steps_go(library: ctypes.CDLL, task: str) -> None:
    """The timed physics plays exactly the recorded trajectory."""
    slot = Alone(library, task)
    outputs = np.random.default_rng(0).uniform(-1, 1, (41, 4))
    actions = outputs.argmax(axis=1)[:, None] if task == LANDER else outputs
    actions = actions.astype(np.float32)
    slot.reset(1)
    for output in outputs:
        slot.step(output)
    stepped = slot.observation.tolist()
    slot.reset(1)
    library.neol_physics(slot.group, actions.ctypes.data, actions.shape[1], 40)
    slot.step(outputs[40])
    assert slot.observation.tolist() == stepped
