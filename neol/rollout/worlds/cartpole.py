"""Gymnasium's CartPole-v1 in compiled code, bit for bit; every line follows `CartPoleEnv`.

The state is float64; an observation is the state rounded to float32 and widened for the network.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from neol.base.kernel import loop_kernel
from neol.random.pcg64 import State, uniform
from neol.rollout.episodes import Batch, Slots, play_batch
from neol.spec.constants import Task

Array = npt.NDArray[np.float64]

GRAVITY = 9.8
POLE_MASS = 0.1
TOTAL_MASS = POLE_MASS + 1.0
HALF_LENGTH = 0.5
POLE_MASS_LENGTH = POLE_MASS * HALF_LENGTH
FORCE = 10.0
SECONDS = 0.02
ANGLE_LIMIT = 12 * 2 * math.pi / 360
POSITION_LIMIT = 2.4


class World(NamedTuple):
    """Carts with one pole each."""

    state: Array
    """float64[slots, 4]: position, velocity, angle, angular velocity."""

    @loop_kernel
    def reset(self, slot: int, random: State, observation: Array) -> None:
        """Begin an episode with numbers from the random stream."""
        for i in range(4):
            self.state[slot, i] = uniform(-0.05, 0.05, random)
            observation[slot, i] = np.float32(self.state[slot, i])

    @loop_kernel
    def step(
        self,
        playing: npt.NDArray[np.int64],
        outputs: Array,
        observation: Array,
        reward: Array,
        ended: npt.NDArray[np.bool_],
    ) -> None:
        """Push each cart to the side of the larger output."""
        for slot in playing:
            ended[slot] = push(self.state[slot], outputs[slot], observation[slot])
            reward[slot] = 1.0

    @loop_kernel
    def play(self, batch: Batch, slots: Slots) -> None:
        """Play the episodes of a batch."""
        play_batch(self, batch, slots)


@loop_kernel
def push(state: Array, outputs: Array, observation: Array) -> bool:
    """Take a step with one cart; return whether the episode has ended."""
    x, x_dot, theta, theta_dot = state
    force = FORCE if np.argmax(outputs) == 1 else -FORCE
    cos, sin = math.cos(theta), math.sin(theta)
    temp = (force + POLE_MASS_LENGTH * (theta_dot * theta_dot) * sin) / TOTAL_MASS
    angular_acceleration = (GRAVITY * sin - cos * temp) / (
        HALF_LENGTH * (4.0 / 3.0 - POLE_MASS * (cos * cos) / TOTAL_MASS)
    )
    acceleration = temp - POLE_MASS_LENGTH * angular_acceleration * cos / TOTAL_MASS
    x += SECONDS * x_dot
    theta += SECONDS * theta_dot
    state[0] = x
    state[1] = x_dot + SECONDS * acceleration
    state[2] = theta
    state[3] = theta_dot + SECONDS * angular_acceleration
    for i in range(4):
        observation[i] = np.float32(state[i])
    return bool(
        x < -POSITION_LIMIT or x > POSITION_LIMIT or theta < -ANGLE_LIMIT or theta > ANGLE_LIMIT
    )


class Simulation:
    """Memory of the carts."""

    def __init__(self, slots: int = 1) -> None:
        self.slots = slots
        self.world = World(np.empty((slots, 4)))


def simulations(_task: Task) -> Callable[[], Simulation]:
    """Return the maker of the task's simulations."""
    return Simulation
