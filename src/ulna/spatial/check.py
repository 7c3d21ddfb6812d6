"""Checks of what users pass in; the inner loops never come here."""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.errors import DtypeError, InputError, NonFiniteError, ShapeError
from ulna.numeric import is_symbolic
from ulna.typing import Array

ROTATION_TOLERANCE = 1e-6
"""How far `R.T @ R` may be from the identity, entry by entry, for R to pass as a rotation."""


def checked(name: str, value: Any, shape: tuple[int, ...], mend: str = "") -> Array:
    """`value` as an array (..., *shape) of finite floats, or of traced scalars or symbols.

    Raises:
        ShapeError: the trailing axes are not `shape`.
        DtypeError: not real numbers.
        NonFiniteError: nan or inf among the numbers.
    """
    expected = "(" + ", ".join(["...", *map(str, shape)]) + ")"
    try:
        array = np.asarray(value)
    except ValueError:
        raise InputError(f"`{name}` is made of rows of different lengths; expected {expected}.") from None
    if array.dtype == object:
        wrong = [x for x in array.flat if isinstance(x, (str, bytes, complex, type(None)))]
        if wrong:
            raise DtypeError(name, type(wrong[0]).__name__)
    elif array.dtype.kind not in "fiub":
        raise DtypeError(name, str(array.dtype))
    if array.dtype != object or not any(is_symbolic(x) for x in array.flat):
        array = array.astype(float, copy=False)
    if array.ndim < len(shape) or array.shape[array.ndim - len(shape) :] != shape:
        raise ShapeError(name, array.shape, expected, mend)
    if array.dtype != object and not np.isfinite(array).all():
        index = tuple(int(i) for i in np.argwhere(~np.isfinite(array))[0])
        raise NonFiniteError(name, index, float(array[index]))
    return array


def checked_rotation(name: str, value: Any, project: str) -> Array:
    """`value` as an array (..., 3, 3) of rotations.

    Args:
        name: what the user calls it.
        value: the matrix or matrices.
        project: the call that makes the nearest rotation, for the message.

    Raises:
        InputError: not orthogonal, or a reflection; says by how much.
    """
    r = checked(name, value, (3, 3))
    if r.dtype == object:
        return r
    error = np.abs(np.swapaxes(r, -1, -2) @ r - np.eye(3)).max(axis=(-2, -1), initial=0.0)
    worst = float(error.max(initial=0.0))
    mend = f"{project} gives the nearest rotation."
    if worst > ROTATION_TOLERANCE:
        raise InputError(
            f"`{name}` is not a rotation{_place(error == worst)}: R.T @ R differs from the identity by "
            f"{worst:.3g}; expected at most {ROTATION_TOLERANCE:g}. {mend}"
        )
    mirrored = np.linalg.det(r) < 0.0
    if mirrored.any():
        raise InputError(
            f"`{name}` is not a rotation{_place(mirrored)}: its determinant is -1 (a reflection); "
            f"expected +1. Look for a flipped axis; {mend}"
        )
    return r


def nearest_rotation(matrix: Array) -> Array:
    """The rotation nearest to `matrix` (..., 3, 3) in the Frobenius norm. Source: Kabsch 1976."""
    u, _, vt = np.linalg.svd(matrix)
    sign = np.where(np.linalg.det(u @ vt) < 0.0, -1.0, 1.0)
    u = np.concatenate([u[..., :2], u[..., 2:] * sign[..., None, None]], axis=-1)
    return u @ vt


def _place(which: Array) -> str:
    """The first place in the batch where `which` holds, as text."""
    return f" at index {tuple(int(i) for i in np.argwhere(which)[0])}" if which.ndim else ""
