"""Homogeneous transformation matrices (4, 4), by the names that MeshCat's scripts use; quaternions are w x y z."""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.checks.arrays import shaped_array
from ulna.errors import InputError
from ulna.spatial import (
    angle_axis_to_matrix,
    matrix_to_euler,
    matrix_to_quat_xyzw,
    quat_multiply,
    quat_xyzw_to_matrix,
    rotation_about,
)
from ulna.typing import Floats


def identity_matrix() -> Floats:
    """The identity, (4, 4)."""
    return np.eye(4)


def translation_matrix(direction: Any) -> Floats:
    """A translation by a vector (3,) [m]."""
    return _matrix(np.eye(3), shaped_array("direction", direction, 3))


def translation_from_matrix(matrix: Any) -> Floats:
    """The translation of a matrix, (3,) [m]."""
    return shaped_array("matrix", matrix, 4, 4)[:3, 3].copy()


def rotation_matrix(angle: float, direction: Any, point: Any = None) -> Floats:
    """A rotation about an axis.

    Args:
        angle: The angle [rad].
        direction: The axis, (3,), of any length but zero.
        point: A point on the axis, (3,) [m]; the origin when not given.

    Returns:
        The matrix, (4, 4).
    """
    rotation = angle_axis_to_matrix(float(angle), unit_vector(direction))
    centre = np.zeros(3) if point is None else shaped_array("point", point, 3)
    return _matrix(rotation, centre - rotation @ centre)


def scale_matrix(factor: float, origin: Any = None, direction: Any = None) -> Floats:
    """A scaling about a point, in all directions or along one.

    Args:
        factor: The factor [-].
        origin: The point, (3,) [m]; the origin when not given.
        direction: The direction, (3,); all when not given.

    Returns:
        The matrix, (4, 4).
    """
    if direction is None:
        linear = factor * np.eye(3)
    else:
        along = unit_vector(direction)
        linear = np.eye(3) + (factor - 1.0) * np.outer(along, along)
    centre = np.zeros(3) if origin is None else shaped_array("origin", origin, 3)
    return _matrix(linear, centre - linear @ centre)


def unit_vector(data: Any) -> Floats:
    """A vector (n,) divided by its length.

    Raises:
        InputError: Its length is zero.
    """
    values = np.asarray(data, dtype=float)
    length = np.linalg.norm(values)
    if not length > 0.0:
        raise InputError(f"The direction is {data!r}; expected a vector that is not zero.")
    return values / length


def quaternion_matrix(quaternion: Any) -> Floats:
    """The rotation of a quaternion w x y z (4,), (4, 4)."""
    w, x, y, z = unit_vector(shaped_array("quaternion", quaternion, 4))
    return _matrix(quat_xyzw_to_matrix(np.array([x, y, z, w])), np.zeros(3))


def quaternion_from_matrix(matrix: Any) -> Floats:
    """The quaternion w x y z (4,) of a matrix (4, 4), with w >= 0."""
    quat = np.asarray(matrix_to_quat_xyzw(np.asarray(matrix, dtype=float)[:3, :3]))[[3, 0, 1, 2]]
    return -quat if quat[0] < 0.0 else quat


def quaternion_about_axis(angle: float, axis: Any) -> Floats:
    """The quaternion of a rotation about an axis.

    Args:
        angle: The angle [rad].
        axis: The axis, (3,).

    Returns:
        w x y z, (4,).
    """
    return np.array([np.cos(angle / 2), *(np.sin(angle / 2) * unit_vector(axis))])


def quaternion_multiply(quaternion1: Any, quaternion0: Any) -> Floats:
    """The product of two quaternions, w x y z each.

    Args:
        quaternion1: The left one, (4,).
        quaternion0: The right one, (4,).

    Returns:
        The product, (4,).
    """
    left, right = (shaped_array("quaternion", q, 4)[[1, 2, 3, 0]] for q in (quaternion1, quaternion0))
    return np.asarray(quat_multiply(left, right))[[3, 0, 1, 2]]


def quaternion_conjugate(quaternion: Any) -> Floats:
    """The quaternion (4,), w first, with the opposite vector."""
    w, x, y, z = _quaternion(quaternion)
    return np.array([w, -x, -y, -z])


def quaternion_inverse(quaternion: Any) -> Floats:
    """The quaternion (4,), w first, whose product with this one is 1."""
    q = _quaternion(quaternion)
    return quaternion_conjugate(q) / (q @ q)


def quaternion_real(quaternion: Any) -> float:
    """The real part of a quaternion (4,), w first."""
    return float(_quaternion(quaternion)[0])


