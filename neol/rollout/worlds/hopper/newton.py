"""The acceleration under constraints: Newton's method with an exact line search.

It minimises a convex cost: the distance of an acceleration from the one without constraints, plus
0.5 * weight * residual^2 of each active row. A row is active if its residual is negative.
"""

import math

from neol.base.kernel import kernel, loop_kernel
from neol.rollout.worlds.hopper.algebra import (
    dot,
    dot_row,
    factorise_cholesky,
    multiply,
    norm,
    solve,
    solve_cholesky,
    update_cholesky,
)
from neol.rollout.worlds.hopper.line_search import search_line
from neol.rollout.worlds.hopper.model import DOFS, Array, Struct


@kernel
def accelerate(hopper: Struct, work: Struct, rows: int, warm_start: Array) -> bool:
    """Find the `acceleration`; return whether the Hessian stayed definite (mj_fwdConstraint)."""
    begin(work, rows, warm_start)
    trace = 0.0
    for i in range(DOFS):
        trace += work.inertia[i, i]
    scale = 1.0 / trace
    tolerance = hopper.tolerance

    differentiate(work)
    for i in range(DOFS):
        work.newton_step[i] = work.gradient[i]
    solve(work.factor, work.inverse_diagonal, work.newton_step)
    is_flat = scale * norm(work.gradient) < tolerance
    if is_flat and decrement(work, scale) < tolerance:
        return True
    if not make_hessian(work, rows):
        return False
    solve_cholesky(work.hessian, work.gradient, work.newton_step)
    if is_flat and decrement(work, scale) < tolerance:
        return True

    for _ in range(int(hopper.iterations)):
        for i in range(DOFS):
            work.search[i] = -work.newton_step[i]
        step, gain = search_line(hopper, work, rows, scale)
        if step == 0.0:
            break
        for i in range(DOFS):
            work.acceleration[i] += work.search[i] * step
            work.momentum[i] += work.search_momentum[i] * step
        for row in range(rows):
            work.residual[row] += work.change[row] * step
            work.was_active[row] = work.active[row]
        activate(work, rows)
        if not update_hessian(work, rows):
            return False
        differentiate(work)
        solve_cholesky(work.hessian, work.gradient, work.newton_step)
        gain *= scale
        if 0.0 < gain < tolerance or scale * norm(work.gradient) < tolerance:
            break
        if decrement(work, scale) < tolerance:
            break
    return True


@loop_kernel
def begin(work: Struct, rows: int, warm_start: Array) -> None:
    """Start from the last step's acceleration, or from that without constraints if better."""
    multiply(work.inertia, warm_start, work.momentum)
    cost = cost_of(work, rows, warm_start)
    for i in range(DOFS):
        force = work.momentum[i] - work.smooth_force[i]
        cost += 0.5 * force * (warm_start[i] - work.smooth_acceleration[i])
    is_better = cost > cost_of(work, rows, work.smooth_acceleration)
    for i in range(DOFS):
        work.acceleration[i] = work.smooth_acceleration[i] if is_better else warm_start[i]
    multiply(work.inertia, work.acceleration, work.momentum)
    for row in range(rows):
        work.residual[row] = residual(work, row, work.acceleration)
    activate(work, rows)


@loop_kernel
def residual(work: Struct, row: int, acceleration: Array) -> float:
    return dot_row(work.jacobian, row, acceleration) - float(work.reference[row])


@loop_kernel
def cost_of(work: Struct, rows: int, acceleration: Array) -> float:
    """Return the cost of an acceleration's constraints."""
    cost = 0.0
    for row in range(rows):
        amount = residual(work, row, acceleration)
        if amount < 0.0:
            cost += 0.5 * work.weight[row] * amount * amount
    return cost


@loop_kernel
def activate(work: Struct, rows: int) -> None:
    """Find the active rows and their force on the degrees of freedom (PrimalUpdateConstraint)."""
    for i in range(DOFS):
        work.constraint_force[i] = 0.0
    for row in range(rows):
        is_active = work.residual[row] < 0.0
        work.active[row] = is_active
        if is_active:
            force = -work.weight[row] * work.residual[row]
            for i in range(DOFS):
                work.constraint_force[i] += work.jacobian[row, i] * force


@loop_kernel
def differentiate(work: Struct) -> None:
    """Write the cost's gradient (PrimalUpdateGrad)."""
    for i in range(DOFS):
        work.gradient[i] = work.momentum[i] - work.smooth_force[i] - work.constraint_force[i]


@loop_kernel
def decrement(work: Struct, scale: float) -> float:
    """Return the expected gain of the next step."""
    return max(0.0, 0.5 * scale * dot(work.gradient, work.newton_step))


@kernel
def make_hessian(work: Struct, rows: int) -> bool:
    """Write the Hessian's Cholesky factor; return whether it is definite (MakeHessian)."""
    hessian = work.hessian
    for i in range(DOFS):
        for j in range(i + 1):
            hessian[i, j] = 0.0
    for row in range(rows):
        if work.active[row]:
            for i in range(DOFS):
                scale = work.jacobian[row, i] * work.weight[row]
                for j in range(i + 1):
                    hessian[i, j] += work.jacobian[row, j] * scale
    for i in range(DOFS):
        for j in range(i + 1):
            hessian[i, j] += work.inertia[i, j]
    return factorise_cholesky(hessian)


@loop_kernel
def update_hessian(work: Struct, rows: int) -> bool:
    """Add rows that became active, subtract rows that became inactive (HessianIncremental)."""
    for row in range(rows):
        if work.active[row] != work.was_active[row]:
            root = math.sqrt(work.weight[row])
            for i in range(DOFS):
                work.update[i] = work.jacobian[row, i] * root
            if not update_cholesky(work.hessian, work.update, 1.0 if work.active[row] else -1.0):
                return False
    return True
