"""Kinematic simulation: a robot that follows joint velocities exactly, up to its position limits."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np

from ulna import numeric
from ulna.checks.arrays import shaped_array
from ulna.checks.values import checked_robot, number
from ulna.compiler import compile
from ulna.model import Model
from ulna.spatial import so3_exp
from ulna.typing import Array, ArrayLike, Floats


@lru_cache(maxsize=64)
def limited_step(n: int) -> Callable[..., tuple[Floats, Floats, float]]:
    """A kernel that moves `n` coordinates for a time and holds them within limits.

    It takes q (n,), v (n,), dt (), and the limits lower (n,), upper (n,), and returns the new q (n,), a copy of
    it, and a number that is finite only if all of q and v are.
    """
    return compile(_limited_step, q=(n,), v=(n,), dt=(), lower=(n,), upper=(n,))


def _limited_step(q: Array, v: Array, dt: Any, lower: Array, upper: Array) -> tuple[Array, Array, Any]:
    moved = numeric.clip(q + dt * v, lower, upper)
    return moved, moved, (q + v).sum()


@lru_cache(maxsize=1)
def pose_step() -> Callable[..., tuple[Floats, float]]:
    """A kernel that moves a pose at a constant velocity for a time.

    It takes T_world_body (4, 4), its velocity v (6,) in the world, linear [m/s] then angular [rad/s], and dt (), and
    returns the new pose (4, 4) and a number that is finite only if all of v is.
    """
    return compile(_pose_step, T=(4, 4), v=(6,), dt=())


def _pose_step(T: Array, v: Array, dt: Any) -> tuple[Array, Any]:
    R, p = so3_exp(dt * v[3:]) @ T[:3, :3], T[:3, 3] + dt * v[:3]
    rows = [[*R[k], p[k]] for k in range(3)]
    return numeric.matrix([*rows, [0.0, 0.0, 0.0, 1.0]]), v.sum()


def kinematic_step(robot: Any, q: ArrayLike, v: ArrayLike, dt: float) -> Floats:
    """The configuration after moving at constant velocity for a time, held at the position limits.

    Args:
        robot: An `ulna.Robot`.
        q: Configuration, shape (nq,) [rad, m].
        v: Velocity, shape (nv,) [rad/s, m/s].
        dt: Duration [s].

    Returns:
        Configuration, shape (nq,) [rad, m].

    Raises:
        ShapeError: `q` or `v` does not fit the robot.
        NonFiniteError: `q` or `v` holds nan or inf.
        InputError: `dt` is not a finite number.
    """
    model = checked_robot(robot).model
    start = shaped_array("q", q, model.nq, labels=model.position_names)
    velocity = shaped_array("v", v, model.nv, labels=model.velocity_names)
    return moved_within_limits(robot, start, velocity, number("dt", dt, "a finite time [s]"))


def moved_within_limits(robot: Any, q: Floats, v: Floats, dt: float) -> Floats:
    """As `kinematic_step`, without checks.

    Args:
        robot: An `ulna.Robot`.
        q: Configuration, shape (nq,) [rad, m].
        v: Velocity, shape (nv,) [rad/s, m/s].
        dt: Duration [s].

    Returns:
        Configuration, shape (nq,) [rad, m].
    """
    model = robot.model
    lower, upper = model.lower_position, model.upper_position
    if _has_vector_coordinates(model):
        return limited_step(model.nq)(q, v, dt, lower, upper)[0]
    return np.clip(robot.integrate(q, dt * v), lower, upper)


@lru_cache(maxsize=256)
def _has_vector_coordinates(model: Model) -> bool:
    """Whether moving is adding: every joint has one coordinate. Rotations and bases move on their group."""
    return 0 < model.nq == model.nv and all(j.kind.nq == 1 for j in model.joints)
