"""Gymnasium's Hopper-v4 in compiled code, bit for bit.

Every line follows `HopperEnv` and `MujocoEnv`, without mj_forward after a reset and
mj_rnePostConstraint after a step, whose results affect neither observation, reward nor the next
step. mj_step is our own if it gives the same bits, otherwise that of the mujoco wheel's library.
"""

import ctypes
import math
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import mujoco
import numpy as np
import numpy.typing as npt

from neol.base.c_calls import address, call_void
from neol.base.kernel import loop_kernel
from neol.random.pcg64 import State, uniform
from neol.rollout.episodes import Batch, Slots, play_batch
from neol.rollout.worlds.hopper.check import own_step
from neol.rollout.worlds.hopper.model import WORK, Array, Struct, hopper_of, load_model
from neol.rollout.worlds.hopper.runge_kutta import step
from neol.spec.constants import Task

TELLS_ADDRESSES = all(hasattr(kind, "_address") for kind in (mujoco.MjModel, mujoco.MjData))
"""Whether MuJoCo's bindings give the addresses of its structs.

Compiled code needs them, and only this private attribute has them.
"""

FRAME_SKIP = 4
SECONDS = 0.002 * FRAME_SKIP
RESET_NOISE = 5e-3
CONTROL_COST = np.float32(1e-3)
HEALTHY_REWARD = 1.0
SPEED_LIMIT = 10.0


class World(NamedTuple):
    """A hopper: addresses of C functions and structs, and views of the state within mjData."""

    mj_reset_data: int
    mj_step: int
    model: int
    data: int
    rest: Array
    """float64[6]: initial positions, before an episode's noise is added."""
    position: Array
    """float64[6]: x, z, and the angles of torso, thigh, leg and foot."""
    velocity: Array
    """float64[6]."""
    control: Array
    """float64[3]: torques of thigh, leg and foot."""
    warm_start: Array
    """float64[6]: acceleration that the next step's solver starts from."""
    own_step: bool
    """Whether our own step has MuJoCo's bits."""
    hopper: Struct
    work: Struct

    @loop_kernel
    def reset(self, slot: int, random: State, observation: Array) -> None:
        """Begin an episode with numbers from the random stream."""
        call_void(self.mj_reset_data, self.model, self.data)
        for i in range(6):
            self.position[i] = self.rest[i] + uniform(-RESET_NOISE, RESET_NOISE, random)
        for i in range(6):
            self.velocity[i] = uniform(-RESET_NOISE, RESET_NOISE, random)
        observe(self, observation[slot])

    @loop_kernel
    def step(
        self,
        playing: npt.NDArray[np.int64],
        outputs: Array,
        observation: Array,
        reward: Array,
        ended: npt.NDArray[np.bool_],
    ) -> None:
        """Turn the joints by the three outputs; the world has one hopper in one slot."""
        for slot in playing:
            reward[slot] = turn(self, outputs[slot])
            observe(self, observation[slot])
            ended[slot] = not is_healthy(self)

    @loop_kernel
    def play(self, batch: Batch, slots: Slots) -> None:
        """Play the episodes of a batch."""
        play_batch(self, batch, slots)


@loop_kernel
def turn(world: World, outputs: Array) -> float:
    """Take a step with the outputs as torques, clipped to +-1; return the reward."""
    squares = np.float32(0.0)
    for i in range(3):
        action = np.float32(min(max(outputs[i], -1.0), 1.0))
        world.control[i] = action
        squares += action * action
    before = world.position[0]
    for _ in range(FRAME_SKIP):
        if not (world.own_step and advance(world)):
            call_void(world.mj_step, world.model, world.data)
    speed = (world.position[0] - before) / SECONDS
    reward: float = speed + HEALTHY_REWARD - CONTROL_COST * squares
    return reward


@loop_kernel
def advance(world: World) -> bool:
    """Take our own step; return False if MuJoCo must take it."""
    return step(
        world.hopper, world.work, world.position, world.velocity, world.control, world.warm_start
    )


@loop_kernel
def observe(world: World, observation: Array) -> None:
    """Write the observation, float64[11]: positions without x, and velocities clipped to +-10."""
    for i in range(1, 6):
        observation[i - 1] = world.position[i]
    for i in range(6):
        observation[5 + i] = min(max(world.velocity[i], -SPEED_LIMIT), SPEED_LIMIT)


@loop_kernel
def is_healthy(world: World) -> bool:
    """Whether the hopper stands: height, torso angle and all other numbers but x within bounds."""
    healthy = 0.7 < world.position[1] < math.inf and -0.2 < world.position[2] < 0.2
    for i in range(2, 6):
        healthy &= -100.0 < world.position[i] < 100.0
    for i in range(6):
        healthy &= -100.0 < world.velocity[i] < 100.0
    return bool(healthy)


class Simulation:
    """Owner of MuJoCo's model and data of one hopper, which live as long as this object."""

    slots = 1

    def __init__(self) -> None:
        self._model = load_model()
        self._data = mujoco.MjData(self._model)
        assert self._model.opt.timestep * FRAME_SKIP == SECONDS
        library = ctypes.CDLL(str(next(Path(mujoco.__file__).parent.glob("libmujoco*"))))
        # MuJoCo's bindings install a timer for a profile that is not used here; it takes a seventh
        # of a step. This disables MuJoCo's timer for the whole process.
        ctypes.c_void_p.in_dll(library, "mjcb_time").value = None
        self.world = World(
            mj_reset_data=address(library.mj_resetData),
            mj_step=address(library.mj_step),
            model=self._model._address,
            data=self._data._address,
            rest=self._data.qpos.copy(),
            position=self._data.qpos,
            velocity=self._data.qvel,
            control=self._data.ctrl,
            warm_start=self._data.qacc_warmstart,
            own_step=own_step(),
            hopper=hopper_of(self._model),
            work=np.zeros((), WORK)[()],
        )


def simulations(_task: Task) -> Callable[[], Simulation] | str:
    """Return the maker of the task's simulations, or why there is none."""
    if not TELLS_ADDRESSES:
        return "this version of mujoco hides the addresses of its structs"
    return Simulation
