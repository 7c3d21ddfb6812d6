"""The inverse of the mass matrix, in loops: the articulated-body algorithm for unit torques, W of them at once.

| symbol | meaning | shape |
|---|---|---|
| T | pose of a step in the frame of its root, in which all below is written | (rows, 12, 1) |
| s, G, U, d | as in articulated.py, in that frame | |
| F | bias force of the present step for each unit torque | (6, width) |
| A | acceleration of a step for each unit torque, in one of a few slots | (slots, 6, width) |
| M | what is on and above the diagonal of the inverse; other entries are of no use | (columns, width) |

Row k of M holds u / d of column k first, inward, then the accelerations, outward. Seen from one frame, forces and
accelerations do not change from body to body. Rows begin at multiples of W, with some columns before the diagonal,
whose forces are zero until their own turn. A step takes the slot of its parent if it is the last one there. Source:
Carpentier 2018, Analytical inverse of the joint space inertia matrix.
"""

from __future__ import annotations

from typing import NamedTuple

from ulna.compiler.procedures import Array1, Array2, Array3, broadcast, f64, procedure
from ulna.recursions._procedures.articulated import Articulated, eliminate_column, spread_inertia
from ulna.recursions._procedures.columns import dot_rows, fill_row, mirror, put_row
from ulna.recursions._procedures.composite import add_inertia
from ulna.recursions._procedures.declaration import recursion
from ulna.recursions._procedures.placements import Placements, multiply, place
from ulna.recursions._procedures.vectors import cross, rotate
from ulna.recursions.tree_table import INT


class Units(NamedTuple):
    """Storage: F, A, M and the columns s, see the module; slots are those of steps, (rows,).

    Attributes:
        F: (6, width), width being the columns rounded up to lanes.
        A: (slots, 6, width).
        slots: (rows,).
        M: (columns, width).
        S: (columns, 6).
        inertias: As in the table, and one more row, (rows + 1, 10).
    """

    F: Array2[f64]
    A: Array3[f64]
    slots: Array1[INT]
    M: Array2[f64]
    S: Array2[f64]
    inertias: Array2[f64]


@procedure
def _in_one_frame(tree, places, work, units, q):
    """T, s and G of every body alone."""
    place(tree, places, q, 1)
    last = len(tree.parents)
    for i in range(1, last):
        if tree.parents[i] > 0:
            multiply(places.T, tree.parents[i], places.X, i, places.T, i, 1)
        else:
            for j in range(12):
                places.T[i, j, 0] = places.T[0, j, 0]
        for k in range(tree.columns[i], tree.columns[i + 1]):
            lx, ly, lz = rotate(places.T, i, tree.S[k, 0], tree.S[k, 1], tree.S[k, 2], 1)
            wx, wy, wz = rotate(places.T, i, tree.S[k, 3], tree.S[k, 4], tree.S[k, 5], 1)
            cx, cy, cz = cross(places.T[i, 9, 0], places.T[i, 10, 0], places.T[i, 11, 0], wx, wy, wz)
            put_row(units.S, k, lx + cx, ly + cy, lz + cz, wx, wy, wz)
        for j in range(10):
            units.inertias[i, j] = tree.inertias[i, j]
            units.inertias[last, j] = 0.0
        add_inertia(places.T, i, units.inertias, last)
        spread_inertia(units.inertias, last, work.G, i, 1)


@procedure
def _force_of(work, F, k, M, n, W):
    """Adds U_k M[k, n : n + W] to W bias forces."""
    gain = M[k, n : n + W]
    for j in range(6):
        F[j, n : n + W] = F[j, n : n + W] + gain * work.U[k, j, 0]


