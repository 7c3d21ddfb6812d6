"""What drives can do: torques and velocities kept within a model's limits."""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna import numeric
from ulna.model import Model
from ulna.typing import Array


def within_effort(model: Model, tau: Array) -> Array:
    """Torques (nv,), each kept within its effort limit."""
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
    """Velocities (nv,), all slowed alike until none exceeds its limit, so that the direction stays."""
    limits = model.velocity_limit
    excess: Any = 1.0
    for i in range(model.nv):
        if np.isfinite(limits[i]) and limits[i] > 0.0:
            excess = numeric.maximum(excess, abs(v[i]) / limits[i])
    return v / excess
