"""Where the frames of steps are: in their parents' (X), and in the world (T)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ulna.compiler.procedures import Array1, Array3, broadcast, f64, procedure
from ulna.recursions._procedures.vectors import put, rotate, three

SINES_AT_ONCE = 8
"""Lanes in which sines and cosines of all joints are computed."""


class Placements(NamedTuple):
    """Storage for placements; angles, sines and cosines of row i are at W i, ...

    Attributes:
        angles: (rows W, rounded up to lanes) [rad].
        sines: Likewise.
        cosines: Likewise.
        X: (rows, 12, W).
        T: (rows, 12, W), or (0, 12, W) where the world's frames are not needed.
    """

    angles: Array1[f64]
    sines: Array1[f64]
    cosines: Array1[f64]
    X: Array3[f64]
    T: Array3[f64]


def new_placements(rows: int, lanes: int, with_world: bool) -> Placements:
    """Storage for the placements of a table.

    Args:
        rows: How many rows the table has.
        lanes: W.
        with_world: Whether placements in the world are needed.

    Returns:
        The storage, with the world in row 0.
    """
    flat = -(-rows * lanes // SINES_AT_ONCE) * SINES_AT_ONCE
    X, T = np.zeros((rows, 12, lanes)), np.zeros((rows if with_world else 0, 12, lanes))
    for world in (X, T):
        world[:1, [0, 4, 8]] = 1.0
    return Placements(np.zeros(flat), np.zeros(flat), np.zeros(flat), X, T)


@procedure
def _read_angles(tree, places, q, W):
    """The angle of every step that turns by one."""
    for i in range(1, len(tree.parents)):
        kind, k = tree.kinds[i], tree.starts[i]
        if kind == 0:
            places.angles[i * W : i * W + W] = q[k, 0:W] * tree.fixed[i, 36] + tree.fixed[i, 37]
        elif kind == 3:
            places.angles[i * W : i * W + W] = q[k + 2, 0:W]
    for i in range(0, len(places.angles), 8):
        places.sines[i : i + 8] = np.sin(places.angles[i : i + 8])
        places.cosines[i : i + 8] = np.cos(places.angles[i : i + 8])


@procedure
def _linear_in(tree, i, c, s, u, w, X, W):
    """X of a step from the cosine and sine of its angle and two lengths."""
    for j in range(9):
        X[i, j, 0:W] = c * tree.fixed[i, 9 + j] + s * tree.fixed[i, 18 + j] + tree.fixed[i, j]
    for j in range(3):
        X[i, 9 + j, 0:W] = u * tree.fixed[i, 30 + j] + w * tree.fixed[i, 33 + j] + tree.fixed[i, 27 + j]


@procedure
def _of_ball(tree, i, q, k, X, W):
    """The rotation of X of a step that reads a unit quaternion at q[k]."""
    x, y, z, w = q[k, 0:W], q[k + 1, 0:W], q[k + 2, 0:W], q[k + 3, 0:W]
    xx, xy, xz = 1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)
    yx, yy, yz = 2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)
    zx, zy, zz = 2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)
    for r in range(3):
        a, b, c = tree.fixed[i, 3 * r], tree.fixed[i, 3 * r + 1], tree.fixed[i, 3 * r + 2]
        put(X, i, 3 * r, xx * a + yx * b + zx * c, xy * a + yy * b + zy * c, xz * a + yz * b + zz * c, W)


@procedure
def _at_lengths(tree, i, q, k, X, W):
    """The translation of X of a step that reads three lengths at q[k]."""
    x, y, z = q[k, 0:W], q[k + 1, 0:W], q[k + 2, 0:W]
    for r in range(3):
        a, b, c = tree.fixed[i, 3 * r], tree.fixed[i, 3 * r + 1], tree.fixed[i, 3 * r + 2]
        X[i, 9 + r, 0:W] = x * a + y * b + z * c + tree.fixed[i, 27 + r]


@procedure
def _place_one(tree, places, q, i, W):
    """X of a step."""
    kind, k, none = tree.kinds[i], tree.starts[i], broadcast(0.0, W)
    c, s = places.cosines[i * W : i * W + W], places.sines[i * W : i * W + W]
    if kind == 0:
        _linear_in(tree, i, c, s, places.angles[i * W : i * W + W], none, places.X, W)
    elif kind == 1:
        u = q[k, 0:W] * tree.fixed[i, 36] + tree.fixed[i, 37]
        _linear_in(tree, i, none, none, u, none, places.X, W)
    elif kind == 2:
        _linear_in(tree, i, q[k, 0:W], q[k + 1, 0:W], none, none, places.X, W)
    elif kind == 3:
        _linear_in(tree, i, c, s, q[k, 0:W], q[k + 1, 0:W], places.X, W)
    elif kind == 4:
        _linear_in(tree, i, q[k + 2, 0:W], q[k + 3, 0:W], q[k, 0:W], q[k + 1, 0:W], places.X, W)
    else:
        _linear_in(tree, i, none, none, none, none, places.X, W)
        if kind != 6:
            _at_lengths(tree, i, q, k, places.X, W)
        if kind == 6:
            _of_ball(tree, i, q, k, places.X, W)
        elif kind == 7:
            _of_ball(tree, i, q, k + 3, places.X, W)


@procedure
def place(tree, places, q, W):
    """X of every step."""
    _read_angles(tree, places, q, W)
    for i in range(1, len(tree.parents)):
        _place_one(tree, places, q, i, W)


@procedure
def multiply(A, i, B, k, C, o, W):
    """C[o] = A[i] B[k] for placements; C[o] is neither of them."""
    for j in range(3):
        x, y, z = rotate(A, i, B[k, j, 0:W], B[k, j + 3, 0:W], B[k, j + 6, 0:W], W)
        C[o, j, 0:W] = x
        C[o, j + 3, 0:W] = y
        C[o, j + 6, 0:W] = z
    px, py, pz = three(B, k, 9, W)
    x, y, z = rotate(A, i, px, py, pz, W)
    put(C, o, 9, A[i, 9, 0:W] + x, A[i, 10, 0:W] + y, A[i, 11, 0:W] + z, W)


@procedure
def place_in_world(tree, places, q, W):
    """X and T of every step."""
    place(tree, places, q, W)
    chain_placements(tree, places, W)


@procedure
def chain_placements(tree, places, W):
    """T of every step, from X."""
    for i in range(1, len(tree.parents)):
        multiply(places.T, tree.parents[i], places.X, i, places.T, i, W)
