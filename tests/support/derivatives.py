"""Numerical derivatives along the tangent space of a configuration, good to about 1e-10.

The functions to differentiate take batches: all points of the difference formula are evaluated at once.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ulna.algorithms.kinematics import configuration_space as configuration
from ulna.model import Model
from ulna.typing import Floats

_STEP = 6e-3
_TIMES = _STEP * np.array([1.0, -1.0, 2.0, -2.0, 3.0, -3.0])
_WEIGHTS = np.array([3 / 4, -3 / 4, -3 / 20, 3 / 20, 1 / 60, -1 / 60]) / _STEP  # central, of sixth order


def along(model: Model, q: Floats, direction: Floats, f: Callable[[Floats], Floats]) -> Floats:
    """The derivative of f(integrate(q, t direction)) by t at 0, for one `direction` or several (n, nv)."""
    times = _TIMES.reshape(-1, *[1] * direction.ndim)
    values = f(configuration.integrate(model, q, times * direction))
    return np.tensordot(_WEIGHTS, values, 1)


def by_configuration(model: Model, q: Floats, f: Callable[[Floats], Floats]) -> Floats:
    """The derivatives of `f` along every direction of the tangent space, stacked in a first axis (nv)."""
    return along(model, q, np.eye(model.nv), f)


def by_vector(x: Floats, f: Callable[[Floats], Floats]) -> Floats:
    """The derivatives of `f` by every entry of `x`, stacked in a first axis."""
    return np.tensordot(_WEIGHTS, f(x + _TIMES[:, None, None] * np.eye(len(x))), 1)
