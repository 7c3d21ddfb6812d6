"""Momentum of bodies and the rate of their second moment, in loops; see `Subtree` in `algorithms/derivatives`.

Row i of D holds a symmetric matrix as xx, xy, xz, yy, yz, zz. Source: Echeandia & Wensing 2021.
"""

from __future__ import annotations

from ulna.compiler.procedures import procedure
from ulna.recursions._procedures.vectors import cross, rotate, three


@procedure
def cross_of_twists(lx, ly, lz, rx, ry, rz, sx, sy, sz, wx, wy, wz):
    """The vector product of two twists."""
    ax, ay, az = cross(rx, ry, rz, sx, sy, sz)
    bx, by, bz = cross(lx, ly, lz, wx, wy, wz)
    cx, cy, cz = cross(rx, ry, rz, wx, wy, wz)
    return ax + bx, ay + by, az + bz, cx, cy, cz


@procedure
def _add_steiner(D, i, ax, ay, az, bx, by, bz):
    """Adds 2 (a.b) 1 - a b^T - b a^T to row i of D."""
    D[i, 0, 0] += 2.0 * (ay * by + az * bz)
    D[i, 1, 0] -= ax * by + ay * bx
    D[i, 2, 0] -= ax * bz + az * bx
    D[i, 3, 0] += 2.0 * (ax * bx + az * bz)
    D[i, 4, 0] -= ay * bz + az * by
    D[i, 5, 0] += 2.0 * (ax * bx + ay * by)


@procedure
def rate_of_body(B, V, D, i):
    """Writes D of the body with the inertia in row i of B and the twist in row i of V."""
    x, y, z = three(V, i, 3, 1)
    xx = 2.0 * (B[i, 6] * y - B[i, 5] * z)
    yy = 2.0 * (B[i, 5] * z - B[i, 8] * x)
    D[i, 0, 0] = xx
    D[i, 1, 0] = z * (B[i, 4] - B[i, 7]) + y * B[i, 8] - x * B[i, 6]
    D[i, 2, 0] = y * (B[i, 9] - B[i, 4]) + x * B[i, 5] - z * B[i, 8]
    D[i, 3, 0] = yy
    D[i, 4, 0] = x * (B[i, 7] - B[i, 9]) + z * B[i, 6] - y * B[i, 5]
    D[i, 5, 0] = -(xx + yy)
    lx, ly, lz = three(V, i, 0, 1)
    _add_steiner(D, i, B[i, 1], B[i, 2], B[i, 3], lx, ly, lz)


@procedure
def add_rate_to_parent(X, i, D, h, p):
    """Adds D of row i, with the momentum in row i of h, seen from the parent, to row p."""
    ax, ay, az = rotate(X, i, D[i, 0, 0], D[i, 1, 0], D[i, 2, 0], 1)  # R D, column by column
    bx, by, bz = rotate(X, i, D[i, 1, 0], D[i, 3, 0], D[i, 4, 0], 1)
    cx, cy, cz = rotate(X, i, D[i, 2, 0], D[i, 4, 0], D[i, 5, 0], 1)
    xx, xy, xz = rotate(X, i, ax, bx, cx, 1)  # (R D) R^T, row by row
    _yx, yy, yz = rotate(X, i, ay, by, cy, 1)
    _zx, _zy, zz = rotate(X, i, az, bz, cz, 1)
    D[p, 0, 0] += xx
    D[p, 1, 0] += xy
    D[p, 2, 0] += xz
    D[p, 3, 0] += yy
    D[p, 4, 0] += yz
    D[p, 5, 0] += zz
    lx, ly, lz = three(h, i, 0, 1)
    lx, ly, lz = rotate(X, i, lx, ly, lz, 1)
    px, py, pz = three(X, i, 9, 1)
    _add_steiner(D, p, px, py, pz, lx, ly, lz)


@procedure
def _times(D, i, x, y, z):
    """The matrix in row i of D times a vector."""
    return (
        D[i, 0, 0] * x + D[i, 1, 0] * y + D[i, 2, 0] * z,
        D[i, 1, 0] * x + D[i, 3, 0] * y + D[i, 4, 0] * z,
        D[i, 2, 0] * x + D[i, 4, 0] * y + D[i, 5, 0] * z,
    )


@procedure
def coriolis(h, D, i, wx, wy, wz):
    """B s for a column with the angular part w."""
    px, py, pz = three(h, i, 0, 1)
    nx, ny, nz = three(h, i, 3, 1)
    fx, fy, fz = cross(wx, wy, wz, px, py, pz)
    mx, my, mz = cross(wx, wy, wz, nx, ny, nz)
    dx, dy, dz = _times(D, i, wx, wy, wz)
    return 2.0 * fx, 2.0 * fy, 2.0 * fz, dx + mx, dy + my, dz + mz


@procedure
def coriolis_transposed(h, D, i, lx, ly, lz, wx, wy, wz):
    """B^T s, a pure moment."""
    px, py, pz = three(h, i, 0, 1)
    nx, ny, nz = three(h, i, 3, 1)
    ax, ay, az = cross(px, py, pz, lx, ly, lz)
    mx, my, mz = cross(nx, ny, nz, wx, wy, wz)
    dx, dy, dz = _times(D, i, wx, wy, wz)
    return 2.0 * ax + dx + mx, 2.0 * ay + dy + my, 2.0 * az + dz + mz
