"""Symmetric matrices in tridiagonal form, and the decomposition of Lanczos."""

from __future__ import annotations

from typing import Any, final

import numpy as np

from pinocchio._constraints._procedures.lanczos_steps import decomposition, eigenvalue
from pinocchio._constraints._procedures.solver_rows import LANES
from pinocchio._containers.arguments import WrongShape, check_size
from pinocchio._containers.arrays import numbers, real, vector
from pinocchio._containers.keywords import by_name
from pinocchio._spatial.random_numbers import generator
from ulna.errors import InputError
from ulna.typing import Floats

__all__ = ["LanczosDecomposition", "TridiagonalSymmetricMatrix"]


@final
class TridiagonalSymmetricMatrix:
    """A symmetric matrix that is zero but for its diagonal and the entries next to it; zero at first.

    Args:
        size: Number of rows.
    """

    __slots__ = ("_diagonal", "_sub")

    def __init__(self, size: int) -> None:
        count = check_size(size, "size")
        self._diagonal, self._sub = np.zeros(count), np.zeros(max(0, count - 1))

    def diagonal(self) -> Floats:
        """The diagonal (n,), live."""
        return self._diagonal

    def subDiagonal(self) -> Floats:
        """The entries below the diagonal (n - 1,), live."""
        return self._sub

    def setZero(self) -> None:
        """Sets all entries to zero."""
        self.setDiagonal(np.zeros_like(self._diagonal))

    def setIdentity(self) -> None:
        """Becomes the identity."""
        self.setDiagonal(np.ones_like(self._diagonal))

    def setRandom(self) -> None:
        """Draws all entries evenly from [-1, 1]."""
        for entries in (self._diagonal, self._sub):
            entries[:] = generator().uniform(-1.0, 1.0, len(entries))

    def setDiagonal(self, diagonal: Any) -> None:
        """Becomes a diagonal matrix with a diagonal (n,)."""
        self._diagonal[:], self._sub[:] = vector(diagonal, len(self._diagonal), "diagonal"), 0.0

    def isZero(self, prec: float = 1e-12) -> bool:
        """Whether no entry is larger than `prec`."""
        return bool(np.abs(self.matrix()).max(initial=0.0) <= real(prec, "prec"))

    def isDiagonal(self, prec: float = 1e-12) -> bool:
        """Whether entries beside the diagonal are at most `prec`."""
        return bool(np.abs(self._sub).max(initial=0.0) <= real(prec, "prec"))

    def isIdentity(self, prec: float = 1e-12) -> bool:
        """Whether it differs from the identity by at most `prec` in each entry."""
        return bool(np.abs(self.matrix() - np.eye(self.rows())).max(initial=0.0) <= real(prec, "prec"))

    def rows(self) -> int:
        """Number of rows."""
        return len(self._diagonal)

    cols = rows

    def matrix(self) -> Floats:
        """The matrix (n, n), a copy."""
        return np.diag(self._diagonal) + np.diag(self._sub, 1) + np.diag(self._sub, -1)

    def computeEigenvalue(self, eigenvalue_index: int, eps: float = 1e-8) -> float:
        """An eigenvalue by bisection with Sturm sequences [Golub & Van Loan, section 8.4.1].

        Args:
            eigenvalue_index: 0 for the smallest.
            eps: Width of the interval in which the search ends [any].

        Returns:
            The middle of that interval [any].

        Raises:
            EigenvalueOutOfRange: There is no such eigenvalue.
            InputError: `eps` is not above zero.
        """
        if not 0 <= eigenvalue_index < self.rows():
            raise EigenvalueOutOfRange(
                f"There is no eigenvalue {eigenvalue_index}; expected 0 to {self.rows() - 1}, the smallest first."
            )
        width = real(eps, "eps")
        if not width > 0.0:
            raise InputError(f"`eps` is {eps!r}; expected a number above zero.")
        return float(eigenvalue(self._diagonal, self._sub, int(eigenvalue_index), width))

    def computeSpectrum(self, eps: float = 1e-8) -> Floats:
        """All eigenvalues (n,), the smallest first, each to `eps`; see `computeEigenvalue`."""
        return np.array([self.computeEigenvalue(k, eps) for k in range(self.rows())])

    def __mul__(self, other: Any) -> Floats:
        return self.matrix() @ numbers(other, "other")

    __matmul__ = __mul__

    def __rmul__(self, other: Any) -> Floats:
        return numbers(other, "other") @ self.matrix()

    def __eq__(self, other: object) -> bool:
        same = isinstance(other, TridiagonalSymmetricMatrix)
        return same and all(map(np.array_equal, (self._diagonal, self._sub), (other._diagonal, other._sub)))

    __hash__ = object.__hash__


