"""Inverse dynamics by the recursive Newton-Euler algorithm, in loops; see `algorithms/dynamics/rnea.py`.

Source: Featherstone 2008, table 5.1.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ulna.compiler.procedures import Array3, broadcast, f64, procedure
from ulna.recursions._procedures.declaration import recursion
from ulna.recursions._procedures.external_forces import subtract_wrenches
from ulna.recursions._procedures.frame_table import Frames
from ulna.recursions._procedures.placements import Placements, place
from ulna.recursions._procedures.vectors import add_wrench_out, cross, momentum, put, three, twist_into


class Motions(NamedTuple):
    """Storage for velocities V, accelerations A and wrenches F of steps in their moving frames, (rows, 6, W) each."""

    V: Array3[f64]
    A: Array3[f64]
    F: Array3[f64]


def new_motions(rows: int, lanes: int) -> Motions:
    """Storage for the motions of a table.

    Args:
        rows: How many rows the table has.
        lanes: W.

    Returns:
        The storage; the world, in row 0, rests.
    """
    return Motions(*(np.zeros((rows, 6, lanes)) for _ in range(3)))


@procedure
def joint_rate(tree, i, v, W):
    """S_i v: the twist of a step relative to its parent, or what an acceleration adds."""
    lx, ly, lz = broadcast(0.0, W), broadcast(0.0, W), broadcast(0.0, W)
    rx, ry, rz = broadcast(0.0, W), broadcast(0.0, W), broadcast(0.0, W)
    for k in range(tree.columns[i], tree.columns[i + 1]):
        rate = v[tree.entries[k], 0:W]
        lx += rate * tree.S[k, 0]
        ly += rate * tree.S[k, 1]
        lz += rate * tree.S[k, 2]
        rx += rate * tree.S[k, 3]
        ry += rate * tree.S[k, 4]
        rz += rate * tree.S[k, 5]
    return lx, ly, lz, rx, ry, rz


@procedure
def velocity_of(tree, X, V, v, i, W):
    """Writes V of a step; returns S_i v."""
    lx, ly, lz, rx, ry, rz = twist_into(X, i, V, tree.parents[i], W)
    sx, sy, sz, wx, wy, wz = joint_rate(tree, i, v, W)
    put(V, i, 0, lx + sx, ly + sy, lz + sz, W)
    put(V, i, 3, rx + wx, ry + wy, rz + wz, W)
    return sx, sy, sz, wx, wy, wz


@procedure
def add_cross_of_twists(V, i, sx, sy, sz, wx, wy, wz, A, W):
    """Adds V_i x s, the vector product of twists, to A of a step."""
    lx, ly, lz = three(V, i, 0, W)
    rx, ry, rz = three(V, i, 3, W)
    ax, ay, az = cross(rx, ry, rz, sx, sy, sz)
    bx, by, bz = cross(lx, ly, lz, wx, wy, wz)
    cx, cy, cz = cross(rx, ry, rz, wx, wy, wz)
    put(A, i, 0, A[i, 0, 0:W] + (ax + bx), A[i, 1, 0:W] + (ay + by), A[i, 2, 0:W] + (az + bz), W)
    put(A, i, 3, A[i, 3, 0:W] + cx, A[i, 4, 0:W] + cy, A[i, 5, 0:W] + cz, W)


@procedure
def acceleration_of(tree, X, A, a, i, HAS_A, W):
    """Writes what A of a step has from its parent and from the acceleration of its joint."""
    lx, ly, lz, rx, ry, rz = twist_into(X, i, A, tree.parents[i], W)
    if HAS_A:
        sx, sy, sz, wx, wy, wz = joint_rate(tree, i, a, W)
        put(A, i, 0, lx + sx, ly + sy, lz + sz, W)
        put(A, i, 3, rx + wx, ry + wy, rz + wz, W)
    else:
        put(A, i, 0, lx, ly, lz, W)
        put(A, i, 3, rx, ry, rz, W)


@procedure
def body_force(tree, moves, i, HAS_V, W):
    """Writes F = I A + V x* I V of a body."""
    lx, ly, lz = three(moves.A, i, 0, W)
    rx, ry, rz = three(moves.A, i, 3, W)
    fx, fy, fz, nx, ny, nz = momentum(tree.inertias, i, lx, ly, lz, rx, ry, rz)
    put(moves.F, i, 0, fx, fy, fz, W)
    put(moves.F, i, 3, nx, ny, nz, W)
    if HAS_V:
        add_gyroscopic(tree, moves.V, moves.F, i, W)


@procedure
def add_gyroscopic(tree, V, F, i, W):
    """Adds V x* I V of a body to F of its step."""
    lx, ly, lz = three(V, i, 0, W)
    rx, ry, rz = three(V, i, 3, W)
    fx, fy, fz, nx, ny, nz = momentum(tree.inertias, i, lx, ly, lz, rx, ry, rz)
    ax, ay, az = cross(rx, ry, rz, fx, fy, fz)
    bx, by, bz = cross(rx, ry, rz, nx, ny, nz)
    cx, cy, cz = cross(lx, ly, lz, fx, fy, fz)
    put(F, i, 0, F[i, 0, 0:W] + ax, F[i, 1, 0:W] + ay, F[i, 2, 0:W] + az, W)
    put(F, i, 3, F[i, 3, 0:W] + (bx + cx), F[i, 4, 0:W] + (by + cy), F[i, 5, 0:W] + (bz + cz), W)


@procedure
def gather_torques(tree, X, F, tau, W):
    """Adds S^T F of every step to tau, and F to the parent's, the leaves first."""
    for i in range(len(tree.parents) - 1, 0, -1):
        fx, fy, fz = three(F, i, 0, W)
        nx, ny, nz = three(F, i, 3, W)
        for k in range(tree.columns[i], tree.columns[i + 1]):
            work = fx * tree.S[k, 0] + fy * tree.S[k, 1] + fz * tree.S[k, 2]
            work += nx * tree.S[k, 3] + ny * tree.S[k, 4] + nz * tree.S[k, 5]
            entry = tree.entries[k]
            tau[entry, 0:W] = tau[entry, 0:W] + work
        if tree.parents[i] > 0:
            add_wrench_out(X, i, F, tree.parents[i], W)


