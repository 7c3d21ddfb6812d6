"""A robot that follows joint velocities exactly, up to its limits: the plainest simulation."""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.errors import InputError, NonFiniteError, ShapeError
from ulna.typing import ArrayLike, Floats


def kinematic_step(robot: Any, q: ArrayLike, v: ArrayLike, dt: float) -> Floats:
    """The configuration after moving at constant velocity for a time, held at the position limits.

    Args:
        robot: An `ulna.Robot`.
        q: Configuration, shape (nq,).
        v: Velocity, shape (nv,) [rad/s or m/s].
        dt: Duration [s].

    Raises:
        ShapeError: `q` or `v` does not fit the robot.
        NonFiniteError: `q` or `v` holds nan or inf.
        InputError: `dt` is not a finite number.
    """
    model = robot.model
    start, velocity = _checked("q", q, model.nq), _checked("v", v, model.nv)
    if not np.isfinite(dt):
        raise InputError(f"`dt` is {dt}; expected a finite time [s].")
    # where every joint has one coordinate, moving is adding; rotations and bases move on their group
    plain = model.nq == model.nv and all(j.kind.nq == 1 for j in model.joints)
    moved = start + dt * velocity if plain else robot.integrate(start, dt * velocity)
    return np.clip(moved, model.lower_position, model.upper_position)


def _checked(name: str, value: ArrayLike, size: int) -> Floats:
    out = np.asarray(value, dtype=float)
    if out.shape != (size,):
        raise ShapeError(name, out.shape, f"({size},)")
    if not np.isfinite(out).all():
        where = int(np.argwhere(~np.isfinite(out))[0][0])
        raise NonFiniteError(name, (where,), float(out[where]))
    return out
