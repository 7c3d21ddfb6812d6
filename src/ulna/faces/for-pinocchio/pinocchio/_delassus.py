"""Delassus operators: the matrix by which constraint forces accelerate constraints, and what is solved with it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, final

import numpy as np

from pinocchio._arrays import numbers, vector
from ulna import linalg
from ulna.errors import InputError, ShapeError
from ulna.typing import Floats

if TYPE_CHECKING:
    from pinocchio._constraint_cholesky import ConstraintCholeskyDecomposition

__all__ = [
    "DelassusCholeskyExpression",
    "DelassusOperatorCholeskyExpression",
    "DelassusOperatorDense",
    "DelassusOperatorSparse",
]


def diagonal(value: Any, size: int, name: str) -> Floats:
    """One number, or one for each row, as a vector (size,) of numbers that are not below zero.

    Raises:
        InputError: one of them is.
    """
    given = numbers(value, name)
    found = np.full(size, float(given)) if given.ndim == 0 else vector(value, size, name).copy()
    if not (found >= 0.0).all():
        raise InputError(f"`{name}` is {value!r}; expected numbers that are not below zero.")
    return found


class _Operator:
    """A matrix G with a compliance and a damping on its diagonal."""

    __slots__ = ("_G", "_compliance", "_damping")

    def _hold(self, G: Floats) -> None:
        if G.ndim != 2 or G.shape[0] != G.shape[1]:
            raise ShapeError("matrix", G.shape, "(n, n)")
        self._G = G
        self._compliance = self._damping = np.zeros(len(G))

    def size(self) -> int:
        """How many rows it has."""
        return len(self._G)

    rows = cols = size

    def matrix(self, enforce_symmetry: bool = False, with_damping: bool = True) -> Any:
        """G with its compliance, and its damping if that is asked for; it is always symmetric."""
        return self._G + np.diag(self._compliance + (self._damping if with_damping else 0.0))

    def inverse(self) -> Any:
        """The inverse of the matrix with compliance and damping."""
        return linalg.inverse(_Operator.matrix(self))

    def solve(self, mat: Any) -> Floats:
        """x with (G + compliance + damping) x = mat, which is (n,) or (n, k)."""
        given = numbers(mat, "mat")
        if given.ndim not in (1, 2) or given.shape[0] != self.size():
            raise ShapeError("mat", given.shape, f"({self.size()},) or ({self.size()}, k)")
        return np.asarray(linalg.solve(_Operator.matrix(self), given), dtype=float)

    def __mul__(self, mat: Any) -> Floats:
        return np.asarray(_Operator.matrix(self) @ numbers(mat, "mat"), dtype=float)

    __matmul__ = __mul__

    def getDamping(self) -> Floats:
        """The damping (n,)."""
        return self._damping.copy()

    def getCompliance(self) -> Floats:
        """The compliance (n,)."""
        return self._compliance.copy()

    def updateDamping(self, mu: Any) -> None:
        """Sets the damping: one number, or one for each row."""
        self._damping = diagonal(mu, self.size(), "mu")

    def updateCompliance(self, mu: Any) -> None:
        """Sets the compliance: one number, or one for each row."""
        self._compliance = diagonal(mu, self.size(), "mu")


@final
class DelassusOperatorDense(_Operator):
    """`DelassusOperatorDense(matrix)`: of a matrix (n, n)."""

    __slots__ = ()

    def __init__(self, matrix: Any) -> None:
        self._hold(numbers(matrix, "matrix").copy())


@final
class DelassusOperatorSparse(_Operator):
    """`DelassusOperatorSparse(matrix)`: of a sparse matrix of scipy; matrix and inverse are of its kind."""

    __slots__ = ("_kind",)

    def __init__(self, matrix: Any) -> None:
        if not hasattr(matrix, "toarray"):
            raise InputError(f"The matrix is {type(matrix).__name__}; expected a sparse matrix of scipy.")
        self._kind = type(matrix)
        self._hold(numbers(matrix.toarray(), "matrix"))

    def matrix(self, enforce_symmetry: bool = False, with_damping: bool = True) -> Any:
        """The same, sparse."""
        return self._kind(super().matrix(enforce_symmetry, with_damping))

    def inverse(self) -> Any:
        """The inverse, sparse."""
        return self._kind(super().inverse())


@final
class DelassusOperatorCholeskyExpression(_Operator):
    """`DelassusOperatorCholeskyExpression(decomposition)`: of its constraints, with its damping."""

    __slots__ = ("_of",)

    def __init__(self, cholesky_decomposition: ConstraintCholeskyDecomposition) -> None:
        self._of = cholesky_decomposition
        self._hold(cholesky_decomposition._delassus())
        self._damping = cholesky_decomposition._mu.copy()

    def cholesky(self) -> ConstraintCholeskyDecomposition:
        """The decomposition."""
        return self._of

    def updateDamping(self, mu: Any) -> None:
        """Sets the damping, that of the decomposition, too."""
        super().updateDamping(mu)
        self._of.updateDamping(self._damping)


DelassusCholeskyExpression = DelassusOperatorCholeskyExpression
