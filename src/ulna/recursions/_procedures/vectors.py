"""Vectors and placements in rows of arrays, for numbers (W = 1) or W lanes at once.

A placement is a row of 12: rotation by rows, then translation. A twist or a wrench is a row of 6, linear part first.
Entry j of row i is `A[i, j, 0:W]`.
"""

from __future__ import annotations

from ulna.compiler.procedures import procedure


@procedure
def three(A, i, j, W):
    """Three entries of row i, from entry j on."""
    return A[i, j, 0:W], A[i, j + 1, 0:W], A[i, j + 2, 0:W]


@procedure
def put(A, i, j, x, y, z, W):
    """Writes three entries of row i, from entry j on."""
    A[i, j, 0:W] = x
    A[i, j + 1, 0:W] = y
    A[i, j + 2, 0:W] = z


@procedure
def add(A, i, j, x, y, z, W):
    """Adds to three entries of row i, from entry j on."""
    A[i, j, 0:W] = A[i, j, 0:W] + x
    A[i, j + 1, 0:W] = A[i, j + 1, 0:W] + y
    A[i, j + 2, 0:W] = A[i, j + 2, 0:W] + z


@procedure
def cross(ax, ay, az, bx, by, bz):
    """The vector product."""
    return ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx


@procedure
def rotate(T, i, x, y, z, W):
    """R (x, y, z), R being in row i."""
    return (
        T[i, 0, 0:W] * x + T[i, 1, 0:W] * y + T[i, 2, 0:W] * z,
        T[i, 3, 0:W] * x + T[i, 4, 0:W] * y + T[i, 5, 0:W] * z,
        T[i, 6, 0:W] * x + T[i, 7, 0:W] * y + T[i, 8, 0:W] * z,
    )


@procedure
def rotate_back(T, i, x, y, z, W):
    """R^T (x, y, z), R being in row i."""
    return (
        T[i, 0, 0:W] * x + T[i, 3, 0:W] * y + T[i, 6, 0:W] * z,
        T[i, 1, 0:W] * x + T[i, 4, 0:W] * y + T[i, 7, 0:W] * z,
        T[i, 2, 0:W] * x + T[i, 5, 0:W] * y + T[i, 8, 0:W] * z,
    )


@procedure
def twist_into(X, i, V, p, W):
    """The twist in row p of V, of the parent's frame, in the moving frame of row i: X^-1 acting on it."""
    lx, ly, lz = three(V, p, 0, W)
    rx, ry, rz = three(V, p, 3, W)
    tx, ty, tz = three(X, i, 9, W)
    cx, cy, cz = cross(tx, ty, tz, rx, ry, rz)
    lx, ly, lz = rotate_back(X, i, lx - cx, ly - cy, lz - cz, W)
    rx, ry, rz = rotate_back(X, i, rx, ry, rz, W)
    return lx, ly, lz, rx, ry, rz


@procedure
def twist_out(T, i, lx, ly, lz, rx, ry, rz, W):
    """A twist of the moving frame of row i in the frame that T is written in: T acting on it."""
    lx, ly, lz = rotate(T, i, lx, ly, lz, W)
    rx, ry, rz = rotate(T, i, rx, ry, rz, W)
    tx, ty, tz = three(T, i, 9, W)
    cx, cy, cz = cross(tx, ty, tz, rx, ry, rz)
    return lx + cx, ly + cy, lz + cz, rx, ry, rz


@procedure
def add_wrench_out(X, i, F, p, W):
    """Adds the wrench in row i of F, of the moving frame of row i, seen from its parent, to row p of F."""
    fx, fy, fz = three(F, i, 0, W)
    nx, ny, nz = three(F, i, 3, W)
    fx, fy, fz = rotate(X, i, fx, fy, fz, W)
    nx, ny, nz = rotate(X, i, nx, ny, nz, W)
    tx, ty, tz = three(X, i, 9, W)
    cx, cy, cz = cross(tx, ty, tz, fx, fy, fz)
    add(F, p, 0, fx, fy, fz, W)
    add(F, p, 3, nx + cx, ny + cy, nz + cz, W)


@procedure
def momentum(B, i, lx, ly, lz, rx, ry, rz):
    """The momentum of the inertia in row i of B at a twist, or the force at an acceleration."""
    hx, hy, hz = B[i, 1], B[i, 2], B[i, 3]
    fx = lx * B[i, 0] + (ry * hz - rz * hy)
    fy = ly * B[i, 0] + (rz * hx - rx * hz)
    fz = lz * B[i, 0] + (rx * hy - ry * hx)
    nx = rx * B[i, 4] + ry * B[i, 5] + rz * B[i, 6] + (lz * hy - ly * hz)
    ny = rx * B[i, 5] + ry * B[i, 7] + rz * B[i, 8] + (lx * hz - lz * hx)
    nz = rx * B[i, 6] + ry * B[i, 8] + rz * B[i, 9] + (ly * hx - lx * hy)
    return fx, fy, fz, nx, ny, nz
