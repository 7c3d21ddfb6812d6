"""Checks of what users pass to trajectories: points, durations, limits."""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.checks.arrays import finite_array, number_or_array
from ulna.errors import InputError, ShapeError
from ulna.spatial import SE3
from ulna.spatial.se3 import read_only
from ulna.typing import ArrayLike, Floats


def vector(name: str, value: ArrayLike, size: int | None = None) -> Floats:
    """One point (n,) of finite floats; a single number is a point with one entry.

    Args:
        name: Name of the argument, for messages.
        value: A number, or numbers (n,).
        size: What n must be; None for any.

    Returns:
        Array (n,).

    Raises:
        ShapeError: Another shape.
    """
    array = finite_array(name, value)
    array = array if array.ndim else array.reshape(1)
    if array.ndim != 1 or array.size == 0 or (size is not None and array.size != size):
        raise ShapeError(name, array.shape, "(n,), one point" if size is None else f"({size},)")
    return array


def filled(name: str, value: ArrayLike | None, size: int) -> Floats:
    """A point (size,); zeros for None, and one number fills all entries.

    Args:
        name: Name of the argument, for messages.
        value: A number, numbers (size,), or None.
        size: Number of entries.

    Returns:
        Array (size,).
    """
    if value is None:
        return np.zeros(size)
    array = finite_array(name, value)
    return np.full(size, float(array)) if array.ndim == 0 else vector(name, array, size)


def rows(name: str, value: ArrayLike, least: int = 2) -> Floats:
    """Several points (k, n) of finite floats, k at least `least`.

    Args:
        name: Name of the argument, for messages.
        value: Numbers (k, n), or (k,) for points of one entry.
        least: Smallest number of points.

    Returns:
        Array (k, n).

    Raises:
        ShapeError: Another shape, or too few points.
    """
    array = finite_array(name, value)
    array = array[:, None] if array.ndim == 1 else array
    if array.ndim != 2 or array.shape[0] < least or array.shape[1] == 0:
        raise ShapeError(name, array.shape, f"(k, n), at least {least} points in rows")
    return array


def increasing(name: str, value: ArrayLike, count: int) -> Floats:
    """Times (count,) that increase strictly [s], the first being 0.

    Args:
        name: Name of the argument, for messages.
        value: Times, (count,) [s].
        count: Number of times.

    Returns:
        Array (count,) [s].

    Raises:
        InputError: The first is not 0, or they do not increase.
        ShapeError: Another number of times.
    """
    t = finite_array(name, value)
    if t.shape != (count,):
        raise ShapeError(name, t.shape, f"({count},), one time for each way-point")
    if t[0] != 0.0:
        raise InputError(f"`{name}[0]` is {t[0]}; expected 0: a trajectory starts at time 0 s.")
    if (np.diff(t) <= 0.0).any():
        k = int(np.argmax(np.diff(t) <= 0.0))
        raise InputError(f"`{name}` does not increase: {t[k]} s is followed by {t[k + 1]} s.")
    return t


def positive(name: str, value: ArrayLike, size: int, infinite: bool = False) -> Floats:
    """Limits above zero (size,); one number holds for all entries.

    Args:
        name: Name of the argument, for messages.
        value: A number, or numbers (size,).
        size: Number of entries.
        infinite: Whether an entry may be inf.

    Returns:
        Array (size,).

    Raises:
        InputError: An entry is not above zero, or infinite where it must not be.
        ShapeError: Another shape.
    """
    limit = number_or_array(name, value, size)
    wrong = ~(limit > 0.0) | (np.isinf(limit) & (not infinite))
    if wrong.any():
        k = int(np.argmax(wrong))
        fix = "np.inf leaves a joint free." if infinite else "Every entry must be finite."
        raise InputError(f"`{name}[{k}]` is {limit[k]}; expected a limit above zero. {fix}")
    return limit


def not_repeating(name: str, points: Floats, gaps: Floats) -> None:
    """Checks that neighbouring way-points differ.

    Args:
        name: Name of the argument, for messages.
        points: Way-points in rows, (k, n).
        gaps: Distances of neighbours, (k - 1,).

    Raises:
        InputError: A distance is zero.
    """
    if (gaps <= 0.0).any():
        k = int(np.argmax(gaps <= 0.0))
        raise InputError(
            f"`{name}[{k}]` and `{name}[{k + 1}]` are the same point, {np.array2string(points[k], precision=4)}; "
            "expected neighbours that differ, or give `times`, so that the robot can wait there."
        )


def pose(name: str, value: Any) -> SE3:
    """One pose: an SE3 or a matrix (4, 4).

    Args:
        name: Name of the argument, for messages.
        value: An SE3, or a matrix (4, 4).

    Returns:
        The pose.

    Raises:
        ShapeError: A batch of poses.
    """
    checked = value if isinstance(value, SE3) else SE3.from_matrix(value)
    if checked.batch_shape != ():
        raise ShapeError(name, (*checked.batch_shape, 4, 4), "(4, 4), one pose")
    return read_only(checked)
