"""An exact line search: the best step along a direction."""

from neol.base.kernel import kernel, loop_kernel
from neol.rollout.worlds.hopper.algebra import dot, dot_row, multiply, norm
from neol.rollout.worlds.hopper.model import LEAST, Struct

Point = tuple[float, float, float, float]
"""Point of a line search: step, cost relative to no step, slope, curvature."""


@kernel
def search_line(hopper: Struct, work: Struct, rows: int, scale: float) -> tuple[float, float]:
    """Find the step along `search` with the least cost; return it and its gain (PrimalSearch)."""
    length = norm(work.search)
    if length < LEAST:
        return 0.0, 0.0
    flat = hopper.search_tolerance * length / scale
    prepare(work, rows)
    start = evaluate(work, rows, 0.0)
    low = evaluate(work, rows, newton_point(start))
    if abs(low[2]) < flat and (low[0] == 0.0 or low[1] < 0.0):
        return low[0], -low[1]
    count, limit = 2, int(hopper.search_iterations)

    sense = 1.0 if low[2] < 0.0 else -1.0
    high = start
    while low[2] * sense <= -flat and count < limit:
        high = low
        low = evaluate(work, rows, newton_point(low))
        count += 1
        if abs(low[2]) < flat and low[1] < 0.0:
            return low[0], -low[1]
    if count >= limit:
        return low[0], -low[1]

    next_high, next_low = low, evaluate(work, rows, newton_point(low))
    count += 1
    while count < limit:
        middle = evaluate(work, rows, 0.5 * (low[0] + high[0]))
        count += 1
        best, is_found = middle, False
        for point in (next_low, next_high, middle):
            if abs(point[2]) < flat and (not is_found or point[1] < best[1]):
                best, is_found = point, True
        if is_found:
            return best[0], -best[1]
        new_low = narrow(narrow(narrow(low, next_low), next_high), middle)
        new_high = narrow(narrow(narrow(high, next_low), next_high), middle)
        if new_low[0] == low[0] and new_high[0] == high[0]:
            return middle[0], -middle[1]
        if new_low[0] != low[0]:
            low, next_low = new_low, evaluate(work, rows, newton_point(new_low))
            count += 1
        if new_high[0] != high[0]:
            high, next_high = new_high, evaluate(work, rows, newton_point(new_high))
            count += 1
    best = low if low[1] <= high[1] else high
    if best[1] < 0.0:
        return best[0], -best[1]
    return 0.0, 0.0


@loop_kernel
def prepare(work: Struct, rows: int) -> None:
    """Write the cost along `search` as parabolas, one for each row (PrimalPrepare)."""
    multiply(work.inertia, work.search, work.search_momentum)
    slope = dot(work.search, work.momentum) - dot(work.smooth_force, work.search)
    work.gauss[0], work.gauss[1] = slope, 0.5 * dot(work.search, work.search_momentum)
    for row in range(rows):
        amount, weight = work.residual[row], work.weight[row]
        change = dot_row(work.jacobian, row, work.search)
        work.change[row] = change
        work.quadratic[row, 0] = amount * (weight * amount) * 0.5
        work.quadratic[row, 1] = change * (weight * amount)
        work.quadratic[row, 2] = change * weight * change * 0.5


@kernel
def evaluate(work: Struct, rows: int, step: float) -> Point:
    """Compute cost, slope and curvature after a step along `search` (PrimalEval)."""
    cost = constant = 0.0
    linear, square = work.gauss[0], work.gauss[1]
    for row in range(rows):
        before = work.quadratic[row, 0] if work.residual[row] < 0.0 else 0.0
        if work.residual[row] + step * work.change[row] < 0.0:
            constant += work.quadratic[row, 0] - before
            linear += work.quadratic[row, 1]
            square += work.quadratic[row, 2]
        else:
            cost -= before
    cost += step * step * square + step * linear + constant
    curvature = 2.0 * square
    if curvature <= 0.0:
        curvature = LEAST
    return step, cost, 2.0 * step * square + linear, curvature


@loop_kernel
def newton_point(point: Point) -> float:
    return point[0] - point[2] / point[3]


@loop_kernel
def narrow(end: Point, candidate: Point) -> Point:
    """Return the candidate if its slope has the sign of the bracket's end and is less steep."""
    if end[2] < candidate[2] < 0.0 or end[2] > candidate[2] > 0.0:
        return candidate
    return end
