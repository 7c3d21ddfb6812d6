"""The inverse of the mass matrix, in loops: the articulated-body algorithm for unit torques, W of them at once.

| symbol | meaning | shape |
|---|---|---|
| F | bias force of the present step for each unit torque | (6, columns) |
| A | acceleration of a step for each unit torque, in one of a few slots | (slots, 6, columns) |

Row k holds u / d of column k first, inward, then the accelerations, outward; only what is on and above the diagonal
is computed. A step takes the slot of its parent if it is the last one there. Source: Carpentier 2018, Analytical
inverse of the joint space inertia matrix.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ulna.compiler.procedures import Array1, Array2, Array3, broadcast, f64, procedure
from ulna.recursions._procedures.articulated import (
    Articulated,
    add_articulated_out,
    eliminate,
    start_inertias,
)
from ulna.recursions._procedures.columns import all_wrenches_out, dot_rows, fill_row, mirror, twists_in
from ulna.recursions._procedures.placements import Placements, place
from ulna.recursions.tree_table import INT, TreeTable


class Units(NamedTuple):
    """Storage: F and A, see the module; slots are those of steps, (rows,)."""

    F: Array2[f64]
    A: Array3[f64]
    slots: Array1[INT]


@procedure
def _force_of(work, F, k, M, n, W):
    """Adds U_k M[k, n : n + W] to W bias forces."""
    gain = M[k, n : n + W]
    for j in range(6):
        F[j, n : n + W] = F[j, n : n + W] + gain * work.U[k, j, 0]


@procedure
def _unit_row(tree, work, units, k, stop, M, W):
    """u / d of column k for the unit torques from its step's columns on, and what it adds to F."""
    inverse = work.inverses[k, 0]
    n = k
    while n + W <= stop:
        M[k, n : n + W] = -inverse * dot_rows(tree.S, k, units.F, n, W)
        n += W
    while n < stop:
        M[k, n] = -inverse * dot_rows(tree.S, k, units.F, n, 1)
        n += 1
    M[k, k] += inverse
    fill_row(M, k, stop, 0.0, W)
    n = k
    while n + W <= stop:
        _force_of(work, units.F, k, M, n, W)
        n += W
    while n < stop:
        _force_of(work, units.F, k, M, n, 1)
        n += 1


@procedure
def _inward(tree, places, work, units, M, C, W):
    """Eliminates the columns of every step, the leaves first; the last column of a step first."""
    for j in range(6):
        fill_row(units.F, j, 0, 0.0, W)
    for i in range(len(tree.parents) - 1, 0, -1):
        for k in range(tree.columns[i + 1] - 1, tree.columns[i] - 1, -1):
            eliminate(tree, work, i, k, 1)
            for n in range(tree.columns[i], k):
                M[k, n] = 0.0
            _unit_row(tree, work, units, k, tree.ends[i], M, W)
        if tree.parents[i] > 0:
            all_wrenches_out(places.X, i, units.F, tree.columns[i], tree.ends[i], W)
            add_articulated_out(places.X, i, work.G, tree.parents[i], C, 1)


@procedure
def _accelerations(tree, places, work, units, i, n, M, W):
    """W accelerations of a step, and its rows of M."""
    slot = units.slots[i]
    if tree.parents[i] > 0:
        twists_in(places.X, i, units.A, units.slots[tree.parents[i]], units.A, slot, n, W)
    else:
        for j in range(6):
            units.A[slot, j, n : n + W] = broadcast(0.0, W)
    for k in range(tree.columns[i], tree.columns[i + 1]):
        work_done = broadcast(0.0, W)
        for j in range(6):
            work_done += units.A[slot, j, n : n + W] * work.U[k, j, 0]
        gain = M[k, n : n + W] - work_done * work.inverses[k, 0]
        M[k, n : n + W] = gain
        for j in range(6):
            units.A[slot, j, n : n + W] = units.A[slot, j, n : n + W] + gain * tree.S[k, j]


@procedure
def _outward(tree, places, work, units, M, W):
    """Accelerations, the root first, of the unit torques from each step's columns on."""
    for i in range(1, len(tree.parents)):
        n = tree.columns[i]
        while n + W <= len(M):
            _accelerations(tree, places, work, units, i, n, M, W)
            n += W
        while n < len(M):
            _accelerations(tree, places, work, units, i, n, M, 1)
            n += 1


@procedure(constants={"W": 8}, contract=True)
def inverse_mass_matrix(
    tree: TreeTable,
    places: Placements,
    work: Articulated,
    units: Units,
    q: Array3[f64],
    M: Array3[f64],
    blocks: int,
    W: int,
) -> None:
    """Inverses of mass matrices, (blocks, nv, nv); see `composite.mass_matrix`."""
    C = np.zeros((1, 27, 1), f64)
    for b in range(blocks):
        place(tree, places, q[b], 1)
        start_inertias(tree, work.G, 1)
        _inward(tree, places, work, units, M[b], C, W)
        _outward(tree, places, work, units, M[b], W)
        mirror(M[b])
