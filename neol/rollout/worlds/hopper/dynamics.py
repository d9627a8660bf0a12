"""Positions, inertia, and the acceleration without constraints."""

import math

from neol.base.kernel import kernel, loop_kernel
from neol.rollout.worlds.hopper.algebra import factorise, solve
from neol.rollout.worlds.hopper.model import BODIES, DOFS, LEAST, Array, Struct


@kernel
def accelerate_smoothly(hopper: Struct, work: Struct) -> None:
    """Compute the input of constraints and `smooth_acceleration` from the state and torques."""
    place(hopper, work)
    weigh(hopper, work)
    factorise(work.inertia, work.factor, work.inverse_diagonal)
    push(hopper, work)
    for i in range(DOFS):
        work.smooth_acceleration[i] = work.smooth_force[i]
    solve(work.factor, work.inverse_diagonal, work.smooth_acceleration)


@loop_kernel
def place(hopper: Struct, work: Struct) -> None:
    """Compute the pose of each body (mj_kinematics); an axis still holds its hinge's place."""
    x = z = 0.0
    w, y = 1.0, 0.0
    xx, xz, zx, zz = 1.0, 0.0, 0.0, 1.0  # rotation of the previous body
    for body in range(BODIES):
        dof = body + 2
        offset_x, offset_z = hopper.position[body, 0], hopper.position[body, 1]
        if body == 0:
            x = offset_x + (work.position[0] - hopper.rest[0])
            z = offset_z + (work.position[1] - hopper.rest[1])
            sense = 1.0
        else:
            x, z = xx * offset_x + xz * offset_z + x, zx * offset_x + zz * offset_z + z
            sense = -1.0

        anchor_x, anchor_z = hopper.anchor[body, 0], hopper.anchor[body, 1]
        turned_x, turned_z = turn(anchor_x, anchor_z, w, y)
        hinge_x, hinge_z = turned_x + x, turned_z + z
        half = (work.position[dof] - hopper.rest[dof]) * 0.5
        cos, sin = math.cos(half), sense * math.sin(half)
        w, y = w * cos - y * sin, w * sin + y * cos
        turned_x, turned_z = turn(anchor_x, anchor_z, w, y)
        x, z = hinge_x - turned_x, hinge_z - turned_z
        norm = math.sqrt(w * w + y * y)
        if abs(norm - 1.0) > LEAST:
            w *= 1.0 / norm
            y *= 1.0 / norm
        work.axis[dof, 0], work.axis[dof, 1], work.axis[dof, 2] = sense, hinge_x, hinge_z

        xx = zz = w * w - y * y
        xz = 2.0 * (w * y)
        zx = -xz
        centre_x, centre_z = hopper.centre[body, 0], hopper.centre[body, 1]
        work.pose[body, 0] = xx * centre_x + xz * centre_z + x
        work.pose[body, 1] = zx * centre_x + zz * centre_z + z
        turn_w, turn_y = hopper.turn[body, 0], hopper.turn[body, 1]
        capsule_w, capsule_y = w * turn_w - y * turn_y, w * turn_y + y * turn_w
        work.pose[body, 2] = 2.0 * (capsule_w * capsule_y)
        work.pose[body, 3] = capsule_w * capsule_w - capsule_y * capsule_y
        work.pose[body, 4] = capsule_w * capsule_w + capsule_y * capsule_y


@loop_kernel
def turn(x: float, z: float, w: float, y: float) -> tuple[float, float]:
    """Rotate a vector by a quaternion (mju_rotVecQuat)."""
    cross_x, cross_z = w * x + y * z, w * z - y * x
    return x + 2.0 * (y * cross_z), z - 2.0 * (y * cross_x)


