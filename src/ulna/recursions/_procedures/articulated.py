"""Forward dynamics by the articulated-body algorithm, in loops; see `algorithms/dynamics/aba.py`.

| symbol | meaning | shape |
|---|---|---|
| G | articulated inertia: M, H and J by rows, force = M v + H w, moment = H^T v + J w | (rows, 27, W) |
| p | bias force | (rows, 6, W) |
| U, d, u | of a column s of S: U = G s, d = s . U plus armature, u = tau - s . p | |

Columns of one step are eliminated one after the other, so no matrix is inverted: each takes U U^T / d from G, and adds
U u / d to p. Source: Featherstone 2008, table 7.1.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ulna.compiler.procedures import Array2, Array3, broadcast, f64, procedure
from ulna.recursions._procedures.declaration import recursion
from ulna.recursions._procedures.external_forces import subtract_wrenches
from ulna.recursions._procedures.frame_table import Frames
from ulna.recursions._procedures.newton_euler import (
    Motions,
    add_cross_of_twists,
    add_gyroscopic,
    velocity_of,
)
from ulna.recursions._procedures.placements import Placements, place
from ulna.recursions._procedures.vectors import add, add_wrench_out, cross, put, rotate, three, twist_into


class Articulated(NamedTuple):
    """Storage.

    Attributes:
        G: (rows, 27, W).
        U: (columns, 6, W).
        inverses: 1 / d, (columns, W).
        u: (columns, W).
    """

    G: Array3[f64]
    U: Array3[f64]
    inverses: Array2[f64]
    u: Array2[f64]


@procedure
def spread_inertia(inertias, row, G, i, W):
    """The inertia in a row as M, H and J of step i."""
    for j in range(27):
        G[i, j, 0:W] = broadcast(0.0, W)
    m, x, y, z = inertias[row, 0], inertias[row, 1], inertias[row, 2], inertias[row, 3]
    for j in range(3):
        G[i, 4 * j, 0:W] = broadcast(m, W)
    put(G, i, 9, broadcast(0.0, W), broadcast(z, W), broadcast(-y, W), W)
    put(G, i, 12, broadcast(-z, W), broadcast(0.0, W), broadcast(x, W), W)
    put(G, i, 15, broadcast(y, W), broadcast(-x, W), broadcast(0.0, W), W)
    xx, xy, xz = inertias[row, 4], inertias[row, 5], inertias[row, 6]
    yy, yz, zz = inertias[row, 7], inertias[row, 8], inertias[row, 9]
    put(G, i, 18, broadcast(xx, W), broadcast(xy, W), broadcast(xz, W), W)
    put(G, i, 21, broadcast(xy, W), broadcast(yy, W), broadcast(yz, W), W)
    put(G, i, 24, broadcast(xz, W), broadcast(yz, W), broadcast(zz, W), W)


@procedure
def _times(G, i, lx, ly, lz, rx, ry, rz, W):
    """The wrench G (l, r)."""
    return (
        G[i, 0, 0:W] * lx + G[i, 1, 0:W] * ly + G[i, 2, 0:W] * lz
        + (G[i, 9, 0:W] * rx + G[i, 10, 0:W] * ry + G[i, 11, 0:W] * rz),
        G[i, 3, 0:W] * lx + G[i, 4, 0:W] * ly + G[i, 5, 0:W] * lz
        + (G[i, 12, 0:W] * rx + G[i, 13, 0:W] * ry + G[i, 14, 0:W] * rz),
        G[i, 6, 0:W] * lx + G[i, 7, 0:W] * ly + G[i, 8, 0:W] * lz
        + (G[i, 15, 0:W] * rx + G[i, 16, 0:W] * ry + G[i, 17, 0:W] * rz),
        G[i, 9, 0:W] * lx + G[i, 12, 0:W] * ly + G[i, 15, 0:W] * lz
        + (G[i, 18, 0:W] * rx + G[i, 19, 0:W] * ry + G[i, 20, 0:W] * rz),
        G[i, 10, 0:W] * lx + G[i, 13, 0:W] * ly + G[i, 16, 0:W] * lz
        + (G[i, 21, 0:W] * rx + G[i, 22, 0:W] * ry + G[i, 23, 0:W] * rz),
        G[i, 11, 0:W] * lx + G[i, 14, 0:W] * ly + G[i, 17, 0:W] * lz
        + (G[i, 24, 0:W] * rx + G[i, 25, 0:W] * ry + G[i, 26, 0:W] * rz),
    )  # fmt: skip


@procedure
def dot_six(S, k, fx, fy, fz, nx, ny, nz):
    """Row k of S, six numbers, times a wrench."""
    return (fx * S[k, 0] + fy * S[k, 1] + fz * S[k, 2]) + (nx * S[k, 3] + ny * S[k, 4] + nz * S[k, 5])


@procedure
def eliminate_column(S, armature, work, i, k, W):
    """U and 1 / d of column k of a step, in row k of S; takes U U^T / d from G."""
    none = broadcast(0.0, W)
    ux, uy, uz, wx, wy, wz = _times(
        work.G, i, none + S[k, 0], none + S[k, 1], none + S[k, 2],
        none + S[k, 3], none + S[k, 4], none + S[k, 5], W,
    )  # fmt: skip
    put(work.U, k, 0, ux, uy, uz, W)
    put(work.U, k, 3, wx, wy, wz, W)
    d = dot_six(S, k, ux, uy, uz, wx, wy, wz) + armature
    inverse = 1.0 / d
    work.inverses[k, 0:W] = inverse
    for r in range(3):
        linear, angular = work.U[k, r, 0:W] * inverse, work.U[k, 3 + r, 0:W] * inverse
        add(work.G, i, 3 * r, -linear * ux, -linear * uy, -linear * uz, W)
        add(work.G, i, 9 + 3 * r, -linear * wx, -linear * wy, -linear * wz, W)
        add(work.G, i, 18 + 3 * r, -angular * wx, -angular * wy, -angular * wz, W)


@procedure
def _rotated(X, i, G, o, C, c, W):
    """C = R A R^T, where A are nine entries of row i of G from o on; in row 0 of C from c on."""
    for j in range(3):
        x, y, z = rotate(X, i, G[i, o + j, 0:W], G[i, o + 3 + j, 0:W], G[i, o + 6 + j, 0:W], W)
        C[0, c + j, 0:W] = x
        C[0, c + 3 + j, 0:W] = y
        C[0, c + 6 + j, 0:W] = z
    for j in range(3):
        x, y, z = three(C, 0, c + 3 * j, W)
        x, y, z = rotate(X, i, x, y, z, W)
        put(C, 0, c + 3 * j, x, y, z, W)


@procedure
def add_articulated_out(X, i, G, p, C, W):
    """Adds G of a step, seen from its parent, to row p: H' = H - M [t], J' = J + [t] H' + ([t] H)^T for X = (R, t)."""
    _rotated(X, i, G, 0, C, 0, W)
    _rotated(X, i, G, 9, C, 9, W)
    _rotated(X, i, G, 18, C, 18, W)
    tx, ty, tz = three(X, i, 9, W)
    for j in range(3):  # ([t] H)^T: row j is column j of [t] H
        x, y, z = cross(tx, ty, tz, C[0, 9 + j, 0:W], C[0, 12 + j, 0:W], C[0, 15 + j, 0:W])
        add(C, 0, 18 + 3 * j, x, y, z, W)
    for r in range(3):  # rows of M [t] are m x t
        mx, my, mz = three(C, 0, 3 * r, W)
        x, y, z = cross(mx, my, mz, tx, ty, tz)
        add(C, 0, 9 + 3 * r, -x, -y, -z, W)
    for j in range(3):
        x, y, z = cross(tx, ty, tz, C[0, 9 + j, 0:W], C[0, 12 + j, 0:W], C[0, 15 + j, 0:W])
        C[0, 18 + j, 0:W] = C[0, 18 + j, 0:W] + x
        C[0, 21 + j, 0:W] = C[0, 21 + j, 0:W] + y
        C[0, 24 + j, 0:W] = C[0, 24 + j, 0:W] + z
    for j in range(27):
        G[p, j, 0:W] = G[p, j, 0:W] + C[0, j, 0:W]


