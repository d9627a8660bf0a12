"""Recorded episodes, so that all measurements use exactly the same steps.

`record` lets networks play in the fast engine and keeps what passed between them and the world.
Then the physics is stepped again under the recorded actions, without network or learning; and
the networks play again in a world that only plays back what it gave them: what is left is the
cost of network and plasticity.
"""

import ctypes
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any, NamedTuple

import gymnasium
import numpy as np
import numpy.typing as npt

from neol.base.c_calls import call_void
from neol.base.kernel import kernel, loop_kernel
from neol.network.forward import Networks
from neol.random.pcg64 import State, seed_pcg64
from neol.rollout.engine import Engine, Rollouts
from neol.rollout.environment import make_environment
from neol.rollout.episodes import Batch, Slots, play_batch
from neol.rollout.fast import FastEngine
from neol.rollout.worlds.box2d import library as box2d
from neol.rollout.worlds.hopper.environment import FRAME_SKIP
from neol.spec.constants import Plasticity, Task

Array = npt.NDArray[np.float64]


@loop_kernel
def copy(source: Array, target: Array) -> None:
    """Copy one row to another."""
    for i in range(len(target)):
        target[i] = source[i]


class Recorder(NamedTuple):
    """World of one slot that passes everything on to another and records it."""

    world: Any
    row: npt.NDArray[np.int64]
    """int64[1]: number of rows in use."""
    observation: Array
    """float64[rows, inputs]: observation of each reset and each step."""
    output: Array
    """float64[rows, outputs]: outputs of the step that led to the row's observation."""
    reward: Array
    """float64[rows]: reward of that step."""
    ended: npt.NDArray[np.bool_]
    """bool[rows]: whether it ended the episode."""

    @loop_kernel
    def reset(self, slot: int, random: State, observation: Array) -> None:
        self.world.reset(slot, random, observation)
        copy(observation[slot], self.observation[self.row[0]])
        self.row[0] += 1

    @loop_kernel
    def step(
        self,
        playing: npt.NDArray[np.int64],
        outputs: Array,
        observation: Array,
        reward: Array,
        ended: npt.NDArray[np.bool_],
    ) -> None:
        self.world.step(playing, outputs, observation, reward, ended)
        row = self.row[0]
        copy(outputs[0], self.output[row])
        copy(observation[0], self.observation[row])
        self.reward[row], self.ended[row] = reward[0], ended[0]
        self.row[0] += 1

    @loop_kernel
    def play(self, batch: Batch, slots: Slots) -> None:
        """Let the networks of a batch play their episodes here."""
        play_batch(self, batch, slots)


class Playback(NamedTuple):
    """World of one slot that gives recorded observations and rewards to any network."""

    row: npt.NDArray[np.int64]
    observation: Array
    reward: Array
    ended: npt.NDArray[np.bool_]

    @loop_kernel
    def reset(self, slot: int, random: State, observation: Array) -> None:
        row = self.row[0]
        copy(self.observation[row], observation[slot])
        self.row[0] = row + 1

    @loop_kernel
    def step(
        self,
        playing: npt.NDArray[np.int64],
        outputs: Array,
        observation: Array,
        reward: Array,
        ended: npt.NDArray[np.bool_],
    ) -> None:
        row = self.row[0]
        copy(self.observation[row], observation[0])
        reward[0], ended[0] = self.reward[row], self.ended[row]
        self.row[0] = row + 1

    @loop_kernel
    def play(self, batch: Batch, slots: Slots) -> None:
        """Let the networks of a batch play their episodes here."""
        play_batch(self, batch, slots)


@dataclass(frozen=True)
class Recording:
    """Recorded episodes of a batch of networks, one episode each."""

    task: Task
    engine: FastEngine
    networks: Networks
    seeds: npt.NDArray[np.uint64]
    plasticity: Plasticity
    rollouts: Rollouts
    log: Recorder

    @property
    def steps(self) -> int:
        """Environment steps of all episodes."""
        return int(self.rollouts.steps.sum())

    def episodes(self) -> Iterator[tuple[np.uint64, Array]]:
        """Yield each episode's seed and its network's outputs, float64[steps, outputs]."""
        row = 0
        for seed, steps in zip(self.seeds[:, 0], self.rollouts.steps[:, 0], strict=True):
            yield seed, self.log.output[row + 1 : row + 1 + steps]
            row += 1 + steps

    def playback(self) -> Engine:
        """Return an engine for these networks in which the world takes no time."""
        log = self.log
        world = Playback(np.zeros(1, dtype=np.int64), log.observation, log.reward, log.ended)
        return FastEngine(lambda: SimpleNamespace(world=world, slots=1), self.task.max_steps)

    def play_back(self, rule: str) -> Rollouts:
        """Play the recorded episodes again with networks that learn by a rule."""
        plasticity = self.plasticity.model_copy(update={"rule": rule})
        return self.playback().evaluate(self.networks, self.seeds, plasticity)


