"""Delassus operators: the matrix by which constraint forces accelerate constraints, and what is solved with it."""

from __future__ import annotations

from array import array
from functools import lru_cache, reduce
from typing import Any, Self, final

import numpy as np

from pinocchio._containers.arguments import ArgumentError, WrongShape
from pinocchio._containers.arrays import not_applicable, numbers, vector
from pinocchio._containers.keywords import by_name, overloads
from pinocchio._model.bound_kernels import BoundKernel
from ulna import linalg, numeric
from ulna.algorithms.constraints.damped_dynamics import damped_factors
from ulna.algorithms.dynamics.mass_matrix_factors import Factors
from ulna.compiler import compile as compile_function
from ulna.errors import InputError
from ulna.typing import Array, Floats

__all__ = [
    "DelassusOperatorDense",
    "DelassusOperatorSparse",
]


def diagonal(value: Any, size: int, name: str) -> Floats:
    """One number, or one for each row, as a vector (size,) of numbers that are not below zero.

    Args:
        value: A number, or numbers (size,).
        size: Number of rows.
        name: Name of the argument, for messages.

    Returns:
        Vector (size,).

    Raises:
        InputError: one of them is.
    """
    array = numbers(value, name)
    entries = np.full(size, float(array)) if array.ndim == 0 else vector(value, size, name).copy()
    if not (entries >= 0.0).all():
        raise InputError(f"`{name}` is {value!r}; expected numbers that are not below zero.")
    return entries


def with_added_diagonal(G: Floats, by: Any) -> Floats:
    """A matrix with something added to its diagonal.

    Args:
        G: Matrix (m, m).
        by: A number, or numbers (m,).

    Returns:
        Matrix (m, m).
    """
    out = G.copy()
    out.reshape(-1)[:: len(out) + 1] += by
    return out


MOST_ROWS = 24
"""Larger matrices are left to LAPACK."""


@lru_cache(MOST_ROWS)
def _solver(size: int) -> Any:
    """b, G, what is added to its diagonal: x, and what is above zero where it is the only one."""

    def run(b: Array, G: Array, compliance: Array, damping: Array) -> tuple[Any, Any]:
        factors = damped_factors(G, compliance + damping)
        return numeric.vector(*factors.solve(list(b))), reduce(numeric.minimum, factors.reciprocals)

    return compile_function(run, b=size, G=(size, size), compliance=size, damping=size)


@lru_cache(MOST_ROWS)
def _inverter(size: int) -> Any:
    """G, what is added to its diagonal: the inverse, and what is above zero where there is one."""
    return compile_function(inverse_and_least_pivot, G=(size, size), mu=())


def inverse_and_least_pivot(G: Array, mu: Any) -> tuple[Any, Any]:
    """The inverse of a symmetric matrix with a number on its diagonal, and what is above zero where there is one.

    Args:
        G: Symmetric semidefinite matrix (m, m), numbers or traced [1/kg].
        mu: Number that is added to the diagonal [1/kg].

    Returns:
        Matrix (m, m), and a number.
    """
    factors = damped_factors(G, numeric.vector(*[mu] * len(G)))
    return factors.inverse(), reduce(numeric.minimum, factors.reciprocals)


@lru_cache(MOST_ROWS)
def _inertial(size: int) -> Any:
    """G and an inertia: `with_inertia`."""

    def run(G: Array, mu: Any) -> Array:
        factors = Factors(np.eye(size) + mu * G)
        return numeric.matrix([factors.solve(column) for column in G])

    return compile_function(run, G=(size, size), mu=())


def with_inertia(G: Floats, mu: float) -> Floats:
    """(1 + mu G)^-1 G of a symmetric semidefinite matrix.

    Args:
        G: Symmetric semidefinite matrix (m, m) [1/kg].
        mu: Inertia at each row [kg].

    Returns:
        Matrix (m, m) [1/kg].
    """
    if 0 < len(G) <= MOST_ROWS:
        return _inertial(len(G))(G, mu)
    return linalg.solve(np.eye(len(G)) + mu * G, G)


def damped_inverse(G: Floats, mu: float) -> Floats:
    """(G + mu 1)^-1 of a symmetric semidefinite matrix.

    Args:
        G: Symmetric semidefinite matrix (m, m) [1/kg].
        mu: Number that is added to the diagonal [1/kg].

    Returns:
        Matrix (m, m) [kg].

    Raises:
        InputError: it is singular.
    """
    if not 0 < len(G) <= MOST_ROWS:
        return linalg.inverse(with_added_diagonal(G, mu))
    result, unique = _inverter(len(G))(G, mu)
    if not unique > 0.0:
        raise InputError(
            f"The {len(G)} rows of the constraints depend on each other: their Delassus matrix has no inverse. Leave "
            "some out, or give a damping mu such as 1e-8."
        )
    return result