@procedure
def start_inertias(tree, G, W):
    """G of every step, of its body alone."""
    for i in range(len(tree.parents)):
        spread_inertia(tree.inertias, i, G, i, W)


@procedure
def _outward(tree, places, moves, work, q, v, W):
    """V, A = V x S v, F = V x* I V and G of every body."""
    place(tree, places, q, W)
    start_inertias(tree, work.G, W)
    none = broadcast(0.0, W)
    for i in range(1, len(tree.parents)):
        put(moves.A, i, 0, none, none, none, W)
        put(moves.A, i, 3, none, none, none, W)
        put(moves.F, i, 0, none, none, none, W)
        put(moves.F, i, 3, none, none, none, W)
        sx, sy, sz, wx, wy, wz = velocity_of(tree, places.X, moves.V, v, i, W)
        add_cross_of_twists(moves.V, i, sx, sy, sz, wx, wy, wz, moves.A, W)
        add_gyroscopic(tree, moves.V, moves.F, i, W)


@procedure
def _inward(tree, places, moves, work, tau, C, W):
    """Eliminates the columns of every step, the leaves first."""
    for i in range(len(tree.parents) - 1, 0, -1):
        for k in range(tree.columns[i], tree.columns[i + 1]):
            eliminate_column(tree.S, tree.armature[tree.entries[k]], work, i, k, W)
            fx, fy, fz = three(moves.F, i, 0, W)
            nx, ny, nz = three(moves.F, i, 3, W)
            u = tau[tree.entries[k], 0:W] - dot_six(tree.S, k, fx, fy, fz, nx, ny, nz)
            work.u[k, 0:W] = u
            gain = u * work.inverses[k, 0:W]
            ux, uy, uz = three(work.U, k, 0, W)
            wx, wy, wz = three(work.U, k, 3, W)
            add(moves.F, i, 0, ux * gain, uy * gain, uz * gain, W)
            add(moves.F, i, 3, wx * gain, wy * gain, wz * gain, W)
        if tree.parents[i] > 0:
            lx, ly, lz = three(moves.A, i, 0, W)
            rx, ry, rz = three(moves.A, i, 3, W)
            fx, fy, fz, nx, ny, nz = _times(work.G, i, lx, ly, lz, rx, ry, rz, W)
            add(moves.F, i, 0, fx, fy, fz, W)
            add(moves.F, i, 3, nx, ny, nz, W)
            add_wrench_out(places.X, i, moves.F, tree.parents[i], W)
            add_articulated_out(places.X, i, work.G, tree.parents[i], C, W)