@final
class EigenvalueOutOfRange(InputError, IndexError):
    """There is no eigenvalue of that index; InputError is a ValueError, which Pinocchio raises."""


@final
class LanczosDecomposition:
    """Q (n, k) with orthonormal columns and T (k, k), tridiagonal, so that A Q = Q T but for the last column.

    `LanczosDecomposition(matrix, decomposition_size)`, or `(size, decomposition_size)` before `compute`. It starts with
    the first unit vector, and orthogonalises every new direction against all columns [Golub & Van Loan, section 10.1].
    Where A Q = Q T is exact already, the next unit vector continues.
    """

    __slots__ = ("_Q", "_T", "_rows")

    @by_name("matrix decomposition_size", "size decomposition_size")
    def __init__(self, matrix: Any, decomposition_size: int) -> None:
        matrix_or_size = check_size(matrix, "size") if np.ndim(matrix) == 0 else _symmetric(matrix)
        n = matrix_or_size if isinstance(matrix_or_size, int) else len(matrix_or_size)
        columns = check_size(decomposition_size, "decomposition_size")
        if not 1 <= columns <= n:
            raise InputError(
                f"`decomposition_size` is {columns}; expected 1 to {n}, the number of rows of the matrix."
            )
        self._rows = np.eye(columns, -(-n // LANES) * LANES)
        self._Q, self._T = self._rows[:, :n].T, TridiagonalSymmetricMatrix(columns)
        if not isinstance(matrix_or_size, int):
            self.compute(matrix_or_size)

    def compute(self, matrix: Any) -> None:
        """Decomposes a symmetric matrix (n, n), of which the lower half is not checked."""
        n, width = self.size(), self._rows.shape[1]
        A = np.zeros((n, width))
        A[:, :n] = _symmetric(matrix, n)
        decomposition(A, self._rows, self._T.diagonal(), self._T.subDiagonal(), np.zeros(width))

    def computeDecompositionResidual(self, matrix: Any) -> Floats:
        """A Q - Q T, (n, k), but for its last column's part that a longer decomposition would take up."""
        A = _symmetric(matrix, self.size())
        residual = A @ self._Q - self._Q @ self._T.matrix()
        last = residual[:, -1]
        if self.decompositionSize() < self.size():
            residual[:, -1] = self._Q @ (self._Q.T @ last)
        return residual

    def Qs(self) -> Floats:
        """The orthonormal basis Q (n, k), live."""
        return self._Q

    def Ts(self) -> TridiagonalSymmetricMatrix:
        """The tridiagonal matrix T (k, k)."""
        return self._T

    def size(self) -> int:
        """Number of rows of the matrix."""
        return len(self._Q)

    def decompositionSize(self) -> int:
        """Number of columns of Q."""
        return self._Q.shape[1]

    def copy(self) -> LanczosDecomposition:
        """A copy."""
        out = LanczosDecomposition(*self._Q.shape)
        out._Q[:] = self._Q
        out._T.setDiagonal(self._T.diagonal())
        out._T.subDiagonal()[:] = self._T.subDiagonal()
        return out

    __copy__ = copy

    def __deepcopy__(self, memo: Any) -> LanczosDecomposition:
        return self.copy()

    def __eq__(self, other: object) -> bool:
        same = isinstance(other, LanczosDecomposition)
        return same and np.array_equal(self._Q, other._Q) and self._T == other._T

    __hash__ = object.__hash__


def _symmetric(matrix: Any, size: int | None = None) -> Floats:
    array = numbers(matrix, "matrix")
    n = len(array) if size is None else size
    if array.shape != (n, n):
        raise WrongShape("matrix", array.shape, f"({n}, {n})")
    return array
