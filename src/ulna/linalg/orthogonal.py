"""Orthogonal columns of small matrices: volumes and the pseudoinverse."""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna import numeric
from ulna.linalg.entries import Rows, column
from ulna.linalg.systems import reciprocal_above
from ulna.typing import Array

_DENORMAL = 1e-290  # smaller squares have lost digits


def orthogonalise(a: Array, noise: float = 0.0) -> tuple[Array, Array, Array, Array]:
    """Splits `a = l @ q`, l unit lower triangular, rows of q orthogonal: modified Gram-Schmidt (GVL 5.2.8).

    Args:
        a: Matrix, shape (..., m, n).
        noise: A row is excluded from the further elimination, and keeps zeros below it in `l`, when at most this
            fraction of its length remains because it depends on the rows above it [-].

    Returns:
        l (..., m, m), q (..., m, n), the squared lengths of the rows of `q` (..., m), and their reciprocals (..., m),
        zero for the rows that were excluded.
    """
    m = a.shape[-2]
    rows = [a[..., i, :] for i in range(m)]
    zero, one = 0.0 * a[..., 0, 0], 0.0 * a[..., 0, 0] + 1.0
    lower: Rows = [[one if i == j else zero for j in range(m)] for i in range(m)]
    floors = [numeric.dot(row, row) * (noise * noise) if noise else 0.0 for row in rows]
    squares, reciprocals = [], []
    for j in range(m):
        squares.append(numeric.dot(rows[j], rows[j]))
        reciprocals.append(reciprocal_above(squares[j], floors[j]))
        for i in range(j + 1, m):
            lower[i][j] = numeric.dot(rows[j], rows[i]) * reciprocals[j]
            rows[i] = rows[i] - column(lower[i][j]) * rows[j]
    return (
        numeric.matrix(lower),
        np.stack(rows, axis=-2),
        numeric.vector(*squares),
        numeric.vector(*reciprocals),
    )


def volume(a: Array) -> Any:
    """Volume spanned by the rows of `a` (..., m, n), the square root of `det(a @ a.T)`.

    It loses no digits to the squaring of `a`.

    Zero when the rows are dependent, hence whenever m > n.
    """
    return volume_of(orthogonalise(a)[2])


def volume_of(squares: Array) -> Any:
    """Volume of a box, from the squared lengths of its edges (..., m)."""
    product = squares[..., 0]
    for i in range(1, squares.shape[-1]):
        product = product * squares[..., i]
    return numeric.sqrt(product)


def pseudoinverse(a: Array) -> tuple[Array, Any]:
    """The pseudoinverse of a matrix of full rank, and how far the rank is from being lost (GVL 5.2.8, 5.5.2).

    With `a = l @ q` of `orthogonalise` it is `q.T @ diag(1 / q^2) @ inverse(l)`; `a @ a.T`, whose condition is
    that of `a` squared, is not formed.

    Args:
        a: (..., m, n).

    Returns:
        The pseudoinverse (..., n, m), and `norm(a) * norm(pseudoinverse)` by Frobenius (...), which lies between the
        condition number and k times that, k the smaller of m and n. The relative error of the pseudoinverse is about
        the rounding unit times that number, as by singular values; from 1e15 on the rank is not full and the
        pseudoinverse means nothing. It is inf, too, where numbers are not finite or their squares not within range.
    """
    if a.shape[-2] > a.shape[-1]:
        inverse, condition = pseudoinverse(np.swapaxes(a, -1, -2))
        return np.swapaxes(inverse, -1, -2), condition
    m = a.shape[-2]
    lower, q, squares, reciprocals = orthogonalise(a)
    rows = [q[..., i, :] * column(reciprocals[..., i]) for i in range(m)]
    for i in reversed(range(m)):
        for j in range(i + 1, m):
            rows[i] = rows[i] - column(lower[..., j, i]) * rows[j]
    size = sum((numeric.dot(a[..., i, :], a[..., i, :]) for i in range(m)), 0.0)
    inverse_size = sum((numeric.dot(row, row) for row in rows), 0.0)
    least = squares[..., 0]
    for i in range(1, m):
        least = numeric.minimum(least, squares[..., i])
    condition = numeric.where(numeric.less(_DENORMAL, least), numeric.sqrt(size * inverse_size), np.inf)
    return np.stack(rows, axis=-1), condition
