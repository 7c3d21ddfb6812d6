"""Time-optimal parameterisation: a path in, the fastest trajectory on it under limits out."""

from __future__ import annotations

from functools import lru_cache
from typing import Any, Literal

import numpy as np

from ulna.errors import InputError, UnknownName
from ulna.trajectory.base import Trajectory
from ulna.trajectory.compose import Retimed
from ulna.trajectory.constraints import (
    Rows,
    acceleration_rows,
    bounds_of,
    joined,
    speed_cap,
    torque_rows,
)
from ulna.trajectory.infeasible import Problem
from ulna.trajectory.inputs import rows
from ulna.trajectory.polynomial import Polynomial
from ulna.trajectory.reach import controllable, fastest, reachable
from ulna.trajectory.space import Poses, Vectors, model_of, require_configurations
from ulna.trajectory.waypoints import cubic_spline
from ulna.typing import ArrayLike, Floats

_SCHEMES = ("interpolation", "collocation")
_PARAMETER = Vectors(("s",))
_ROUNDING = 1e-10  # what part of the greatest squared rate an interval may lack to be one


def time_optimal(
    path: Trajectory | ArrayLike,
    robot: Any = None,
    *,
    velocity: ArrayLike | None = None,
    acceleration: ArrayLike | None = None,
    torque: ArrayLike | None = None,
    grid: int | ArrayLike = 100,
    start_rate: float = 0.0,
    end_rate: float = 0.0,
    scheme: Literal["interpolation", "collocation"] = "interpolation",
) -> Retimed:
    """The fastest motion along a path under limits of joint speed, acceleration and torque.

    The path's own time is only a parameter s, from 0 to its `duration`; any trajectory of joints will do.
    Torques are those of the rigid robot with armature, without friction.

    Args:
        path: A trajectory of joints, twice differentiable; or way-points (k + 1, n), joined by a cubic
            spline that leaves the first and reaches the last along the line to its neighbour.
        robot: A Robot or a Model; it gives the limits of speed and torque that are not given here.
        velocity: Limits of speed: one, (n,), or (2, n) least and greatest [rad/s or m/s].
        acceleration: Limits of acceleration, likewise [rad/s^2 or m/s^2].
        torque: Limits of torque, likewise [N m or N]; needs a robot. np.inf leaves torques out.
        grid: How many segments the path is cut into, evenly but with points moved onto its knots; or the grid itself,
            increasing from 0 to the path's duration.
        start_rate: Rate of s at the start [1/s].
        end_rate: Rate of s at the end [1/s].
        scheme: Where limits of acceleration and torque hold: "interpolation", at both ends of each segment under the
            segment's constant s''; "collocation", at its start only, which is faster and exceeds limits a little more.

    Returns:
        The path under its law of time; `.duration` is exact for the law, and `.law` holds s(t).

    Raises:
        InputError: No way to keep the limits; names the place on the path and the limits that exclude each other.

    Between grid points limits may be exceeded in second order of the grid's width; `ulna.trajectory.check` tells.
    Source: Pham & Pham, A new approach to time-optimal path parameterization based on reachability analysis (2018).
    """
    if scheme not in _SCHEMES:
        raise UnknownName("scheme", scheme, _SCHEMES)
    curve = path if isinstance(path, Trajectory) else _spline(path)
    if isinstance(curve.space, Poses):
        raise InputError("The path is one of poses; expected joints: follow(path, ik) makes them.")
    n = curve.space.n
    model = None if robot is None else model_of(robot)
    if model is not None:
        require_configurations("path", curve.space, model)
    if torque is not None and model is None:
        raise InputError("`torque` was given without `robot`, whose dynamics they take; pass it.")
    names = curve.space.names if model is None else model.velocity_names
    speeds = bounds_of("velocity", _or_limit(velocity, model, "velocity_limit"), n)
    s, D = _grid(grid, curve)
    q, tangent, curvature = curve._at(s, 2)
    limits = _rows(model, (q, tangent, curvature), acceleration, torque)
    cap = speed_cap(tangent, speeds)
    both_ends = scheme == "interpolation"
    problem = Problem(s, D, names, tangent, speeds, limits, both_ends, cap)
    problem.check_rate("end", end_rate, len(s) - 1, 0.0, cap[-1])
    back, ahead = reachable(limits.arrays, D, both_ends)
    K = controllable(back, cap, end_rate * end_rate)
    empty = ~(K[:, 0] <= K[:, 1] + _ROUNDING * abs(K[:, 1].max()))
    if empty.any():
        problem.refuse_empty(K, int(np.flatnonzero(empty)[-1]))
    problem.check_rate("start", start_rate, 0, *K[0])
    x = fastest(ahead, K, start_rate * start_rate)[: len(s)]
    return Retimed(curve, _law(s, D, x), "time-optimal")