@procedure
def _forces(tree, places, moves, q, v, a, HAS_V, HAS_A, W):
    """The forces on the bodies of one block of samples."""
    place(tree, places, q, W)
    for k in range(3):
        moves.A[0, k, 0:W] = broadcast(-tree.gravity[k], W)
    for i in range(1, len(tree.parents)):
        acceleration_of(tree, places.X, moves.A, a, i, HAS_A, W)
        if HAS_V:
            sx, sy, sz, wx, wy, wz = velocity_of(tree, places.X, moves.V, v, i, W)
            add_cross_of_twists(moves.V, i, sx, sy, sz, wx, wy, wz, moves.A, W)
        body_force(tree, moves, i, HAS_V, W)


@procedure
def _of_forces(tree, places, moves, a, tau, HAS_A, W):
    """The torques of one block of samples, of the forces on the bodies."""
    for k in range(len(tau)):
        if HAS_A:
            tau[k, 0:W] = a[k, 0:W] * tree.armature[k]
        else:
            tau[k, 0:W] = broadcast(0.0, W)
    gather_torques(tree, places.X, moves.F, tau, W)


@procedure
def _torques(tree, places, moves, q, v, a, tau, HAS_V, HAS_A, W):
    """The torques of one block of samples."""
    _forces(tree, places, moves, q, v, a, HAS_V, HAS_A, W)
    _of_forces(tree, places, moves, a, tau, HAS_A, W)


@procedure
def _loaded_torques(tree, places, moves, frames, q, v, a, wrenches, tau, HAS_V, HAS_A, W):
    """The same under external forces."""
    _forces(tree, places, moves, q, v, a, HAS_V, HAS_A, W)
    subtract_wrenches(tree, places, frames, wrenches, moves.F, W)
    _of_forces(tree, places, moves, a, tau, HAS_A, W)


@recursion(W=1, places=Placements, moves=Motions)
def inverse_dynamics(tree, places, moves, q, v, a, tau, blocks, W):
    """The joint torques of accelerations.

    Args:
        q: Configurations, one a lane, (blocks, nq, W) [rad, m].
        v: Velocities, (blocks, nv, W) [rad/s, m/s].
        a: Accelerations, (blocks, nv, W) [rad/s^2, m/s^2].
        tau: Torques that are written, (blocks, nv, W) [N m, N].
    """
    for b in range(blocks):
        _torques(tree, places, moves, q[b], v[b], a[b], tau[b], True, True, W)


@recursion(W=1, places=Placements, moves=Motions)
def bias_forces(tree, places, moves, q, v, tau, blocks, W):
    """The joint torques of velocities and gravity; see `inverse_dynamics`."""
    for b in range(blocks):
        _torques(tree, places, moves, q[b], v[b], v[b], tau[b], True, False, W)


@recursion(W=1, places=Placements, moves=Motions)
def gravity_forces(tree, places, moves, q, tau, blocks, W):
    """The joint torques of gravity; see `inverse_dynamics`."""
    for b in range(blocks):
        _torques(tree, places, moves, q[b], q[b], q[b], tau[b], False, False, W)


@recursion(W=1, places=Placements, moves=Motions, frames=Frames)
def loaded_inverse_dynamics(tree, places, moves, frames, q, v, a, wrenches, tau, blocks, W):
    """The joint torques of accelerations under external forces; see `inverse_dynamics`.

    Args:
        places: Storage, with the world's frames.
        frames: The frames that forces act on, and how these are written.
        q: Configurations, one a lane, (blocks, nq, W) [rad, m].
        v: Velocities, (blocks, nv, W) [rad/s, m/s].
        a: Accelerations, (blocks, nv, W) [rad/s^2, m/s^2].
        wrenches: What the surroundings exert at the frames, (blocks, 6 k, W) [N, N m].
        tau: Torques that are written, (blocks, nv, W) [N m, N].
    """
    for b in range(blocks):
        _loaded_torques(tree, places, moves, frames, q[b], v[b], a[b], wrenches[b], tau[b], True, True, W)


@recursion(W=1, places=Placements, moves=Motions, frames=Frames)
def loaded_bias_forces(tree, places, moves, frames, q, v, wrenches, tau, blocks, W):
    """The joint torques of velocities, gravity and external forces; see `loaded_inverse_dynamics`."""
    for b in range(blocks):
        _loaded_torques(tree, places, moves, frames, q[b], v[b], v[b], wrenches[b], tau[b], True, False, W)


@recursion(W=1, places=Placements, moves=Motions, frames=Frames)
def loaded_gravity_forces(tree, places, moves, frames, q, wrenches, tau, blocks, W):
    """The joint torques of gravity and external forces; see `loaded_inverse_dynamics`."""
    for b in range(blocks):
        _loaded_torques(tree, places, moves, frames, q[b], q[b], q[b], wrenches[b], tau[b], False, False, W)