@procedure
def _accelerate(tree, places, moves, work, a, W):
    """The accelerations of the joints, the root first."""
    for j in range(3):
        moves.A[0, j, 0:W] = broadcast(-tree.gravity[j], W)
    for i in range(1, len(tree.parents)):
        lx, ly, lz, rx, ry, rz = twist_into(places.X, i, moves.A, tree.parents[i], W)
        add(moves.A, i, 0, lx, ly, lz, W)
        add(moves.A, i, 3, rx, ry, rz, W)
        for k in range(tree.columns[i + 1] - 1, tree.columns[i] - 1, -1):
            work_done = broadcast(0.0, W)
            for j in range(6):
                work_done += work.U[k, j, 0:W] * moves.A[i, j, 0:W]
            gain = (work.u[k, 0:W] - work_done) * work.inverses[k, 0:W]
            a[tree.entries[k], 0:W] = gain
            for j in range(6):
                moves.A[i, j, 0:W] = moves.A[i, j, 0:W] + gain * tree.S[k, j]


@recursion(W=1, places=Placements, moves=Motions, work=Articulated)
def forward_dynamics(tree, places, moves, work, q, v, tau, a, blocks, W):
    """Joint accelerations, (blocks, nv, W), of torques (blocks, nv, W); see `newton_euler.inverse_dynamics`."""
    C = np.zeros((1, 27, W), f64)
    for b in range(blocks):
        _outward(tree, places, moves, work, q[b], v[b], W)
        _inward(tree, places, moves, work, tau[b], C, W)
        _accelerate(tree, places, moves, work, a[b], W)


@recursion(W=1, places=Placements, moves=Motions, work=Articulated, frames=Frames)
def loaded_forward_dynamics(tree, places, moves, work, frames, q, v, tau, wrenches, a, blocks, W):
    """Joint accelerations under external forces as well; see `newton_euler.loaded_inverse_dynamics`."""
    C = np.zeros((1, 27, W), f64)
    for b in range(blocks):
        _outward(tree, places, moves, work, q[b], v[b], W)
        subtract_wrenches(tree, places, frames, wrenches[b], moves.F, W)
        _inward(tree, places, moves, work, tau[b], C, W)
        _accelerate(tree, places, moves, work, a[b], W)
