"""Which triangle is seen at each sample of a picture: projection, clipping and the z-buffer."""

from __future__ import annotations

import numpy as np

from ulna.typing import Array, Floats

_SIZES = (1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64)
_CHUNK = 3_000_000


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
    whole = np.flatnonzero(count == 3)
    pieces, owner = [corners[whole]], [whole]
    one, two = np.flatnonzero(count == 1), np.flatnonzero(count == 2)
    if len(one):  # turn the corner that stays to the front, and shorten both its edges
        turned = _turn(corners[one], beyond[one].argmax(axis=1))
        pieces.append(
            np.stack(
                [
                    turned[:, 0],
                    _cut(turned[:, 0], turned[:, 1], near),
                    _cut(turned[:, 0], turned[:, 2], near),
                ],
                1,
            )
        )
        owner.append(one)
    if len(two):  # turn the corner that goes to the front; a four-sided piece stays
        turned = _turn(corners[two], (~beyond[two]).argmax(axis=1))
        p, q = _cut(turned[:, 1], turned[:, 0], near), _cut(turned[:, 2], turned[:, 0], near)
        pieces += [np.stack([p, turned[:, 1], turned[:, 2]], 1), np.stack([p, turned[:, 2], q], 1)]
        owner += [two, two]
    return np.concatenate(pieces), np.concatenate(owner)


def _turn(corners: Floats, front: Array) -> Floats:
    order = (front[:, None] + np.arange(3)) % 3
    return np.take_along_axis(corners, order[:, :, None], axis=1)


def _cut(inside: Floats, outside: Floats, near: float) -> Floats:
    t = (inside[:, 2] - near) / np.maximum(inside[:, 2] - outside[:, 2], 1e-30)
    return inside + t[:, None] * (outside - inside)


def rasterise(points: Array, nearness: Array, owner: Array, width: int, height: int) -> tuple[Array, Array]:
    """The nearest triangle at every sample.

    Args:
        points: Corners on the screen in samples, x to the right and y down, shape (m, 3, 2).
        nearness: A positive number at each corner that is linear on the screen and larger nearer by, shape
            (m, 3).
        owner: A number below 2**32 for each triangle, to be found again, shape (m,).
        width: Samples across.
        height: Samples down.

    Returns:
        The nearness of what is seen, 0 where there is nothing, and its owner; shape (height, width) each.
    """
    # one 64-bit key holds both: the bits of a positive float32 sort as the number does
    keys = np.zeros(height * width, dtype=np.uint64)
    p = points.astype(np.float32)
    edge_1, edge_2 = p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]
    area = edge_1[:, 0] * edge_2[:, 1] - edge_1[:, 1] * edge_2[:, 0]
    low = np.ceil(p.min(axis=1) - 0.5)  # first and last sample whose centre can lie inside
    high = np.floor(p.max(axis=1) - 0.5)
    low = np.maximum(low, 0.0)
    high = np.minimum(high, np.array([width - 1, height - 1], dtype=np.float32))
    span = (high - low).max(axis=1) + 1
    drawn = (np.abs(area) > 1e-9) & (high >= low).all(axis=1)
    smaller = 0
    for size in _SIZES:
        chosen = np.flatnonzero(drawn & (span > smaller) & (span <= size))
        smaller = size
        step = max(_CHUNK // (size * size), 1)
        for start in range(0, len(chosen), step):
            part = chosen[start : start + step]
            _fill(keys, p, edge_1, edge_2, area, nearness, owner, low, part, size, size, width, height)
    for triangle in np.flatnonzero(drawn & (span > _SIZES[-1])):
        w, h = (high[triangle] - low[triangle]).astype(int) + 1
        part = np.array([triangle])
        band = max(_CHUNK // int(w), 1)
        for top in range(0, int(h), band):
            corner = low.copy() if h > band else low
            corner[triangle, 1] += top
            rows = min(band, int(h) - top)
            _fill(keys, p, edge_1, edge_2, area, nearness, owner, corner, part, int(w), rows, width, height)
    found = (keys >> np.uint64(32)).astype(np.uint32).view(np.float32)
    return found.reshape(height, width), (keys & np.uint64(0xFFFFFFFF)).astype(np.int64).reshape(
        height, width
    )


def _fill(
    keys: Array,
    p: Array,
    edge_1: Array,
    edge_2: Array,
    area: Array,
    nearness: Array,
    owner: Array,
    low: Array,
    part: Array,
    across: int,
    down: int,
    width: int,
    height: int,
) -> None:
    """Enter the triangles `part` into the keys, each with a block of `across` x `down` samples at `low`."""
    origin = low[part] + np.float32(0.5) - p[part, 0]
    x = origin[:, 0, None, None] + np.arange(across, dtype=np.float32)
    y = origin[:, 1, None, None] + np.arange(down, dtype=np.float32)[:, None]
    e1, e2, inverse = edge_1[part], edge_2[part], (1.0 / area[part])[:, None, None]
    u = (x * e2[:, 1, None, None] - y * e2[:, 0, None, None]) * inverse
    v = (y * e1[:, 0, None, None] - x * e1[:, 1, None, None]) * inverse
    inside = (u >= 0) & (v >= 0) & (u + v <= 1)
    column = low[part, 0].astype(np.int64)[:, None, None] + np.arange(across)
    row = low[part, 1].astype(np.int64)[:, None, None] + np.arange(down)[:, None]
    inside &= (column < width) & (row < height)
    which, j, i = np.nonzero(inside)
    near = nearness[part].astype(np.float32)
    value = near[which, 0] + u[which, j, i] * (near[which, 1] - near[which, 0])
    value += v[which, j, i] * (near[which, 2] - near[which, 0])
    value = np.maximum(value, np.float32(1e-30))
    key = (value.astype(np.float32).view(np.uint32).astype(np.uint64) << np.uint64(32)) | owner[part][
        which
    ].astype(np.uint64)
    np.maximum.at(keys, row[which, j, 0] * width + column[which, 0, i], key)