class DelassusOperator:
    """A matrix G with a compliance and a damping on its diagonal."""

    __slots__ = ("_G", "_compliance", "_damping", "_solve_vector", "_unique")

    def __copy__(self) -> Self:
        other = object.__new__(type(self))
        for kind in type(self).__mro__:
            for name in getattr(kind, "__slots__", ()):
                setattr(other, name, getattr(self, name))
        other._damping, other._unique = self._damping.copy(), array("d", [0.0])
        other._solve_vector = None
        return other

    def _hold(self, G: Floats) -> None:
        if G.ndim != 2 or G.shape[0] != G.shape[1]:
            raise WrongShape("matrix", G.shape, "(n, n)")
        self._G = G
        self._compliance, self._damping = np.zeros(len(G)), np.zeros(len(G))
        self._solve_vector: Any = None  # bound to these arrays when first called
        self._unique = array("d", [0.0])

    def _bind(self) -> Any:
        """Binds what solves with one vector to the arrays of this operator."""
        self._solve_vector = not_applicable
        if 0 < len(self._G) <= MOST_ROWS:
            trailing_inputs = np.ascontiguousarray(self._G), self._compliance, self._damping
            others = (np.frombuffer(self._unique).reshape(()),)
            kernel = _solver(len(self._G))
            self._solve_vector = BoundKernel(kernel, others=others, trailing_inputs=trailing_inputs).call
        return self._solve_vector

    def size(self) -> int:
        """How many rows it has."""
        return len(self._G)

    rows = cols = size

    def matrix(self, enforce_symmetry: bool = False, with_damping: bool = True) -> Any:
        """G with its compliance, and its damping if `with_damping`; it is always symmetric.

        Args:
            enforce_symmetry: Accepted and ignored: it is always symmetric.
            with_damping: Whether the damping counts.

        Returns:
            Matrix (m, m).
        """
        return with_added_diagonal(
            self._G, self._compliance + self._damping if with_damping else self._compliance
        )

    def inverse(self) -> Any:
        """The inverse of the matrix with compliance and damping."""
        G = DelassusOperator.matrix(self)
        if 0 < len(G) <= MOST_ROWS:
            result, unique = _inverter(len(G))(G, 0.0)
            if unique > 0.0:
                return result
        return linalg.inverse(G)

    def solve(self, mat: Any) -> Floats:
        """x with (G + compliance + damping) x = mat, which is (n,) or (n, k)."""
        step = self._solve_vector or self._bind()
        x = step(mat)
        if x is not NotImplemented and self._unique[0] > 0.0:
            return x
        right = mat if type(mat) is np.ndarray else numbers(mat, "mat")
        if right.ndim not in (1, 2) or len(right) != len(self._G):
            raise WrongShape("mat", right.shape, f"({self.size()},) or ({self.size()}, k)")
        if right.ndim == 1 and 0 < len(right) <= MOST_ROWS:
            solution, unique = _solver(len(right))(right, self._G, self._compliance, self._damping)
            if unique > 0.0:
                return solution
        return linalg.solve(DelassusOperator.matrix(self), right)

    def __mul__(self, mat: Any) -> Floats:
        return np.asarray(DelassusOperator.matrix(self) @ numbers(mat, "mat"), dtype=float)

    __matmul__ = __mul__

    def getDamping(self) -> Floats:
        """The damping (n,)."""
        return self._damping.copy()

    def getCompliance(self) -> Floats:
        """The compliance (n,)."""
        return self._compliance.copy()

    @by_name("mu", "mus")
    def updateDamping(self, mu: Any) -> None:
        """Sets the damping: one number, or one for each row."""
        self._damping = diagonal(mu, self.size(), "mu")
        self._solve_vector = None

    def _damp(self, mu: float) -> None:
        """The same with a number that is known to be none below zero."""
        self._damping = np.full(len(self._G), mu)
        self._solve_vector = None

    @by_name("mu", "mus")
    def updateCompliance(self, mu: Any) -> None:
        """Sets the compliance: one number, or one for each row."""
        self._compliance = diagonal(mu, self.size(), "mu")
        self._solve_vector = None


@final
class DelassusOperatorDense(DelassusOperator):
    """`DelassusOperatorDense(matrix)`: of a matrix (n, n)."""

    __slots__ = ()

    def __init__(self, matrix: Any) -> None:
        self._hold(numbers(matrix, "matrix").copy())


@final
class DelassusOperatorSparse(DelassusOperator):
    """`DelassusOperatorSparse(matrix)`: of a sparse matrix of scipy; matrix and inverse are of its kind."""

    __slots__ = ("_kind",)

    def __init__(self, matrix: Any) -> None:
        if not hasattr(matrix, "toarray"):
            raise ArgumentError(f"The matrix is {type(matrix).__name__}; expected a sparse matrix of scipy.")
        self._kind = type(matrix)
        self._hold(numbers(matrix.toarray(), "matrix"))

    @overloads("enforce_symmetry:bool? with_damping:bool?", "with_damping:bool?")
    def matrix(self, enforce_symmetry: bool = False, with_damping: bool = True) -> Any:
        """The same, sparse.

        Args:
            enforce_symmetry: Accepted and ignored: it is always symmetric.
            with_damping: Whether the damping counts.

        Returns:
            Sparse matrix (m, m).
        """
        return self._kind(super().matrix(enforce_symmetry, with_damping))

    def inverse(self) -> Any:
        """The inverse, sparse."""
        return self._kind(super().inverse())
