"""Derivatives of inverse dynamics, and the Coriolis matrix, in loops; see `algorithms/derivatives/inverse_dynamics.py`.

| symbol | meaning | shape |
|---|---|---|
| h, D | momentum, and rate of the second moment, of all bodies from a step outward: xx, xy, xz, yy, yz, zz | (6), (6) |
| psi, chi, phi | motion that a column s causes outward; V x s in phi for the Coriolis matrix | (columns, 6) |
| r, y, z | forces by a, by v and by q of a column, in the frame that the recursion has come to | (6, columns) |
| t | the moment B^T s of a column, half of it for the Coriolis matrix | (3, columns) |

All columns of what a step moves are one range, as joints are depth first: they go to the parent together, W at once.
All velocities and accelerations are those relative to the world. Source: Carpentier & Mansard 2018; Singh, Russell &
Wensing 2022; Echeandia & Wensing 2021 for the Coriolis matrix.
"""

from __future__ import annotations

from typing import NamedTuple

from ulna.compiler.procedures import Array2, Array3, f64, procedure
from ulna.recursions._procedures.columns import (
    all_wrenches_out,
    dot_rows,
    fill_row,
    mirror,
    put_column,
    put_row,
    turn_columns,
)
from ulna.recursions._procedures.composite import add_inertia
from ulna.recursions._procedures.declaration import recursion
from ulna.recursions._procedures.external_forces import subtract_wrenches
from ulna.recursions._procedures.frame_table import Frames
from ulna.recursions._procedures.moving_bodies import (
    add_rate_to_parent,
    coriolis,
    coriolis_transposed,
    cross_of_twists,
    rate_of_body,
)
from ulna.recursions._procedures.newton_euler import (
    Motions,
    acceleration_of,
    add_cross_of_twists,
    body_force,
    velocity_of,
)
from ulna.recursions._procedures.placements import Placements, place
from ulna.recursions._procedures.vectors import add_wrench_out, cross, momentum, put, three, twist_into


class DerivativeWorkspace(NamedTuple):
    """Arrays that the recursion writes; see the module for the symbols.

    Rows 0 and 1 of `line` hold entries that belong below the diagonal, (2, columns).
    """

    inertias: Array2[f64]
    h: Array3[f64]
    D: Array3[f64]
    psi: Array2[f64]
    chi: Array2[f64]
    phi: Array2[f64]
    r: Array2[f64]
    y: Array2[f64]
    z: Array2[f64]
    t: Array2[f64]
    line: Array2[f64]


@procedure
def states_of_bodies(tree, places, moves, work, q, v, a, HAS_A):
    """Velocities, accelerations and forces of the bodies; their inertias, momenta and rates."""
    place(tree, places, q, 1)
    for i in range(len(tree.parents)):
        for j in range(10):
            work.inertias[i, j] = tree.inertias[i, j]
    for k in range(3):
        moves.A[0, k, 0] = -tree.gravity[k]
    for i in range(1, len(tree.parents)):
        sx, sy, sz, wx, wy, wz = velocity_of(tree, places.X, moves.V, v, i, 1)
        if HAS_A:
            acceleration_of(tree, places.X, moves.A, a, i, True, 1)
            add_cross_of_twists(moves.V, i, sx, sy, sz, wx, wy, wz, moves.A, 1)
            body_force(tree, moves, i, True, 1)
        lx, ly, lz = three(moves.V, i, 0, 1)
        rx, ry, rz = three(moves.V, i, 3, 1)
        fx, fy, fz, nx, ny, nz = momentum(tree.inertias, i, lx, ly, lz, rx, ry, rz)
        put(work.h, i, 0, fx, fy, fz, 1)
        put(work.h, i, 3, nx, ny, nz, 1)
        rate_of_body(tree.inertias, moves.V, work.D, i)


@procedure
def column_derivatives(tree, X, moves, work, i, k, HAS_A):
    """Writes psi, chi and phi of column k of step i."""
    sx, sy, sz, wx, wy, wz = (
        tree.S[k, 0], tree.S[k, 1], tree.S[k, 2], tree.S[k, 3], tree.S[k, 4], tree.S[k, 5],
    )  # fmt: skip
    lx, ly, lz = three(moves.V, i, 0, 1)
    rx, ry, rz = three(moves.V, i, 3, 1)
    ax, ay, az, bx, by, bz = cross_of_twists(lx, ly, lz, rx, ry, rz, sx, sy, sz, wx, wy, wz)
    if HAS_A:
        ux, uy, uz, ox, oy, oz = twist_into(X, i, moves.V, tree.parents[i], 1)
        px, py, pz, ex, ey, ez = cross_of_twists(ux, uy, uz, ox, oy, oz, sx, sy, sz, wx, wy, wz)
        put_row(work.psi, k, px, py, pz, ex, ey, ez)
        put_row(work.phi, k, ax + px, ay + py, az + pz, bx + ex, by + ey, bz + ez)
        cx, cy, cz, dx, dy, dz = twist_into(X, i, moves.A, tree.parents[i], 1)
        cx, cy, cz, dx, dy, dz = cross_of_twists(cx, cy, cz, dx, dy, dz, sx, sy, sz, wx, wy, wz)
        px, py, pz, ex, ey, ez = cross_of_twists(ux, uy, uz, ox, oy, oz, px, py, pz, ex, ey, ez)
        put_row(work.chi, k, cx + px, cy + py, cz + pz, dx + ex, dy + ey, dz + ez)
    else:
        put_row(work.phi, k, ax, ay, az, bx, by, bz)


