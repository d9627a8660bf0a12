"""Vectors of six numbers and matrices of six rows, each sum in MuJoCo's order.

Only the lower triangle of a symmetric or triangular matrix is read.
"""

import math

from neol.base.kernel import loop_kernel
from neol.rollout.worlds.hopper.model import DOFS, LEAST, Array


@loop_kernel
def dot(a: Array, b: Array) -> float:
    """Dot product of two vectors of six numbers."""
    return float(
        (a[0] * b[0] + a[2] * b[2]) + (a[1] * b[1] + a[3] * b[3]) + (a[4] * b[4] + a[5] * b[5])
    )


@loop_kernel
def dot_four(rows: Array, row: int, x: Array) -> float:
    """Dot product of a row's first four numbers, in the order of MuJoCo's vectors (mju_dot)."""
    even = rows[row, 0] * x[0] + rows[row, 2] * x[2]
    odd = rows[row, 1] * x[1] + rows[row, 3] * x[3]
    return float(even + odd)


@loop_kernel
def dot_row(rows: Array, row: int, x: Array) -> float:
    """Dot product of a row's six numbers with a vector."""
    return float(dot_four(rows, row, x) + (rows[row, 4] * x[4] + rows[row, 5] * x[5]))


@loop_kernel
def norm(x: Array) -> float:
    return math.sqrt(dot(x, x))


@loop_kernel
def multiply(inertia: Array, x: Array, product: Array) -> None:
    """Multiply a symmetric matrix by a vector (mju_mulSymVecSparse)."""
    for i in range(DOFS):
        product[i] = inertia[i, i] * x[i]
        for j in range(i - 1, -1, -1):
            product[i] += inertia[i, j] * x[j]
            product[j] += inertia[i, j] * x[i]


@loop_kernel
def factorise(inertia: Array, factor: Array, inverse_diagonal: Array) -> None:
    """Factorise the inertia as L'DL, with ones on the diagonal of L (mj_factorI)."""
    for i in range(DOFS):
        for j in range(i + 1):
            factor[i, j] = inertia[i, j]
    for k in range(DOFS - 1, -1, -1):
        inverse = 1.0 / factor[k, k]
        inverse_diagonal[k] = inverse
        for i in range(k - 1, -1, -1):
            scale = -factor[k, i] * inverse
            for j in range(i + 1):
                factor[i, j] += factor[k, j] * scale
        for j in range(k):
            factor[k, j] *= inverse


@loop_kernel
def solve(factor: Array, inverse_diagonal: Array, x: Array) -> None:
    """Solve for x with the factorised inertia, in place (mj_solveLD)."""
    for i in range(DOFS - 1, 0, -1):
        for j in range(i):
            x[j] -= factor[i, j] * x[i]
    for i in range(DOFS):
        x[i] *= inverse_diagonal[i]
    x[1] -= factor[1, 0] * x[0]
    x[2] -= factor[2, 0] * x[0] + factor[2, 1] * x[1]
    x[3] -= factor[3, 0] * x[0] + factor[3, 1] * x[1] + factor[3, 2] * x[2]
    x[4] -= dot_four(factor, 4, x)
    x[5] -= dot_four(factor, 5, x) + factor[5, 4] * x[4]


@loop_kernel
def factorise_cholesky(matrix: Array) -> bool:
    """Factorise a matrix as LL' in its lower triangle; return whether it is definite.

    (mju_cholFactor)
    """
    for j in range(DOFS):
        square = matrix[j, j] - dot_rows(matrix, j, j, j)
        if square < LEAST:
            return False
        matrix[j, j] = math.sqrt(square)
        inverse = 1.0 / matrix[j, j]
        for i in range(j + 1, DOFS):
            matrix[i, j] = (matrix[i, j] - dot_rows(matrix, i, j, j)) * inverse
    return True


@loop_kernel
def dot_rows(matrix: Array, i: int, j: int, count: int) -> float:
    """Dot product of the first 0 to 5 numbers of two rows, in the order of mju_dot."""
    total = 0.0
    first = 0
    if count >= 4:
        total = (matrix[i, 0] * matrix[j, 0] + matrix[i, 2] * matrix[j, 2]) + (
            matrix[i, 1] * matrix[j, 1] + matrix[i, 3] * matrix[j, 3]
        )
        first = 4
    for k in range(first, count):
        total += matrix[i, k] * matrix[j, k]
    return total


@loop_kernel
def solve_cholesky(factor: Array, vector: Array, x: Array) -> None:
    """Solve LL'x = vector (mju_cholSolve)."""
    x[0] = vector[0] / factor[0, 0]
    x[1] = (vector[1] - factor[1, 0] * x[0]) / factor[1, 1]
    x[2] = (vector[2] - (factor[2, 0] * x[0] + factor[2, 1] * x[1])) / factor[2, 2]
    three = factor[3, 0] * x[0] + factor[3, 1] * x[1] + factor[3, 2] * x[2]
    x[3] = (vector[3] - three) / factor[3, 3]
    x[4] = (vector[4] - dot_four(factor, 4, x)) / factor[4, 4]
    x[5] = (vector[5] - (dot_four(factor, 5, x) + factor[5, 4] * x[4])) / factor[5, 5]
    for i in range(DOFS - 1, -1, -1):
        x[i] /= factor[i, i]
        for j in range(i):
            x[j] += factor[i, j] * -x[i]


@loop_kernel
def update_cholesky(factor: Array, x: Array, sign: float) -> bool:
    """Update the factor of A to that of A + sign * xx'; return whether that is definite.

    (mju_cholUpdate)
    """
    for k in range(DOFS):
        if x[k] != 0.0:
            diagonal = factor[k, k]
            square = diagonal * diagonal + sign * (x[k] * x[k])
            if square < LEAST:
                return False
            root = math.sqrt(square)
            cos, sin = root / diagonal, x[k] / diagonal
            inverse = 1.0 / cos
            factor[k, k] = root
            for i in range(k + 1, DOFS):
                factor[i, k] = (factor[i, k] + sign * sin * x[i]) * inverse
                x[i] = cos * x[i] - sin * factor[i, k]
    return True
