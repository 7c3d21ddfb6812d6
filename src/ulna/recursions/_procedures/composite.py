"""The mass matrix by the composite-rigid-body algorithm, in loops; see `algorithms/dynamics/crba.py`.

All columns of what a step moves are one range, as joints are depth first: their wrenches go to the parent together, W
at once. Source: Featherstone 2008, table 6.2.
"""

from __future__ import annotations

from typing import NamedTuple

from ulna.compiler.procedures import Array2, f64, procedure
from ulna.recursions._procedures.columns import all_wrenches_out, dot_rows, fill_row, mirror
from ulna.recursions._procedures.declaration import recursion
from ulna.recursions._procedures.placements import Placements, place
from ulna.recursions._procedures.vectors import momentum, rotate


class Composite(NamedTuple):
    """Storage.

    Attributes:
        inertias: Of all bodies from each step outward, as in the table, (rows, 10).
        F: Wrenches that accelerate them along their columns, (6, columns).
        M: The matrix of the tree with every joint free, (columns, columns); of mimic joints only.
    """

    inertias: Array2[f64]
    F: Array2[f64]
    M: Array2[f64]


@procedure
def add_inertia(X, i, B, p):
    """Adds the inertia in row i of B, seen from the parent, to row p."""
    m = B[i, 0]
    hx, hy, hz = rotate(X, i, B[i, 1], B[i, 2], B[i, 3], 1)
    px, py, pz = X[i, 9, 0], X[i, 10, 0], X[i, 11, 0]
    ax, ay, az = rotate(X, i, B[i, 4], B[i, 5], B[i, 6], 1)  # R I, column by column
    bx, by, bz = rotate(X, i, B[i, 5], B[i, 7], B[i, 8], 1)
    cx, cy, cz = rotate(X, i, B[i, 6], B[i, 8], B[i, 9], 1)
    xx, xy, xz = rotate(X, i, ax, bx, cx, 1)  # (R I) R^T, row by row
    _yx, yy, yz = rotate(X, i, ay, by, cy, 1)
    _zx, _zy, zz = rotate(X, i, az, bz, cz, 1)
    gx, gy, gz = hx + 0.5 * m * px, hy + 0.5 * m * py, hz + 0.5 * m * pz
    B[p, 0] += m
    B[p, 1] += hx + m * px
    B[p, 2] += hy + m * py
    B[p, 3] += hz + m * pz
    B[p, 4] += xx + 2.0 * (gy * py + gz * pz)
    B[p, 5] += xy - (gx * py + gy * px)
    B[p, 6] += xz - (gx * pz + gz * px)
    B[p, 7] += yy + 2.0 * (gx * px + gz * pz)
    B[p, 8] += yz - (gy * pz + gz * py)
    B[p, 9] += zz + 2.0 * (gx * px + gy * py)


@procedure
def column_wrenches(tree, work, i):
    """The wrenches of the columns of a step."""
    for k in range(tree.columns[i], tree.columns[i + 1]):
        fx, fy, fz, nx, ny, nz = momentum(
            work.inertias,
            i,
            tree.S[k, 0],
            tree.S[k, 1],
            tree.S[k, 2],
            tree.S[k, 3],
            tree.S[k, 4],
            tree.S[k, 5],
        )
        work.F[0, k] = fx
        work.F[1, k] = fy
        work.F[2, k] = fz
        work.F[3, k] = nx
        work.F[4, k] = ny
        work.F[5, k] = nz


@procedure
def _row(tree, work, M, k, stop, W):
    """Row k of M from its diagonal on; zero from column `stop` on."""
    n = k
    while n + W <= stop:
        M[k, n : n + W] = dot_rows(tree.S, k, work.F, n, W)
        n += W
    while n < stop:
        M[k, n] = dot_rows(tree.S, k, work.F, n, 1)
        n += 1
    fill_row(M, k, stop, 0.0, W)


@procedure
def _upper(tree, places, work, q, M, W):
    """What is on and above the diagonal of the matrix of all columns."""
    place(tree, places, q, 1)
    for i in range(len(tree.parents)):
        for j in range(10):
            work.inertias[i, j] = tree.inertias[i, j]
    for i in range(len(tree.parents) - 1, 0, -1):
        column_wrenches(tree, work, i)
        for k in range(tree.columns[i], tree.columns[i + 1]):
            _row(tree, work, M, k, tree.ends[i], W)
        if tree.parents[i] > 0:
            all_wrenches_out(places.X, i, work.F, tree.columns[i], tree.ends[i], W)
            add_inertia(places.X, i, work.inertias, tree.parents[i])


@procedure
def _by_entries(tree, work, M):
    """Adds the rows and columns of mimic joints to those of their sources."""
    for k in range(len(tree.entries)):
        e = tree.entries[k]
        for n in range(k, len(tree.entries)):
            other = tree.entries[n]
            M[e, other] += work.M[k, n]
            if n != k:
                M[other, e] += work.M[k, n]


@recursion(W=8, places=Placements, work=Composite)
def mass_matrix(tree, places, work, q, M, blocks, W):
    """Mass matrices.

    Args:
        q: Configurations, (blocks, nq, 1) [rad, m].
        M: Matrices that are written, (blocks, nv, nv) [kg, kg m, kg m^2].
    """
    for b in range(blocks):
        if len(work.M) == 0:
            _upper(tree, places, work, q[b], M[b], W)
            mirror(M[b])
        else:
            _upper(tree, places, work, q[b], work.M, W)
            for k in range(len(tree.armature)):
                fill_row(M[b], k, 0, 0.0, W)
            _by_entries(tree, work, M[b])
        for k in range(len(tree.armature)):
            M[b, k, k] += tree.armature[k]
