"""Checks of what users pass to trajectories: points, durations, limits."""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.checks.arrays import finite_array, number_or_array
from ulna.checks.values import number
from ulna.errors import InputError, ShapeError
from ulna.spatial import SE3
from ulna.typing import ArrayLike, Floats


def vector(name: str, value: ArrayLike, size: int | None = None) -> Floats:
    """One point (n,) of finite floats; a single number is a point with one entry."""
    array = finite_array(name, value)
    array = array if array.ndim else array.reshape(1)
    if array.ndim != 1 or array.size == 0 or (size is not None and array.size != size):
        raise ShapeError(name, array.shape, "(n,), one point" if size is None else f"({size},)")
    return array


def filled(name: str, value: ArrayLike | None, size: int) -> Floats:
    """A point (size,); zeros for None, and one number fills all entries."""
    if value is None:
        return np.zeros(size)
    array = finite_array(name, value)
    return np.full(size, float(array)) if array.ndim == 0 else vector(name, array, size)


def rows(name: str, value: ArrayLike, least: int = 2) -> Floats:
    """Several points (k, n) of finite floats, k at least `least`."""
    array = finite_array(name, value)
    array = array[:, None] if array.ndim == 1 else array
    if array.ndim != 2 or array.shape[0] < least or array.shape[1] == 0:
        raise ShapeError(name, array.shape, f"(k, n), at least {least} points in rows")
    return array


def seconds(name: str, value: Any) -> float:
    """A duration: finite and above zero [s]."""
    return above_zero(name, value, "a time above zero [s]")


def above_zero(name: str, value: Any, expected: str) -> float:
    """A finite number above zero."""
    return number(name, value, expected, above=0.0)


def increasing(name: str, value: ArrayLike, count: int) -> Floats:
    """Times (count,) that increase strictly [s], the first being 0."""
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
    """Limits above zero (size,); one number holds for all entries."""
    limit = number_or_array(name, value, size)
    wrong = ~(limit > 0.0) | (np.isinf(limit) & (not infinite))
    if wrong.any():
        k = int(np.argmax(wrong))
        fix = "np.inf leaves a joint free." if infinite else "Every entry must be finite."
        raise InputError(f"`{name}[{k}]` is {limit[k]}; expected a limit above zero. {fix}")
    return limit


def not_repeating(name: str, points: Floats, gaps: Floats) -> None:
    """Refuses way-points that repeat: `gaps` are the distances of neighbours."""
    if (gaps <= 0.0).any():
        k = int(np.argmax(gaps <= 0.0))
        raise InputError(
            f"`{name}[{k}]` and `{name}[{k + 1}]` are the same point, {np.array2string(points[k], precision=4)}; "
            "expected neighbours that differ, or give `times`, so that the robot can wait there."
        )


def pose(name: str, value: Any) -> SE3:
    """One pose: an SE3 or a matrix (4, 4)."""
    checked = value if isinstance(value, SE3) else SE3.from_matrix(value)
    if checked.batch_shape != ():
        raise ShapeError(name, (*checked.batch_shape, 4, 4), "(4, 4), one pose")
    return checked
