"""Numerical derivatives along the tangent space of a configuration, good to about 1e-10."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ulna.algorithms import configuration
from ulna.model import Model
from ulna.typing import Floats

_STEP = 6e-3
_WEIGHTS = {1: 3 / 4, 2: -3 / 20, 3: 1 / 60}  # central differences of sixth order


def derivative(f: Callable[[float], Floats]) -> Floats:
    """df/dt at t = 0."""
    return sum(w * (np.asarray(f(k * _STEP)) - f(-k * _STEP)) for k, w in _WEIGHTS.items()) / _STEP  # type: ignore[return-value]


def along(model: Model, q: Floats, direction: Floats, f: Callable[[Floats], Floats]) -> Floats:
    """d f(integrate(q, t direction)) / dt at t = 0."""
    return derivative(lambda t: f(configuration.integrate(model, q, t * direction)))


def by_configuration(model: Model, q: Floats, f: Callable[[Floats], Floats]) -> Floats:
    """The derivatives of `f` along every direction of the tangent space, stacked in a first axis of length nv."""
    return np.stack([along(model, q, e, f) for e in np.eye(model.nv)])


def by_vector(x: Floats, f: Callable[[Floats], Floats]) -> Floats:
    """The derivatives of `f` by every entry of `x`, stacked in a first axis."""
    return np.stack([derivative(lambda t, e=e: f(x + t * e)) for e in np.eye(len(x))])
