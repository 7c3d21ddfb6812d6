"""The factors of a mass matrix that keep the tree's zeros, and what is solved with them.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| M | symmetric positive definite matrix | (nv, nv) | | |
| L, d | unit lower triangle; diagonal | (nv, nv), (nv) | | M = L^T diag(d) L |
| E | inverse of L | (nv, nv) | | E_k = e_k - sum_j L_kj E_j, j < k |
| x | solution of M x = b | (nv) | | L^T y = b, z = y / d, L x = z |
| M^-1 | inverse | (nv, nv) | | E diag(1 / d) E^T |

Source: Featherstone 2008, section 6.5 (tables 6.3 and 6.4). The elimination runs from the last joint to the first, so
that an entry of L is zero wherever neither of two joints is an ancestor of the other: such branch-induced zeros are
left out, in E likewise. An entry of M^-1 is a sum over the common ancestors of its joints. Joints that mimic joints
couple fill in.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np

from ulna.algorithms.dynamics.pivots import ZeroPivot
from ulna.compiler.forms.columns import Columns, row_places
from ulna.linalg import reciprocal_above
from ulna.numeric import matrix
from ulna.typing import Array


class Factors:
    """L and 1/d of a matrix of numbers, batches of numbers, symbols or traced scalars.

    Attributes:
        lower: For each row of L its entries before the diagonal, by column; those that are zero are missing.
        reciprocals: 1/d.
        pivots: d; none where they are not known.
    """

    def __init__(self, M: Array, floors: Sequence[Any] | None = None) -> None:
        """Factors a matrix; a pivot that is not above its floor has a reciprocal of zero, and its entry of solutions
        too.

        Args:
            M: Symmetric positive definite matrix, shape (..., nv, nv).
            floors: One for each pivot; None for none.

        Raises:
            ZeroPivot: without floors, a pivot is zero whatever the inputs.
        """
        n = M.shape[-1]
        rows = [[M[..., i, j] for j in range(i + 1)] for i in range(n)]
        self.lower: list[dict[int, Any]] = [{} for _ in range(n)]
        self.pivots: list[Any] = [None] * n
        self.reciprocals: list[Any] = [None] * n
        for k in reversed(range(n)):
            self.pivots[k] = pivot = rows[k][k]
            self.reciprocals[k] = (
                inverse_pivot(pivot, k) if floors is None else reciprocal_above(pivot, floors[k])
            )
            filled = [j for j in range(k) if not is_zero(rows[k][j])]
            self.lower[k] = {j: rows[k][j] * self.reciprocals[k] for j in filled}
            for i in filled:
                for j in filled:
                    if j <= i:
                        rows[i][j] = rows[i][j] - self.lower[k][i] * rows[k][j]

    @classmethod
    def of(
        cls, lower: list[dict[int, Any]], reciprocals: Sequence[Any], pivots: Sequence[Any] = ()
    ) -> Factors:
        """Factors that are known already.

        Args:
            lower: For each row of L its entries before the diagonal, by column.
            reciprocals: 1/d.
            pivots: d; none where they are not known.

        Returns:
            The factors, of which nothing is checked.
        """
        factors = object.__new__(cls)
        factors.lower, factors.reciprocals, factors.pivots = lower, list(reciprocals), list(pivots)
        return factors

    def solve(self, b: Sequence[Any]) -> list[Any]:
        """x with M x = b, entry by entry."""
        return self.outward(
            y * reciprocal for y, reciprocal in zip(self.inward(b), self.reciprocals, strict=True)
        )

    def columns(self, matrices: Sequence[Any], sign: float = 1.0) -> Columns:
        """M^-1 B or -M^-1 B for some matrices B, column by column.

        Args:
            matrices: Each B, shape (nv, nv), or a number, which stands for that multiple of the unit matrix.
            sign: 1 or -1 [-].

        Returns:
            The products as a function of the columns of each B.
        """
        keys = [sorted(row) for row in self.lower]
        n = len(keys)

        def body(table: Array, column: Array) -> Array:
            entries = iter(table)
            lower = [{j: next(entries) for j in row} for row in keys]
            return np.array(Factors.of(lower, list(entries)).solve(list(column)), dtype=object)

        table = [self.lower[k][j] for k in range(n) for j in keys[k]]
        return Columns([*table, *(sign * r for r in self.reciprocals)], matrices, body, n, inverts=True)

    def inward(self, b: Iterable[Any]) -> list[Any]:
        """y with L^T y = b; entries that are zero by the tree stay so."""
        y = list(b)
        for k in reversed(range(len(y))):
            if not is_zero(y[k]):
                for j, l in self.lower[k].items():
                    y[j] = y[j] - l * y[k]
        return y

    def outward(self, z: Iterable[Any]) -> list[Any]:
        """x with L x = z."""
        x: list[Any] = []
        for k, entry in enumerate(z):
            x.append(entry)
            for j, l in self.lower[k].items():
                x[k] = x[k] - l * x[j]
        return x

    def unit_inverse(self) -> list[dict[int, Any]]:
        """For each row of E its entries before the diagonal, by column; those that are zero are missing."""
        E: list[dict[int, Any]] = []
        for k in range(len(self.lower)):
            row: dict[int, Any] = {}
            for j, l in sorted(self.lower[k].items(), reverse=True):
                row[j] = row[j] - l if j in row else -l
                for c, e in E[j].items():
                    row[c] = row[c] - l * e if c in row else -(l * e)
            E.append(row)
        return E

    def inverse(self) -> Array:
        """M^-1, (..., nv, nv); its two equal halves are computed once."""
        n = len(self.lower)
        E = self.unit_inverse()
        out: list[list[Any]] = [[0.0] * n for _ in range(n)]
        for k in range(n):
            scaled = {j: e * self.reciprocals[j] for j, e in E[k].items()} | {k: self.reciprocals[k]}
            for i in range(k + 1):
                total: Any = scaled.get(i, 0.0)
                for j, e in E[i].items():
                    if j in scaled:
                        total = total + scaled[j] * e
                out[i][k] = out[k][i] = total
        return matrix(out) if n else np.zeros((0, 0))


def elimination_paths(M: Array) -> list[list[int]]:
    """For each row the columns before the diagonal in which L may have entries: a path to the root of a tree.

    The parent of a row is the last column in which L has an entry; all other columns with entries are its ancestors.

    Args:
        M: Symmetric positive definite matrix, shape (nv, nv), whose zeros are known.

    Returns:
        The columns, in rising order.
    """
    n = M.shape[-1]
    filled = [{j for j in range(k) if not is_zero(M[k, j])} for k in range(n)]
    for k in reversed(range(n)):
        for i in filled[k]:
            filled[i] |= {j for j in filled[k] if j < i}
    paths: list[list[int]] = []
    for columns in filled:
        parent = max(columns, default=-1)
        paths.append([*paths[parent], parent] if parent >= 0 else [])
    return paths


def columns_of_inverse(M: Array) -> Columns:
    """M^-1, column by column, with L and d left to the compiled code.

    Args:
        M: Symmetric positive definite matrix, shape (nv, nv), whose zeros are known.

    Returns:
        The rows of M, and what is done with a column of the unit matrix.

    Raises:
        ZeroPivot: an entry of the diagonal is zero whatever the inputs.
    """
    for k in range(M.shape[-1]):
        if is_zero(M[k, k]):
            raise ZeroPivot(k)
    paths = elimination_paths(M)
    return Columns(
        list(rows_of_factors(M, paths)), [1.0], solution_by_rows(paths), len(paths), paths, inverts=True
    )


def rows_of_factors(M: Array, paths: Sequence[Sequence[int]]) -> Array:
    """The rows of a matrix that is to be factored in compiled code, one after the other.

    Args:
        M: Symmetric positive definite matrix, shape (nv, nv).
        paths: For each row the columns before the diagonal, as from `elimination_paths`.

    Returns:
        The vector, shape (size,); for size and places see `ulna.compiler.forms.columns.row_places`.
    """
    places, size = row_places(paths)
    table = np.zeros(size, dtype=object)
    for k, path in enumerate(paths):
        for place, j in enumerate([*path, k], places[k]):
            table[place] = M[k, j]
    return table


def solution_by_rows(paths: Sequence[Sequence[int]]) -> Callable[[Array, Array], Array]:
    """The solution of M x = b from factors in rows.

    Args:
        paths: For each row the columns before the diagonal.

    Returns:
        The function of the rows of L, followed by 1/d, and of b, each a vector.
    """
    return lambda table, b: np.array(factors_in_rows(table, paths).solve(list(b)), dtype=object)


def factors_in_rows(table: Array, paths: Sequence[Sequence[int]]) -> Factors:
    """The factors whose rows lie one after the other.

    Args:
        table: The rows of L, followed by 1/d, shape (size,).
        paths: For each row the columns before the diagonal.

    Returns:
        The factors.
    """
    places, size = row_places(paths)
    lower = [dict(zip(path, table[place:], strict=False)) for place, path in zip(places, paths, strict=True)]
    return Factors.of(lower, list(table[size:]))


def is_zero(x: Any) -> bool:
    """Whether a number, every number of a batch, or a traced number that depends on nothing, is zero."""
    if isinstance(x, np.ndarray):
        return all(map(is_zero, x.flat)) if x.dtype == object else not x.any()
    return getattr(x, "_known_", x if isinstance(x, (int, float)) else None) == 0.0


def inverse_pivot(pivot: Any, index: int) -> Any:
    """1 / pivot.

    Args:
        pivot: The articulated inertia that an entry of v moves, a number, batch or traced scalar.
        index: That entry of v, for the error.

    Returns:
        The reciprocal.

    Raises:
        ZeroPivot: it is zero whatever the inputs.
    """
    if is_zero(pivot):
        raise ZeroPivot(index)
    return 1.0 / pivot
