"""The decomposition of Lanczos and eigenvalues of tridiagonal matrices, as procedures for any size.

Source: Golub & Van Loan, Matrix computations (2013), sections 10.1 and 8.4.1; Barth, Martin & Wilkinson, Calculation of
the eigenvalues of a symmetric tridiagonal matrix by the method of bisection (1967), for where the search ends.
"""

from __future__ import annotations

import numpy as np

from pinocchio._constraints._procedures.solver_rows import LANES, larger, row_times
from ulna.compiler.procedures import Array1, Array2, f64, procedure, sum_of

_BREAKDOWN = 1e-12
"""Below this part of the largest entry of the matrix a new direction counts as zero."""
_ROUNDING = 2.0**-51


@procedure
def _scale(G, weight):
    """The largest entry of G + weight I."""
    most = 0.0
    for i in range(len(G)):
        for j in range(len(G)):
            most = larger(most, abs(G[i, j] + (weight if i == j else 0.0)))
    return most


@procedure
def _length(v, W):
    """The length of a vector."""
    total = v[0:W] * v[0:W]
    for n in range(W, len(v), W):
        total = total + v[n : n + W] * v[n : n + W]
    return np.sqrt(sum_of(total))


@procedure
def _orthogonalize(Q, count, v, W):
    """Subtracts from v its components along the first rows of Q, again while most of it goes; returns its length."""
    before, length = np.inf, _length(v, W)
    for _ in range(2):
        if length < 0.1 * before:
            before = length
            for j in range(count):
                along = row_times(Q, j, v, 0, W)
                for n in range(0, len(v), W):
                    v[n : n + W] = v[n : n + W] - Q[j, n : n + W] * along
            length = _length(v, W)
    return length


@procedure
def _next_axis(Q, count, v, m, W):
    """The first axis that is not among the first rows of Q, less its components along them; its length."""
    for j in range(m):
        for i in range(len(v)):
            v[i] = 0.0
        v[(count + j) % m] = 1.0
        length = _orthogonalize(Q, count, v, W)
        if length > 1e-8:
            return length
    return 1.0


@procedure
def _image(G, weight, Q, k, v, W):
    """v = (G + weight I) times row k of Q."""
    for i in range(len(G)):
        total = G[i, 0:W] * Q[k, 0:W]
        for n in range(W, G.shape[1], W):
            total = total + G[i, n : n + W] * Q[k, n : n + W]
        v[i] = sum_of(total) + weight * Q[k, i]


@procedure
def decompose(G, weight, Q, diagonal, below, v, W):
    """Rows of Q and a tridiagonal T with (G + weight I) Q^T = Q^T T but for the last column, from the first axis on."""
    smallest = _BREAKDOWN * _scale(G, weight)
    for n in range(Q.shape[1]):
        Q[0, n] = 1.0 if n == 0 else 0.0
        v[n] = 0.0
    for k in range(len(Q)):
        _image(G, weight, Q, k, v, W)
        diagonal[k] = row_times(Q, k, v, 0, W)
        if k + 1 < len(Q):
            length = _orthogonalize(Q, k + 1, v, W)
            below[k] = length
            if length <= smallest:
                below[k] = 0.0
                length = _next_axis(Q, k + 1, v, len(G), W)
            for n in range(Q.shape[1]):
                Q[k + 1, n] = v[n] / length


@procedure
def _count_below(diagonal, below, value):
    """How many eigenvalues are below a value: how many pivots of T - value I are negative."""
    count, pivot = 0, 1.0
    for k in range(len(diagonal)):
        beside = abs(below[k - 1]) if k > 0 else 0.0
        pivot = diagonal[k] - value - (beside * beside / pivot if pivot != 0.0 else beside / _ROUNDING)
        if pivot < 0.0:
            count += 1
    return count


@procedure
def eigenvalue(diagonal: Array1[f64], below: Array1[f64], index: int, width: float) -> float:
    """An eigenvalue of a tridiagonal matrix, 0 being the smallest, to a width."""
    low, high = np.inf, -np.inf  # Gershgorin: where all eigenvalues are
    for k in range(len(diagonal)):
        radius = abs(below[k]) if k + 1 < len(diagonal) else 0.0
        if k > 0:
            radius += abs(below[k - 1])
        low, high = min(low, diagonal[k] - radius), max(high, diagonal[k] + radius)
    while high - low > 2.0 * _ROUNDING * (abs(low) + abs(high)) + width:
        middle = 0.5 * (low + high)
        if _count_below(diagonal, below, middle) > index:
            high = middle
        else:
            low = middle
    return 0.5 * (low + high)


@procedure(constants={"W": LANES})
def decomposition(
    G: Array2[f64], Q: Array2[f64], diagonal: Array1[f64], below: Array1[f64], work: Array1[f64], W: int
) -> None:
    """`decompose`, for calls from Python: G, Q and `work` are filled up to lanes with zeros."""
    decompose(G, 0.0, Q, diagonal, below, work, W)