def record(
    task: Task,
    engine: Engine,
    networks: Networks,
    seeds: npt.NDArray[np.uint64],
    plasticity: Plasticity,
) -> Recording:
    """Play and record one episode with each network."""
    assert isinstance(engine, FastEngine)
    assert seeds.shape[1] == 1
    rollouts = engine.evaluate(networks, seeds, plasticity)
    assert not rollouts.failed.any()
    rows = int(rollouts.steps.sum()) + len(seeds)
    simulation = engine.make_simulation()
    log = Recorder(
        world=simulation.world,
        row=np.zeros(1, dtype=np.int64),
        observation=np.empty((rows, networks.inputs)),
        output=np.empty((rows, networks.outputs)),
        reward=np.empty(rows),
        ended=np.zeros(rows, dtype=np.bool_),
    )
    recorder = FastEngine(
        lambda: SimpleNamespace(world=log, slots=1, owner=simulation), task.max_steps
    )
    again = recorder.evaluate(networks, seeds, plasticity)
    assert again.returns.tolist() == rollouts.returns.tolist()
    return Recording(task, engine, networks, seeds, plasticity, rollouts, log)


def seconds_of_physics(recording: Recording) -> float:
    """Return the CPU seconds of the physics' steps under the recorded actions.

    LunarLander and BipedalWalker: the core's `neol_physics`, which sets forces and motors, calls
    the unmodified b2World::Step and, for the walker, casts its ten rays by b2World::RayCast.
    Hopper: four mj_step a step.
    CartPole's physics is a handful of additions inside our kernel: there is nothing to step.
    """
    simulation = recording.engine.make_simulation()
    world = simulation.world
    random = np.empty(4, dtype=np.uint64)
    observation = np.empty((1, recording.networks.inputs))
    seconds = 0.0
    for seed, outputs in recording.episodes():
        replay = _replay(recording.task, world, outputs)
        seed_pcg64(seed, random)
        world.reset(0, random, observation)
        start = time.process_time()
        replay()
        seconds += time.process_time() - start
    return seconds


def seconds_of_resets(recording: Recording) -> float:
    """Return the CPU seconds of our engine's resets, from the seed to the first observation."""
    simulation = recording.engine.make_simulation()
    start = time.process_time()
    _reset_all(simulation.world, recording.seeds, np.empty((1, recording.networks.inputs)))
    return time.process_time() - start


@kernel
def _reset_all(world: Any, seeds: npt.NDArray[np.uint64], observation: Array) -> None:
    random = np.empty(4, dtype=np.uint64)
    for episode in range(len(seeds)):
        seed_pcg64(seeds[episode, 0], random)
        world.reset(0, random, observation)


def _replay(task: Task, world: Any, outputs: Array) -> Callable[[], None]:
    """Return a function that steps the physics through an episode's actions."""
    actions = np.clip(outputs, -1.0, 1.0).astype(np.float32)
    if task.environment == "Hopper-v4":
        controls = actions.astype(np.float64)
        return lambda: _step_mujoco(world, controls)
    if world.discrete:
        actions = np.argmax(outputs, axis=1).astype(np.float32).reshape(-1, 1)
    core = box2d.load()
    assert isinstance(core, ctypes.CDLL)
    steps, width = actions.shape
    return lambda: core.neol_physics(world.group, actions.ctypes.data, width, steps)


@kernel
def _step_mujoco(world: Any, controls: Array) -> None:
    for step in range(len(controls)):
        world.control[:] = controls[step]
        for _ in range(FRAME_SKIP):
            call_void(world.mj_step, world.model, world.data)


def seconds_of_gymnasium(recording: Recording) -> float:
    """Return the CPU seconds of Gymnasium's `env.step` alone under the recorded actions."""
    environment = make_environment(recording.task)
    seconds = 0.0
    for seed, outputs in recording.episodes():
        if recording.task.fresh_world:
            environment.close()
            environment = make_environment(recording.task)
        environment.reset(seed=int(seed))
        actions = _actions(environment.action_space, outputs)
        start = time.process_time()
        for action in actions:
            environment.step(action)
        seconds += time.process_time() - start
    environment.close()
    return seconds


def _actions(space: Any, outputs: Array) -> list[Any]:
    if isinstance(space, gymnasium.spaces.Discrete):
        chosen: list[Any] = np.argmax(outputs, axis=1).tolist()
        return chosen
    return list(np.clip(outputs, space.low, space.high).astype(space.dtype))
