"""Grids along a path: every knot is a grid point, and each segment is sampled from inside.

| symbol | meaning | shape | unit |
|---|---|---|---|
| s, h, D | grid points, lengths of segments, twice those | (N + 1,), (N,), (N,) | [1] |
| q, p', p'' | configurations, first and second derivatives at the nodes of each segment | (N, 5, n) | [rad] |

The first and the last node of a segment lie inside it by a billionth of its length, so that at a knot, where p'' may
jump, each segment sees its own side.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

from ulna.data_classes import dataclass
from ulna.errors import InputError
from ulna.trajectory.quartics import NODES
from ulna.trajectory.trajectory import Trajectory
from ulna.typing import Floats

_KNOT_OFFSETS = np.array([1e-9, 0.0, 0.0, 0.0, -1e-9])
_LEAST, _FEWEST = 4, 2  # segments of a piece of the path: usually, and where the pieces are many
_SAME_KNOT = 1e-12  # knots nearer to each other than this part of the path are one
_LAYERS = 0.5 ** np.arange(8, 0, -1)  # how the segment next to a place of rest is divided


@dataclass(frozen=True, eq=False)
class Sampled:
    """A path on a grid."""

    s: Floats
    D: Floats
    q: Floats
    tangent: Floats
    curvature: Floats


def sampled(path: Trajectory, s: Floats) -> Sampled:
    """The path at the nodes of each segment.

    Args:
        path: The path.
        s: Grid points, (N + 1,).

    Returns:
        Configurations and derivatives at the five nodes of each segment.

    Raises:
        InputError: The path is not finite, or jumps at a grid point; says where.
    """
    h = s[1:] - s[:-1]
    q, tangent, curvature = at_nodes(path, s, NODES + _KNOT_OFFSETS)
    if not np.isfinite(curvature.sum()):
        k = int(np.argmax(~np.isfinite(curvature).all(axis=(1, 2))))
        raise InputError(
            f"The path has no finite second derivative near s = {s[k]:.6g} of {s[-1]:.6g}; "
            "expected a path whose second derivative is finite on each side of every knot."
        )
    return Sampled(s, 2.0 * h, q, tangent, curvature)


def at_nodes(path: Trajectory, s: Floats, nodes: Floats) -> tuple[Floats, ...]:
    """Configuration and derivatives at nodes of each segment, (N, nodes, ...) each.

    Args:
        path: The path.
        s: Grid points, (N + 1,).
        nodes: Places in parts of a segment, (nodes,).

    Returns:
        q, p' and p'', (N, nodes, ...) each.
    """
    places = s[:-1, None] + (s[1:] - s[:-1])[:, None] * nodes
    return tuple(row.reshape(*places.shape, -1) for row in path._at(places.reshape(-1), 2))


def first_grid(grid: Any, path: Trajectory) -> Floats:
    """The grid to start with: even between knots; or the given one with all knots.

    Args:
        grid: Number of segments, or grid points (N + 1,) from 0 to the path's duration.
        path: The path.

    Returns:
        Grid points, (N + 1,), with all knots of the path among them.

    Raises:
        InputError: Neither a count nor a grid of this path.
    """
    length, knots = path.duration, path.knots
    if isinstance(grid, (int, np.integer)) and grid >= 2:
        return _even_grid(int(grid), length, _distinct(knots, length).tobytes())
    s = np.array(grid, dtype=float)
    if s.ndim == 0:
        raise InputError(f"`grid` is {grid!r}; expected a count of at least 2 segments, or the grid.")
    if s.ndim == 1 and s.size > 2 and s[0] == 0.0 and abs(s[-1] - length) <= 1e-9 * length:
        s[-1] = length
        if (s[1:] > s[:-1]).all():
            return _with_knots(s, _distinct(knots, length))
    raise InputError(
        f"`grid` does not increase from 0 to {length:.6g}, the path's duration, by at least 2 steps."
    )


def halved(s: Floats, chosen: Any) -> Floats:
    """The grid with the chosen segments (N,) cut in halves.

    Args:
        s: Grid points, (N + 1,).
        chosen: Which segments, (N,) of bool.

    Returns:
        Grid points, increasing, (M + 1,).
    """
    return np.sort(np.concatenate([s, 0.5 * (s[:-1] + s[1:])[chosen]]))


def graded(s: Floats, first: Any, last: Any) -> Floats:
    """The grid with the segments in layers that the path rests at the first or the last node of, (N,) of bool each.

    There the rate of s grows without bound as the motion leaves or reaches rest; layers that halve follow it.

    Args:
        s: Grid points, (N + 1,).
        first: Segments at whose first node the path rests, (N,) of bool.
        last: Segments at whose last node it rests, (N,) of bool.

    Returns:
        Grid points, increasing, (M + 1,).
    """
    after, before = np.flatnonzero(first), np.flatnonzero(last) + 1
    layers = [
        (s[after, None] + (s[after + 1] - s[after])[:, None] * _LAYERS).reshape(-1),
        (s[before, None] + (s[before - 1] - s[before])[:, None] * _LAYERS).reshape(-1),
    ]
    return np.unique(np.concatenate([s, *layers]))


def _distinct(knots: Floats, length: float) -> Floats:
    """The knots, one of those that differ by rounding alone, from 0 to the length."""
    if (knots[1:] - knots[:-1] > _SAME_KNOT * length).all():
        return knots
    inner = knots[(knots > _SAME_KNOT * length) & (knots < length * (1.0 - _SAME_KNOT))]
    distinct = inner[np.append(True, np.diff(inner) > _SAME_KNOT * length)] if inner.size else inner
    return np.concatenate([[0.0], distinct, [length]])


@lru_cache(maxsize=64)
def _even_grid(count: int, length: float, knots: bytes) -> Floats:
    ends = np.frombuffer(knots)
    pieces = ends.size - 1
    least = _LEAST if _LEAST * pieces <= max(count, 40) else _FEWEST
    number = np.maximum(np.rint(np.diff(ends) * (count / length)).astype(int), least)
    parts = [
        np.linspace(a, b, m, endpoint=False) for a, b, m in zip(ends[:-1], ends[1:], number, strict=True)
    ]
    s = np.append(np.concatenate(parts), length)
    s.flags.writeable = False
    return s


def _with_knots(s: Floats, knots: Floats) -> Floats:
    """A given grid with the path's knots in it, and at least two segments in each piece."""
    near = np.minimum(np.searchsorted(s, knots), s.size - 1)
    if (s[near] == knots).all() and (near[1:] - near[:-1] > 1).all():
        return s
    for side in (near, np.maximum(near - 1, 0)):
        same = np.abs(s[side] - knots) <= 1e-9 * s[-1]
        s[side[same]] = knots[same]
    s = np.unique(np.concatenate([s, knots]))
    lonely = np.diff(np.searchsorted(s, knots)) == 1
    return np.unique(np.concatenate([s, 0.5 * (knots[:-1] + knots[1:])[lonely]]))