def quaternion_imag(quaternion: Any) -> Floats:
    """The vector (3,) of a quaternion (4,), w first."""
    return _quaternion(quaternion)[1:].copy()


def quaternion_slerp(
    quat0: Any, quat1: Any, fraction: float, spin: int = 0, shortestpath: bool = True
) -> Floats:
    """The rotation between two, at constant velocity [Shoemake 1985].

    Args:
        quat0: First quaternion (4,), w first.
        quat1: Second quaternion (4,), w first.
        fraction: From 0 to 1 [-].
        spin: How many half turns to add.
        shortestpath: Whether the shorter of both ways is taken.

    Returns:
        Quaternion (4,), w first.
    """
    first, second = (unit_vector(_quaternion(q)) for q in (quat0, quat1))
    if fraction in (0.0, 1.0):
        return second if fraction else first
    cosine = float(first @ second)
    if shortestpath and cosine < 0.0:
        cosine, second = -cosine, -second
    angle = np.arccos(min(cosine, 1.0)) + spin * np.pi
    if abs(angle) < 1e-15:
        return first
    weights = np.sin((1.0 - fraction) * angle), np.sin(fraction * angle)
    return (weights[0] * first + weights[1] * second) / np.sin(angle)


def _quaternion(value: Any) -> Floats:
    return shaped_array("quaternion", value, 4)


def euler_from_quaternion(quaternion: Any, axes: str = "sxyz") -> tuple[float, float, float]:
    """The Euler angles of a quaternion; see `euler_from_matrix`.

    Args:
        quaternion: Quaternion (4,), w first.
        axes: Order of the axes, "s" for static ones before, or "r" for those that turn with it.

    Returns:
        Three angles [rad].
    """
    return euler_from_matrix(quaternion_matrix(quaternion), axes)


def quaternion_from_euler(ai: float, aj: float, ak: float, axes: str = "sxyz") -> Floats:
    """The quaternion of three angles; see `euler_matrix`.

    Args:
        ai: The first angle [rad].
        aj: The second [rad].
        ak: The third [rad].
        axes: "s" for fixed axes or "r" for turning ones, then three of "xyz".

    Returns:
        w x y z, (4,).
    """
    return quaternion_from_matrix(euler_matrix(ai, aj, ak, axes))


def euler_matrix(ai: float, aj: float, ak: float, axes: str = "sxyz") -> Floats:
    """Rotations about three axes, one after the other.

    Args:
        ai: The first angle [rad].
        aj: The second [rad].
        ak: The third [rad].
        axes: "s" for fixed axes or "r" for turning ones, then three of "xyz".

    Returns:
        The matrix, (4, 4).

    Raises:
        InputError: `axes` names no axes.
    """
    fixed, order = _checked(axes)
    first, second, third = (
        rotation_about("xyz".index(axis), angle) for axis, angle in zip(order, (ai, aj, ak), strict=True)
    )
    return _matrix(third @ second @ first if fixed else first @ second @ third, np.zeros(3))


def euler_from_matrix(matrix: Any, axes: str = "sxyz") -> tuple[float, float, float]:
    """The three angles [rad] of a rotation; see `euler_matrix`.

    Args:
        matrix: The matrix, (4, 4) or (3, 3).
        axes: "s" for fixed axes or "r" for turning ones, then three of "xyz".

    Returns:
        The angles [rad].

    Raises:
        InputError: `axes` names no axes.
    """
    fixed, order = _checked(axes)
    rotation = np.asarray(matrix, dtype=float)[:3, :3]
    angles = np.asarray(matrix_to_euler(rotation, order[::-1] if fixed else order)).tolist()
    first, second, third = reversed(angles) if fixed else angles
    return first, second, third


def _checked(axes: str) -> tuple[bool, str]:
    order = axes[1:] if isinstance(axes, str) else ""
    if len(order) != 3 or axes[0] not in "sr" or set(order) - set("xyz") or order[1] in (order[0], order[2]):
        raise InputError(f"`axes` is {axes!r}; expected 's' or 'r' and three axes, such as 'sxyz' or 'rzyx'.")
    return axes[0] == "s", order


def inverse_matrix(matrix: Any) -> Floats:
    """The inverse of a matrix (n, n)."""
    return np.linalg.inv(matrix)


def concatenate_matrices(*matrices: Any) -> Floats:
    """The product of matrices (4, 4), the last one acting first."""
    product = np.eye(4)
    for matrix in matrices:
        product = product @ shaped_array("matrix", matrix, 4, 4)
    return product


def _matrix(linear: Any, translation: Any) -> Floats:
    out = np.eye(4)
    out[:3, :3], out[:3, 3] = linear, translation
    return out
