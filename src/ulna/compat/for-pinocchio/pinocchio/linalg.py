"""Small helpers of linear algebra."""

from __future__ import annotations

from typing import Any

import numpy as np

from pinocchio._containers.arguments import ArgumentError, WrongShape, check_size
from pinocchio._containers.arrays import numbers
from ulna.errors import InputError
from ulna.typing import Floats

__all__ = [
    "computeLargestEigenvector",
    "inv",
    "isOrthonormal",
    "orthogonalization",
    "orthonormalization",
    "retrieveLargestEigenvalue",
]


def inv(matrix: Any) -> Floats:
    """The inverse of a matrix."""
    return np.asarray(np.linalg.inv(_square(matrix, "matrix")), dtype=float)


def computeLargestEigenvector(mat: Any, max_it: int = 10, rel_tol: float = 1e-8) -> Floats:
    """The eigenvector of the eigenvalue of largest size of a symmetric matrix, by power iteration from (1, ..., 1).

    Source: Golub & Van Loan, Matrix Computations, 4th edition, 7.3.1.

    Args:
        mat: The matrix (n, n).
        max_it: Most steps, one at least.
        rel_tol: Change of the eigenvalue between two steps at which the iteration ends, relative to it [-].

    Returns:
        Eigenvector (n,), whose length is the size of the eigenvalue.

    Raises:
        InputError: No step is allowed.
    """
    matrix = _square(mat, "mat")
    if check_size(max_it, "max_it", 2**31) < 1:
        raise InputError("`max_it` is 0; expected one step at least.")
    direction, size = np.full(len(matrix), len(matrix) ** -0.5), 1.0
    eigenvector = direction
    for _ in range(max_it):
        eigenvector = matrix @ direction
        before, size = size, float(np.linalg.norm(eigenvector))
        if abs(size - before) <= rel_tol * max(size, before) or size == 0.0:
            break
        direction = eigenvector / size
    return eigenvector


def retrieveLargestEigenvalue(eigenvector: Any) -> float:
    """The largest eigenvalue, out of the eigenvector that `computeLargestEigenvector` gives."""
    return float(np.linalg.norm(numbers(eigenvector, "eigenvector")))


def isOrthonormal(matrix: Any, prec: float = 1e-12) -> bool:
    """Whether the columns of a matrix are of length 1 and orthogonal to each other, within `prec`.

    Args:
        matrix: The matrix (n, k).
        prec: Largest difference between entries of its Gram matrix and the identity [-].

    Returns:
        Whether they are.

    Raises:
        WrongShape: It is no matrix.
    """
    columns = numbers(matrix, "matrix")
    if columns.ndim != 2:
        raise WrongShape("matrix", columns.shape, "(n, k)")
    return bool(np.abs(columns.T @ columns - np.eye(columns.shape[1])).max(initial=0.0) <= prec)


def orthogonalization(basis: Any, vec: Floats, threshold: float = 0.0) -> None:
    """Subtracts from a vector, in place, its components along the orthonormal columns of a basis.

    Args:
        basis: Orthonormal columns, (n, k).
        vec: The vector (n,), which is changed.
        threshold: Components up to this size remain [any].

    Raises:
        WrongShape: The vector does not fit the basis.
    """
    columns = numbers(basis, "basis")
    columns = columns[:, None] if columns.ndim == 1 else columns
    if columns.ndim != 2 or _changed(vec).shape != columns.shape[:1]:
        raise WrongShape("vec", np.shape(vec), f"({columns.shape[0]},)")
    for column in columns.T:
        part = float(column @ vec)
        if abs(part) > threshold:
            vec -= part * column


def orthonormalization(matrix: Floats, threshold: float = 0.0) -> None:
    """Makes the columns of a matrix orthonormal, in place, one after the other (Gram and Schmidt).

    Args:
        matrix: The matrix (n, k), which is changed.
        threshold: Components up to this size remain [any].

    Raises:
        WrongShape: It is no matrix.
    """
    if _changed(matrix).ndim != 2:
        raise WrongShape("matrix", matrix.shape, "(n, k)")
    for k in range(matrix.shape[1]):
        orthogonalization(matrix[:, :k], matrix[:, k], threshold)
        matrix[:, k] /= np.linalg.norm(matrix[:, k])


def _square(matrix: Any, name: str) -> Floats:
    array = numbers(matrix, name)
    if array.ndim != 2 or array.shape[0] != array.shape[1]:
        raise WrongShape(name, array.shape, "(n, n)")
    return array


def _changed(array: Any) -> Floats:
    if not isinstance(array, np.ndarray) or array.dtype != float:
        raise ArgumentError(f"{array!r} is to be changed in place; expected a NumPy array of floats.")
    return array
