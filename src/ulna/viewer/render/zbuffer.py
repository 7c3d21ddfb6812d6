"""Which triangle is seen at each sample of a picture: projection, clipping and the z-buffer."""

from __future__ import annotations

import numpy as np

from ulna.typing import Array, Floats

_CHUNK_SAMPLES = 2_000_000  # samples of the boxes around triangles


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
    """The nearest triangle at every sample, row by row of each triangle, so that slivers cost what they cover.

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
    x, y = points[:, :, 0].astype(float), points[:, :, 1].astype(float)
    (x_low, x_high), (y_low, y_high) = _extent(x), _extent(y)
    area = (x[:, 1] - x[:, 0]) * (y[:, 2] - y[:, 0]) - (y[:, 1] - y[:, 0]) * (x[:, 2] - x[:, 0])
    # first and last row, and column, of samples whose middle can lie inside
    top, bottom = np.maximum(np.ceil(y_low - 0.5), 0), np.minimum(np.floor(y_high - 0.5), height - 1)
    left, right = np.maximum(np.ceil(x_low - 0.5), 0), np.minimum(np.floor(x_high - 0.5), width - 1)
    drawn = np.flatnonzero((np.abs(area) > 1e-9) & (top <= bottom) & (left <= right))
    rows = (bottom - top)[drawn].astype(np.int64) + 1
    cells = np.cumsum(rows * ((right - left)[drawn] + 1))
    part = 0
    while part < len(drawn):  # as many triangles at once as memory is well used for
        done = cells[part - 1] if part else 0.0
        end = max(int(np.searchsorted(cells, done + _CHUNK_SAMPLES, side="right")), part + 1)
        chosen = drawn[part:end]
        bounds = x[chosen], y[chosen], area[chosen], top[chosen].astype(np.int64), rows[part:end]
        _rasterise_rows(keys, *bounds, nearness[chosen].astype(float), owner[chosen], width)
        part = end
    nearness_of = (keys >> np.uint64(32)).astype(np.uint32).view(np.float32)
    return nearness_of.reshape(height, width), (keys & np.uint64(0xFFFFFFFF)).astype(np.int64).reshape(
        height, width
    )


def _rasterise_rows(
    keys: Array,
    x: Array,
    y: Array,
    area: Array,
    top: Array,
    rows: Array,
    near: Array,
    owner: Array,
    width: int,
) -> None:
    """Enter triangles into the keys, each with `rows` rows of samples from `top` on."""
    which, step = _repeat_indices(rows)
    row = top[which] + step
    at = row + 0.5
    low, high = np.full(len(row), -0.5), np.full(len(row), width - 0.5)
    for k in range(3):  # an edge bounds the row from the left or from the right
        x0, y0 = x[:, k], y[:, k]
        dx, dy = x[:, (k + 1) % 3] - x0, y[:, (k + 1) % 3] - y0
        level = np.abs(dy) < 1e-12
        slope = np.where(level, 0.0, dx / np.where(level, 1.0, dy))
        crossing = (x0 - slope * y0)[which] + slope[which] * at
        bounds_left, bounds_right = (~level & (dy * area < 0))[which], (~level & (dy * area > 0))[which]
        np.copyto(low, np.maximum(low, crossing), where=bounds_left)
        np.copyto(high, np.minimum(high, crossing), where=bounds_right)
    first = np.maximum(np.ceil(low - 0.5), 0).astype(np.int64)
    last = np.minimum(np.floor(high - 0.5), width - 1).astype(np.int64)
    lines = np.flatnonzero(last >= first)
    # nearness over the screen: near_0 + (x - x_0) across + (y - y_0) down
    one, two = near[:, 1] - near[:, 0], near[:, 2] - near[:, 0]
    across = (one * (y[:, 2] - y[:, 0]) - two * (y[:, 1] - y[:, 0])) / area
    down = (two * (x[:, 1] - x[:, 0]) - one * (x[:, 2] - x[:, 0])) / area
    origin = near[:, 0] - x[:, 0] * across - y[:, 0] * down
    which, row, first, at = which[lines], row[lines], first[lines], at[lines]
    at_first = origin[which] + (first + 0.5) * across[which] + at * down[which]
    line, step = _repeat_indices(last[lines] - first + 1)
    value = at_first[line] + step * across[which][line]
    bits = np.maximum(value, 1e-30).astype(np.float32).view(np.uint32).astype(np.uint64)
    key = (bits << np.uint64(32)) | owner[which].astype(np.uint64)[line]
    np.maximum.at(keys, (row * width + first)[line] + step, key)


def _extent(v: Array) -> tuple[Array, Array]:
    """The least and the largest of three columns; many times faster than a reduction over so few."""
    a, b, c = v.T
    return np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)


def _repeat_indices(counts: Array) -> tuple[Array, Array]:
    """Every number as often as its count says, and how often it occurred before: 0 0 1 1 1 and
    0 1 0 1 2 for [2, 3].
    """
    which = np.repeat(np.arange(len(counts)), counts)
    return which, np.arange(len(which)) - np.repeat(np.cumsum(counts) - counts, counts)
