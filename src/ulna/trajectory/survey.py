"""Samples of a path: greatest rates by the limits of speed, and where the path rests, turns or jumps."""

from __future__ import annotations

from functools import lru_cache, reduce
from typing import Any

import numpy as np

from ulna.compiler import compile
from ulna.data_classes import dataclass
from ulna.errors import InputError
from ulna.numeric import maximum, minimum, where
from ulna.trajectory.constraint_rows import Bounds
from ulna.trajectory.grids import Sampled
from ulna.trajectory.quartics import NODES
from ulna.trajectory.reach import HUGE
from ulna.trajectory.trajectory import Trajectory
from ulna.typing import Array, Floats

TINY = 1e-140  # a path that moves a joint less than this in one unit does not move it
_REST = (
    1e-6,
    1e-3,
)  # tangent and curvature at a node, in parts of those at the middle: there the path is at rest

_JUMP = 1e-6  # greatest gap of a point [rad or m], and of a tangent in parts of the greatest one
_NONE = np.zeros(0, dtype=int)


@dataclass(frozen=True)
class Survey:
    """Numbers of each segment, (N,).

    Attributes:
        start: Greatest x at its start that keeps joint speeds at its nodes; huge where nothing limits it.
        end: The same at its end.
        slow_first: Whether the path does not move at the first node, though it does at the middle.
        slow_last: The same at the last node.
        rests_first: Whether it does not begin to move there either: its curvature vanishes too.
        rests_last: The same at the last node.
        size: Greatest entry of p' at the nodes.
    """

    start: Floats
    end: Floats
    slow_first: Any
    slow_last: Any
    rests_first: Any
    rests_last: Any
    size: Floats


def surveyed(at: Sampled, velocity: Bounds) -> Survey:
    """The survey of a path.

    Since x is linear on a segment, a node at the part w of it bounds x at the start by its own bound over 1 - w,
    and x at the end by that over w.

    Args:
        at: Samples of the path.
        velocity: Limits of speed.

    Returns:
        Greatest squared rates, and where the path rests; see `Survey`.
    """
    kernel = _kernel(at.tangent.shape[-1])
    start, end, first, last, size = kernel(at.tangent, at.curvature, velocity.low, velocity.high)
    return Survey(start, end, first > 0.0, last > 0.0, first > 1.0, last > 1.0, size)


def corners(path: Trajectory, at: Sampled, size: float) -> Any:
    """The grid points that are corners, where the tangent jumps, so that the motion must stop.

    Args:
        path: The path.
        at: Its samples.
        size: Greatest entry of its tangent [rad, m].

    Returns:
        Numbers of the grid points, (c,).

    Raises:
        InputError: The path itself jumps; says where.
    """
    if path.knots.size == 2:
        return _NONE
    q, tangent = at.q, at.tangent
    turn = _jump_kernel(tangent.shape[-1])(tangent[:-1, -1], tangent[1:, 0])
    tolerance = _JUMP + 1e-8 * size * at.D.max()
    gap = _jump_kernel(q.shape[-1])(q[:-1, -1], q[1:, 0]) if q.shape == tangent.shape else None
    if gap is None or gap.max() > tolerance:  # numbers may differ where points do not, as after a whole turn
        gap = np.abs(path.space.difference(q[:-1, -1], q[1:, 0])).max(axis=1)
    if gap.max() > tolerance:
        k = int(np.argmax(gap)) + 1
        raise InputError(
            f"The path jumps by {gap.max():.3g} at s = {at.s[k]:.6g} of {at.s[-1]:.6g}; expected a path without gaps."
        )
    return np.flatnonzero(turn > _JUMP * size) + 1


@lru_cache(maxsize=32)
def _jump_kernel(n: int) -> Any:
    return compile(lambda one, two: _size(one - two), one=(n,), two=(n,)).gufunc


@lru_cache(maxsize=32)
def _kernel(n: int) -> Any:
    def survey(tangent: Array, curvature: Array, low: Array, high: Array) -> tuple[Any, ...]:
        start, end = HUGE, HUGE
        for row, w in zip(tangent, NODES, strict=True):
            least = HUGE
            for t, lo, hi in zip(row, low, high, strict=True):
                rate = where(t < 0.0, lo, hi) / where(abs(t) < TINY, TINY, abs(t))
                least = minimum(least, rate * rate)
            start = minimum(start, least / (1.0 - w)) if w < 1.0 else start
            end = minimum(end, least / w) if w > 0.0 else end
        speeds, bends = [_size(row) for row in tangent], [_size(row) for row in curvature]
        rests = [
            where(speeds[k] <= _REST[0] * speeds[2], where(bends[k] <= _REST[1] * bends[2], 2.0, 1.0), 0.0)
            for k in (0, -1)
        ]
        return start, end, *rests, reduce(maximum, speeds)

    shapes: dict[str, Any] = dict.fromkeys(("tangent", "curvature"), (len(NODES), n))
    return compile(survey, **shapes, low=(n,), high=(n,)).gufunc


def _size(row: Array) -> Any:
    return reduce(maximum, [abs(x) for x in row])
