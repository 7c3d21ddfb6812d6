"""Products of dense matrices of tens of rows, for which BLAS takes longer."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from pinocchio._constraints._procedures.solver_rows import LANES
from ulna.compiler.procedures import Array2, f64, procedure
from ulna.typing import Floats

ROWS, COLUMNS = 4, 2 * LANES
"""Size of the block of the product that is computed in registers; products have at least as many."""


@procedure(constants={"W": LANES}, contract=True)
def multiply(A: Array2[f64], B: Array2[f64], C: Array2[f64], W: int) -> None:
    """C = A B, in blocks; the last ones begin so early that they end with the matrix."""
    for first_row in range(0, C.shape[0], ROWS):
        i = min(first_row, C.shape[0] - ROWS)
        for first_column in range(0, C.shape[1], 2 * W):
            j = min(first_column, C.shape[1] - 2 * W)
            right = j + W
            a0, a1 = B[0, j : j + W] * A[i, 0], B[0, right : right + W] * A[i, 0]
            b0, b1 = B[0, j : j + W] * A[i + 1, 0], B[0, right : right + W] * A[i + 1, 0]
            c0, c1 = B[0, j : j + W] * A[i + 2, 0], B[0, right : right + W] * A[i + 2, 0]
            d0, d1 = B[0, j : j + W] * A[i + 3, 0], B[0, right : right + W] * A[i + 3, 0]
            for k in range(1, B.shape[0]):
                x, y = B[k, j : j + W], B[k, right : right + W]
                a0, a1 = a0 + x * A[i, k], a1 + y * A[i, k]
                b0, b1 = b0 + x * A[i + 1, k], b1 + y * A[i + 1, k]
                c0, c1 = c0 + x * A[i + 2, k], c1 + y * A[i + 2, k]
                d0, d1 = d0 + x * A[i + 3, k], d1 + y * A[i + 3, k]
            C[i, j : j + W] = a0
            C[i, right : right + W] = a1
            C[i + 1, j : j + W] = b0
            C[i + 1, right : right + W] = b1
            C[i + 2, j : j + W] = c0
            C[i + 2, right : right + W] = c1
            C[i + 3, j : j + W] = d0
            C[i + 3, right : right + W] = d1


def bound_product(A: Floats, B: Floats, C: Floats) -> Callable[[], Any]:
    """What writes A B into C each time it is called.

    Args:
        A: (m, n), which stays where it is, as the others.
        B: (n, k).
        C: (m, k).

    Returns:
        The function.
    """
    if C.shape[0] < ROWS or C.shape[1] < COLUMNS or not len(B):
        return partial(np.dot, A, B, C)
    return multiply.bind(A, B, C, are_arrays_private=True)
