"""The recursions over a table of joints, as procedures: the model is an input, so nothing is compiled for it.

| symbol | meaning | shape | unit |
|---|---|---|---|
| X | placement of a step in its parent's frame: rotation by rows, then translation | (12,) | [m] |
| T | placement of a step in the world | (12,) | [m] |
| S | columns of motion subspaces in the moving frame, those of mimic joints times their ratio | (columns, 6) | |
| V, A, F | twist, its rate, wrench of each step in its moving frame, linear part first | (steps, 6) | |
| B | inertia: mass, mass times centre, moments xx, xy, xz, yy, yz, zz about the frame's origin | (10,) | |

Source: Featherstone, Rigid Body Dynamics Algorithms, tables 5.1 and 6.2; see `ulna/algorithms/dynamics/rnea.py`.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ulna.compiler.procedures import Array1, Array2, f64, procedure

INT = np.int64
REVOLUTE, PRISMATIC, CIRCLE, SPHERICAL, FREE_FLYER, TRANSLATION, PLANAR_CIRCLE = range(7)
"""What a step is; a helical joint is a revolute one with a pitch."""


class Table(NamedTuple):
    """Steps, parents first; a step is a joint, or one part of a joint that is made of parts.

    Attributes:
        parents: The parent of each step, -1 for the world, (steps,).
        kinds: What it is, (steps,).
        starts: Where its configuration begins in q, (steps,).
        columns: Where its columns of S begin, (steps + 1,).
        geometry: Axis (3), pitch, ratio, offset, first and second axis of a plane (3 each), (steps, 12).
        S: Columns, (columns, 6).
        entries: The entry of v that a column belongs to, (columns,).
    """

    parents: Array1[INT]
    kinds: Array1[INT]
    starts: Array1[INT]
    columns: Array1[INT]
    geometry: Array2[f64]
    S: Array2[f64]
    entries: Array1[INT]


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


class Numbers(NamedTuple):
    """Parameters of the model and the state: placements P (steps, 12), inertias B (steps, 10), vectors, and tasks."""

    P: Array2[f64]
    B: Array2[f64]
    armature: Array1[f64]
    gravity: Array1[f64]
    q: Array1[f64]
    v: Array1[f64]
    a: Array1[f64]
    forces: Array2[f64]
    tasks: Array1[INT]


class Results(NamedTuple):
    """What is computed: see the module."""

    X: Array2[f64]
    T: Array2[f64]
    V: Array2[f64]
    A: Array2[f64]
    F: Array2[f64]
    H: Array2[f64]
    B: Array2[f64]
    tau: Array1[f64]
    M: Array2[f64]
    J: Array2[f64]
    dJ: Array2[f64]


@procedure
def _set(out, i, j, x, y, z):
    """Writes three numbers to row i of `out`, from column j on."""
    out[i, j] = x
    out[i, j + 1] = y
    out[i, j + 2] = z


@procedure
def _add(out, i, j, x, y, z):
    """Adds three numbers to row i of `out`, from column j on."""
    out[i, j] += x
    out[i, j + 1] += y
    out[i, j + 2] += z


@procedure
def _rotate(T, i, x, y, z):
    """R (x, y, z), R being in row i."""
    return (
        T[i, 0] * x + T[i, 1] * y + T[i, 2] * z,
        T[i, 3] * x + T[i, 4] * y + T[i, 5] * z,
        T[i, 6] * x + T[i, 7] * y + T[i, 8] * z,
    )


@procedure
def _rotate_back(T, i, x, y, z):
    """R^T (x, y, z), R being in row i."""
    return (
        T[i, 0] * x + T[i, 3] * y + T[i, 6] * z,
        T[i, 1] * x + T[i, 4] * y + T[i, 7] * z,
        T[i, 2] * x + T[i, 5] * y + T[i, 8] * z,
    )


@procedure
def _cross(ax, ay, az, bx, by, bz):
    return ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx


@procedure
def _add_cross(out, i, j, ax, ay, az, bx, by, bz):
    """Adds the vector product of a and b to row i of `out`, from column j on."""
    out[i, j] += ay * bz - az * by
    out[i, j + 1] += az * bx - ax * bz
    out[i, j + 2] += ax * by - ay * bx


@procedure
def _turn(x, y, z, s, c, L):
    """Writes the rotation about a unit axis: a a^T + c (I - a a^T) + s [a]x."""
    _set(L, 0, 0, x * x + c * (1.0 - x * x), x * y - c * (x * y) - s * z, x * z - c * (x * z) + s * y)
    _set(L, 0, 3, x * y - c * (x * y) + s * z, y * y + c * (1.0 - y * y), y * z - c * (y * z) - s * x)
    _set(L, 0, 6, x * z - c * (x * z) - s * y, y * z - c * (y * z) + s * x, z * z + c * (1.0 - z * z))


@procedure
def _quaternion(q, k, L):
    """Writes the rotation of a unit quaternion x, y, z, w."""
    x, y, z, w = q[k], q[k + 1], q[k + 2], q[k + 3]
    _set(L, 0, 0, 1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y))
    _set(L, 0, 3, 2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x))
    _set(L, 0, 6, 2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y))


@procedure
def _joint_transform(table, i, q, L):
    """Writes the placement of the moving frame of a step in its fixed frame."""
    kind, k = table.kinds[i], table.starts[i]
    x, y, z = table.geometry[i, 0], table.geometry[i, 1], table.geometry[i, 2]
    for j in range(12):
        L[0, j] = 0.0
    L[0, 0] = 1.0
    L[0, 4] = 1.0
    L[0, 8] = 1.0
    if kind == 0:
        angle = table.geometry[i, 4] * q[k] + table.geometry[i, 5]
        _turn(x, y, z, math.sin(angle), math.cos(angle), L)
        advance = table.geometry[i, 3] * angle
        _set(L, 0, 9, advance * x, advance * y, advance * z)
    elif kind == 1:
        s = table.geometry[i, 4] * q[k] + table.geometry[i, 5]
        _set(L, 0, 9, s * x, s * y, s * z)
    elif kind == 2:
        _turn(x, y, z, q[k + 1], q[k], L)
    elif kind == 3:
        _quaternion(q, k, L)
    elif kind == 4:
        _quaternion(q, k + 3, L)
        _set(L, 0, 9, q[k], q[k + 1], q[k + 2])
    elif kind == 5:
        _set(L, 0, 9, q[k], q[k + 1], q[k + 2])
    else:
        _turn(x, y, z, q[k + 3], q[k + 2], L)
        for j in range(3):
            L[0, 9 + j] = table.geometry[i, 6 + j] * q[k] + table.geometry[i, 9 + j] * q[k + 1]


@procedure
def _product(A, i, B, k, C, o):
    """C[o] = A[i] B[k] for placements; C[o] is neither of them."""
    for r in range(3):
        x, y, z = A[i, 3 * r], A[i, 3 * r + 1], A[i, 3 * r + 2]
        for c in range(3):
            C[o, 3 * r + c] = x * B[k, c] + y * B[k, 3 + c] + z * B[k, 6 + c]
        C[o, 9 + r] = A[i, 9 + r] + x * B[k, 9] + y * B[k, 10] + z * B[k, 11]


@procedure
def _place(table, numbers, out):
    """X and T of every step."""
    L = np.zeros((1, 12), f64)
    for i in range(len(table.parents)):
        _joint_transform(table, i, numbers.q, L)
        _product(numbers.P, i, L, 0, out.X, i)
        if table.parents[i] < 0:
            for j in range(12):
                out.T[i, j] = out.X[i, j]
        else:
            _product(out.T, table.parents[i], out.X, i, out.T, i)


@procedure
def _into_child(X, i, W, parent, out):
    """The twist of the parent, in row `parent` of W, in the moving frame of step i: row i of `out`."""
    x, y, z = _cross(X[i, 9], X[i, 10], X[i, 11], W[parent, 3], W[parent, 4], W[parent, 5])
    lx, ly, lz = _rotate_back(X, i, W[parent, 0] - x, W[parent, 1] - y, W[parent, 2] - z)
    rx, ry, rz = _rotate_back(X, i, W[parent, 3], W[parent, 4], W[parent, 5])
    _set(out, i, 0, lx, ly, lz)
    _set(out, i, 3, rx, ry, rz)


@procedure
def _move(table, numbers, out, is_falling):
    """V and A of every step; relative to free fall where `is_falling` is 1."""
    root = np.zeros((2, 6), f64)
    for j in range(3):
        root[1, j] = -float(is_falling) * numbers.gravity[j]
    for i in range(len(table.parents)):
        parent = table.parents[i]
        if parent < 0:
            _into_child(out.X, i, root, 0, out.V)
            _into_child(out.X, i, root, 1, out.A)
        else:
            _into_child(out.X, i, out.V, parent, out.V)
            _into_child(out.X, i, out.A, parent, out.A)
        lx, ly, lz = out.V[i, 0], out.V[i, 1], out.V[i, 2]
        rx, ry, rz = out.V[i, 3], out.V[i, 4], out.V[i, 5]
        for k in range(table.columns[i], table.columns[i + 1]):
            rate, gain = numbers.v[table.entries[k]], numbers.a[table.entries[k]]
            for j in range(6):
                out.V[i, j] += table.S[k, j] * rate
                out.A[i, j] += table.S[k, j] * gain
            sx, sy, sz = table.S[k, 0] * rate, table.S[k, 1] * rate, table.S[k, 2] * rate
            wx, wy, wz = table.S[k, 3] * rate, table.S[k, 4] * rate, table.S[k, 5] * rate
            _add_cross(out.A, i, 0, rx, ry, rz, sx, sy, sz)
            _add_cross(out.A, i, 0, lx, ly, lz, wx, wy, wz)
            _add_cross(out.A, i, 3, rx, ry, rz, wx, wy, wz)


@procedure
def _inertia_times(B, i, W, k, out, o):
    """Adds the wrench of the inertia in row i of B and the twist in row k of W to row o of `out`."""
    lx, ly, lz, x, y, z = W[k, 0], W[k, 1], W[k, 2], W[k, 3], W[k, 4], W[k, 5]
    m, hx, hy, hz = B[i, 0], B[i, 1], B[i, 2], B[i, 3]
    _add(out, o, 0, m * lx, m * ly, m * lz)
    _add_cross(out, o, 0, x, y, z, hx, hy, hz)
    _add_cross(out, o, 3, hx, hy, hz, lx, ly, lz)
    out[o, 3] += B[i, 4] * x + B[i, 5] * y + B[i, 6] * z
    out[o, 4] += B[i, 5] * x + B[i, 7] * y + B[i, 8] * z
    out[o, 5] += B[i, 6] * x + B[i, 8] * y + B[i, 9] * z


@procedure
def _forces(X, i, F, k):
    """The wrench in row k of F, of the moving frame of step i, in the frame of its parent."""
    x, y, z = _rotate(X, i, F[k, 0], F[k, 1], F[k, 2])
    nx, ny, nz = _rotate(X, i, F[k, 3], F[k, 4], F[k, 5])
    mx, my, mz = _cross(X[i, 9], X[i, 10], X[i, 11], x, y, z)
    return x, y, z, nx + mx, ny + my, nz + mz


@procedure
def _body_wrench(numbers, out, i):
    """H and F of one body, without what it carries."""
    for j in range(6):
        out.H[i, j] = 0.0
        out.F[i, j] = -numbers.forces[i, j]
    _inertia_times(numbers.B, i, out.V, i, out.H, i)
    _inertia_times(numbers.B, i, out.A, i, out.F, i)
    lx, ly, lz, x, y, z = out.V[i, 0], out.V[i, 1], out.V[i, 2], out.V[i, 3], out.V[i, 4], out.V[i, 5]
    _add_cross(out.F, i, 0, x, y, z, out.H[i, 0], out.H[i, 1], out.H[i, 2])
    _add_cross(out.F, i, 3, x, y, z, out.H[i, 3], out.H[i, 4], out.H[i, 5])
    _add_cross(out.F, i, 3, lx, ly, lz, out.H[i, 0], out.H[i, 1], out.H[i, 2])


@procedure
def _inverse_dynamics(table, numbers, out):
    """Momenta H, wrenches F through the joints, and tau."""
    steps = len(table.parents)
    for i in range(steps):
        _body_wrench(numbers, out, i)
    for k in range(len(out.tau)):
        out.tau[k] = numbers.armature[k] * numbers.a[k]
    for i in range(steps - 1, -1, -1):
        for k in range(table.columns[i], table.columns[i + 1]):
            work = 0.0
            for j in range(6):
                work += table.S[k, j] * out.F[i, j]
            out.tau[table.entries[k]] += work
        if table.parents[i] >= 0:
            x, y, z, nx, ny, nz = _forces(out.X, i, out.F, i)
            _add(out.F, table.parents[i], 0, x, y, z)
            _add(out.F, table.parents[i], 3, nx, ny, nz)


@procedure
def _add_inertia(T, i, B, k, out, o):
    """Adds the inertia in row k of B, moved by the placement in row i of T, to row o of `out`."""
    m = B[k, 0]
    hx, hy, hz = _rotate(T, i, B[k, 1], B[k, 2], B[k, 3])
    px, py, pz = T[i, 9], T[i, 10], T[i, 11]
    ax, ay, az = _rotate(T, i, B[k, 4], B[k, 5], B[k, 6])  # R I, column by column
    bx, by, bz = _rotate(T, i, B[k, 5], B[k, 7], B[k, 8])
    cx, cy, cz = _rotate(T, i, B[k, 6], B[k, 8], B[k, 9])
    xx, xy, xz = _rotate(T, i, ax, bx, cx)  # (R I) R^T, row by row
    _yx, yy, yz = _rotate(T, i, ay, by, cy)
    _zx, _zy, zz = _rotate(T, i, az, bz, cz)
    hp, pp = hx * px + hy * py + hz * pz, px * px + py * py + pz * pz
    out[o, 0] += m
    _add(out, o, 1, hx + m * px, hy + m * py, hz + m * pz)
    out[o, 4] += xx + 2.0 * (hp - hx * px) + m * (pp - px * px)
    out[o, 5] += xy - hx * py - px * hy - m * px * py
    out[o, 6] += xz - hx * pz - px * hz - m * px * pz
    out[o, 7] += yy + 2.0 * (hp - hy * py) + m * (pp - py * py)
    out[o, 8] += yz - hy * pz - py * hz - m * py * pz
    out[o, 9] += zz + 2.0 * (hp - hz * pz) + m * (pp - pz * pz)


@procedure
def _along_support(table, out, i, k, F):
    """Adds the products of the wrench F, of column k of step i, with the columns of S up to the world to M."""
    step = i
    while step >= 0:
        last = table.columns[step + 1]
        if step == i:
            last = k + 1
        for n in range(table.columns[step], last):
            work = 0.0
            for j in range(6):
                work += table.S[n, j] * F[0, j]
            out.M[table.entries[k], table.entries[n]] += work
            if n != k:
                out.M[table.entries[n], table.entries[k]] += work
        x, y, z, nx, ny, nz = _forces(out.X, step, F, 0)
        _set(F, 0, 0, x, y, z)
        _set(F, 0, 3, nx, ny, nz)
        step = table.parents[step]


@procedure
def _mass_matrix(table, numbers, out):
    """Inertias B of what each step moves, and M."""
    F = np.zeros((1, 6), f64)
    steps, size = len(table.parents), len(out.tau)
    for i in range(steps):
        for j in range(10):
            out.B[i, j] = numbers.B[i, j]
    for r in range(size):
        for c in range(size):
            out.M[r, c] = 0.0
        out.M[r, r] = numbers.armature[r]
    for i in range(steps - 1, -1, -1):
        if table.parents[i] >= 0:
            _add_inertia(out.X, i, out.B, i, out.B, table.parents[i])
        for k in range(table.columns[i], table.columns[i + 1]):
            for j in range(6):
                F[0, j] = 0.0
            _inertia_times(out.B, i, table.S, k, F, 0)
            _along_support(table, out, i, k, F)


@procedure
def _to_world(T, i, W, k, out, o):
    """The twist in row k of W, of the moving frame of step i, in the world: row o of `out`."""
    x, y, z = _rotate(T, i, W[k, 0], W[k, 1], W[k, 2])
    a, b, c = _rotate(T, i, W[k, 3], W[k, 4], W[k, 5])
    _set(out, o, 0, x, y, z)
    _set(out, o, 3, a, b, c)
    _add_cross(out, o, 0, T[i, 9], T[i, 10], T[i, 11], a, b, c)


@procedure
def _columns_in_world(table, out):
    """J of every step."""
    for i in range(len(table.parents)):
        for k in range(table.columns[i], table.columns[i + 1]):
            _to_world(out.T, i, table.S, k, out.J, k)


@procedure
def _column_rates(table, out):
    """The rates dJ of columns: a column turns with the body that carries it."""
    W = np.zeros((1, 6), f64)
    for i in range(len(table.parents)):
        _to_world(out.T, i, out.V, i, W, 0)
        for k in range(table.columns[i], table.columns[i + 1]):
            lx, ly, lz = out.J[k, 0], out.J[k, 1], out.J[k, 2]
            rx, ry, rz = out.J[k, 3], out.J[k, 4], out.J[k, 5]
            for j in range(6):
                out.dJ[k, j] = 0.0
            _add_cross(out.dJ, k, 0, W[0, 3], W[0, 4], W[0, 5], lx, ly, lz)
            _add_cross(out.dJ, k, 0, W[0, 0], W[0, 1], W[0, 2], rx, ry, rz)
            _add_cross(out.dJ, k, 3, W[0, 3], W[0, 4], W[0, 5], rx, ry, rz)


@procedure
def evaluate(table: Table, numbers: Numbers, out: Results) -> None:
    """X and T of every step, and what `numbers.tasks` asks for; see `Tasks`.

    Args:
        table: The steps.
        numbers: Parameters, state and tasks.
        out: What is computed.
    """
    _place(table, numbers, out)
    if numbers.tasks[0] == 1:
        _move(table, numbers, out, numbers.tasks[1])
    if numbers.tasks[2] == 1:
        _inverse_dynamics(table, numbers, out)
    if numbers.tasks[3] == 1:
        _mass_matrix(table, numbers, out)
    if numbers.tasks[4] == 1:
        _columns_in_world(table, out)
    if numbers.tasks[5] == 1:
        _column_rates(table, out)
