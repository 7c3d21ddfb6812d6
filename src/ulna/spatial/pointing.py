"""Rotations of a tool or a camera whose z axis points somewhere."""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.errors import InputError
from ulna.spatial.batched import unit_vectors
from ulna.typing import ArrayLike, Floats

_PARALLEL = 1e-9  # sine of the angle below which two directions count as parallel


def rotation_along(direction: ArrayLike, x: ArrayLike | None = None) -> Floats:
    """The rotation whose z axis has a direction and whose x axis is as near as possible to another.

    Args:
        direction: Direction of the z axis, of any length but zero, shape (..., 3) [-].
        x: Direction that the x axis approaches, shape (..., 3) [-]; None for the world's x, or the world's z where
            `direction` is along x.

    Returns:
        Rotation matrix, shape (..., 3, 3) [-].

    Raises:
        InputError: A direction is zero, or both are parallel.
    """
    z = _unit("direction", direction)
    hint = np.array([1.0, 0.0, 0.0]) if x is None else _unit("x", x)
    across = hint - (hint * z).sum(axis=-1, keepdims=True) * z
    length = np.linalg.norm(across, axis=-1, keepdims=True)
    if (length < _PARALLEL).any():
        if x is not None:
            raise InputError(
                "`x` and `direction` are parallel; expected an `x` that is across, or None to choose."
            )
        up = np.array([0.0, 0.0, 1.0])
        across = np.where(length < _PARALLEL, up - z[..., 2:] * z, across)
        length = np.linalg.norm(across, axis=-1, keepdims=True)
    return _columns(across, length, z)


def rotation_looking(direction: ArrayLike, up: ArrayLike) -> Floats:
    """The rotation of a camera: z along its view, x to the right and y down in the picture.

    Args:
        direction: Direction of the view, shape (..., 3) [-].
        up: Direction that is up in the picture, shape (..., 3) [-].

    Returns:
        Rotation matrix, shape (..., 3, 3) [-].

    Raises:
        InputError: A direction is zero, or both are parallel.
    """
    z, above = _unit("target - position", direction), _unit("up", up)
    right = np.cross(z, above)
    length = np.linalg.norm(right, axis=-1, keepdims=True)
    if (length < _PARALLEL).any():
        raise InputError("`up` is parallel to the view; expected a direction across, such as up=(1, 0, 0).")
    return _columns(right, length, z)


def _unit(name: str, direction: ArrayLike) -> Floats:
    return np.asarray(unit_vectors(name, direction, 3, "a direction"), dtype=float)


def _columns(across: Floats, length: Floats, z: Floats) -> Floats:
    """The rotation of a z axis and a vector of some length, nearly at right angles to it, along which x lies."""
    x = across / length
    x = x - (x * z).sum(axis=-1, keepdims=True) * z  # of nearly parallel directions few digits were left
    x = x / np.linalg.norm(x, axis=-1, keepdims=True)
    matrix: Any = np.stack([x, np.cross(z, x), z + 0.0 * x], axis=-1)
    return matrix
