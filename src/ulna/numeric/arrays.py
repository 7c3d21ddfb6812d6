"""Vectors and matrices of floats, traced scalars or symbols: assembled, multiplied, checked."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ulna.numeric.scalars import is_symbolic
from ulna.typing import Array


def vector(*components: Any) -> Array:
    """The array whose last axis holds `components` (scalars, or batches of one shape).

    Example:
        >>> from ulna import numeric
        >>> polar = ulna.compile(lambda r, a: numeric.vector(r * np.cos(a), r * np.sin(a)), r=(), a=())
        >>> polar(2.0, 0.0)
        array([2., 0.])
    """
    if is_symbolic(*components):
        if not any(isinstance(c, (np.ndarray, np.generic)) for c in components):
            return object_vector(components)
        components = tuple(np.broadcast_arrays(*(np.asarray(c, dtype=object) for c in components)))
        return np.stack(components, axis=-1)
    if all(isinstance(c, (float, int)) for c in components):
        return np.array(components, dtype=float)
    return np.stack(np.broadcast_arrays(*components), axis=-1).astype(float, copy=False)


def object_vector(values: Sequence[Any]) -> Any:
    """An object array (n,) of the values, whatever they are."""
    array = np.empty(len(values), dtype=object)
    array[:] = values
    return array


def triple(v: Any) -> tuple[float, float, float]:
    """The three entries of a vector (3,) as numbers."""
    x, y, z = (float(c) for c in v)
    return x, y, z


def matrix(rows: Any) -> Array:
    """The array whose last two axes hold `rows` (a nested sequence of scalars or batches)."""
    flat = vector(*(entry for row in rows for entry in row))
    return flat.reshape(*flat.shape[:-1], len(rows), len(rows[0]))


def cross(a: Array, b: Array) -> Array:
    """The cross product along the last axis.

    Args:
        a, b: Vectors, shape (..., 3).

    Returns:
        a x b, shape (..., 3).
    """
    a0, a1, a2 = a[..., 0], a[..., 1], a[..., 2]
    b0, b1, b2 = b[..., 0], b[..., 1], b[..., 2]
    return vector(a1 * b2 - a2 * b1, a2 * b0 - a0 * b2, a0 * b1 - a1 * b0)


def dot(a: Array, b: Array) -> Any:
    """The inner product along the last axis.

    Args:
        a, b: Vectors, shape (..., n).

    Returns:
        Shape (...).
    """
    return (a * b).sum(axis=-1)


def apply(m: Array, v: Array) -> Array:
    """Matrix times vector, with batch axes.

    Args:
        m: Matrix, shape (..., m, n).
        v: Vector in any unit, such as [rad/s], shape (..., n).

    Returns:
        m v, shape (..., m).
    """
    return (m @ v[..., None])[..., 0]


def skew(v: Array) -> Array:
    """The matrix of the cross product with `v`: `skew(v) @ u == cross(v, u)`."""
    x, y, z = v[..., 0], v[..., 1], v[..., 2]
    o = 0.0 * x if not is_symbolic(v) else 0.0
    return matrix([[o, -z, y], [z, o, -x], [-y, x, o]])
