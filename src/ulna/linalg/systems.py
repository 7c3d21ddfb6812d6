"""Systems of linear equations, factors, inverses and determinants, on floats, symbols and traced scalars alike.

Float matrices (with any leading batch axes) go to LAPACK. Object matrices are eliminated in unrolled steps,
so that structural zeros cost nothing; the order is that of Golub & Van Loan, Matrix Computations (2013), the
section named at each function. Sizes are those of robotics, up to a few dozen rows.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna import numeric
from ulna.linalg.entries import (
    by_column,
    cofactors,
    eliminate,
    lapack_solve,
    ldl_rows,
    to_matrix,
    to_rows,
)
from ulna.numeric import is_symbolic
from ulna.numeric.arrays import object_vector
from ulna.typing import Array


def ldl(a: Array) -> tuple[Array, Array]:
    """Splits a symmetric positive definite `a = l @ diag(d) @ l.T`, l unit lower triangular (GVL 4.1.2).

    Args:
        a: (..., n, n); only its lower triangle is read.

    Returns:
        l (..., n, n) and d (..., n).
    """
    if not is_symbolic(a):
        root = np.linalg.cholesky(a)
        diagonal = np.diagonal(root, axis1=-2, axis2=-1)
        return root / diagonal[..., None, :], diagonal * diagonal
    rows, d = ldl_rows(to_rows(a))
    return to_matrix(rows), object_vector(d)


def cholesky(a: Array) -> Array:
    """The lower triangle l with `a = l @ l.T`, `a` (..., n, n) symmetric positive definite (GVL 4.2.5)."""
    if not is_symbolic(a):
        return np.linalg.cholesky(a)
    lower, d = ldl(a)
    return lower * numeric.sqrt(d)


def solve_spd(a: Array, b: Array) -> Array:
    """Solves `a @ x = b` for a symmetric positive definite `a`.

    Args:
        a: Matrix, shape (..., n, n); only its lower triangle is read when it is traced.
        b: Right-hand sides, shape (..., n) or (..., n, k); a vector when it has one axis less than `a`.

    Returns:
        x, shape (..., n) or (..., n, k) as `b`.
    """
    if not is_symbolic(a, b):
        return lapack_solve(a, b)
    lower, d = ldl_rows(to_rows(a))
    inverse = [1 / x for x in d]
    n = len(d)

    def one(column: list[Any]) -> list[Any]:
        y = list(column)
        for i in range(n):
            for j in range(i):
                y[i] = y[i] - lower[i][j] * y[j]
        y = [y[i] * inverse[i] for i in range(n)]
        for i in reversed(range(n)):
            for j in range(i + 1, n):
                y[i] = y[i] - lower[j][i] * y[j]
        return y

    return by_column(one, b)


def solve_damped(J: Array, b: Array, damping: Any) -> Array:
    """The x with the least |J x - b|^2 + damping |x|^2, by whichever of the two normal equations is smaller.

    Source: Nakamura & Hanafusa, Inverse kinematic solutions with singularity robustness (1986), eq. 16.

    Args:
        J: Matrix, shape (m, n).
        b: Right-hand side, shape (m,).
        damping: Above 0 where J may lose rank.

    Returns:
        x, shape (n,).
    """
    m, n = J.shape[-2:]
    if m <= n:
        return J.T @ solve_spd(J @ J.T + damping * np.eye(m), b)
    return solve_spd(J.T @ J + damping * np.eye(n), J.T @ b)


def solve(a: Array, b: Array) -> Array:
    """Solves `a @ x = b` for any invertible `a` by elimination with row pivoting (GVL 3.4).

    A traced matrix is pivoted by selection, in the same order as a float one. Symbols cannot be compared:
    their pivots are the first entries that are not the number zero.

    Args:
        a: Matrix, shape (..., n, n).
        b: Right-hand sides, shape (..., n) or (..., n, k); a vector when it has one axis less than `a`.

    Returns:
        x, shape (..., n) or (..., n, k) as `b`.
    """
    if not is_symbolic(a, b):
        return lapack_solve(a, b)
    n = a.shape[-1]
    right = b if b.ndim == 2 else b[:, None]
    rows = [list(left) + list(extra) for left, extra in zip(to_rows(a), right, strict=True)]
    eliminate(rows, n)
    k = right.shape[1]
    for i in reversed(range(n)):
        inverse = 1 / rows[i][i]  # an integer keeps symbols exact
        for c in range(n, n + k):
            value = rows[i][c]
            for j in range(i + 1, n):
                value = value - rows[i][j] * rows[j][c]
            rows[i][c] = value * inverse
    x = to_matrix([row[n:] for row in rows])
    return x if b.ndim == 2 else x[:, 0]


def inverse(a: Array) -> Array:
    """The inverse of `a` (..., n, n)."""
    if not is_symbolic(a):
        return np.linalg.inv(a)
    return solve(a, np.eye(a.shape[-1]))


def determinant(a: Array) -> Any:
    """The determinant of `a` (..., n, n): cofactors up to 3 rows, elimination beyond."""
    if not is_symbolic(a):
        return np.linalg.det(a)
    rows = to_rows(a)
    if len(rows) > 3:
        sign = eliminate(rows, len(rows))
        product = sign * rows[0][0]
        for i in range(1, len(rows)):
            product = product * rows[i][i]
        return product
    return cofactors(rows)


def reciprocal_above(x: Any, floor: Any) -> Any:
    """1 / x for x > floor, else 0, elementwise.

    Args:
        x: Number or array, shape (...).
        floor: What `x` must exceed, shape (...).

    Returns:
        Shape (...).
    """
    above = numeric.less(floor, x)
    return numeric.where(above, 1.0 / numeric.where(above, x, 1.0), 0.0)
