"""The recursions over a table of joints, as procedures: the model is an input, so nothing is compiled for it.

| symbol | meaning | shape | unit |
|---|---|---|---|
| X | placement of a step in its parent's frame: rotation by rows, then translation | (12,) | [m] |
| T | placement of a step in the world | (12,) | [m] |
| S | columns of motion subspaces in the moving frame, those of mimic joints times their ratio | (columns, 6) | |
| V, A, F | twist, its rate, wrench of each step in its moving frame, linear part first | (rows, 6) | |
| B | inertia: mass, mass times centre, moments xx, xy, xz, yy, yz, zz about the frame's origin | (10,) | |

Step i is in row i + 1, row 0 is the world, as in `ulna.recursions`, whose procedures are called for one sample: the
last axis of arrays has one lane. Joints may stand in any order after their parents, so columns of subtrees are no
ranges. Source: Featherstone, Rigid Body Dynamics Algorithms, tables 5.1 and 6.2.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ulna.compiler.procedures import Array1, Array2, Array3, f64, procedure
from ulna.recursions._procedures.columns import all_wrenches_out, dot_rows
from ulna.recursions._procedures.composite import Composite, add_inertia, column_wrenches
from ulna.recursions._procedures.newton_euler import (
    acceleration_of,
    add_cross_of_twists,
    body_force,
    gather_torques,
    velocity_of,
)
from ulna.recursions._procedures.placements import Placements, new_placements, place_in_world
from ulna.recursions._procedures.vectors import add, cross, momentum, put, three, twist_out
from ulna.recursions.tree_table import TreeTable

INT = np.int64


class Tasks(NamedTuple):
    """What is computed besides placements; each counts what it needs.

    Attributes:
        motion: V and A.
        falling: A is relative to free fall.
        dynamics: H, F and tau, after motion.
        mass: B and M.
        columns: J.
        rates: dJ, after motion and columns.
    """

    motion: bool = False
    falling: bool = False
    dynamics: bool = False
    mass: bool = False
    columns: bool = False
    rates: bool = False


PLACEMENTS = Tasks()
MOTION = Tasks(motion=True)
DYNAMICS = Tasks(motion=True, falling=True, dynamics=True)
MASS = Tasks(mass=True)
COLUMNS = Tasks(columns=True)
RATES = Tasks(motion=True, columns=True, rates=True)


class State(NamedTuple):
    """The state, forces on the bodies in their moving frames (rows, 6), and tasks; one lane."""

    q: Array2[f64]
    v: Array2[f64]
    a: Array2[f64]
    forces: Array2[f64]
    tasks: Array1[INT]


class Motions(NamedTuple):
    """Storage for what moves with the steps, (rows, 6, 1) each, for tau (nv, 1), and for J and dJ (columns, 6, 1)."""

    V: Array3[f64]
    A: Array3[f64]
    F: Array3[f64]
    H: Array3[f64]
    tau: Array2[f64]
    J: Array3[f64]
    dJ: Array3[f64]


class Results(NamedTuple):
    """What is computed: see the module; a row for each step, without the world."""

    X: np.ndarray
    T: np.ndarray
    V: np.ndarray
    A: np.ndarray
    F: np.ndarray
    H: np.ndarray
    B: np.ndarray
    tau: np.ndarray
    M: np.ndarray
    J: np.ndarray
    dJ: np.ndarray


class Storage(NamedTuple):
    """What the procedures write to."""

    places: Placements
    moves: Motions
    work: Composite

    def results(self) -> Results:
        """The results, as views."""
        moves, work = self.moves, self.work
        of_steps = [x[1:, :, 0] for x in (self.places.X, self.places.T, moves.V, moves.A, moves.F, moves.H)]
        of_columns = moves.J[:, :, 0], moves.dJ[:, :, 0]
        return Results._make([*of_steps, work.inertias[1:], moves.tau[:, 0], work.M, *of_columns])


def new_storage(rows: int, columns: int, nv: int) -> Storage:
    """Storage for a table.

    Args:
        rows: How many rows the table has.
        columns: How many columns.
        nv: Number of entries of a velocity.

    Returns:
        The storage.
    """
    of_steps, of_columns = [(rows, 6, 1)] * 4, [(columns, 6, 1)] * 2
    work = Composite(*map(np.zeros, ((rows, 10), (6, columns), (nv, nv))))
    moves = Motions(*map(np.zeros, [*of_steps, (nv, 1), *of_columns]))
    return Storage(new_placements(rows, 1, True), moves, work)


@procedure
def _move(tree, X, state, moves, is_falling):
    """V and A of every step; relative to free fall where `is_falling` is 1."""
    for k in range(3):
        moves.A[0, k, 0] = -float(is_falling) * tree.gravity[k]
    for i in range(1, len(tree.parents)):
        acceleration_of(tree, X, moves.A, state.a, i, True, 1)
        lx, ly, lz, rx, ry, rz = velocity_of(tree, X, moves.V, state.v, i, 1)
        add_cross_of_twists(moves.V, i, lx, ly, lz, rx, ry, rz, moves.A, 1)


@procedure
def _inverse_dynamics(tree, X, state, moves):
    """Momenta H, wrenches F through the joints, and tau."""
    for i in range(1, len(tree.parents)):
        lx, ly, lz = three(moves.V, i, 0, 1)
        rx, ry, rz = three(moves.V, i, 3, 1)
        fx, fy, fz, nx, ny, nz = momentum(tree.inertias, i, lx, ly, lz, rx, ry, rz)
        put(moves.H, i, 0, fx, fy, fz, 1)
        put(moves.H, i, 3, nx, ny, nz, 1)
        body_force(tree, moves, i, True, 1)
        for j in range(6):
            moves.F[i, j, 0] -= state.forces[i, j]
    for k in range(len(tree.armature)):
        moves.tau[k, 0] = tree.armature[k] * state.a[k, 0]
    gather_torques(tree, X, moves.F, moves.tau, 1)


@procedure
def _along_support(tree, X, work, i, k):
    """Adds the products of the wrench of column k of step i with the columns of S up to the world to M."""
    step = i
    while step > 0:
        last = tree.columns[step + 1]
        if step == i:
            last = k + 1
        for n in range(tree.columns[step], last):
            product = dot_rows(tree.S, n, work.F, k, 1)
            work.M[tree.entries[k], tree.entries[n]] += product
            if n != k:
                work.M[tree.entries[n], tree.entries[k]] += product
        all_wrenches_out(X, step, work.F, k, k + 1, 1)
        step = tree.parents[step]


@procedure
def _mass_matrix(tree, X, work):
    """Inertias B of what each step moves, and M."""
    for i in range(len(tree.parents)):
        for j in range(10):
            work.inertias[i, j] = tree.inertias[i, j]
    for r in range(len(tree.armature)):
        for c in range(len(tree.armature)):
            work.M[r, c] = 0.0
        work.M[r, r] = tree.armature[r]
    for i in range(len(tree.parents) - 1, 0, -1):
        column_wrenches(tree, work, i)
        for k in range(tree.columns[i], tree.columns[i + 1]):
            _along_support(tree, X, work, i, k)
        if tree.parents[i] > 0:
            add_inertia(X, i, work.inertias, tree.parents[i])


@procedure
def _columns_in_world(tree, T, J):
    """J of every step."""
    for i in range(1, len(tree.parents)):
        for k in range(tree.columns[i], tree.columns[i + 1]):
            lx, ly, lz = tree.S[k, 0], tree.S[k, 1], tree.S[k, 2]
            lx, ly, lz, rx, ry, rz = twist_out(T, i, lx, ly, lz, tree.S[k, 3], tree.S[k, 4], tree.S[k, 5], 1)
            put(J, k, 0, lx, ly, lz, 1)
            put(J, k, 3, rx, ry, rz, 1)


@procedure
def _column_rates(tree, T, moves):
    """The rates dJ of columns: a column turns with the body that carries it."""
    for i in range(1, len(tree.parents)):
        lx, ly, lz = three(moves.V, i, 0, 1)
        rx, ry, rz = three(moves.V, i, 3, 1)
        lx, ly, lz, rx, ry, rz = twist_out(T, i, lx, ly, lz, rx, ry, rz, 1)
        for k in range(tree.columns[i], tree.columns[i + 1]):
            sx, sy, sz = three(moves.J, k, 0, 1)
            wx, wy, wz = three(moves.J, k, 3, 1)
            x, y, z = cross(rx, ry, rz, sx, sy, sz)
            put(moves.dJ, k, 0, x, y, z, 1)
            x, y, z = cross(lx, ly, lz, wx, wy, wz)
            add(moves.dJ, k, 0, x, y, z, 1)
            x, y, z = cross(rx, ry, rz, wx, wy, wz)
            put(moves.dJ, k, 3, x, y, z, 1)


@procedure
def evaluate(tree: TreeTable, state: State, places: Placements, moves: Motions, work: Composite) -> None:
    """X and T of every step, and what `state.tasks` asks for; see `Tasks`.

    Args:
        tree: The steps.
        state: State and tasks.
        places: Placements that are computed.
        moves: Motions, wrenches, torques and Jacobians that are computed.
        work: Inertias and mass matrix that are computed.
    """
    place_in_world(tree, places, state.q, 1)
    if state.tasks[0] == 1:
        _move(tree, places.X, state, moves, state.tasks[1])
    if state.tasks[2] == 1:
        _inverse_dynamics(tree, places.X, state, moves)
    if state.tasks[3] == 1:
        _mass_matrix(tree, places.X, work)
    if state.tasks[4] == 1:
        _columns_in_world(tree, places.T, moves.J)
    if state.tasks[5] == 1:
        _column_rates(tree, places.T, moves)
