"""The constraints of a pose: joints at their limits, and contacts with the floor."""

import math

from neol.base.kernel import kernel, loop_kernel
from neol.rollout.worlds.hopper.algebra import dot_row
from neol.rollout.worlds.hopper.model import BODIES, DOFS, LEAST, LIMITED, Struct

APART = 0.01
"""Largest distance of two parts' spheres at which they may touch, with margins and rounding."""


@kernel
def constrain(hopper: Struct, work: Struct) -> int:
    """Write a row for each constraint; return their number, or -1 if parts may touch."""
    if may_touch(hopper, work, 0, 2) or may_touch(hopper, work, 0, 3):
        return -1
    if may_touch(hopper, work, 1, 3):
        return -1
    rows = 0
    for joint in range(LIMITED):
        for side in range(2):
            rows = limit(hopper, work, joint, side, rows)
    for body in range(BODIES):
        if work.pose[body, 1] <= hopper.contact_margin + hopper.bound[body]:
            for side in range(2):
                rows = touch(hopper, work, body, side, rows)
    return rows


@loop_kernel
def may_touch(hopper: Struct, work: Struct, one: int, other: int) -> bool:
    """Whether the spheres around two bodies meet; a body and its parent never collide."""
    x = work.pose[one, 0] - work.pose[other, 0]
    z = work.pose[one, 1] - work.pose[other, 1]
    reach = hopper.bound[one] + hopper.bound[other] + APART
    return bool(x * x + z * z <= reach * reach)


@loop_kernel
def limit(hopper: Struct, work: Struct, joint: int, side: int, row: int) -> int:
    """Add a joint's lower or upper limit if it is exceeded; return the number of rows.

    (mj_instantiateLimit, mj_makeImpedance, mj_referenceConstraint)
    """
    dof, sense = DOFS - LIMITED + joint, 2.0 * side - 1.0
    distance = sense * (hopper.limit[joint, side] - work.position[dof])
    if distance >= 0.0:
        return row
    for i in range(DOFS):
        work.jacobian[row, i] = 0.0
    work.jacobian[row, dof] = -sense
    impedance = impede(hopper, distance)
    inverse_weight = (1.0 - impedance) * hopper.limit_inverse_weight[joint] / impedance
    work.weight[row] = 1.0 / max(LEAST, inverse_weight)
    work.reference[row] = (
        -hopper.limit_damping * dot_row(work.jacobian, row, work.velocity)
        - hopper.limit_stiffness * impedance * distance
    )
    return row + 1


@loop_kernel
def impede(hopper: Struct, distance: float) -> float:
    """Return a limit's impedance at a distance (getimpedance): two parabolas that join smoothly."""
    least, greatest = hopper.limit_impedance[0], hopper.limit_impedance[1]
    width, midpoint = hopper.limit_impedance[2], hopper.limit_impedance[3]
    x = abs(distance / width)
    if x >= 1.0:
        return float(greatest)
    if x <= midpoint:
        y = 1.0 / midpoint * (x * x)
    else:
        y = 1.0 - 1.0 / (1.0 - midpoint) * ((1.0 - x) * (1.0 - x))
    return float(least + y * (greatest - least))


@loop_kernel
def touch(hopper: Struct, work: Struct, body: int, side: int, row: int) -> int:
    """Add the contact of a body's end with the floor, if any; return the number of rows.

    (mjc_PlaneCapsule, mju_makeFrame, mj_instantiateContact, mj_referenceConstraint)
    """
    radius, half = hopper.radius[body], hopper.half_length[body]
    end_x, end_z = half * work.pose[body, 2], half * work.pose[body, 3]
    if side == 1:
        end_x, end_z = -end_x, -end_z
    x, z = work.pose[body, 0] + end_x, work.pose[body, 1] + end_z
    distance = z - radius
    if z > hopper.contact_margin + radius or distance >= hopper.contact_margin:
        return row
    z += -distance / 2.0 - radius
    x -= work.centre[0]
    z -= work.centre[1]

    tangent = work.pose[body, 2]
    length = math.sqrt(tangent * tangent)
    tangent = 1.0 if length < LEAST else tangent * (1.0 / length)
    for i in range(DOFS):
        normal = along = 0.0
        if i <= body + 2:
            turning = work.axis[i, 0]
            normal = work.axis[i, 2] - turning * x
            along = (work.axis[i, 1] + turning * z) * tangent
        work.jacobian[row, i] = normal + along * hopper.friction[body]
        work.jacobian[row + 1, i] = normal - along * hopper.friction[body]
        work.jacobian[row + 2, i] = normal  # the edges across the plane
        work.jacobian[row + 3, i] = normal
    for edge in range(row, row + 4):
        work.weight[edge] = hopper.contact_weight[body]
        work.reference[edge] = -hopper.contact_damping * dot_row(
            work.jacobian, edge, work.velocity
        ) - hopper.contact_stiffness * (distance - hopper.contact_margin)
    return row + 4
