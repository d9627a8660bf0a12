"""Check that our own steps equal those of the installed MuJoCo, bit for bit."""

import sys
from functools import cache

import mujoco
import numpy as np

from neol.base.errors import NOTICE
from neol.rollout.worlds.hopper.model import DOFS, LIMITED, WORK, Struct, hopper_of, load_model
from neol.rollout.worlds.hopper.runge_kutta import step

STEPS = 4
"""Steps from each state; the solver of each starts from the acceleration of the one before."""
STATES = ([-1.0, 0.0, -1.0, -1.3, -1.3, -1.0], [1.0, 1.4, 1.0, 0.2, 0.2, 1.0])
"""Least and greatest positions of the compared states: in the air, standing, lying."""


def has_same_bits(model: mujoco.MjModel, hopper: Struct) -> bool:
    """Whether our own steps with these constants equal the model's from 100 random states.

    In every other state each joint is close to one of its limits, where limits are softest.
    """
    data, work = mujoco.MjData(model), np.zeros((), WORK)[()]
    random = np.random.default_rng(0)
    starts = random.uniform(*STATES, size=(100, DOFS))
    limits = random.permuted(np.tile(model.jnt_range[-LIMITED:], (50, 1, 1)), axis=2)[:, :, 0]
    starts[::2, -LIMITED:] = limits + random.normal(scale=1e-3, size=limits.shape)
    for position in starts:
        velocity, control, warm_start = (
            random.normal(size=DOFS),
            random.uniform(-1.0, 1.0, LIMITED),
            np.zeros(DOFS),
        )
        mujoco.mj_resetData(model, data)
        data.qpos, data.qvel, data.ctrl = position, velocity, control
        for _ in range(STEPS):
            if not step(hopper, work, position, velocity, control, warm_start):
                break
            mujoco.mj_step(model, data)
            ours = (*position, *velocity, *warm_start)
            if ours != (*data.qpos, *data.qvel, *data.qacc_warmstart):
                return False
    return True


@cache
def own_step() -> bool:
    """Whether our own steps equal this MuJoCo's, tested once; prints a note if they differ."""
    model = load_model()
    same = has_same_bits(model, hopper_of(model))
    if not same:
        version = mujoco.__version__
        print(f"{NOTICE}MuJoCo {version} takes Hopper's steps; ours differ", file=sys.stderr)
    return same
