"""One step of the hopper."""

from neol.base.kernel import kernel, loop_kernel
from neol.rollout.worlds.hopper.constraints import constrain
from neol.rollout.worlds.hopper.dynamics import accelerate_smoothly
from neol.rollout.worlds.hopper.model import DOFS, LIMITED, Array, Struct
from neol.rollout.worlds.hopper.newton import accelerate

GREATEST = 1e10
"""mjMAXVAL: beyond it MuJoCo resets the state."""


@kernel
def step(
    hopper: Struct,
    work: Struct,
    position: Array,
    velocity: Array,
    control: Array,
    warm_start: Array,
) -> bool:
    """Take a fourth-order Runge-Kutta step (mj_step, mj_fwdActuation, mj_RungeKutta).

    Position, velocity and the acceleration that the next step's solver starts from change in
    place. Returns False and changes nothing in rare states (parts of the hopper close together,
    numbers out of bounds): MuJoCo must then take the step.
    """
    if not (is_usual(position) and is_usual(velocity)):
        return False
    time_step = hopper.time_step
    for i in range(LIMITED):
        work.torque[DOFS - LIMITED + i] = hopper.gear[i] * control[i]
    for i in range(DOFS):
        work.velocity_sum[i] = work.acceleration_sum[i] = 0.0
    for stage in range(4):
        ahead = 0.5 if stage < 3 else 1.0
        for i in range(DOFS):
            if stage == 0:
                work.position[i], work.velocity[i] = position[i], velocity[i]
            else:
                work.position[i] = position[i] + time_step * (work.velocity[i] * ahead)
                work.velocity[i] = velocity[i] + work.acceleration[i] * ahead * time_step
        if not (forward(hopper, work, warm_start) and is_usual(work.acceleration)):
            return False
        share = 1.0 / 6.0 if stage in (0, 3) else 1.0 / 3.0
        for i in range(DOFS):
            work.velocity_sum[i] += work.velocity[i] * share
            work.acceleration_sum[i] += work.acceleration[i] * share
    for i in range(DOFS):
        velocity[i] += work.acceleration_sum[i] * time_step
        position[i] += time_step * work.velocity_sum[i]
        warm_start[i] = work.acceleration[i]
    return True


@loop_kernel
def is_usual(x: Array) -> bool:
    """Whether all numbers are within MuJoCo's bounds."""
    usual = True
    for i in range(DOFS):
        usual &= abs(x[i]) <= GREATEST
    return usual


@kernel
def forward(hopper: Struct, work: Struct, warm_start: Array) -> bool:
    """Find the acceleration of a state; return whether that succeeded (mj_forward)."""
    accelerate_smoothly(hopper, work)
    rows = constrain(hopper, work)
    if rows > 0:
        return accelerate(hopper, work, rows, warm_start)
    for i in range(DOFS):
        work.acceleration[i] = work.smooth_acceleration[i]
    return bool(rows == 0)
