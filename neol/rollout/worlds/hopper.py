"""Gymnasium's Hopper-v4 in compiled code, bit for bit, on the mujoco wheel's own library.

`HopperEnv` and `MujocoEnv` are the source of every line. Of what they call, only
mj_rnePostConstraint is left out: it fills in forces that neither the observation, the reward
nor the next step reads.
"""

import ctypes
import math
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

import mujoco
import numpy as np
import numpy.typing as npt

from neol.base.c_calls import address, call_void
from neol.base.kernel import loop_kernel
from neol.random.pcg64 import State, uniform
from neol.rollout.episodes import Batch, Slots, play_batch
from neol.spec.constants import Task

Array = npt.NDArray[np.float64]

TELLS_ADDRESSES = all(hasattr(kind, "_address") for kind in (mujoco.MjModel, mujoco.MjData))
"""Whether MuJoCo's bindings say where its structs lie.

Compiled code must know, and only this private attribute says it.
"""

FRAME_SKIP = 4
SECONDS = 0.002 * FRAME_SKIP
RESET_NOISE = 5e-3
CONTROL_COST = np.float32(1e-3)
HEALTHY_REWARD = 1.0
SPEED_LIMIT = 10.0


class World(NamedTuple):
    """A hopper: C functions and structs by address, and views of the state within mjData."""

    mj_reset_data: int
    mj_forward: int
    mj_step: int
    model: int
    data: int
    rest: Array
    """float64[6]: the positions before an episode's noise."""
    position: Array
    """float64[6]: x, z, and the angles of torso, thigh, leg and foot."""
    velocity: Array
    """float64[6]."""
    control: Array
    """float64[3]: torques of thigh, leg and foot."""

    @loop_kernel
    def reset(self, slot: int, random: State, observation: Array) -> None:
        """Begin an episode with draws from the random stream."""
        call_void(self.mj_reset_data, self.model, self.data)
        for i in range(6):
            self.position[i] = self.rest[i] + uniform(-RESET_NOISE, RESET_NOISE, random)
        for i in range(6):
            self.velocity[i] = uniform(-RESET_NOISE, RESET_NOISE, random)
        call_void(self.mj_forward, self.model, self.data)
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
        """Turn the joints by the three outputs; there is one hopper, in one slot."""
        for slot in playing:
            reward[slot] = turn(self, outputs[slot])
            observe(self, observation[slot])
            ended[slot] = not is_healthy(self)

    @loop_kernel
    def play(self, batch: Batch, slots: Slots) -> None:
        """Let the networks of a batch play their episodes here."""
        play_batch(self, batch, slots)


@loop_kernel
def turn(world: World, outputs: Array) -> float:
    """Take a step with these torques, clipped to +-1: the reward."""
    squares = np.float32(0.0)
    for i in range(3):
        action = np.float32(min(max(outputs[i], -1.0), 1.0))
        world.control[i] = action
        squares += action * action
    before = world.position[0]
    for _ in range(FRAME_SKIP):
        call_void(world.mj_step, world.model, world.data)
    speed = (world.position[0] - before) / SECONDS
    reward: float = speed + HEALTHY_REWARD - CONTROL_COST * squares
    return reward


@loop_kernel
def observe(world: World, observation: Array) -> None:
    """Write the observation, float64[11]: positions but x, and velocities clipped to +-10."""
    for i in range(1, 6):
        observation[i - 1] = world.position[i]
    for i in range(6):
        observation[5 + i] = min(max(world.velocity[i], -SPEED_LIMIT), SPEED_LIMIT)


@loop_kernel
def is_healthy(world: World) -> bool:
    """Whether the hopper stands: height, torso angle and all else but x within bounds."""
    healthy = 0.7 < world.position[1] < math.inf and -0.2 < world.position[2] < 0.2
    for i in range(2, 6):
        healthy &= -100.0 < world.position[i] < 100.0
    for i in range(6):
        healthy &= -100.0 < world.velocity[i] < 100.0
    return bool(healthy)


class Simulation:
    """MuJoCo's model and data of one hopper, which live as long as this object."""

    slots = 1

    def __init__(self) -> None:
        gymnasium = find_spec("gymnasium")
        assert gymnasium is not None and gymnasium.origin is not None
        path = Path(gymnasium.origin).parent / "envs" / "mujoco" / "assets" / "hopper.xml"
        self._model = mujoco.MjModel.from_xml_path(str(path))
        # A hopper is one kinematic tree, so the islands of its constraints are one at most: to look
        # for them takes a tenth of a step's time and changes no bit of it.
        self._model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_ISLAND
        self._data = mujoco.MjData(self._model)
        assert self._model.opt.timestep * FRAME_SKIP == SECONDS
        library = ctypes.CDLL(str(next(Path(mujoco.__file__).parent.glob("libmujoco*"))))
        # MuJoCo's bindings have it look at the clock throughout a step, for a profile that nobody
        # reads here: a seventh of the time. In the whole process it looks no more.
        ctypes.c_void_p.in_dll(library, "mjcb_time").value = None
        self.world = World(
            mj_reset_data=address(library.mj_resetData),
            mj_forward=address(library.mj_forward),
            mj_step=address(library.mj_step),
            model=self._model._address,
            data=self._data._address,
            rest=self._data.qpos.copy(),
            position=self._data.qpos,
            velocity=self._data.qvel,
            control=self._data.ctrl,
        )


def simulations(_task: Task) -> Callable[[], Simulation] | str:
    """What makes simulations of the task, or why nothing can."""
    if not TELLS_ADDRESSES:
        return "this version of mujoco does not say where its structs lie"
    return Simulation
