"""Poses, Jacobians and twists of frames, in loops; see `algorithms/kinematics`.

A frame is the row of the joint that carries it and its placement F there, as a row of 12.
"""

from __future__ import annotations

import numpy as np

from ulna.compiler.procedures import Array1, broadcast, f64, procedure
from ulna.recursions._procedures.declaration import recursion
from ulna.recursions._procedures.frame_table import INT, Frames
from ulna.recursions._procedures.newton_euler import (
    Motions,
    acceleration_of,
    add_cross_of_twists,
    velocity_of,
)
from ulna.recursions._procedures.placements import Placements, place_in_world
from ulna.recursions._procedures.vectors import cross, rotate, rotate_back, three, twist_out


@procedure
def constant_pose(F, k, T, i, C, W):
    """C[0] = T[i] F[k], where F is constant."""
    for r in range(3):
        x, y, z = three(T, i, 3 * r, W)
        for c in range(3):
            C[0, 3 * r + c, 0:W] = x * F[k, c] + y * F[k, 3 + c] + z * F[k, 6 + c]
        C[0, 9 + r, 0:W] = T[i, 9 + r, 0:W] + (x * F[k, 9] + y * F[k, 10] + z * F[k, 11])


@procedure
def _poses(tree, places, frames, q, out, C, W):
    """Matrices of the frames, 16 numbers each."""
    place_in_world(tree, places, q, W)
    for k in range(len(frames.rows)):
        constant_pose(frames.placements, k, places.T, frames.rows[k], C, W)
        for r in range(3):
            for c in range(3):
                out[16 * k + 4 * r + c, 0:W] = C[0, 3 * r + c, 0:W]
            out[16 * k + 4 * r + 3, 0:W] = C[0, 9 + r, 0:W]
            out[16 * k + 12 + r, 0:W] = broadcast(0.0, W)
        out[16 * k + 15, 0:W] = broadcast(1.0, W)


@recursion(W=1, places=Placements, frames=Frames)
def frame_poses(tree, places, frames, q, out, blocks, W):
    """Poses of frames in the world.

    Args:
        tree: The table of the joints that carry them.
        places: Storage, with the world's frames.
        frames: The frames.
        q: Configurations, one a lane, (blocks, nq, W) [rad, m].
        out: Matrices by rows that are written, (blocks, 16 k, W) [m].
    """
    C = np.zeros((1, 12, W), f64)
    for b in range(blocks):
        _poses(tree, places, frames, q[b], out[b], C, W)


@procedure
def jacobian_column(tree, T, C, k, i, reference, W):
    """Column k of S, of step i, in a reference: of the frame with the pose in C[0]."""
    lx, ly, lz = rotate(T, i, tree.S[k, 0], tree.S[k, 1], tree.S[k, 2], W)
    rx, ry, rz = rotate(T, i, tree.S[k, 3], tree.S[k, 4], tree.S[k, 5], W)
    px, py, pz = three(T, i, 9, W)
    if reference > 0:
        px, py, pz = px - C[0, 9, 0:W], py - C[0, 10, 0:W], pz - C[0, 11, 0:W]
    cx, cy, cz = cross(px, py, pz, rx, ry, rz)
    lx, ly, lz = lx + cx, ly + cy, lz + cz
    if reference == 2:
        lx, ly, lz = rotate_back(C, 0, lx, ly, lz, W)
        rx, ry, rz = rotate_back(C, 0, rx, ry, rz, W)
    return lx, ly, lz, rx, ry, rz


@procedure
def _jacobian(tree, places, frames, q, J, C, W):
    """The Jacobian of one frame by rows; entries that its joints do not move are left as they are."""
    place_in_world(tree, places, q, W)
    constant_pose(frames.placements, 0, places.T, frames.rows[0], C, W)
    n = len(tree.armature)
    for k in range(len(tree.entries)):
        for r in range(6):
            J[r * n + tree.entries[k], 0:W] = broadcast(0.0, W)
    for i in range(1, len(tree.parents)):
        for k in range(tree.columns[i], tree.columns[i + 1]):
            lx, ly, lz, rx, ry, rz = jacobian_column(tree, places.T, C, k, i, frames.reference[0], W)
            e = tree.entries[k]
            J[e, 0:W] = J[e, 0:W] + lx
            J[n + e, 0:W] = J[n + e, 0:W] + ly
            J[2 * n + e, 0:W] = J[2 * n + e, 0:W] + lz
            J[3 * n + e, 0:W] = J[3 * n + e, 0:W] + rx
            J[4 * n + e, 0:W] = J[4 * n + e, 0:W] + ry
            J[5 * n + e, 0:W] = J[5 * n + e, 0:W] + rz


@recursion(W=1, places=Placements, frames=Frames)
def frame_jacobian(tree, places, frames, q, J, blocks, W):
    """Jacobians of one frame.

    Args:
        tree: The table of the joints that carry it.
        places: Storage, with the world's frames.
        frames: The frame.
        q: Configurations, one a lane, (blocks, nq, W) [rad, m].
        J: Jacobians by rows that are written, (blocks, 6 nv, W); zero where no joint of the table writes.
    """
    C = np.zeros((1, 12, W), f64)
    for b in range(blocks):
        _jacobian(tree, places, frames, q[b], J[b], C, W)


