"""LunarLander-v3 and BipedalWalker-v3 (also hardcore): the C++ core, called from kernels.

Observations, rewards and ends of the core's episodes equal, bit for bit, those of a new Gymnasium
environment for each episode.
"""

import ctypes
import weakref
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from neol.base.c_calls import address, call_void
from neol.base.kernel import loop_kernel
from neol.random.pcg64 import State
from neol.rollout.episodes import Batch, Slots, play_batch
from neol.rollout.worlds.box2d import library as box2d
from neol.rollout.worlds.box2d.library import PATHS, TASKS
from neol.spec.constants import Task

Array = npt.NDArray[np.float64]


class World(NamedTuple):
    """A group of simulations of the core, as addresses of the group and its C functions."""

    neol_reset: int
    neol_step: int
    group: int
    discrete: bool
    action: npt.NDArray[np.float32]
    """float32[slots, 4]: torques of the walker's joints, or LunarLander's action in column 0."""

    @loop_kernel
    def reset(self, slot: int, random: State, observation: Array) -> None:
        """Begin an episode in a new world with numbers from the random stream."""
        call_void(self.neol_reset, self.group, np.int64(slot), random, observation[slot])

    @loop_kernel
    def step(
        self,
        playing: npt.NDArray[np.int64],
        outputs: Array,
        observation: Array,
        reward: Array,
        ended: npt.NDArray[np.bool_],
    ) -> None:
        """Fire the engines or turn the joints of the playing slots."""
        for slot in playing:
            if self.discrete:
                self.action[slot, 0] = np.argmax(outputs[slot])
            else:
                for i in range(4):
                    self.action[slot, i] = min(max(outputs[slot, i], -1.0), 1.0)
        call_void(
            self.neol_step,
            self.group,
            len(playing),
            playing,
            self.action,
            observation,
            reward,
            ended,
        )

    @loop_kernel
    def play(self, batch: Batch, slots: Slots) -> None:
        """Play the episodes of a batch."""
        play_batch(self, batch, slots)


class Simulation:
    """Owner of a group of simulations of the core, which lives as long as this object."""

    def __init__(self, library: ctypes.CDLL, environment: str, path: str, slots: int) -> None:
        group = library.neol_create(TASKS.index(environment), slots, PATHS.index(path))
        weakref.finalize(self, library.neol_destroy, group)
        self.slots = slots
        self.world = World(
            neol_reset=address(library.neol_reset),
            neol_step=address(library.neol_step),
            group=group,
            discrete=environment == "LunarLander-v3",
            action=np.zeros((slots, 4), dtype=np.float32),
        )


def simulations(task: Task) -> Callable[[], Simulation] | str:
    """Return the maker of groups of the task's simulations, or why there is none."""
    if task.environment != "LunarLander-v3" and not task.fresh_world:
        return "its C++ core plays every episode in a fresh world"
    library = box2d.load()
    if isinstance(library, str):
        return library
    path = box2d.chosen_path(library)
    return partial(Simulation, library, task.environment, path, box2d.SLOTS[path])
