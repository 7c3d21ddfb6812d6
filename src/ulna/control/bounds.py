"""What drives can do: torques and velocities kept within a model's limits, and limits of controls."""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna import numeric
from ulna.errors import InputError, ShapeError
from ulna.model import Model
from ulna.typing import Array, ArrayLike, Floats


def within_effort(model: Model, tau: Array) -> Array:
    """Torques, each clipped to its effort limit.

    Args:
        model: The robot.
        tau: Joint torques, shape (nv,) [N m, N].

    Returns:
        Joint torques, shape (nv,) [N m, N].
    """
    limits = model.effort_limit
    return numeric.vector(
        *(
            numeric.clip(tau[i], -limits[i], limits[i])
            if np.isfinite(limits[i]) and limits[i] > 0.0
            else tau[i]
            for i in range(model.nv)
        )
    )


def within_speed(model: Model, v: Array) -> Array:
    """Velocities, all scaled alike until none exceeds its limit, so that the direction stays.

    Args:
        model: The robot.
        v: Joint velocities, shape (nv,) [rad/s, m/s].

    Returns:
        Joint velocities, shape (nv,) [rad/s, m/s].
    """
    limits = model.velocity_limit
    excess: Any = 1.0
    for i in range(model.nv):
        if np.isfinite(limits[i]) and limits[i] > 0.0:
            excess = numeric.maximum(excess, abs(v[i]) / limits[i])
    return v / excess


def least_and_greatest(name: str, value: ArrayLike, n: int) -> Floats:
    """Limits from one number, n of them, or least and greatest ones.

    Args:
        name: Name of the argument, for messages.
        value: Limits in both directions, () or (n,), or (2, n) [any]; np.inf for none.
        n: How many numbers are limited.

    Returns:
        Least and greatest values, shape (2, n) [any].

    Raises:
        ShapeError: Limits of another shape.
        InputError: Limits that are nan, or a least value above the greatest one.
    """
    limits = np.asarray(value, dtype=float)
    if limits.shape in ((), (n,)):
        limits = np.broadcast_to(limits, (n,))
        limits = np.stack([-limits, limits])
    if limits.shape != (2, n):
        raise ShapeError(name, limits.shape, f"one number, ({n},), or (2, {n}): least and greatest")
    if not (limits[0] <= limits[1]).all():  # also for nan
        k = int(np.argmin(limits[0] <= limits[1]))
        raise InputError(
            f"Entry {k} of `{name}` is from {limits[0, k]:g} to {limits[1, k]:g}; expected a least value that is not "
            "above the greatest one, np.inf for no limit."
        )
    return limits
