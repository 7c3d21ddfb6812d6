"""Unit axes and rotations about them, with exact zeros and ones wherever the axis has them.

A compiled kernel folds constants that are exactly 0 or 1, so a rotation about z must cost two products with
sine and cosine per column, not nine entries of rounding noise.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from functools import cache
from typing import Any

import numpy as np

from ulna.errors import InputError
from ulna.numeric import is_symbolic, matrix, sincos, vector
from ulna.spatial import SE3
from ulna.typing import Array, Floats

Axis = tuple[float, float, float]

SNAP = 1e-15
"""Components closer than this to 0, 1 or -1 become exactly that; a tenth of what the tests could ever see."""


def axis_name(axis: Axis) -> str:
    """``"x"``, ``"-z"``, or the rounded components ``"(0.6, 0, 0.8)"``."""
    for i, letter in enumerate("xyz"):
        if abs(axis[i]) == 1.0 and sum(map(abs, axis)) == 1.0:
            return letter if axis[i] > 0 else f"-{letter}"
    return "(" + ", ".join(f"{c:.3g}" for c in axis) + ")"


def snap(x: float) -> float:
    """`x`, or the exact 0, 1 or -1 it is within `SNAP` of; never -0.0."""
    nearest = round(x) if abs(x) < 1.5 else math.inf
    return float(nearest) if abs(x - nearest) <= SNAP else x


def unit_axis(axis: Iterable[float], what: str = "axis") -> Axis:
    """A vector scaled to length 1, its components snapped to exact 0 and 1.

    Args:
        axis: Three numbers.
        what: What they are, for the message.

    Returns:
        The unit axis.

    Raises:
        InputError: `axis` is not 3 finite numbers, or has no length.
    """
    try:
        components = tuple(float(c) for c in axis)
    except (TypeError, ValueError) as error:
        raise InputError(f"`{what}` is {axis!r}; expected 3 numbers such as (0, 0, 1).") from error
    if len(components) != 3 or not all(map(math.isfinite, components)):
        raise InputError(f"`{what}` is {components}; expected 3 finite numbers such as (0, 0, 1).")
    largest = max(map(abs, components))
    if largest == 0.0:
        raise InputError(f"`{what}` is {components}, which has no direction; expected for example (0, 0, 1).")
    scaled = [c / largest for c in components]  # so that no square under- or overflows
    length = math.sqrt(sum(c * c for c in scaled))
    if abs(length * largest - 1.0) <= SNAP:
        x, y, z = (snap(c) for c in components)  # already of length 1: keep its very bits
    else:
        x, y, z = (snap(c / length) for c in scaled)
    return (x, y, z)


@cache
def unit(axis: Axis) -> Floats:
    """`axis` as a read-only array."""
    return constant(axis)


def constant(values: Any) -> Floats:
    """`values` as a read-only array of floats, or of traced scalars if there are any."""
    out = np.array(values, dtype=object if is_symbolic(values) else float)
    out.setflags(write=False)
    return out


def snap_pose(pose: SE3) -> SE3:
    """`pose` with rounding noise cleaned off and its arrays read-only.

    Entries of the rotation within `SNAP` of 0, 1 or -1 become exactly that, and translations below `SNAP` [m]
    become
    0: what a rotation by pi/2 leaves behind would otherwise be computed with in every compiled kernel.
    """
    rotation = [[snap(float(entry)) for entry in row] for row in pose.rotation.tolist()]
    translation = [float(t) if abs(t) > SNAP else 0.0 for t in pose.translation.tolist()]
    return SE3(constant(rotation), constant(translation))


ZERO = constant((0.0, 0.0, 0.0))
EYE = constant(np.eye(3))


def rotation_about(axis: Axis, angle: Any) -> Array:
    """The rotation matrix about a unit axis.

    Args:
        axis: Unit axis.
        angle: Angle, shape (...) [rad].

    Returns:
        Rotation matrix, shape (..., 3, 3) [-].
    """
    return rotation_of(axis, *sincos(angle))


def rotation_of(axis: Axis, s: Any, c: Any) -> Array:
    """The rotation matrix about a unit axis: a a^T + c (I - a a^T) + s [a]x.

    This is Rodrigues' formula, its constant matrices worked out beforehand.

    Args:
        axis: Unit axis a.
        s: Sine of the angle, shape (...).
        c: Cosine of the angle, shape (...).

    Returns:
        Rotation matrix, shape (..., 3, 3).
    """
    x, y, z = axis
    cross = ((0.0, -z, y), (z, 0.0, -x), (-y, x, 0.0))
    rows = []
    for i in range(3):
        row = []
        for j in range(3):
            fixed = axis[i] * axis[j]
            swung = _one_minus_square(axis, i) if i == j else -fixed
            row.append(_sum(fixed, _times(swung, c), _times(cross[i][j], s)))
        rows.append(row)
    return matrix(rows)


def rotate_about(axis: Axis, angle: Any, v: Axis) -> Array:
    """A constant vector turned about an axis.

    Args:
        axis: Unit axis.
        angle: Angle, shape (...) [rad].
        v: The vector, three numbers.

    Returns:
        The turned vector, shape (..., 3), in the same unit.
    """
    s, c = sincos(angle)
    a, u = np.array(axis), np.array(v)
    along = np.array([snap(e) for e in a * (a @ u)])
    across = np.array([snap(e) for e in u - along])
    turned = np.array([snap(e) for e in np.cross(a, u)])
    return vector(
        *(_sum(float(along[i]), _times(float(across[i]), c), _times(float(turned[i]), s)) for i in range(3))
    )


def scaled_axis(axis: Axis, factor: Any) -> Array:
    """`factor * axis`, with exact zeros where the axis has them.

    Args:
        axis: Unit axis.
        factor: Number or batch, shape (...).

    Returns:
        The vector, shape (..., 3).
    """
    return vector(*(_sum(0.0, _times(component, factor)) for component in axis))


def _one_minus_square(axis: Axis, i: int) -> float:
    """1 - axis[i]^2 as the sum of the other two squares, which is exact near 0."""
    return sum(axis[j] * axis[j] for j in range(3) if j != i)


def _times(coefficient: float, x: Any) -> Any:
    """`coefficient * x` without the product where it is none; None for nothing at all."""
    if coefficient == 0.0:
        return None
    if coefficient == 1.0:
        return x
    return -x if coefficient == -1.0 else coefficient * x


def _sum(number: float, *terms: Any) -> Any:
    """The sum of a number and those terms that are there."""
    total: Any = None if number == 0.0 else number
    for term in terms:
        if term is not None:
            total = term if total is None else total + term
    return 0.0 if total is None else total
