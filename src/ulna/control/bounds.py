"""What drives can do: torques and velocities kept within a model's limits."""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna import numeric
from ulna.model import Model
from ulna.typing import Array


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
