"""Gymnasium's CartPole-v1 in compiled code, bit for bit: `CartPoleEnv` is the source of every line.

The state is float64; an observation is the state rounded to float32, widened again for the network.
"""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from neol.base.kernel import kernel
from neol.random.pcg64 import State, uniform
from neol.rollout.episodes import Batch, play_batch

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
    """A cart with a pole."""

    state: Array
    """float64[4]: position, velocity, angle, angular velocity."""

    @kernel
    def reset(self, random: State, observation: Array) -> None:
        """Begin an episode with draws from the random stream."""
        for i in range(4):
            self.state[i] = uniform(-0.05, 0.05, random)
            observation[i] = np.float32(self.state[i])

    @kernel
    def step(self, outputs: Array, observation: Array) -> tuple[float, bool]:
        """Push the cart to the larger output's side: reward, and whether the episode ended."""
        x, x_dot, theta, theta_dot = self.state
        force = FORCE if np.argmax(outputs) == 1 else -FORCE
        cos, sin = math.cos(theta), math.sin(theta)
        temp = (force + POLE_MASS_LENGTH * (theta_dot * theta_dot) * sin) / TOTAL_MASS
        angular_acceleration = (GRAVITY * sin - cos * temp) / (
            HALF_LENGTH * (4.0 / 3.0 - POLE_MASS * (cos * cos) / TOTAL_MASS)
        )
        acceleration = temp - POLE_MASS_LENGTH * angular_acceleration * cos / TOTAL_MASS
        x += SECONDS * x_dot
        theta += SECONDS * theta_dot
        self.state[0] = x
        self.state[1] = x_dot + SECONDS * acceleration
        self.state[2] = theta
        self.state[3] = theta_dot + SECONDS * angular_acceleration
        for i in range(4):
            observation[i] = np.float32(self.state[i])
        terminated = (
            x < -POSITION_LIMIT or x > POSITION_LIMIT or theta < -ANGLE_LIMIT or theta > ANGLE_LIMIT
        )
        return 1.0, terminated

    @kernel
    def play(self, batch: Batch, begin: int, end: int) -> None:
        """Let networks begin to end of a batch play their episodes here."""
        play_batch(self, batch, begin, end)


class Simulation:
    """A cart with a pole, in memory of its own."""

    def __init__(self) -> None:
        self.world = World(np.empty(4))
