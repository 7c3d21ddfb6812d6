"""Columns of matrices, of which W are computed at once; `A[r, n : n + W]` is row r of W columns."""

from __future__ import annotations

from ulna.compiler.procedures import broadcast, procedure


@procedure
def _three_rows(F, r, n, W):
    """Three rows of W columns."""
    return F[r, n : n + W], F[r + 1, n : n + W], F[r + 2, n : n + W]


@procedure
def _put_rows(F, r, n, x, y, z, W):
    """Writes three rows of W columns."""
    F[r, n : n + W] = x
    F[r + 1, n : n + W] = y
    F[r + 2, n : n + W] = z


@procedure
def _rotated(X, i, x, y, z):
    """R (x, y, z) of lanes, where R is of numbers."""
    return (
        x * X[i, 0, 0] + y * X[i, 1, 0] + z * X[i, 2, 0],
        x * X[i, 3, 0] + y * X[i, 4, 0] + z * X[i, 5, 0],
        x * X[i, 6, 0] + y * X[i, 7, 0] + z * X[i, 8, 0],
    )


@procedure
def _lever(X, i, x, y, z):
    """p x (x, y, z) of lanes, p being the translation in row i of X."""
    px, py, pz = X[i, 9, 0], X[i, 10, 0], X[i, 11, 0]
    return z * py - y * pz, x * pz - z * px, y * px - x * py


@procedure
def _wrenches_out(X, i, F, n, W):
    """Takes W wrenches of the moving frame of row i to its parent's."""
    fx, fy, fz = _three_rows(F, 0, n, W)
    nx, ny, nz = _three_rows(F, 3, n, W)
    fx, fy, fz = _rotated(X, i, fx, fy, fz)
    nx, ny, nz = _rotated(X, i, nx, ny, nz)
    cx, cy, cz = _lever(X, i, fx, fy, fz)
    _put_rows(F, 0, n, fx, fy, fz, W)
    _put_rows(F, 3, n, nx + cx, ny + cy, nz + cz, W)


@procedure
def all_wrenches_out(X, i, F, start, stop, W):
    """Takes the wrenches in columns from `start` to `stop` of the moving frame of row i to its parent's."""
    n = start
    while n + W <= stop:
        _wrenches_out(X, i, F, n, W)
        n += W
    while n < stop:
        _wrenches_out(X, i, F, n, 1)
        n += 1


@procedure
def _turned(X, i, t, n, W):
    """Rotates W vectors to the parent of row i."""
    x, y, z = _three_rows(t, 0, n, W)
    x, y, z = _rotated(X, i, x, y, z)
    _put_rows(t, 0, n, x, y, z, W)


@procedure
def turn_columns(X, i, t, start, stop, W):
    """Rotates the vectors in columns from `start` to `stop`, (3, columns), to the parent of row i."""
    n = start
    while n + W <= stop:
        _turned(X, i, t, n, W)
        n += W
    while n < stop:
        _turned(X, i, t, n, 1)
        n += 1


@procedure
def dot_rows(S, k, F, n, W):
    """The products of row k of S, six numbers, with W columns of six."""
    x, y, z = _three_rows(F, 0, n, W)
    a, b, c = _three_rows(F, 3, n, W)
    return (x * S[k, 0] + y * S[k, 1] + z * S[k, 2]) + (a * S[k, 3] + b * S[k, 4] + c * S[k, 5])


@procedure
def fill_row(M, k, start, value, W):
    """Sets row k of M from column `start` on."""
    n = start
    while n + W <= M.shape[1]:
        M[k, n : n + W] = broadcast(value, W)
        n += W
    while n < M.shape[1]:
        M[k, n] = value
        n += 1


@procedure
def mirror(M):
    """Copies what is above the diagonal below it, in blocks that caches hold."""
    n = len(M)
    for first in range(0, n, 16):
        for other in range(first, n, 16):
            for j in range(max(other, first + 1), min(other + 16, n)):
                for i in range(first, min(first + 16, j)):
                    M[j, i] = M[i, j]


@procedure
def put_row(A, k, lx, ly, lz, rx, ry, rz):
    """Writes row k."""
    A[k, 0] = lx
    A[k, 1] = ly
    A[k, 2] = lz
    A[k, 3] = rx
    A[k, 4] = ry
    A[k, 5] = rz


@procedure
def put_column(A, k, lx, ly, lz, rx, ry, rz):
    """Writes column k."""
    A[0, k] = lx
    A[1, k] = ly
    A[2, k] = lz
    A[3, k] = rx
    A[4, k] = ry
    A[5, k] = rz