@procedure
def _unit_row(tree, work, units, k, stop, W):
    """u / d of column k for the unit torques up to column `stop`, and what it adds to F."""
    inverse, first = work.inverses[k, 0], k // W * W
    whole = stop // W * W
    if stop == len(units.M):
        whole = units.M.shape[1]
    for n in range(first, whole, W):
        units.M[k, n : n + W] = -inverse * dot_rows(units.S, k, units.F, n, W)
    for n in range(max(whole, k), stop):
        units.M[k, n] = -inverse * dot_rows(units.S, k, units.F, n, 1)
    units.M[k, k] += inverse
    if whole < units.M.shape[1]:
        fill_row(units.M, k, stop, 0.0, W)
    for n in range(first, whole, W):
        _force_of(work, units.F, k, units.M, n, W)
    for n in range(max(whole, k), stop):
        _force_of(work, units.F, k, units.M, n, 1)


@procedure
def _inward(tree, work, units, W):
    """Eliminates the columns of every step, the leaves first; the last column of a step first."""
    for j in range(6):
        fill_row(units.F, j, 0, 0.0, W)
    for i in range(len(tree.parents) - 1, 0, -1):
        for k in range(tree.columns[i + 1] - 1, tree.columns[i] - 1, -1):
            eliminate_column(units.S, tree.armature[tree.entries[k]], work, i, k, 1)
            _unit_row(tree, work, units, k, tree.ends[i], W)
        p = tree.parents[i]
        if p > 0:
            for j in range(27):
                work.G[p, j, 0] += work.G[i, j, 0]


@procedure
def _accelerations(tree, work, units, i, n, W):
    """W accelerations of a step, and its rows of M."""
    slot, p = units.slots[i], tree.parents[i]
    before = units.slots[p]
    x, y, z = units.A[before, 0, n : n + W], units.A[before, 1, n : n + W], units.A[before, 2, n : n + W]
    a, b, c = units.A[before, 3, n : n + W], units.A[before, 4, n : n + W], units.A[before, 5, n : n + W]
    if p == 0:
        none = broadcast(0.0, W)
        x, y, z, a, b, c = none, none, none, none, none, none
    for k in range(tree.columns[i], tree.columns[i + 1]):
        work_done = (x * work.U[k, 0, 0] + y * work.U[k, 1, 0] + z * work.U[k, 2, 0]) + (
            a * work.U[k, 3, 0] + b * work.U[k, 4, 0] + c * work.U[k, 5, 0]
        )
        gain = units.M[k, n : n + W] - work_done * work.inverses[k, 0]
        units.M[k, n : n + W] = gain
        x, y, z = x + gain * units.S[k, 0], y + gain * units.S[k, 1], z + gain * units.S[k, 2]
        a, b, c = a + gain * units.S[k, 3], b + gain * units.S[k, 4], c + gain * units.S[k, 5]
    units.A[slot, 0, n : n + W] = x
    units.A[slot, 1, n : n + W] = y
    units.A[slot, 2, n : n + W] = z
    units.A[slot, 3, n : n + W] = a
    units.A[slot, 4, n : n + W] = b
    units.A[slot, 5, n : n + W] = c


@procedure
def _outward(tree, work, units, W):
    """Accelerations, the root first, of the unit torques from each step's columns on."""
    for i in range(1, len(tree.parents)):
        for n in range(tree.columns[i] // W * W, units.M.shape[1], W):
            _accelerations(tree, work, units, i, n, W)


@procedure
def _copy_upper(M, out, W):
    """Copies what is on and above the diagonal."""
    for k in range(len(out)):
        n = k
        while n + W <= len(out):
            out[k, n : n + W] = M[k, n : n + W]
            n += W
        while n < len(out):
            out[k, n] = M[k, n]
            n += 1


@recursion(W=8, places=Placements, work=Articulated, units=Units)
def inverse_mass_matrix(tree, places, work, units, q, M, blocks, W):
    """Inverses of mass matrices, (blocks, nv, nv); see `composite.mass_matrix`."""
    for b in range(blocks):
        _in_one_frame(tree, places, work, units, q[b])
        _inward(tree, work, units, W)
        _outward(tree, work, units, W)
        _copy_upper(units.M, M[b], W)
        mirror(M[b])
