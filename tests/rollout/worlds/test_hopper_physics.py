"""Our own steps of the hopper against MuJoCo's: equal, and differences are detected."""

import platform

import mujoco
import numpy as np
import pytest

from neol.base.errors import NOTICE
from neol.base.kernel import kernel
from neol.random.pcg64 import seed_pcg64, uniform
from neol.rollout.worlds.hopper import check
from neol.rollout.worlds.hopper import environment as hopper
from neol.rollout.worlds.hopper.model import HOPPER, Struct, hopper_of, load_model, model_path
from tests.helpers.stepwise import Array
from tests.rollout.worlds.test_hopper import STANDING, stand

pytestmark = pytest.mark.skipif(
    platform.machine() != "x86_64", reason="MuJoCo is compiled with fused multiply-adds"
)


@kernel
def count_equal_steps(
    one: hopper.World, other: hopper.World, policy: Array, noise: float, steps: int, seed: int
) -> int:
    """Play two hoppers by one noisy linear policy; return the steps to the first unequal bit.

    An episode goes on for a while when the hopper has fallen, so that it also lies and folds up.
    """
    random, again = np.empty(4, dtype=np.uint64), np.empty(4, dtype=np.uint64)
    observation, outputs = np.empty((1, 11)), np.empty(3)
    seed_pcg64(np.uint64(seed), random)
    left = 0
    for count in range(steps):
        if left == 0:
            left = 1000
            again[:] = random
            one.reset(0, random, observation)
            other.reset(0, again, observation)
        for i in range(3):
            outputs[i] = uniform(-noise, noise, random)
            for j in range(11):
                outputs[i] += policy[i, j] * observation[0, j]
        reward, other_reward = hopper.turn(one, outputs), hopper.turn(other, outputs)
        for i in range(6):
            if one.position[i] != other.position[i] or one.velocity[i] != other.velocity[i]:
                return count
        if reward != other_reward:
            return count
        hopper.observe(one, observation[0])
        left -= 1
        if not hopper.is_healthy(one):
            left = min(left, 100)
    return steps


def library_world(simulation: hopper.Simulation) -> hopper.World:
    """A simulation's world, in which MuJoCo takes every step."""
    assert simulation.world.own_step
    return simulation.world._replace(own_step=False)


@pytest.mark.slow
def test_own_steps_have_the_bits_of_the_library() -> None:
    """Under policies that stand, that fall soon, that act at random, and of lying hoppers."""
    own, library = hopper.Simulation(), hopper.Simulation()
    random = np.random.default_rng(0)
    for noise in (0.0, 0.2, 2.0):
        for policy in (STANDING, np.zeros((3, 11)), *random.normal(size=(3, 3, 11))):
            worlds = own.world, library_world(library)
            assert count_equal_steps(*worlds, policy, noise, 3000, 1) == 3000


def test_standing_hoppers_need_no_step_of_the_library() -> None:
    simulation = hopper.Simulation()
    world = simulation.world._replace(mj_step=0)  # a call would crash
    observation, random = np.empty((1, 11)), np.array([1, 2, 3, 5], dtype=np.uint64)
    world.reset(0, random, observation)
    for _ in range(1000):
        hopper.turn(world, stand(observation[0]))
        hopper.observe(world, observation[0])
    assert hopper.is_healthy(world)


@pytest.mark.parametrize("value", [1e11, -np.inf, np.nan])
@pytest.mark.parametrize("name", ["position", "velocity"])
def test_what_is_beyond_all_measure_begins_anew_as_in_the_library(name: str, value: float) -> None:
    own, library = hopper.Simulation(), hopper.Simulation()
    for world in (own.world, library_world(library)):
        world.reset(0, np.array([1, 2, 3, 5], dtype=np.uint64), np.empty((1, 11)))
        getattr(world, name)[4] = value
        hopper.turn(world, np.ones(3))
    assert own.world.position.tolist() == library.world.position.tolist()
    assert own.world.velocity.tolist() == library.world.velocity.tolist()
    assert abs(own.world.position[1] - 1.25) < 0.01, "it was reset"


@pytest.mark.parametrize("folded", [(-2.6, -2.6, 0.7), (-1.0, -2.6, -0.7), (0.0, -2.6, 0.0)])
def test_parts_that_may_touch_are_left_to_the_library(folded: tuple[float, ...]) -> None:
    simulation = hopper.Simulation()
    world = simulation.world
    world.position[:] = 0.0, 1.25, 0.0, *folded
    before = world.position.copy()
    assert not hopper.advance(world)
    assert world.position.tolist() == before.tolist()


FAR_OFF = {
    "tolerance": 1e8,
    "search_tolerance": 1e8,
    "iterations": 0.01,
    "search_iterations": 0.02,
    "bound": 0.5,
    "limit": 0.2,
}
"""Factors where a change by a tenth would show in rare states only."""


def wrong(hopper_: Struct, name: str, index: tuple[int, ...]) -> Struct:
    """Return a hopper with one changed number."""
    changed = hopper_.copy()
    values = np.atleast_1d(changed[name]).copy()
    values[index] = 0.1 if values[index] == 0.0 else FAR_OFF.get(name, 0.9) * values[index]
    changed[name] = values.reshape(HOPPER[name].shape)
    return changed


@pytest.mark.parametrize("name", HOPPER.names)
def test_any_wrong_number_is_noticed(name: str) -> None:
    model = load_model()
    right = hopper_of(model)
    assert check.has_same_bits(model, right)
    for index in np.ndindex(HOPPER[name].shape or (1,)):
        assert not check.has_same_bits(model, wrong(right, name, index)), index


@pytest.mark.parametrize("flag", ["LIMIT", "CONTACT", "DAMPER", "GRAVITY", "WARMSTART", "REFSAFE"])
def test_another_way_of_computing_is_noticed(flag: str) -> None:
    """REFSAFE changes nothing of the hopper."""
    model = load_model()
    other = mujoco.MjModel.from_xml_path(str(model_path()))
    other.opt.disableflags |= getattr(mujoco.mjtDisableBit, f"mjDSBL_{flag}")
    assert check.has_same_bits(other, hopper_of(model)) == (flag == "REFSAFE")


def test_where_bits_differ_the_library_steps_and_a_line_says_so(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert check.own_step.__wrapped__()
    assert capsys.readouterr() == ("", "")
    changed = wrong(hopper_of(load_model()), "mass", (2,))
    monkeypatch.setattr(check, "hopper_of", lambda _: changed)
    assert not check.own_step.__wrapped__()
    notice = capsys.readouterr().err
    assert notice.startswith(f"{NOTICE}MuJoCo {mujoco.__version__} takes Hopper's steps")
    assert notice.count("\n") == 1
