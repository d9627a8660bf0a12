"""LunarLander-v3 and BipedalWalker-v3 (and its hardcore variant): the C++ core in a kernel's hands.

The core's episodes equal Gymnasium's in every bit of observations, rewards and ends, where
Gymnasium's environment is new for each episode.
"""

import ctypes
import weakref
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from neol.base.c_calls import address, call_int
from neol.base.kernel import kernel
from neol.random.pcg64 import State
from neol.rollout.episodes import Batch, play_batch
from neol.rollout.worlds.box2d.library import TASKS

Array = npt.NDArray[np.float64]


class World(NamedTuple):
    """A simulation of the core: its C functions and itself by address, and room for a step."""

    neol_reset: int
    neol_step: int
    simulation: int
    discrete: bool
    action: npt.NDArray[np.float32]
    """float32[4]: how hard the walker's joints turn; or, first, the number of LunarLander's."""
    reward: Array
    """float64[1]."""

    @kernel
    def reset(self, random: State, observation: Array) -> None:
        """Begin an episode in a new world with draws from the random stream."""
        call_int(self.neol_reset, self.simulation, random, observation)

    @kernel
    def step(self, outputs: Array, observation: Array) -> tuple[float, bool]:
        """Fire the engine or turn the joints: reward, and whether the episode ended."""
        if self.discrete:
            self.action[0] = np.argmax(outputs)
        else:
            for i in range(4):
                self.action[i] = min(max(outputs[i], -1.0), 1.0)
        ended: int = call_int(
            self.neol_step, self.simulation, self.action, observation, self.reward
        )
        return self.reward[0], ended != 0

    @kernel
    def play(self, batch: Batch, begin: int, end: int) -> None:
        """Let networks begin to end of a batch play their episodes here."""
        play_batch(self, batch, begin, end)


class Simulation:
    """One simulation of the core, which lives as long as this object."""

    def __init__(self, library: ctypes.CDLL, environment: str) -> None:
        simulation = library.neol_create(TASKS.index(environment))
        weakref.finalize(self, library.neol_destroy, simulation)
        self.world = World(
            neol_reset=address(library.neol_reset),
            neol_step=address(library.neol_step),
            simulation=simulation,
            discrete=environment == "LunarLander-v3",
            action=np.zeros(4, dtype=np.float32),
            reward=np.zeros(1),
        )
