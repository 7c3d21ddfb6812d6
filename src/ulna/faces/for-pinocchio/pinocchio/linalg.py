"""Small helpers of linear algebra."""

from __future__ import annotations

from typing import Any

import numpy as np

from pinocchio._arrays import numbers
from ulna.typing import Floats

__all__ = ["computeLargestEigenvector", "inv"]


def inv(matrix: Any) -> Floats:
    """The inverse of a matrix."""
    return np.asarray(np.linalg.inv(numbers(matrix, "matrix")), dtype=float)


def computeLargestEigenvector(matrix: Any) -> Floats:
    """The eigenvector of the largest eigenvalue of a symmetric matrix."""
    return np.asarray(np.linalg.eigh(numbers(matrix, "matrix")).eigenvectors[:, -1], dtype=float)