@procedure
def write_force_column(tree, work, A, motion, B, i, k, scale, HAS_B):
    """Writes column k of the forces A: I motion, and `scale` times B of what row k of B holds."""
    fx, fy, fz, nx, ny, nz = momentum(
        work.inertias, i, motion[k, 0], motion[k, 1], motion[k, 2], motion[k, 3], motion[k, 4], motion[k, 5]
    )
    if HAS_B:
        gx, gy, gz, mx, my, mz = coriolis(work.h, work.D, i, B[k, 3], B[k, 4], B[k, 5])
        fx, fy, fz = fx + scale * gx, fy + scale * gy, fz + scale * gz
        nx, ny, nz = nx + scale * mx, ny + scale * my, nz + scale * mz
    put_column(A, k, fx, fy, fz, nx, ny, nz)


@procedure
def _write_moment(tree, work, i, k, scale):
    """Writes t of column k."""
    tx, ty, tz = coriolis_transposed(
        work.h, work.D, i, tree.S[k, 0], tree.S[k, 1], tree.S[k, 2], tree.S[k, 3], tree.S[k, 4], tree.S[k, 5]
    )
    work.t[0, k] = scale * tx
    work.t[1, k] = scale * ty
    work.t[2, k] = scale * tz


@procedure
def add_motion_cross_force(tree, F, A, i, k):
    """Adds s x* F to column k of A, of the bodies from step i outward."""
    fx, fy, fz = three(F, i, 0, 1)
    nx, ny, nz = three(F, i, 3, 1)
    ax, ay, az = cross(tree.S[k, 3], tree.S[k, 4], tree.S[k, 5], fx, fy, fz)
    bx, by, bz = cross(tree.S[k, 3], tree.S[k, 4], tree.S[k, 5], nx, ny, nz)
    cx, cy, cz = cross(tree.S[k, 0], tree.S[k, 1], tree.S[k, 2], fx, fy, fz)
    A[0, k] += ax
    A[1, k] += ay
    A[2, k] += az
    A[3, k] += bx + cx
    A[4, k] += by + cy
    A[5, k] += bz + cz


@procedure
def _write_upper_row(S, k, F, M, start, stop, W):
    """M[k, n] = row k of S times column n of F, for all columns n."""
    n = start
    while n + W <= stop:
        M[k, n : n + W] = dot_rows(S, k, F, n, W)
        n += W
    while n < stop:
        M[k, n] = dot_rows(S, k, F, n, 1)
        n += 1


@procedure
def _write_lower_column(A, B, c, work, row, M, start, stop, W):
    """M[n, c] = A_c . r_n + (angular part of B_c) . t_n, for all columns n."""
    n = start
    while n + W <= stop:
        turned = work.t[0, n : n + W] * B[c, 3] + work.t[1, n : n + W] * B[c, 4]
        turned = turned + work.t[2, n : n + W] * B[c, 5]
        work.line[row, n : n + W] = dot_rows(A, c, work.r, n, W) + turned
        n += W
    while n < stop:
        rest = work.t[0, n] * B[c, 3] + work.t[1, n] * B[c, 4] + work.t[2, n] * B[c, 5]
        work.line[row, n] = dot_rows(A, c, work.r, n, 1) + rest
        n += 1
    for n in range(start, stop):
        M[n, c] = work.line[row, n]


@procedure
def add_bodies_to_parent(tree, X, moves, work, i, HAS_A):
    """Adds inertia, momentum, rate and force of what a step moves to those of its parent."""
    parent = tree.parents[i]
    add_inertia(X, i, work.inertias, parent)
    add_rate_to_parent(X, i, work.D, work.h, parent)
    add_wrench_out(X, i, work.h, parent, 1)
    if HAS_A:
        add_wrench_out(X, i, moves.F, parent, 1)


@procedure
def _add_to_parent(tree, X, moves, work, i, HAS_A, W):
    """Takes all of a step to its parent: the columns of what it moves, inertia, momentum, rate, force."""
    start, stop = tree.columns[i], tree.ends[i]
    all_wrenches_out(X, i, work.r, start, stop, W)
    all_wrenches_out(X, i, work.y, start, stop, W)
    turn_columns(X, i, work.t, start, stop, W)
    if HAS_A:
        all_wrenches_out(X, i, work.z, start, stop, W)
    add_bodies_to_parent(tree, X, moves, work, i, HAS_A)