@loop_kernel
def weigh(hopper: Struct, work: Struct) -> None:
    """Compute the inertia of the bodies and of the degrees of freedom (mj_comPos, mj_crb)."""
    pose, axis = work.pose, work.axis
    centre_x = centre_z = 0.0
    for body in range(BODIES - 1, -1, -1):
        centre_x = pose[body, 0] * hopper.mass[body] + centre_x
        centre_z = pose[body, 1] * hopper.mass[body] + centre_z
    centre_x *= hopper.inverse_mass
    centre_z *= hopper.inverse_mass
    work.centre[0], work.centre[1] = centre_x, centre_z

    own, composite = work.spatial_inertia, work.composite_inertia
    for body in range(BODIES):
        mass, yy = hopper.mass[body], pose[body, 4]
        x, z = pose[body, 0] - centre_x, pose[body, 1] - centre_z
        own[body, 0] = yy * (yy * hopper.inertia[body]) + mass * (x * x + z * z)
        own[body, 1], own[body, 2], own[body, 3] = mass * x, mass * z, mass
        for i in range(4):
            composite[body, i] = own[body, i]
    for body in range(BODIES - 1, 0, -1):
        for i in range(4):
            composite[body - 1, i] += composite[body, i]

    axis[0, 0], axis[0, 1], axis[0, 2] = 0.0, 1.0, 0.0
    axis[1, 0], axis[1, 1], axis[1, 2] = 0.0, 0.0, 1.0
    for i in range(2, DOFS):
        x, z = centre_x - axis[i, 1], centre_z - axis[i, 2]
        axis[i, 1], axis[i, 2] = axis[i, 0] * z, -(axis[i, 0] * x)

    for i in range(DOFS):
        turning, x, z = momentum(composite, max(0, i - 2), axis[i, 0], axis[i, 1], axis[i, 2])
        for j in range(i + 1):
            work.inertia[i, j] = axis[j, 0] * turning + axis[j, 1] * x + axis[j, 2] * z
        work.inertia[i, i] += hopper.armature[i]


@loop_kernel
def momentum(
    inertia: Array, body: int, turning: float, x: float, z: float
) -> tuple[float, float, float]:
    """Multiply a body's spatial inertia by a motion (mju_mulInertVec)."""
    yy, mass_x, mass_z, mass = (
        inertia[body, 0],
        inertia[body, 1],
        inertia[body, 2],
        inertia[body, 3],
    )
    return (
        yy * turning + mass_z * x - mass_x * z,
        mass_z * turning + mass * x,
        mass * z - mass_x * turning,
    )


@loop_kernel
def push(hopper: Struct, work: Struct) -> None:
    """Compute all forces except those of constraints.

    (mj_comVel, mj_rne, mj_passive, mj_fwdAcceleration)
    """
    axis, force, velocity = work.axis, work.spatial_force, work.velocity
    turning, x, z = 0.0, velocity[0], velocity[1]
    inertial_x, inertial_z = 0.0, hopper.gravity
    for body in range(BODIES):
        a, b, c, speed = axis[body + 2, 0], axis[body + 2, 1], axis[body + 2, 2], velocity[body + 2]
        inertial_x += (turning * c - z * a) * speed
        inertial_z += (x * a - turning * b) * speed
        turning += a * speed
        x += b * speed
        z += c * speed
        _, momentum_x, momentum_z = momentum(work.spatial_inertia, body, turning, x, z)
        moment, force_x, force_z = momentum(work.spatial_inertia, body, 0.0, inertial_x, inertial_z)
        force[body, 0] = moment + (z * momentum_x - x * momentum_z)
        force[body, 1] = force_x + turning * momentum_z
        force[body, 2] = force_z - turning * momentum_x
    for body in range(BODIES - 1, 0, -1):
        for i in range(3):
            force[body - 1, i] += force[body, i]
    for i in range(DOFS):
        body = max(0, i - 2)
        bias = (
            axis[i, 0] * force[body, 0] + axis[i, 1] * force[body, 1] + axis[i, 2] * force[body, 2]
        )
        work.smooth_force[i] = -velocity[i] * hopper.damping[i] - bias + work.torque[i]
