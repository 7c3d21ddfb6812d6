"""Which triangle is seen at each sample of a picture: projection, clipping and the z-buffer."""

from __future__ import annotations

import numpy as np

from ulna.typing import Array, Floats
from ulna.viewer.render.triangle_filling import fill_triangles


def clip_near(corners: Floats, near: float) -> tuple[Floats, Array]:
    """Triangles cut at the plane z = near, keeping what lies beyond it.

    Args:
        corners: Corners in the camera's frame with z the distance along the view, shape (m, 3, 3).
        near: Distance of the plane [m].

    Returns:
        The corners of the pieces, (k, 3, 3), and the number of the triangle that each piece is of, (k,).
    """
    beyond = corners[:, :, 2] > near
    count = beyond.sum(axis=1)
    in_front = np.flatnonzero(count == 3)
    pieces, owner = [corners[in_front]], [in_front]
    one, two = np.flatnonzero(count == 1), np.flatnonzero(count == 2)
    if len(one):  # turn the corner that stays to the front, and shorten both its edges
        turned = _rotate_corners(corners[one], beyond[one].argmax(axis=1))
        pieces.append(
            np.stack(
                [
                    turned[:, 0],
                    _edge_at_near(turned[:, 0], turned[:, 1], near),
                    _edge_at_near(turned[:, 0], turned[:, 2], near),
                ],
                1,
            )
        )
        owner.append(one)
    if len(two):  # turn the corner that goes to the front; a four-sided piece stays
        turned = _rotate_corners(corners[two], (~beyond[two]).argmax(axis=1))
        p, q = (
            _edge_at_near(turned[:, 1], turned[:, 0], near),
            _edge_at_near(turned[:, 2], turned[:, 0], near),
        )
        pieces += [np.stack([p, turned[:, 1], turned[:, 2]], 1), np.stack([p, turned[:, 2], q], 1)]
        owner += [two, two]
    return np.concatenate(pieces), np.concatenate(owner)


def _rotate_corners(corners: Floats, front: Array) -> Floats:
    order = (front[:, None] + np.arange(3)) % 3
    return np.take_along_axis(corners, order[:, :, None], axis=1)


def _edge_at_near(inside: Floats, outside: Floats, near: float) -> Floats:
    t = (inside[:, 2] - near) / np.maximum(inside[:, 2] - outside[:, 2], 1e-30)
    return inside + t[:, None] * (outside - inside)


def rasterise(points: Array, nearness: Array, owner: Array, width: int, height: int) -> tuple[Array, Array]:
    """The nearest triangle at every sample.

    Args:
        points: Corners on the screen in samples, x to the right and y down, shape (m, 3, 2).
        nearness: A positive number at each corner that is linear on the screen and larger nearer by, shape
            (m, 3).
        owner: A number for each triangle, to be found again, shape (m,); of equally near ones the largest is.
        width: Samples across.
        height: Samples down.

    Returns:
        The nearness of what is seen, 0 where there is nothing, and its owner; shape (height, width) each.
    """
    depth, owners = np.zeros((height, width), np.float32), np.zeros((height, width), np.int64)
    corners, near = (np.ascontiguousarray(a, dtype=float) for a in (points, nearness))
    numbers = np.ascontiguousarray(owner, dtype=np.int64)
    fill_triangles(corners, near, numbers, depth.reshape(-1), owners.reshape(-1), width, height)
    return depth, owners