@procedure
def _derivatives(tree, places, moves, work, by_q, by_v, M, W):
    """The three matrices of one sample, of its states; entries of M below the diagonal are not written."""
    for k in range(len(tree.armature)):
        fill_row(by_q, k, 0, 0.0, W)
        fill_row(by_v, k, 0, 0.0, W)
        fill_row(M, k, 0, 0.0, W)
    for i in range(len(tree.parents) - 1, 0, -1):
        first, after, stop = tree.columns[i], tree.columns[i + 1], tree.ends[i]
        for k in range(first, after):
            column_derivatives(tree, places.X, moves, work, i, k, True)
            write_force_column(tree, work, work.r, tree.S, tree.S, i, k, 0.0, False)
            write_force_column(tree, work, work.y, work.phi, tree.S, i, k, 1.0, True)
            write_force_column(tree, work, work.z, work.chi, work.psi, i, k, 1.0, True)
            _write_moment(tree, work, i, k, 1.0)
        for k in range(first, after):
            _write_upper_row(tree.S, k, work.r, M, k, stop, W)
            _write_upper_row(tree.S, k, work.y, by_v, first, stop, W)
            _write_upper_row(tree.S, k, work.z, by_q, first, stop, W)
            _write_lower_column(work.phi, tree.S, k, work, 0, by_v, after, stop, W)
            _write_lower_column(work.chi, work.psi, k, work, 1, by_q, after, stop, W)
        for k in range(first, after):
            add_motion_cross_force(tree, moves.F, work.z, i, k)
        if tree.parents[i] > 0:
            _add_to_parent(tree, places.X, moves, work, i, True, W)
    mirror(M)
    for k in range(len(tree.armature)):
        M[k, k] += tree.armature[k]


@procedure
def _coriolis(tree, places, moves, work, q, v, C, W):
    """The Coriolis matrix of one sample."""
    states_of_bodies(tree, places, moves, work, q, v, v, False)
    for i in range(len(tree.parents) - 1, 0, -1):
        first, after, stop = tree.columns[i], tree.columns[i + 1], tree.ends[i]
        for k in range(first, after):
            column_derivatives(tree, places.X, moves, work, i, k, False)
            write_force_column(tree, work, work.r, tree.S, tree.S, i, k, 0.0, False)
            write_force_column(tree, work, work.y, work.phi, tree.S, i, k, 0.5, True)
            _write_moment(tree, work, i, k, 0.5)
        for k in range(first, after):
            _write_upper_row(tree.S, k, work.y, C, first, stop, W)
            _write_lower_column(work.phi, tree.S, k, work, 0, C, after, stop, W)
        if tree.parents[i] > 0:
            _add_to_parent(tree, places.X, moves, work, i, False, W)


@recursion(W=8, places=Placements, moves=Motions, work=DerivativeWorkspace)
def inverse_dynamics_derivatives(tree, places, moves, work, q, v, a, by_q, by_v, by_a, blocks, W):
    """Derivatives of the torques of inverse dynamics; no joint mimics another.

    Args:
        q: Configurations, (blocks, nq, 1) [rad, m].
        v: Velocities, (blocks, nv, 1) [rad/s, m/s].
        a: Accelerations, (blocks, nv, 1) [rad/s^2, m/s^2].
        by_q: Matrices that are written, (blocks, nv, nv).
        by_v: Likewise.
        by_a: Likewise; the mass matrices.
    """
    for b in range(blocks):
        states_of_bodies(tree, places, moves, work, q[b], v[b], a[b], True)
        _derivatives(tree, places, moves, work, by_q[b], by_v[b], by_a[b], W)


@recursion(W=8, places=Placements, moves=Motions, work=DerivativeWorkspace, frames=Frames)
def loaded_inverse_dynamics_derivatives(
    tree, places, moves, work, frames, q, v, a, wrenches, by_q, by_v, by_a, blocks, W
):
    """The same with external forces, in axes of frames, (blocks, 6 k, 1); see `inverse_dynamics_derivatives`."""
    for b in range(blocks):
        states_of_bodies(tree, places, moves, work, q[b], v[b], a[b], True)
        subtract_wrenches(tree, places, frames, wrenches[b], moves.F, 1)
        _derivatives(tree, places, moves, work, by_q[b], by_v[b], by_a[b], W)


@recursion(W=8, places=Placements, moves=Motions, work=DerivativeWorkspace)
def coriolis_matrix(tree, places, moves, work, q, v, C, blocks, W):
    """Coriolis matrices of the Christoffel symbols, (blocks, nv, nv); see `inverse_dynamics_derivatives`."""
    for b in range(blocks):
        for k in range(len(tree.armature)):
            fill_row(C[b], k, 0, 0.0, W)
        _coriolis(tree, places, moves, work, q[b], v[b], C[b], W)
