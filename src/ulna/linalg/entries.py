"""Entries of small matrices as lists of rows: elimination, cofactors, and conversions from and to arrays."""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna import numeric
from ulna.numeric.arrays import object_vector
from ulna.typing import Array

Rows = list[list[Any]]


def cofactors(rows: Rows) -> Any:
    """The determinant of a matrix of at most three rows."""
    if not rows:
        return 1.0
    if len(rows) == 1:
        return rows[0][0]
    if len(rows) == 2:
        (a, b), (c, d) = rows
        return a * d - b * c
    (a, b, c), (d, e, f), (g, h, i) = rows
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)


def ldl_rows(a: Rows) -> tuple[Rows, list[Any]]:
    """The unit lower triangle and the diagonal of `a = l @ diag(d) @ l.T`."""
    n = len(a)
    lower: Rows = [[1.0 if i == j else 0.0 for j in range(n)] for i in range(n)]
    d: list[Any] = []
    for i in range(n):
        scaled = []  # l[i][j] * d[j], which both the next entries of the row and the pivot need
        for j in range(i):
            value = a[i][j]
            for k in range(j):
                value = value - scaled[k] * lower[j][k]
            scaled.append(value)
            lower[i][j] = value / d[j]
        pivot = a[i][i]
        for j in range(i):
            pivot = pivot - scaled[j] * lower[i][j]
        d.append(pivot)
    return lower, d


def eliminate(rows: Rows, n: int) -> Any:
    """Brings columns to a triangle by Gaussian elimination with partial pivoting, in place.

    Args:
        rows: The rows of the matrix, with right-hand sides behind them.
        n: How many columns.

    Returns:
        The sign of the permutation of the rows, 1 or -1.
    """
    sign: Any = 1
    for k in range(n):
        for i in range(k + 1, n):
            swap = _is_better_pivot(rows[i][k], rows[k][k])
            if swap is False:
                continue
            upper, lower = rows[k], rows[i]
            rows[k] = upper[:k] + [_pick(swap, y, x) for x, y in zip(upper[k:], lower[k:], strict=True)]
            rows[i] = lower[:k] + [_pick(swap, x, y) for x, y in zip(upper[k:], lower[k:], strict=True)]
            sign = _pick(swap, -sign, sign)
        for i in range(k + 1, n):
            if _is_zero(rows[i][k]):
                continue
            factor = rows[i][k] / rows[k][k]
            rows[i] = rows[i][: k + 1] + [
                y - factor * x for x, y in zip(rows[k][k + 1 :], rows[i][k + 1 :], strict=True)
            ]
    return sign


def _is_better_pivot(candidate: Any, pivot: Any) -> Any:
    """Whether to swap: a bool where it is known, else a traced condition."""
    if _is_zero(candidate):
        return False
    if _is_zero(pivot):
        return True
    if hasattr(candidate, "free_symbols") or hasattr(pivot, "free_symbols"):
        return False
    answer = numeric.less(abs(pivot), abs(candidate))
    return bool(answer) if isinstance(answer, (bool, np.bool_)) else answer


def _is_zero(x: Any) -> bool:
    if isinstance(x, (float, int, np.generic)):
        return bool(x == 0)
    return bool(getattr(x, "is_zero", False) is True)


def _pick(condition: Any, a: Any, b: Any) -> Any:
    if isinstance(condition, bool):
        return a if condition else b
    return numeric.where(condition, a, b)


def column(x: Any) -> Any:
    """`x` as a factor of a row: a batch gains an axis, a scalar stays."""
    return x[..., None] if isinstance(x, np.ndarray) and x.ndim else x


def to_rows(a: Array) -> Rows:
    """The entries of a matrix (m, n)."""
    return [list(row) for row in a]


def to_matrix(rows: Rows) -> Array:
    """An object array (m, n) of entries."""
    out = np.empty((len(rows), len(rows[0]) if rows else 0), dtype=object)
    for i, row in enumerate(rows):
        for j, value in enumerate(row):
            out[i, j] = value
    return out


def by_column(f: Any, b: Array) -> Array:
    """Applies a function of lists to the columns of a matrix, or to a vector.

    Args:
        f: Maps the entries of a column to those of another.
        b: The columns, shape (n,) or (n, k).

    Returns:
        The results as columns, shape (m,) or (m, k).
    """
    if b.ndim == 1:
        return object_vector(f(list(b)))
    return to_matrix([list(x) for x in zip(*(f(list(b[:, k])) for k in range(b.shape[1])), strict=True)])


def lapack_solve(a: Array, b: Array) -> Array:
    """Solves `a x = b` for floats.

    Args:
        a: Matrix, shape (..., n, n).
        b: Right-hand side, shape (..., n) or (..., n, k).

    Returns:
        x, shape (..., n) or (..., n, k) as `b`.
    """
    if b.ndim == a.ndim - 1:  # NumPy 2 takes only a 1-dimensional b for a vector
        return np.linalg.solve(a, b[..., None])[..., 0]
    return np.linalg.solve(a, b)
