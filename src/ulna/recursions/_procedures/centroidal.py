"""Matrices of the centre of mass and the momentum, in loops; see `algorithms/dynamics/centroidal.py`.

The composite inertia of what a step moves times a column of it is that column's momentum, which is rotated into the
world and taken about the centre of mass. Source: Orin, Goswami & Lee 2013.
"""

from __future__ import annotations

from typing import NamedTuple

from ulna.compiler.procedures import Array1, Array2, f64, procedure
from ulna.recursions._procedures.composite import add_inertia, column_wrenches
from ulna.recursions._procedures.declaration import recursion
from ulna.recursions._procedures.placements import Placements, place_in_world
from ulna.recursions._procedures.vectors import cross, rotate


class Columns(NamedTuple):
    """Storage for what each column of the tree causes.

    Attributes:
        inertias: Of all bodies from each step outward, as in the table, (rows, 10).
        F: Wrenches that accelerate them along their columns, (6, columns).
        mass: The mass of all bodies, (1,) [kg].
    """

    inertias: Array2[f64]
    F: Array2[f64]
    mass: Array1[f64]


@procedure
def _composites(tree, places, work, q):
    """The inertia of all bodies from each step outward; that of all of them, in the world, in row 0."""
    place_in_world(tree, places, q, 1)
    for i in range(len(tree.parents)):
        for j in range(10):
            work.inertias[i, j] = tree.inertias[i, j]
    for i in range(len(tree.parents) - 1, 0, -1):
        column_wrenches(tree, work, i)
        add_inertia(places.X, i, work.inertias, tree.parents[i])


@procedure
def _momentum_columns(tree, T, work, out):
    """Adds the columns of the momentum about the centre of mass, or of its first rows only."""
    mass = work.mass[0]
    gx, gy, gz = work.inertias[0, 1] / mass, work.inertias[0, 2] / mass, work.inertias[0, 3] / mass
    for i in range(1, len(tree.parents)):
        px, py, pz = T[i, 9, 0] - gx, T[i, 10, 0] - gy, T[i, 11, 0] - gz
        for k in range(tree.columns[i], tree.columns[i + 1]):
            e = tree.entries[k]
            fx, fy, fz = rotate(T, i, work.F[0, k], work.F[1, k], work.F[2, k], 1)
            out[0, e] += fx
            out[1, e] += fy
            out[2, e] += fz
            if len(out) == 6:
                nx, ny, nz = rotate(T, i, work.F[3, k], work.F[4, k], work.F[5, k], 1)
                cx, cy, cz = cross(px, py, pz, fx, fy, fz)
                out[3, e] += nx + cx
                out[4, e] += ny + cy
                out[5, e] += nz + cz


@procedure
def _clear(M):
    for r in range(len(M)):
        for c in range(M.shape[1]):
            M[r, c] = 0.0


@recursion(W=8, places=Placements, work=Columns)
def centroidal_matrix(tree, places, work, q, out, blocks, W):
    """Matrices from v to the momentum about the centre of mass, (blocks, 6, nv).

    Args:
        places: Storage for one sample, with the world's frames.
        q: Configurations, (blocks, nq, 1) [rad, m].
        out: Matrices that are written.
    """
    for b in range(blocks):
        _composites(tree, places, work, q[b])
        _clear(out[b])
        _momentum_columns(tree, places.T, work, out[b])


@recursion(W=8, places=Placements, work=Columns)
def center_of_mass_jacobian(tree, places, work, q, out, blocks, W):
    """Jacobians of the centre of mass, (blocks, 3, nv); see `centroidal_matrix`."""
    for b in range(blocks):
        _composites(tree, places, work, q[b])
        _clear(out[b])
        _momentum_columns(tree, places.T, work, out[b])
        for r in range(3):
            for c in range(out.shape[2]):
                out[b, r, c] /= work.mass[0]


@recursion(W=8, places=Placements, work=Columns)
def centroidal_inertia(tree, places, work, q, out, blocks, W):
    """Inertias about the centre of mass, all joints held, (blocks, 3, 3) [kg m^2]; see `centroidal_matrix`."""
    for b in range(blocks):
        _composites(tree, places, work, q[b])
        x, y, z = work.inertias[0, 1], work.inertias[0, 2], work.inertias[0, 3]
        mass = work.mass[0]
        out[b, 0, 0] = work.inertias[0, 4] - (y * y + z * z) / mass
        out[b, 0, 1] = work.inertias[0, 5] + x * y / mass
        out[b, 0, 2] = work.inertias[0, 6] + x * z / mass
        out[b, 1, 1] = work.inertias[0, 7] - (x * x + z * z) / mass
        out[b, 1, 2] = work.inertias[0, 8] + y * z / mass
        out[b, 2, 2] = work.inertias[0, 9] - (x * x + y * y) / mass
        out[b, 1, 0] = out[b, 0, 1]
        out[b, 2, 0] = out[b, 0, 2]
        out[b, 2, 1] = out[b, 1, 2]