@procedure
def _into_frame(F, lx, ly, lz, rx, ry, rz):
    """A twist of the moving frame that carries a frame, in the frame: F[0]^-1 acting on it."""
    cx, cy, cz = cross(rx, ry, rz, F[0, 9], F[0, 10], F[0, 11])
    lx, ly, lz = lx + cx, ly + cy, lz + cz
    return (
        lx * F[0, 0] + ly * F[0, 3] + lz * F[0, 6],
        lx * F[0, 1] + ly * F[0, 4] + lz * F[0, 7],
        lx * F[0, 2] + ly * F[0, 5] + lz * F[0, 8],
        rx * F[0, 0] + ry * F[0, 3] + rz * F[0, 6],
        rx * F[0, 1] + ry * F[0, 4] + rz * F[0, 7],
        rx * F[0, 2] + ry * F[0, 5] + rz * F[0, 8],
    )


@procedure
def _in_reference(C, reference, out, W):
    """Writes the twist in `out`, of the frame with the pose C[0], in a reference."""
    lx, ly, lz = out[0, 0:W], out[1, 0:W], out[2, 0:W]
    rx, ry, rz = out[3, 0:W], out[4, 0:W], out[5, 0:W]
    if reference == 0:
        lx, ly, lz, rx, ry, rz = twist_out(C, 0, lx, ly, lz, rx, ry, rz, W)
    elif reference == 1:
        lx, ly, lz = rotate(C, 0, lx, ly, lz, W)
        rx, ry, rz = rotate(C, 0, rx, ry, rz, W)
    _write(out, lx, ly, lz, rx, ry, rz, W)


@procedure
def _write(out, lx, ly, lz, rx, ry, rz, W):
    """Writes a twist."""
    out[0, 0:W] = lx
    out[1, 0:W] = ly
    out[2, 0:W] = lz
    out[3, 0:W] = rx
    out[4, 0:W] = ry
    out[5, 0:W] = rz


@procedure
def _add_centripetal(twist, out, W):
    """Adds w x v of a twist to the linear part of a spatial acceleration: that of the origin then."""
    cx, cy, cz = cross(
        twist[3, 0:W], twist[4, 0:W], twist[5, 0:W], twist[0, 0:W], twist[1, 0:W], twist[2, 0:W]
    )
    out[0, 0:W] = out[0, 0:W] + cx
    out[1, 0:W] = out[1, 0:W] + cy
    out[2, 0:W] = out[2, 0:W] + cz


@procedure
def _of_frame(A, row, F, out, W):
    """Writes the twist or acceleration in a row of A, of the moving frame that carries a frame, in the frame."""
    lx, ly, lz = three(A, row, 0, W)
    rx, ry, rz = three(A, row, 3, W)
    lx, ly, lz, rx, ry, rz = _into_frame(F, lx, ly, lz, rx, ry, rz)
    _write(out, lx, ly, lz, rx, ry, rz, W)


@procedure
def _acceleration(tree, places, moves, frames, classical, q, v, a, out, C, twist, W):
    """The acceleration of one frame, without gravity."""
    place_in_world(tree, places, q, W)
    row, reference = frames.rows[0], frames.reference[0]
    constant_pose(frames.placements, 0, places.T, row, C, W)
    for i in range(1, len(tree.parents)):
        acceleration_of(tree, places.X, moves.A, a, i, True, W)
        sx, sy, sz, wx, wy, wz = velocity_of(tree, places.X, moves.V, v, i, W)
        add_cross_of_twists(moves.V, i, sx, sy, sz, wx, wy, wz, moves.A, W)
    _of_frame(moves.V, row, frames.placements, twist, W)
    _of_frame(moves.A, row, frames.placements, out, W)
    _in_reference(C, reference, twist, W)
    _in_reference(C, reference, out, W)
    if classical[0] > 0:
        _add_centripetal(twist, out, W)


@procedure
def _velocity(tree, places, moves, frames, q, v, out, C, W):
    """The twist of one frame."""
    place_in_world(tree, places, q, W)
    row = frames.rows[0]
    constant_pose(frames.placements, 0, places.T, row, C, W)
    for i in range(1, len(tree.parents)):
        _sx, _sy, _sz, _wx, _wy, _wz = velocity_of(tree, places.X, moves.V, v, i, W)
    _of_frame(moves.V, row, frames.placements, out, W)
    _in_reference(C, frames.reference[0], out, W)


@recursion(W=1, places=Placements, moves=Motions, frames=Frames)
def frame_velocity(tree, places, moves, frames, q, v, out, blocks, W):
    """Twists of one frame, (blocks, 6, W); see `frame_jacobian`."""
    C = np.zeros((1, 12, W), f64)
    for b in range(blocks):
        _velocity(tree, places, moves, frames, q[b], v[b], out[b], C, W)


@recursion(W=1, places=Placements, moves=Motions, frames=Frames, classical=Array1[INT])
def frame_acceleration(tree, places, moves, frames, classical, q, v, a, out, blocks, W):
    """Accelerations of one frame, (blocks, 6, W); of its origin if `classical` holds 1. See `frame_jacobian`."""
    C = np.zeros((1, 12, W), f64)
    twist = np.zeros((6, W), f64)
    for b in range(blocks):
        _acceleration(tree, places, moves, frames, classical, q[b], v[b], a[b], out[b], C, twist, W)
