"""The mass matrix by the composite-rigid-body algorithm, in loops; see `algorithms/dynamics/crba.py`.

All columns of what a step moves are one range, as joints are depth first: their wrenches go inward together, W at
once. Source: Featherstone 2008, table 6.2.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ulna.compiler.procedures import Array2, f64, procedure
from ulna.recursions._procedures.columns import all_wrenches_out, dot_rows, fill_row, mirror, put_row
from ulna.recursions._procedures.declaration import recursion
from ulna.recursions._procedures.placements import Placements, multiply, place
from ulna.recursions._procedures.vectors import momentum, rotate, twist_out


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
def _first_row(tree, last):
    """The first of at most eight rows of which each one is all that the row before carries."""
    first = last
    while (
        first > 1
        and last - first < 7
        and tree.parents[first] == first - 1
        and tree.ends[first - 1] == tree.ends[first]
    ):
        first -= 1
    return first


@procedure
def _block_columns(tree, places, work, Y, S, first, last):
    """Y of the rows of a block in the frame that carries it, and there its columns and their wrenches."""
    for j in range(12):
        Y[0, j, 0] = places.X[first, j, 0]
    for i in range(first + 1, last + 1):
        multiply(Y, i - first - 1, places.X, i, Y, i - first, 1)
    for i in range(last, first - 1, -1):
        column_wrenches(tree, work, i)
        all_wrenches_out(Y, i - first, work.F, tree.columns[i], tree.columns[i + 1], 1)
        for k in range(tree.columns[i], tree.columns[i + 1]):
            lx, ly, lz, rx, ry, rz = twist_out(
                Y,
                i - first,
                tree.S[k, 0],
                tree.S[k, 1],
                tree.S[k, 2],
                tree.S[k, 3],
                tree.S[k, 4],
                tree.S[k, 5],
                1,
            )
            put_row(S, k - tree.columns[first], lx, ly, lz, rx, ry, rz)
        if tree.parents[i] > 0:
            add_inertia(places.X, i, work.inertias, tree.parents[i])


@procedure
def _rows(M, S, F, first, after, stop, W):
    """Rows of M from their diagonals on, of columns whose motions are in S; zero from column `stop` on."""
    for k in range(first, after):
        for n in range(k, after):
            M[k, n] = dot_rows(S, k - first, F, n, 1)
    n = after
    while n + W <= stop:
        for k in range(first, after):
            M[k, n : n + W] = dot_rows(S, k - first, F, n, W)
        n += W
    while n < stop:
        for k in range(first, after):
            M[k, n] = dot_rows(S, k - first, F, n, 1)
        n += 1
    for k in range(first, after):
        fill_row(M, k, stop, 0.0, W)


@procedure
def _upper(tree, places, work, q, M, W):
    """What is on and above the diagonal of the matrix of all columns.

    Wrenches go inward by whole blocks of rows: they are taken to the frame that carries a block once, not row by row.
    """
    place(tree, places, q, 1)
    Y = np.zeros((8, 12, 1), f64)
    S = np.zeros((48, 6), f64)  # a row has six columns at most
    for i in range(len(tree.parents)):
        for j in range(10):
            work.inertias[i, j] = tree.inertias[i, j]
    last = len(tree.parents) - 1
    while last > 0:
        first = _first_row(tree, last)
        begin, after, stop = tree.columns[first], tree.columns[last + 1], tree.ends[first]
        _block_columns(tree, places, work, Y, S, first, last)
        all_wrenches_out(Y, last - first, work.F, after, stop, W)
        _rows(M, S, work.F, begin, after, stop, W)
        last = first - 1


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