def _grid(grid: Any, path: Trajectory) -> tuple[Floats, Floats]:
    """The grid points, and twice the lengths of its segments."""
    length = path.duration
    if isinstance(grid, (int, np.integer)) and grid >= 2:
        return _even_grid(int(grid), length, path.knots.tobytes())
    s = np.array(grid, dtype=float)
    if s.ndim == 0:
        raise InputError(f"`grid` is {grid!r}; expected a count of at least 2 segments, or the grid.")
    if s.ndim == 1 and s.size > 2 and s[0] == 0.0 and abs(s[-1] - length) <= 1e-9 * length:
        s[-1] = length
        D = 2.0 * (s[1:] - s[:-1])
        if D.min() > 0.0:
            return s, D
    raise InputError(
        f"`grid` does not increase from 0 to {length:.6g}, the path's duration, by at least 2 steps."
    )


@lru_cache(maxsize=64)
def _even_grid(count: int, length: float, knots: bytes) -> tuple[Floats, Floats]:
    """An even grid, its points moved onto the path's knots where they are near: there its shape may change sharply."""
    s = np.linspace(0.0, length, count + 1)
    inner = np.frombuffer(knots)[1:-1]
    nearest = np.rint(inner * (count / length)).astype(int)
    moved = s.copy()
    moved[nearest] = inner
    if np.unique(nearest).size == nearest.size and moved[0] == 0.0 and moved[-1] == length:
        s = moved
    D = 2.0 * np.diff(s)
    s.flags.writeable = D.flags.writeable = False
    return s, D


def _spline(points: ArrayLike) -> Polynomial:
    """A cubic spline through way-points whose tangent is nowhere zero at the ends."""
    q = rows("path", points)
    once = cubic_spline(q, duration=1.0)
    slopes = np.diff(q, axis=0) / np.diff(once.times)[:, None]
    return cubic_spline(q, once.times, v0=slopes[0], v1=slopes[-1])


def _or_limit(given: ArrayLike | None, model: Any, name: str) -> ArrayLike | None:
    """Limits that were given, or those of the model, where zero stands for none."""
    if given is not None or model is None:
        return given
    limit = getattr(model, name)
    return np.where(limit > 0.0, limit, np.inf)


def _rows(model: Any, at: tuple[Floats, ...], acceleration: Any, torque: Any) -> Rows:
    q, tangent, curvature = at
    n, found = tangent.shape[1], []
    limits = bounds_of("acceleration", acceleration, n)
    if limits.any:
        found.append(acceleration_rows(tangent, curvature, limits))
    limits = bounds_of("torque", _or_limit(torque, model, "effort_limit"), n)
    if limits.any:
        found.append(torque_rows(model, q, tangent, curvature, limits))
    if not found:
        raise InputError(
            "No limit of acceleration or torque is finite; with speeds alone no motion starts from rest."
        )
    return joined(found)


def _law(s: Floats, D: Floats, x: Floats) -> Polynomial:
    """s(t) of constant acceleration on each segment."""
    rate = np.sqrt(x)
    mean = rate[:-1] + rate[1:]
    if not mean.min() > 0.0:
        k = int(np.argmin(mean))
        raise InputError(
            f"The motion comes to rest on the path at s = {s[k]:.6g} of {s[-1]:.6g} and cannot leave it. "
            "Look for limits that are too low there, or a way-point at which the path turns back."
        )
    times, c = np.zeros(x.size), np.empty((D.size, 3, 1))
    np.cumsum(D / mean, out=times[1:])
    c[:, 0, 0], c[:, 1, 0] = s[:-1], rate[:-1]
    np.divide(x[1:] - x[:-1], 2.0 * D, out=c[:, 2, 0])
    return Polynomial(times, c, _PARAMETER, "law")
