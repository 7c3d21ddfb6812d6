"""Small dense linear algebra on floats, symbols and traced scalars alike.

Float matrices (with any leading batch axes) go to LAPACK. Object matrices are eliminated in unrolled steps,
so that structural zeros cost nothing; the order is that of Golub & Van Loan, Matrix Computations (2013), the
section named at each function. Sizes are those of robotics, up to a few dozen rows.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna import numeric
from ulna.numeric import is_symbolic
from ulna.typing import Array

_Rows = list[list[Any]]
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
    lower: _Rows = [[one if i == j else zero for j in range(m)] for i in range(m)]
    floors = [numeric.dot(row, row) * (noise * noise) if noise else 0.0 for row in rows]
    squares, reciprocals = [], []
    for j in range(m):
        squares.append(numeric.dot(rows[j], rows[j]))
        reciprocals.append(reciprocal_above(squares[j], floors[j]))
        for i in range(j + 1, m):
            lower[i][j] = numeric.dot(rows[j], rows[i]) * reciprocals[j]
            rows[i] = rows[i] - _column(lower[i][j]) * rows[j]
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
    rows = [q[..., i, :] * _column(reciprocals[..., i]) for i in range(m)]
    for i in reversed(range(m)):
        for j in range(i + 1, m):
            rows[i] = rows[i] - _column(lower[..., j, i]) * rows[j]
    size = sum((numeric.dot(a[..., i, :], a[..., i, :]) for i in range(m)), 0.0)
    inverse_size = sum((numeric.dot(row, row) for row in rows), 0.0)
    least = squares[..., 0]
    for i in range(1, m):
        least = numeric.minimum(least, squares[..., i])
    condition = numeric.where(numeric.less(_DENORMAL, least), numeric.sqrt(size * inverse_size), np.inf)
    return np.stack(rows, axis=-1), condition


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
    rows, d = _ldl(_rows(a))
    return _matrix(rows), _vector(d)


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
        return _lapack_solve(a, b)
    lower, d = _ldl(_rows(a))
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

    return _by_column(one, b)


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
        return _lapack_solve(a, b)
    n = a.shape[-1]
    right = b if b.ndim == 2 else b[:, None]
    rows = [list(left) + list(extra) for left, extra in zip(_rows(a), right, strict=True)]
    _eliminate(rows, n)
    k = right.shape[1]
    for i in reversed(range(n)):
        inverse = 1 / rows[i][i]  # an integer keeps symbols exact
        for c in range(n, n + k):
            value = rows[i][c]
            for j in range(i + 1, n):
                value = value - rows[i][j] * rows[j][c]
            rows[i][c] = value * inverse
    x = _matrix([row[n:] for row in rows])
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
    rows = _rows(a)
    if len(rows) > 3:
        sign = _eliminate(rows, len(rows))
        product = sign * rows[0][0]
        for i in range(1, len(rows)):
            product = product * rows[i][i]
        return product
    return _cofactors(rows)


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


def _cofactors(rows: _Rows) -> Any:
    if not rows:
        return 1.0
    if len(rows) == 1:
        return rows[0][0]
    if len(rows) == 2:
        (a, b), (c, d) = rows
        return a * d - b * c
    (a, b, c), (d, e, f), (g, h, i) = rows
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)


def _ldl(a: _Rows) -> tuple[_Rows, list[Any]]:
    n = len(a)
    lower: _Rows = [[1.0 if i == j else 0.0 for j in range(n)] for i in range(n)]
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


def _eliminate(rows: _Rows, n: int) -> Any:
    """Brings the first n columns of `rows` to a triangle, in place; returns the sign of the swaps."""
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


def _column(x: Any) -> Any:
    """`x` as a factor of a row: a batch gains an axis, a scalar stays."""
    return x[..., None] if isinstance(x, np.ndarray) and x.ndim else x


def _rows(a: Array) -> _Rows:
    return [list(row) for row in a]


def _vector(values: list[Any]) -> Array:
    out = np.empty(len(values), dtype=object)
    out[:] = values
    return out


def _matrix(rows: _Rows) -> Array:
    out = np.empty((len(rows), len(rows[0]) if rows else 0), dtype=object)
    for i, row in enumerate(rows):
        for j, value in enumerate(row):
            out[i, j] = value
    return out


def _by_column(f: Any, b: Array) -> Array:
    if b.ndim == 1:
        return _vector(f(list(b)))
    return _matrix([list(x) for x in zip(*(f(list(b[:, k])) for k in range(b.shape[1])), strict=True)])


def _lapack_solve(a: Array, b: Array) -> Array:
    if b.ndim == a.ndim - 1:  # NumPy 2 takes only a 1-dimensional b for a vector
        return np.linalg.solve(a, b[..., None])[..., 0]
    return np.linalg.solve(a, b)
