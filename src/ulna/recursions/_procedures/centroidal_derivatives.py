"""Derivatives of the centroidal momentum, in loops; see `algorithms/derivatives/centroidal.py`.

| symbol | meaning | shape |
|---|---|---|
| r, y, z, d | columns of dF/da, dF/dv, dF/dq, dh/dq: in moving frames, then about the world's origin | (6, columns) |

Source: Orin, Goswami & Lee 2013; Carpentier & Mansard 2018. All observers rest in the world.
"""

from __future__ import annotations

from ulna.compiler.procedures import Array1, Array2, f64, procedure
from ulna.recursions._procedures.columns import all_wrenches_out, fill_row
from ulna.recursions._procedures.declaration import recursion
from ulna.recursions._procedures.derivatives import (
    DerivativeWorkspace,
    add_bodies_to_parent,
    add_motion_cross_force,
    column_derivatives,
    states_of_bodies,
    write_force_column,
)
from ulna.recursions._procedures.newton_euler import Motions
from ulna.recursions._procedures.placements import Placements, chain_placements
from ulna.recursions._procedures.vectors import cross


@procedure
def _columns_in_world(tree, places, moves, work, d, W):
    """Writes r, y, z and d about the world's origin; row 0 of storage then has the sums over the robot."""
    for i in range(len(tree.parents) - 1, 0, -1):
        first, after = tree.columns[i], tree.columns[i + 1]
        for k in range(first, after):
            column_derivatives(tree, places.X, moves, work, i, k, True)
            write_force_column(tree, work, work.r, tree.S, tree.S, i, k, 0.0, False)
            write_force_column(tree, work, work.y, work.phi, tree.S, i, k, 1.0, True)
            write_force_column(tree, work, work.z, work.chi, work.psi, i, k, 1.0, True)
            write_force_column(tree, work, d, work.psi, work.psi, i, k, 0.0, False)
            add_motion_cross_force(tree, moves.F, work.z, i, k)
            add_motion_cross_force(tree, work.h, d, i, k)
        all_wrenches_out(places.T, i, work.r, first, after, W)
        all_wrenches_out(places.T, i, work.y, first, after, W)
        all_wrenches_out(places.T, i, work.z, first, after, W)
        all_wrenches_out(places.T, i, d, first, after, W)
        add_bodies_to_parent(tree, places.X, moves, work, i, True)


@procedure
def _start(tree, moves, work):
    """Takes the world's own part off the sums that row 0 will have."""
    for j in range(6):
        moves.F[0, j, 0] = 0.0
        work.h[0, j, 0] = 0.0
        work.D[0, j, 0] = 0.0
    for j in range(10):
        work.inertias[0, j] = 0.0


@procedure
def _about_centre(tree, A, total, r, work, mass, out, WITH_TOTAL):
    """Adds columns of A, taken about the moving centre of mass, to the entries that they belong to."""
    x, y, z = work.inertias[0, 1] / mass, work.inertias[0, 2] / mass, work.inertias[0, 3] / mass
    for k in range(len(tree.entries)):
        e = tree.entries[k]
        cx, cy, cz = cross(x, y, z, A[0, k], A[1, k], A[2, k])
        nx, ny, nz = A[3, k] - cx, A[4, k] - cy, A[5, k] - cz
        if WITH_TOTAL:
            fx, fy, fz = total[0, 0, 0] / mass, total[0, 1, 0] / mass, total[0, 2, 0] / mass
            cx, cy, cz = cross(r[0, k], r[1, k], r[2, k], fx, fy, fz)
            nx, ny, nz = nx - cx, ny - cy, nz - cz
        out[0, e] += A[0, k]
        out[1, e] += A[1, k]
        out[2, e] += A[2, k]
        out[3, e] += nx
        out[4, e] += ny
        out[5, e] += nz


@recursion(W=8, places=Placements, moves=Motions, work=DerivativeWorkspace, d=Array2[f64], mass=Array1[f64])
def centroidal_derivatives(
    tree, places, moves, work, d, mass, q, v, a, dh_dq, dF_dq, dF_dv, dF_da, blocks, W
):
    """The derivatives of the momentum about the centre of mass, and of its rate.

    Args:
        tree: The table, without gravity.
        places: Storage for one sample, with the world's frames.
        d: Storage, (6, columns).
        mass: That of all that moves, (1,) [kg].
        q: Configurations, (blocks, nq, 1) [rad, m].
        v: Velocities, (blocks, nv, 1) [rad/s, m/s].
        a: Accelerations, (blocks, nv, 1) [rad/s^2, m/s^2].
        dh_dq: Matrices that are written, (blocks, 6, nv).
        dF_dq: Likewise.
        dF_dv: Likewise.
        dF_da: Likewise.
    """
    for b in range(blocks):
        states_of_bodies(tree, places, moves, work, q[b], v[b], a[b], True)
        chain_placements(tree, places, 1)
        _start(tree, moves, work)
        _columns_in_world(tree, places, moves, work, d, W)
        for r in range(6):
            fill_row(dh_dq[b], r, 0, 0.0, W)
            fill_row(dF_dq[b], r, 0, 0.0, W)
            fill_row(dF_dv[b], r, 0, 0.0, W)
            fill_row(dF_da[b], r, 0, 0.0, W)
        _about_centre(tree, d, work.h, work.r, work, mass[0], dh_dq[b], True)
        _about_centre(tree, work.z, moves.F, work.r, work, mass[0], dF_dq[b], True)
        _about_centre(tree, work.y, work.h, work.r, work, mass[0], dF_dv[b], False)
        _about_centre(tree, work.r, work.h, work.r, work, mass[0], dF_da[b], False)
