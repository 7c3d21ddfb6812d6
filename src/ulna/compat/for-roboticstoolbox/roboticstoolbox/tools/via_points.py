"""Motions through points, whose corners are cut by quintic blends."""

from __future__ import annotations

import math
from collections import namedtuple
from collections.abc import Sequence
from typing import Any

import numpy as np

from roboticstoolbox.tools.sampled import Trajectory
from ulna import trajectory
from ulna.checks.arrays import number_or_array
from ulna.errors import InputError
from ulna.typing import Floats

mstraj_info = namedtuple("mstraj_info", ["slowest", "segtime", "clock"])


def mstraj(
    viapoints: Any,
    dt: float,
    tacc: Any,
    qdmax: Any = None,
    tsegment: Any = None,
    q0: Any = None,
    qd0: Any = None,
    qdf: Any = None,
    verbose: bool = False,
) -> Trajectory:
    """Straight from point to point, corners cut by quintic blends of `tacc` seconds, sampled every `dt`.

    Args:
        viapoints: Points by rows, (k, n); the first is the start unless `q0` is given.
        dt: Time between rows [s].
        tacc: Time of a blend [s], one for all or one for each segment; with 0 velocities jump at the points.
        qdmax: Greatest speeds, one or (n,).
        tsegment: Times of segments instead, (k - 1,) [s].
        q0: Start, (n,).
        qd0: Velocity at the start, (n,).
        qdf: Velocity at the end, (n,).
        verbose: Whether to print each segment.

    Returns:
        Positions, (m, n).

    Raises:
        InputError: Both `qdmax` and `tsegment`, or neither, or times that do not fit.
    """
    points = np.atleast_2d(np.asarray(viapoints, dtype=float))
    if q0 is not None:
        points = np.vstack([np.asarray(q0, dtype=float), points])
    segments, n = len(points) - 1, points.shape[1]
    blends = np.ceil(number_or_array("tacc", tacc, segments) / dt - 1e-9) * dt
    v = number_or_array("qd0", 0.0 if qd0 is None else qd0, n)
    halves = np.ceil(blends / 2 / dt - 1e-9) * dt
    corners = [*halves[:1], *blends[1:]]
    times = _segment_times(np.abs(np.diff(points, axis=0)), corners, blends, dt, qdmax, tsegment)
    p, clock, half, duration = points[0], 0, 0.0, 0.0
    rows: list[Any] = []
    arrive, info = np.zeros(segments), []
    for k, (a, b, half, corner) in enumerate(zip(points, points[1:], halves, corners, strict=False)):
        slowest, duration = times[k]
        info.append(mstraj_info(slowest, duration, clock))
        arrive[k] = clock + duration + (half if k else 0.0)
        rate = (b - a) / duration
        if verbose:
            print(f"segment {k}: from {a} to {b} in {duration:.6g} s, slowest axis {slowest}")
        rows += _corner(p, v, a + half * rate, rate, corner, dt)
        line = np.arange(round(half / dt) + 1, round((duration - half) / dt) + 1) * dt
        rows += [(a + t * rate, rate, np.zeros(n)) for t in line]
        p, v = rows[-1][0] if rows else a, rate
        clock += float(corner + dt * len(line))
    rows += _corner(p, v, points[-1], number_or_array("qdf", 0.0 if qdf is None else qdf, n), half, dt)
    out = _sampled(rows, dt)
    out.arrive, out.via = arrive, points[1:]
    out.info = [*info, mstraj_info(None, duration, clock)]
    return out


def _segment_times(
    lengths: Floats, corners: Sequence[float], blends: Floats, dt: float, qdmax: Any, tsegment: Any
) -> list[tuple[float, float]]:
    """For each segment the axis that takes longest, nan where times are given, and how long it takes [s]."""
    if (qdmax is None) == (tsegment is None):
        raise InputError("mstraj takes `qdmax` or `tsegment`, one of them.")
    if tsegment is not None:
        return [(math.nan, float(t)) for t in number_or_array("tsegment", tsegment, len(lengths))]
    speeds, times = number_or_array("qdmax", qdmax, lengths.shape[1]), []
    for length, corner, blend in zip(lengths, corners, blends, strict=True):
        needed = corner + np.ceil(length / speeds / dt - 1e-9) * dt
        times.append((int(needed.argmax()), np.maximum(needed.max(), 2 * blend)))
    return times


def _sampled(rows: list[Any], dt: float) -> Any:
    """The trajectory of rows of position, velocity and acceleration, `dt` apart."""
    q, rates, rises = (np.array(part) for part in zip(*rows, strict=True))
    return Trajectory("mstraj", dt * np.arange(len(q)), q, rates, rises, istime=True)


def _corner(a: Floats, v: Floats, b: Floats, w: Floats, duration: float, dt: float) -> list[Any]:
    """Rows of the quintic from `a` at the velocity `v` to `b` at `w`, without the first."""
    at = np.arange(1, round(duration / dt) + 1) * dt
    return list(zip(*trajectory.quintic_states(a, b, duration, at, v, w), strict=True)) if at.size else []
