"""The kinematic Hessian of a frame, in loops over pairs of columns; see `algorithms/kinematics/hessian.py`.

| symbol | meaning | shape |
|---|---|---|
| J | columns of the Jacobian | (6, columns) |
| H | H[6 k + r, j]: row r of column j's derivative with respect to column k's coordinate | (6 columns, columns) |

Columns after those of a step are one range, as the joints that carry a frame are a chain: W at once.
"""

from __future__ import annotations

import numpy as np

from ulna.compiler.procedures import Array2, broadcast, f64, procedure
from ulna.recursions._procedures.columns import put_column
from ulna.recursions._procedures.declaration import recursion
from ulna.recursions._procedures.frame_table import Frames
from ulna.recursions._procedures.frames import constant_pose, jacobian_column
from ulna.recursions._procedures.placements import Placements, place_in_world
from ulna.recursions._procedures.vectors import cross


@procedure
def _put(H, k, j, lx, ly, lz, rx, ry, rz, W):
    """Writes the derivatives of W columns with respect to the coordinate of column k."""
    H[6 * k, j : j + W] = lx
    H[6 * k + 1, j : j + W] = ly
    H[6 * k + 2, j : j + W] = lz
    H[6 * k + 3, j : j + W] = rx
    H[6 * k + 4, j : j + W] = ry
    H[6 * k + 5, j : j + W] = rz


@procedure
def _before(J, H, k, j, reference, W):
    """Derivatives of W columns of steps before that of column k, which moves them only as the frame moves."""
    zero = broadcast(0.0, W)
    if reference == 0:
        _put(H, k, j, zero, zero, zero, zero, zero, zero, W)
    else:
        wx, wy, wz = J[3, j : j + W], J[4, j : j + W], J[5, j : j + W]
        ax, ay, az = cross(wx, wy, wz, J[0, k], J[1, k], J[2, k])
        if reference == 1:
            _put(H, k, j, ax, ay, az, zero, zero, zero, W)
        else:
            lx, ly, lz = J[0, j : j + W], J[1, j : j + W], J[2, j : j + W]
            bx, by, bz = cross(lx, ly, lz, J[3, k], J[4, k], J[5, k])
            cx, cy, cz = cross(wx, wy, wz, J[3, k], J[4, k], J[5, k])
            _put(H, k, j, ax + bx, ay + by, az + bz, cx, cy, cz, W)


@procedure
def _after(J, H, k, j, reference, W):
    """Derivatives of W columns of the step of column k, or of steps after it."""
    zero = broadcast(0.0, W)
    if reference == 2:
        _put(H, k, j, zero, zero, zero, zero, zero, zero, W)
    else:
        ax, ay, az = cross(J[3, k], J[4, k], J[5, k], J[0, j : j + W], J[1, j : j + W], J[2, j : j + W])
        wx, wy, wz = J[3, j : j + W], J[4, j : j + W], J[5, j : j + W]
        cx, cy, cz = cross(J[3, k], J[4, k], J[5, k], wx, wy, wz)
        if reference == 0:
            bx, by, bz = cross(J[0, k], J[1, k], J[2, k], wx, wy, wz)
            ax, ay, az = ax + bx, ay + by, az + bz
        _put(H, k, j, ax, ay, az, cx, cy, cz, W)


@procedure
def _hessian(tree, places, frames, J, q, H, C, W):
    """The Hessian of all columns."""
    place_in_world(tree, places, q, 1)
    constant_pose(frames.placements, 0, places.T, frames.rows[0], C, 1)
    reference = frames.reference[0]
    for i in range(1, len(tree.parents)):
        for k in range(tree.columns[i], tree.columns[i + 1]):
            lx, ly, lz, rx, ry, rz = jacobian_column(tree, places.T, C, k, i, reference, 1)
            put_column(J, k, lx, ly, lz, rx, ry, rz)
    for i in range(1, len(tree.parents)):
        first = tree.columns[i]
        for k in range(first, tree.columns[i + 1]):
            j = 0
            while j + W <= first:
                _before(J, H, k, j, reference, W)
                j += W
            while j < first:
                _before(J, H, k, j, reference, 1)
                j += 1
            while j + W <= H.shape[1]:
                _after(J, H, k, j, reference, W)
                j += W
            while j < H.shape[1]:
                _after(J, H, k, j, reference, 1)
                j += 1


@recursion(W=8, places=Placements, frames=Frames, J=Array2[f64])
def frame_hessian(tree, places, frames, J, q, H, blocks, W):
    """Hessians of one frame.

    Args:
        tree: The table of the joints that carry it, each column with an entry of velocity of its own.
        places: Storage for one sample, with the world's frames.
        frames: The frame.
        J: Storage, (6, columns).
        q: Configurations, (blocks, nq, 1) [rad, m].
        H: Hessians that are written, (blocks, 6 columns, columns).
    """
    C = np.zeros((1, 12, 1), f64)
    for b in range(blocks):
        _hessian(tree, places, frames, J, q[b], H[b], C, W)
