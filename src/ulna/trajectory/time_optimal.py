"""Time-optimal parameterisation: a path in, the fastest trajectory on it under limits out."""

from __future__ import annotations

from functools import partial
from typing import Any, Literal

import numpy as np

from ulna.checks.arrays import known_limits
from ulna.checks.labels import in_order
from ulna.errors import InputError, UnknownName
from ulna.model.of_robot import model_of
from ulna.trajectory.compose import Retimed
from ulna.trajectory.constraint_rows import Bounds, Rows, acceleration_rows, bounds_of, joined, torque_rows
from ulna.trajectory.discretization import Task
from ulna.trajectory.grids import first_grid
from ulna.trajectory.inputs import rows
from ulna.trajectory.polynomial import Polynomial
from ulna.trajectory.quartics import DEGREE
from ulna.trajectory.solver import solved
from ulna.trajectory.space import Poses, Vectors, require_configurations
from ulna.trajectory.trajectory import Trajectory
from ulna.trajectory.waypoints import cubic_spline
from ulna.typing import ArrayLike, Floats

_SCHEMES = ("interpolation", "collocation")
_PARAMETER = Vectors(("s",))


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

    The path's own time is only a parameter s, from 0 to its `duration`; any trajectory of joints will do. Limits hold
    at every time, not only at grid points: none is exceeded by more than a millionth of it. At corners of the path,
    where its tangent jumps, the motion stops. Torques are those of the rigid robot with armature, without friction.

    Args:
        path: A trajectory of joints, twice differentiable; or way-points (k + 1, n), joined by a cubic
            spline that leaves the first and reaches the last along the line to its neighbour.
        robot: A Robot or a Model; it gives the limits of speed and torque that are not given here.
        velocity: Limits of speed: one, (n,), or (2, n) least and greatest [rad/s or m/s].
        acceleration: Limits of acceleration, likewise, (), (n,) or (2, n) [rad/s^2 or m/s^2].
        torque: Limits of torque, likewise, (), (n,) or (2, n) [N m or N]; needs a robot. np.inf leaves torques
            out.
        grid: Number of segments that the path is cut into, evenly between its knots; or grid points (N + 1,),
            increasing from 0 to the path's duration. Knots are grid points in any case, and segments that are too
            long are halved.
        start_rate: Rate of s at the start [1/s].
        end_rate: Rate of s at the end [1/s].
        scheme: Where limits of acceleration and torque are imposed at first: "interpolation", at both ends of each
            segment; "collocation", at its start, and at its end too where they would be exceeded on the segment.

    Returns:
        The path under its law of time; `.duration` is exact for the law, `.law` holds s(t), and `.use` the greatest
        part of each limit that is used, as it was certified: 1 is at the limit.

    Raises:
        InputError: No way to keep the limits; names the place on the path and the limits that exclude each other. Or a
            path that does not move, or jumps.
        UnknownName: No such scheme.

    Source: Pham & Pham, A new approach to time-optimal path parameterization based on reachability analysis (2018).

    Example:
        >>> robot = ulna.load("panda")
        >>> q = robot.configurations["ready"]
        >>> best = ulna.trajectory.time_optimal([q, q + 0.2, q], robot, acceleration=10.0)
        >>> max(best.use.values()) <= 1.0 + 1e-6
        True
    """
    if scheme not in _SCHEMES:
        raise UnknownName("scheme", scheme, _SCHEMES)
    model = None if robot is None else model_of(robot)
    curve = _curve(path if model is None else in_order("path", path, model.position_names))
    if model is not None:
        require_configurations("path", curve.space, model)
    if torque is not None and model is None:
        raise InputError("`torque` was given without `robot`, whose dynamics they take; pass it.")
    names = curve.space.names if model is None else model.velocity_names
    speeds = bounds_of("velocity", _or_limit("velocity", velocity, model, "velocity_limit"), curve.space.n)
    hard = bounds_of("acceleration", _or_limit("acceleration", acceleration, model), curve.space.n)
    strong = bounds_of("torque", _or_limit("torque", torque, model, "effort_limit"), curve.space.n)
    if not (hard.any or strong.any):
        raise InputError(
            "No limit of acceleration or torque is finite; with speeds alone no motion starts from rest."
        )
    plain = isinstance(curve, Polynomial) and curve.coefficients.shape[1] <= DEGREE + 2
    task = Task(
        curve,
        names,
        speeds,
        partial(_rows, model, hard, strong, curve.duration),
        (start_rate, end_rate),
        scheme == "interpolation",
        plain and not strong.any,
    )
    solution = solved(task, first_grid(grid, curve))
    return Retimed(curve, _law(solution.s, solution.D, solution.x), "time-optimal", solution.use)


def _curve(path: Trajectory | ArrayLike) -> Trajectory:
    """The path as a trajectory of joints; way-points are joined by a spline."""
    curve = path if isinstance(path, Trajectory) else _spline(path)
    if isinstance(curve.space, Poses):
        raise InputError("The path is one of poses; expected joints: follow(path, ik) makes them.")
    return curve


def _spline(points: ArrayLike) -> Polynomial:
    """A cubic spline through way-points whose tangent is nowhere zero at the ends."""
    q = rows("path", points)
    once = cubic_spline(q, duration=1.0)
    slopes = np.diff(q, axis=0) / np.diff(once.times)[:, None]
    return cubic_spline(q, once.times, v0=slopes[0], v1=slopes[-1])


def _or_limit(name: str, limit: ArrayLike | None, model: Any, attribute: str = "") -> ArrayLike | None:
    """Limits that were passed, in order, or those of the model, where zero stands for none."""
    if model is None or (limit is None and not attribute):
        return limit
    if limit is not None:
        return in_order(name, limit, model.velocity_names)
    return known_limits(getattr(model, attribute))


def _rows(
    model: Any, hard: Bounds, strong: Bounds, length: float, q: Floats, tangent: Floats, curvature: Floats
) -> Rows:
    """The constraints of acceleration and torque at places of the path."""
    parts = []
    if hard.any:
        parts.append(acceleration_rows(tangent, curvature, hard))
    if strong.any:
        parts.append(torque_rows(model, q, tangent, curvature, strong, length))
    return joined(parts)


def _law(s: Floats, D: Floats, x: Floats) -> Polynomial:
    """s(t) of constant acceleration on each segment."""
    rate = np.sqrt(x)
    mean = rate[:-1] + rate[1:]
    if not mean.min() > 0.0:
        k = int(np.argmin(mean))
        raise InputError(
            f"The motion comes to rest on the path at s = {s[k]:.6g} of {s[-1]:.6g} and cannot leave it. "
            "Look for limits that are too low there, or nearly reached at rest."
        )
    times, c = np.zeros(x.size), np.empty((D.size, 3, 1))
    np.cumsum(D / mean, out=times[1:])
    c[:, 0, 0], c[:, 1, 0] = s[:-1], rate[:-1]
    np.divide(x[1:] - x[:-1], 2.0 * D, out=c[:, 2, 0])
    return Polynomial(times, c, _PARAMETER, "law")
