"""The core against Gymnasium, new for each episode; one simulation of ours plays all of them."""

import ctypes
from collections.abc import Callable
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.envs.box2d.bipedal_walker import BipedalWalkerHeuristics
from gymnasium.envs.box2d.lunar_lander import heuristic

from neol.rollout.worlds.box2d import environment
from tests.helpers.stepwise import Array, compare_episode

LANDER, WALKER, HARDCORE = "LunarLander-v3", "BipedalWalker-v3", "BipedalWalkerHardcore-v3"
SIZES = {LANDER: (4, 8), WALKER: (4, 24), HARDCORE: (4, 24)}

Policy = Callable[[Array], Array]


def heuristic_policy(peer: gymnasium.Env[Any, Any]) -> Policy:
    """Gymnasium's own demonstration: it lands, or walks to the end."""
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


def play(library: ctypes.CDLL, task: str, episodes: range, limit: int) -> None:
    """Episodes of the policies in turn, a heuristic one among each six."""
    simulation = environment.Simulation(library, task)
    for seed in episodes:
        peer = gymnasium.make(task, max_episode_steps=limit, disable_env_checker=True)
        choices = policies(task, np.random.default_rng(seed))
        choices["heuristic"] = heuristic_policy(peer)
        policy = list(choices.values())[seed % len(choices)]
        compare_episode(simulation.world, peer, seed, policy)


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
    simulation = environment.Simulation(library, task)
    lengths = []
    for seed in range(seeds):
        peer = gymnasium.make(task, disable_env_checker=True)
        lengths.append(compare_episode(simulation.world, peer, seed, heuristic_policy(peer)))
    assert max(lengths) > (200 if task == LANDER else 1500)


def hover(observation: Array) -> Array:
    """Gymnasium's lander heuristic, aimed at a point above the pad."""
    x, y, x_speed, y_speed, angle, turn, *_ = observation
    tilt = 0.5 * (np.clip(0.5 * x + x_speed, -0.4, 0.4) - angle) - turn
    lift = 0.5 * (0.7 - y) - 0.5 * y_speed
    return np.array([0.05, tilt, max(lift, 0.0), -tilt])


def stand(_: Array) -> Array:
    """Legs that stay apart."""
    return np.array([0.7, 0.1, -0.4, -0.2])


@pytest.mark.parametrize(("task", "policy"), [(LANDER, hover), (WALKER, stand), (HARDCORE, stand)])
def test_an_episode_to_the_limit(library: ctypes.CDLL, task: str, policy: Policy) -> None:
    simulation = environment.Simulation(library, task)
    peer = gymnasium.make(task, disable_env_checker=True)
    assert peer.spec is not None
    steps = compare_episode(simulation.world, peer, 1, policy)
    assert steps == peer.spec.max_episode_steps


@pytest.mark.parametrize("task", SIZES)
def test_an_episode_depends_on_nothing_beside_it(library: ctypes.CDLL, task: str) -> None:
    """Another simulation that steps in turns with the first changes none of its bits."""
    simulation, other = (environment.Simulation(library, task) for _ in range(2))
    outputs, size = SIZES[task]
    observation = np.empty(size)
    random = np.random.default_rng(0)
    other.world.reset(np.array([1, 2, 3, 5], dtype=np.uint64), observation)

    def disturbed(_: Array) -> Array:
        other.world.step(random.uniform(-1, 1, outputs), observation)
        return random.uniform(-1, 1, outputs)

    peer = gymnasium.make(task, max_episode_steps=100, disable_env_checker=True)
    compare_episode(simulation.world, peer, 1, disturbed)


def test_a_failed_assertion_of_box2d_ends_the_episode(library: ctypes.CDLL) -> None:
    simulation = environment.Simulation(library, WALKER)
    observation = np.empty(24)
    simulation.world.reset(np.array([1, 2, 3, 5], dtype=np.uint64), observation)
    reward, ended = simulation.world.step(np.full(4, np.nan), observation)
    assert ended
    assert np.isnan(reward)
    assert np.isnan(observation).any()
    peer = gymnasium.make(WALKER, max_episode_steps=100, disable_env_checker=True)
    compare_episode(simulation.world, peer, 2, stand)


@pytest.mark.parametrize("task", [LANDER, WALKER])
def test_the_physics_alone_goes_where_steps_go(library: ctypes.CDLL, task: str) -> None:
    """What benchmarks time plays the very trajectory."""
    simulation = environment.Simulation(library, task)
    stream = np.array([1, 2, 3, 5], dtype=np.uint64)
    random = np.random.default_rng(0)
    outputs = random.uniform(-1, 1, (41, 4))
    actions = outputs.argmax(axis=1)[:, None] if task == LANDER else outputs
    actions = actions.astype(np.float32)
    stepped, replayed = np.empty(SIZES[task][1]), np.empty(SIZES[task][1])
    simulation.world.reset(stream, stepped)
    for output in outputs:
        simulation.world.step(output, stepped)
    simulation.world.reset(stream, replayed)
    pointer = actions.ctypes.data
    library.neol_physics(simulation.world.simulation, pointer, actions.shape[1], 40)
    simulation.world.step(outputs[40], replayed)
    assert replayed.tolist() == stepped.tolist()
