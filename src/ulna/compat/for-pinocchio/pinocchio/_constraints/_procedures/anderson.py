"""Anderson's acceleration of fixed-point iterations, as procedures for any size.

| symbol | meaning | shape |
|---|---|---|
| x_j, z_j | the last iterates, j = 0 the newest | (m,) |
| f_j | by how much z_j differs from what its iteration started from | (m,) |
| a | weights: a_1 (f_0 - f_1) + a_2 (f_1 - f_2) + ... is nearest to f_0 | (capacity - 1,) |

The next iteration starts from x_0 - a_1 (x_0 - x_1) - a_2 (x_1 - x_2) - ..., and z alike. Source: Walker & Ni, Anderson
acceleration for fixed-point iterations (2011), section 2; weights by Householder's reflections with exchange of
columns, Golub & Van Loan, Matrix computations (2013), section 5.4.2.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from pinocchio._constraints._procedures.solver_rows import INT
from ulna.compiler.procedures import Array1, Array2, f64, procedure

_EPS = 2.0**-52


class History(NamedTuple):
    """The last iterates, in a ring, and storage.

    Attributes:
        x, z, f: (capacity, width).
        M: The differences of f, which reflections change; a row each (capacity - 1, width).
        b: Right side (width,).
        a: Weights (capacity,).
        order: Which difference each row of M is (capacity,).
        count: How many iterates there are, and where the newest one is (2,).
    """

    x: Array2[f64]
    z: Array2[f64]
    f: Array2[f64]
    M: Array2[f64]
    b: Array1[f64]
    a: Array1[f64]
    order: Array1[INT]
    count: Array1[INT]


@procedure
def clear(history):
    """Forgets all iterates."""
    history.count[0] = 0
    history.count[1] = 0


@procedure
def remember(history, x, z, start):
    """Adds an iterate, in place of the oldest one where there is no room."""
    capacity = len(history.x)
    if history.count[0] > 0:
        history.count[1] = (history.count[1] + 1) % capacity
    for i in range(len(x)):
        history.x[history.count[1], i] = x[i]
        history.z[history.count[1], i] = z[i]
        history.f[history.count[1], i] = z[i] - start[i]
    history.count[0] = min(history.count[0] + 1, capacity)


@procedure
def _place(history, j):
    """Where iterate j is."""
    return (history.count[1] - j + len(history.x)) % len(history.x)


@procedure
def _length(M, j, first, m):
    """The square of the length of a row of M, from an entry on."""
    total = 0.0
    for i in range(first, m):
        total += M[j, i] * M[j, i]
    return total


@procedure
def _exchange(history, j, k):
    """Exchanges two rows of M."""
    if j != k:
        other = history.order[j]
        history.order[j] = history.order[k]
        history.order[k] = other
        for i in range(history.M.shape[1]):
            entry = history.M[j, i]
            history.M[j, i] = history.M[k, i]
            history.M[k, i] = entry


@procedure
def _reflect(M, k, v, j, scale, m):
    """Subtracts scale (v . row j) v from row j of M, v being row k with one before its entries from k + 1 on."""
    along = v[j, k]
    for i in range(k + 1, m):
        along += M[k, i] * v[j, i]
    along *= scale
    v[j, k] -= along
    for i in range(k + 1, m):
        v[j, i] -= along * M[k, i]


@procedure
def _eliminate(M, b, k, m):
    """Reflects row k of M onto its entry k, and all later rows and b with it."""
    first, tail = M[k, k], _length(M, k, k + 1, m)
    if tail <= 2.2250738585072014e-308:
        return
    length = np.sqrt(first * first + tail)
    if first >= 0.0:
        length = -length
    for i in range(k + 1, m):
        M[k, i] /= first - length
    scale = (length - first) / length
    M[k, k] = length
    for j in range(k + 1, len(M)):
        _reflect(M, k, M, j, scale, m)
    along = b[k]
    for i in range(k + 1, m):
        along += M[k, i] * b[i]
    along *= scale
    b[k] -= along
    for i in range(k + 1, m):
        b[i] -= along * M[k, i]


@procedure
def _weights(history, m):
    """The weights, of the differences in M and of b; where M has a smaller rank, of the first pivots alone."""
    columns = len(history.M)
    largest = 0.0
    for j in range(columns):
        history.order[j] = j
        history.a[j] = 0.0
        largest = max(largest, _length(history.M, j, 0, m))
    threshold, rank, steps = largest * _EPS * _EPS / float(m), min(m, columns), min(m, columns)
    for k in range(steps):
        pivot, most = k, _length(history.M, k, k, m)
        for j in range(k + 1, columns):
            length = _length(history.M, j, k, m)
            if length > most:
                pivot, most = j, length
        if most < threshold * float(m - k):
            rank = k
            break
        _exchange(history, pivot, k)
        _eliminate(history.M, history.b, k, m)
    for k in range(rank - 1, -1, -1):
        value = history.b[k]
        for j in range(k + 1, rank):
            value -= history.M[j, k] * history.a[history.order[j]]
        history.a[history.order[k]] = value / history.M[k, k]


@procedure
def accelerate(history, x, z, m, W):
    """Extrapolates the newest iterate, which x and z hold, in place."""
    for j in range(len(history.M)):
        here, there = _place(history, j), _place(history, j + 1)
        for n in range(0, len(x), W):
            history.M[j, n : n + W] = history.f[here, n : n + W] - history.f[there, n : n + W]
    for n in range(0, len(x), W):
        history.b[n : n + W] = history.f[history.count[1], n : n + W]
    _weights(history, m)
    for j in range(len(history.M)):
        here, there, weight = _place(history, j), _place(history, j + 1), history.a[j]
        for n in range(0, len(x), W):
            x[n : n + W] = x[n : n + W] - (history.x[here, n : n + W] - history.x[there, n : n + W]) * weight
            z[n : n + W] = z[n : n + W] - (history.z[here, n : n + W] - history.z[there, n : n + W]) * weight
