"""The hopper's constants, and the scratch space of its physics.

Both are numpy records, which kernels take as one pointer; passing tuples of arrays would take more
time than the physics itself.
"""

import math
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Struct = Any
"""A record of `HOPPER` or `WORK`."""

BODIES, DOFS, LIMITED = 4, 6, 3
"""Torso, thigh, leg, foot; x, z and four angles; the last three angles have limits."""
ROWS = LIMITED + BODIES * 2 * 4
"""Largest number of constraints: one for each limit, four (a pyramid's edges) for each contact.

Both ends of each part can touch the floor.
"""
LEAST = 1e-15
"""mjMINVAL."""


def _record(**shapes: tuple[int, ...]) -> np.dtype[np.void]:
    return np.dtype([(name, np.float64, shape) for name, shape in shapes.items()], align=True)


HOPPER = _record(
    # of each body
    position=(BODIES, 2),  # origin of its frame in its parent's frame
    anchor=(BODIES, 2),  # its hinge in its own frame
    centre=(BODIES, 2),  # centre of its mass and of its capsule
    turn=(BODIES, 2),  # rotation of its capsule
    mass=(BODIES,),
    inertia=(BODIES,),  # about y
    half_length=(BODIES,),
    radius=(BODIES,),
    bound=(BODIES,),  # radius of the sphere around it
    friction=(BODIES,),  # against the floor
    contact_weight=(BODIES,),  # D of a contact's rows
    # of each degree of freedom
    rest=(DOFS,),
    armature=(DOFS,),
    damping=(DOFS,),
    # of each limited degree of freedom
    gear=(LIMITED,),
    limit=(LIMITED, 2),
    limit_inverse_weight=(LIMITED,),
    limit_impedance=(4,),  # least, greatest, width, midpoint
    limit_stiffness=(),
    limit_damping=(),
    contact_margin=(),
    contact_stiffness=(),
    contact_damping=(),
    gravity=(),
    inverse_mass=(),
    time_step=(),
    tolerance=(),
    search_tolerance=(),
    iterations=(),
    search_iterations=(),
)

WORK = _record(
    torque=(DOFS,),
    position=(DOFS,),
    velocity=(DOFS,),
    # of each body: centre x, z; its axis x, z; yy of its rotation
    pose=(BODIES, 5),
    centre=(2,),  # centre of all mass
    spatial_inertia=(BODIES, 4),  # about `centre`: yy, mass * x, mass * z, mass
    composite_inertia=(BODIES, 4),  # including all bodies below it
    spatial_force=(BODIES, 3),
    axis=(DOFS, 3),
    inertia=(DOFS, DOFS),  # lower triangles, here and below
    factor=(DOFS, DOFS),
    inverse_diagonal=(DOFS,),
    smooth_force=(DOFS,),
    smooth_acceleration=(DOFS,),
    acceleration=(DOFS,),
    # of each constraint
    jacobian=(ROWS, DOFS),
    weight=(ROWS,),
    reference=(ROWS,),
    residual=(ROWS,),
    change=(ROWS,),
    active=(ROWS,),
    was_active=(ROWS,),
    quadratic=(ROWS, 3),
    # Newton's method
    hessian=(DOFS, DOFS),
    constraint_force=(DOFS,),
    momentum=(DOFS,),  # inertia * acceleration
    gradient=(DOFS,),
    newton_step=(DOFS,),
    search=(DOFS,),
    search_momentum=(DOFS,),
    update=(DOFS,),
    gauss=(2,),
    # Runge-Kutta method
    velocity_sum=(DOFS,),
    acceleration_sum=(DOFS,),
)


def hopper_of(model: mujoco.MjModel) -> Struct:
    """Return a record of `HOPPER` from MuJoCo's model."""
    body, plane, hinge = slice(1, 5), [0, 2], slice(3, 6)
    hopper = np.zeros((), HOPPER)
    hopper["position"] = model.body_pos[body, plane]
    hopper["anchor"] = model.jnt_pos[2:6, plane]
    hopper["centre"] = model.body_ipos[body, plane]
    hopper["turn"] = model.body_iquat[body, plane]
    hopper["mass"] = model.body_mass[body]
    hopper["inertia"] = model.body_inertia[body, 1]
    hopper["radius"], hopper["half_length"] = model.geom_size[body, 0], model.geom_size[body, 1]
    hopper["bound"] = model.geom_rbound[body]
    hopper["rest"] = model.qpos0
    hopper["armature"] = model.dof_armature
    hopper["damping"] = model.dof_damping
    hopper["gear"] = model.actuator_gear[:, 0]
    hopper["gravity"] = -model.opt.gravity[2]
    hopper["inverse_mass"] = 1.0 / model.body_subtreemass[1]
    hopper["time_step"] = model.opt.timestep
    hopper["tolerance"] = model.opt.tolerance
    hopper["search_tolerance"] = model.opt.tolerance * model.opt.ls_tolerance
    hopper["iterations"] = model.opt.iterations
    hopper["search_iterations"] = model.opt.ls_iterations

    least, greatest, width, midpoint, _ = model.jnt_solimp[3]
    hopper["limit"] = model.jnt_range[hinge]
    hopper["limit_inverse_weight"] = model.dof_invweight0[hinge]
    hopper["limit_impedance"] = least, greatest, width, midpoint
    hopper["limit_stiffness"], hopper["limit_damping"] = _spring(model.jnt_solref[3], greatest)

    least, greatest, *_ = model.geom_solimp[1]
    impedance = 0.5 * (least + greatest)
    stiffness, hopper["contact_damping"] = _spring(model.geom_solref[1], greatest)
    hopper["contact_stiffness"] = stiffness * impedance
    hopper["contact_margin"] = model.geom_margin[0] + model.geom_margin[1]
    friction = np.maximum(model.geom_friction[0, 0], model.geom_friction[body, 0])
    hopper["friction"] = friction
    hopper["contact_weight"] = [
        _contact_weight(mu, weight, impedance)
        for mu, weight in zip(friction, model.body_invweight0[body, 0], strict=True)
    ]
    return hopper[()]


def _spring(reference: Any, greatest: float) -> tuple[float, float]:
    """Return K and B of a constraint (mj_makeImpedance)."""
    time, ratio = reference
    stiffness = 1.0 / (greatest * greatest * time * time * ratio * ratio)
    return stiffness, 2.0 / (greatest * time)


def _contact_weight(friction: float, inverse_weight: float, impedance: float) -> float:
    """Return D of the edges of a contact's pyramid (mj_diagApprox, mj_makeImpedance)."""
    diagonal = inverse_weight + friction * friction * inverse_weight
    regularisation = (1.0 - impedance) * diagonal / impedance
    mu = friction * math.sqrt(regularisation / regularisation)
    return 1.0 / (2.0 * mu * mu * regularisation)


def model_path() -> Path:
    """Return the path of Gymnasium's hopper model."""
    gymnasium = find_spec("gymnasium")
    assert gymnasium is not None and gymnasium.origin is not None
    return Path(gymnasium.origin).parent / "envs" / "mujoco" / "assets" / "hopper.xml"


@cache
def load_model() -> mujoco.MjModel:
    """Load Gymnasium's hopper model unchanged."""
    return mujoco.MjModel.from_xml_path(str(model_path()))
