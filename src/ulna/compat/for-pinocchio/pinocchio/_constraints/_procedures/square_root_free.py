"""L D L^T of a symmetric matrix with a number on its diagonal, as procedures for any size.

Source: Golub & Van Loan, Matrix computations (2013), section 4.1.2.
"""

from __future__ import annotations

from typing import NamedTuple

from pinocchio._constraints._procedures.solver_rows import row_times
from ulna.compiler.procedures import Array1, Array2, f64, procedure


class Factors(NamedTuple):
    """The factors; rows are filled up to lanes with zeros.

    Attributes:
        U: What of L^T is right of its diagonal of ones, all else being zero (m, width).
        d: D^-1 (m,).
    """

    U: Array2[f64]
    d: Array1[f64]


@procedure
def factorize(factors, G, weight, W):
    """Factorizes G + weight I."""
    width = G.shape[1]
    for i in range(len(G)):
        for n in range(0, width, W):
            factors.U[i, n : n + W] = G[i, n : n + W]
        factors.U[i, i] += weight
    for k in range(len(G)):
        inverse = 1.0 / factors.U[k, k]
        factors.d[k] = inverse
        for i in range(k + 1, len(G)):
            part = factors.U[k, i] * inverse
            for n in range(i // W * W, width, W):
                factors.U[i, n : n + W] = factors.U[i, n : n + W] - factors.U[k, n : n + W] * part
        for n in range(k // W * W, width, W):
            factors.U[k, n : n + W] = factors.U[k, n : n + W] * inverse
        for n in range(k + 1):
            factors.U[k, n] = 0.0


@procedure
def solve(factors, b, W):
    """Solves for a vector (width,), in place."""
    m = len(factors.d)
    for k in range(m):
        for n in range(k // W * W, len(b), W):
            b[n : n + W] = b[n : n + W] - factors.U[k, n : n + W] * b[k]
    for k in range(m):
        b[k] *= factors.d[k]
    for k in range(m - 2, -1, -1):
        b[k] -= row_times(factors.U, k, b, k // W * W, W)
