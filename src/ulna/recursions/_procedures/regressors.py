"""The regressors of torques, in loops; see `algorithms/dynamics/regressors.py`.

The ten wrenches of a body, one for each of its parameters, travel inward together, W at once, with those of all bodies
behind it: as joints are depth first, the parameters of what a step moves are one range. Source: Atkeson, An &
Hollerbach 1986; Siciliano, section 7.2.2.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ulna.compiler.procedures import Array1, Array2, f64, procedure
from ulna.recursions._procedures.columns import all_wrenches_out, dot_rows, fill_row, put_column
from ulna.recursions._procedures.declaration import recursion
from ulna.recursions._procedures.newton_euler import (
    Motions,
    acceleration_of,
    add_cross_of_twists,
    velocity_of,
)
from ulna.recursions._procedures.placements import Placements, place
from ulna.recursions._procedures.vectors import cross, three

INT = np.int64


class Bodies(NamedTuple):
    """Storage, and which bodies steps move.

    Attributes:
        body: The body that a step carries itself, or -1, (rows,).
        starts: The first body that a step moves, (rows,).
        stops: The one after the last, (rows,).
        wrenches: Ten columns for each body, (6, 10 nbodies).
    """

    body: Array1[INT]
    starts: Array1[INT]
    stops: Array1[INT]
    wrenches: Array2[f64]


@procedure
def _body_wrenches(F, n, ax, ay, az, wx, wy, wz, ex, ey, ez):
    """Writes ten columns from n on: a of the origin; angular velocity w and acceleration e."""
    xx, yy, zz = wx * wx, wy * wy, wz * wz
    xy, xz, yz = wx * wy, wx * wz, wy * wz
    put_column(F, n, ax, ay, az, 0.0, 0.0, 0.0)
    put_column(F, n + 1, -(yy + zz), xy + ez, xz - ey, 0.0, -az, ay)
    put_column(F, n + 2, xy - ez, -(xx + zz), yz + ex, az, 0.0, -ax)
    put_column(F, n + 3, xz + ey, yz - ex, -(xx + yy), -ay, ax, 0.0)
    put_column(F, n + 4, 0.0, 0.0, 0.0, ex, xz, -xy)
    put_column(F, n + 5, 0.0, 0.0, 0.0, ey - xz, ex + yz, xx - yy)
    put_column(F, n + 6, 0.0, 0.0, 0.0, -yz, ey, xy)
    put_column(F, n + 7, 0.0, 0.0, 0.0, ez + xy, zz - xx, ex - yz)
    put_column(F, n + 8, 0.0, 0.0, 0.0, yy - zz, ez - xy, ey + xz)
    put_column(F, n + 9, 0.0, 0.0, 0.0, yz, -xz, ez)


@procedure
def _add_row(S, k, F, Y, e, start, stop, W):
    """Adds the products of row k of S with columns of F to row e of Y."""
    n = start
    while n + W <= stop:
        Y[e, n : n + W] = Y[e, n : n + W] + dot_rows(S, k, F, n, W)
        n += W
    while n < stop:
        Y[e, n] += dot_rows(S, k, F, n, 1)
        n += 1


@procedure
def _motions(tree, places, moves, q, v, a, HAS_V):
    """Velocities and accelerations of the bodies of one sample, those of free fall taken off."""
    place(tree, places, q, 1)
    for k in range(3):
        moves.A[0, k, 0] = -tree.gravity[k]
    for i in range(1, len(tree.parents)):
        acceleration_of(tree, places.X, moves.A, a, i, HAS_V, 1)
        if HAS_V:
            sx, sy, sz, wx, wy, wz = velocity_of(tree, places.X, moves.V, v, i, 1)
            add_cross_of_twists(moves.V, i, sx, sy, sz, wx, wy, wz, moves.A, 1)


@procedure
def _regressor(tree, places, moves, bodies, q, v, a, Y, HAS_V, W):
    """The matrix of one sample."""
    _motions(tree, places, moves, q, v, a, HAS_V)
    for e in range(Y.shape[0]):
        fill_row(Y, e, 0, 0.0, W)
    for i in range(len(tree.parents) - 1, 0, -1):
        if bodies.body[i] >= 0:
            vx, vy, vz = three(moves.V, i, 0, 1)
            wx, wy, wz = three(moves.V, i, 3, 1)
            ax, ay, az = three(moves.A, i, 0, 1)
            ex, ey, ez = three(moves.A, i, 3, 1)
            cx, cy, cz = cross(wx, wy, wz, vx, vy, vz)
            ax, ay, az = ax + cx, ay + cy, az + cz
            _body_wrenches(bodies.wrenches, 10 * bodies.body[i], ax, ay, az, wx, wy, wz, ex, ey, ez)
        start, stop = 10 * bodies.starts[i], 10 * bodies.stops[i]
        for k in range(tree.columns[i], tree.columns[i + 1]):
            _add_row(tree.S, k, bodies.wrenches, Y, tree.entries[k], start, stop, W)
        if tree.parents[i] > 0:
            all_wrenches_out(places.X, i, bodies.wrenches, start, stop, W)


@recursion(W=8, places=Placements, moves=Motions, bodies=Bodies)
def joint_torque_regressor(tree, places, moves, bodies, q, v, a, Y, blocks, W):
    """The regressors of inverse dynamics.

    Args:
        q: Configurations, (blocks, nq, 1) [rad, m].
        v: Velocities, (blocks, nv, 1) [rad/s, m/s].
        a: Accelerations, (blocks, nv, 1) [rad/s^2, m/s^2].
        Y: Matrices that are written, (blocks, nv, 10 nbodies).
    """
    for b in range(blocks):
        _regressor(tree, places, moves, bodies, q[b], v[b], a[b], Y[b], True, W)


@recursion(W=8, places=Placements, moves=Motions, bodies=Bodies)
def gravity_regressor(tree, places, moves, bodies, q, Y, blocks, W):
    """The regressors at rest; see `joint_torque_regressor`."""
    for b in range(blocks):
        _regressor(tree, places, moves, bodies, q[b], q[b], q[b], Y[b], False, W)
