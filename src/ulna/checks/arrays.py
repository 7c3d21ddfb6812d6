"""Checks of arrays of numbers: types, shapes, finite entries, and rotations among them."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ulna.checks.values import MAX_LENGTH, real_number, short_repr
from ulna.errors import DtypeError, InputError, NonFiniteError, ShapeError
from ulna.numeric import check_not_masked, is_symbolic
from ulna.typing import Array, Floats

ROTATION_TOLERANCE = 1e-6
"""How far `R.T @ R` may be from the identity, entry by entry, for R to pass as a rotation."""


def finite_array(name: str, value: Any, expected: str = "numbers") -> Floats:
    """A copy of finite numbers, in whatever shape.

    Args:
        name: The name of the argument, for the message.
        value: What was passed.
        expected: What was expected, for the message.

    Returns:
        A new array (...) in the shape of `value`.

    Raises:
        InputError: they are no numbers, or rows differ in length.
        NonFiniteError: nan or inf among them.
    """
    check_not_masked(name, value)
    try:
        raw = np.asarray(value)
        if raw.dtype.kind not in "fiu" and raw.size:
            raw = np.array([real_number(x) for x in np.asarray(value, dtype=object).flat]).reshape(raw.shape)
        out = np.array(raw, dtype=float)
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"`{name}` is {short_repr(value)}; expected {expected}.") from None
    if not math.isfinite(np.vdot(out, out)) and not np.isfinite(out).all():  # a quick look first
        where = tuple(int(i) for i in np.argwhere(~np.isfinite(out))[0])
        raise NonFiniteError(name, where, float(out[where]), "Look where it comes from.")
    return out


def shaped_array(name: str, value: Any, *shape: int | None, fix: str = "") -> Floats:
    """A copy of finite numbers of a given shape.

    Args:
        name: The name of the argument, for the message.
        value: What was passed.
        *shape: The lengths of the axes; None for any length.
        fix: How to correct it, for the message.

    Returns:
        A new array (...) of that shape.

    Raises:
        InputError: they are no numbers, or rows differ in length.
        ShapeError: another shape.
        NonFiniteError: nan or inf among them.
    """
    out = finite_array(name, value)
    if out.shape != shape and (
        len(shape) != out.ndim or any(n not in (None, m) for n, m in zip(shape, out.shape, strict=True))
    ):
        wanted = str(tuple("n" if n is None else n for n in shape)).replace("'", "")
        raise ShapeError(name, out.shape, wanted if shape else "one number", fix)
    return out


def length_array(name: str, value: Any, *shape: int | None, fix: str = "") -> Floats:
    """As `shaped_array`, for lengths that a screen can show.

    Args:
        name: The name of the argument, for the message.
        value: What was passed [m].
        *shape: The lengths of the axes; None for any length.
        fix: How to correct it, for the message.

    Returns:
        A new array (...) of that shape [m].

    Raises:
        InputError: they are no numbers, rows differ in length, or a length is above `MAX_LENGTH`.
        ShapeError: another shape.
        NonFiniteError: nan or inf among them.
    """
    out = shaped_array(name, value, *shape, fix=fix)
    if out.size and max(out.max(), -out.min()) > MAX_LENGTH:
        raise InputError(
            f"`{name}` reaches as far as {np.abs(out).max():g} m; expected at most {MAX_LENGTH:g} m."
        )
    return out


def scale_factors(name: str, value: Any, *count: int) -> Floats:
    """Factors above zero along each axis.

    Args:
        name: The name of the argument, for the message.
        value: What was passed, shape (*count, 3), (3,) or one number [-].
        *count: The batch axes of the result.

    Returns:
        A new array, shape (*count, 3) [-].

    Raises:
        InputError: they are no numbers, not above zero, or above `MAX_LENGTH`.
        ShapeError: another shape.
        NonFiniteError: nan or inf among them.
    """
    out = finite_array(name, value, "a factor, or one along each axis")
    if out.shape not in ((), (3,), (*count, 3)):
        raise ShapeError(name, out.shape, f"{(*count, 3)}, (3,), or one number")
    if out.size and not (out.min() > 0.0 and out.max() <= MAX_LENGTH):
        raise InputError(
            f"`{name}` is {short_repr(value)}; expected factors above zero, at most {MAX_LENGTH:g}."
        )
    return np.array(np.broadcast_to(out, (*count, 3)))


def batched_array(name: str, value: Any, shape: tuple[int, ...], fix: str = "") -> Array:
    """An array of finite floats, or of traced scalars or symbols, with any leading batch axes.

    Args:
        name: The name of the argument, for the message.
        value: What was passed.
        shape: The trailing axes.
        fix: How to correct it, for the message.

    Returns:
        The array, shape (..., *shape).

    Raises:
        ShapeError: the trailing axes are not `shape`.
        DtypeError: not real numbers.
        NonFiniteError: nan or inf among the numbers.
        InputError: rows differ in length.
    """
    expected = "(" + ", ".join(["...", *map(str, shape)]) + ")"
    check_not_masked(name, value)
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
        raise ShapeError(name, array.shape, expected, fix)
    if array.dtype != object and not np.isfinite(array).all():
        index = tuple(int(i) for i in np.argwhere(~np.isfinite(array))[0])
        raise NonFiniteError(name, index, float(array[index]))
    return array


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
