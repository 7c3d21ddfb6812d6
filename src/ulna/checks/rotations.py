"""Checks of rotation matrices."""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.checks.arrays import batched_array
from ulna.errors import InputError
from ulna.typing import Array

ROTATION_TOLERANCE = 1e-6
"""How far `R.T @ R` may be from the identity, entry by entry, for R to pass as a rotation."""


def checked_rotation(name: str, value: Any, project: str) -> Array:
    """An array of rotations.

    Args:
        name: The name of the argument, for the message.
        value: The matrix or matrices, shape (..., 3, 3) [-].
        project: The call that makes the nearest rotation, for the message.

    Returns:
        The array, shape (..., 3, 3) [-].

    Raises:
        InputError: not orthogonal, or a reflection; says by how much.
        ShapeError: another shape.
    """
    r = batched_array(name, value, (3, 3))
    if r.dtype == object:
        return r
    error = np.abs(np.swapaxes(r, -1, -2) @ r - np.eye(3)).max(axis=(-2, -1), initial=0.0)
    worst = float(error.max(initial=0.0))
    fix = f"{project} returns the nearest rotation."
    if worst > ROTATION_TOLERANCE:
        raise InputError(
            f"`{name}` is not a rotation{_place(error == worst)}: R.T @ R differs from the identity by "
            f"{worst:.3g}; expected at most {ROTATION_TOLERANCE:g}. {fix}"
        )
    mirrored = np.linalg.det(r) < 0.0
    if mirrored.any():
        raise InputError(
            f"`{name}` is not a rotation{_place(mirrored)}: its determinant is -1 (a reflection); "
            f"expected +1. Look for a flipped axis; {fix}"
        )
    return r


def _place(which: Array) -> str:
    """The first place in the batch where `which` holds, as text."""
    return f" at index {tuple(int(i) for i in np.argwhere(which)[0])}" if which.ndim else ""
