"""Rotations as three angles or as angle and axis, and how their rates make an angular velocity.

Three angles about the axes "ijk" mean R = R_i(a1) R_j(a2) R_k(a3): turns about moving axes read from the
left, or about fixed axes read from the right. Of the twelve sequences two have names:

| name  | angles            | matrix                  | used by                              |
|-------|-------------------|-------------------------|--------------------------------------|
| `rpy` | roll, pitch, yaw  | Rz(yaw) Ry(pitch) Rx(roll) | URDF, SDF, ROS                    |
| `eul` | phi, theta, psi   | Rz(phi) Ry(theta) Rz(psi)  | textbooks, wrists of robot arms   |

Where two axes line up (pitch of 90 degrees, theta of 0) only the sum of two angles is known: the first angle
of the sequence (yaw, phi) is then taken to be zero, and the angles returned still make the rotation to full
precision.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.checks.values import short_repr
from ulna.errors import InputError
from ulna.numeric import apply, arctan2, by_precision, cross, dot, less, matrix, sincos, sqrt, vector, where
from ulna.spatial.batched import core_shapes
from ulna.spatial.quaternion import log_of_rotation
from ulna.typing import Array

_ALIGNED = 1e-28  # squared sine of the angle between two axes below which they count as lined up


def rotation_about(axis: int, angle: Any) -> Array:
    """The rotation about a coordinate axis.

    Args:
        axis: 0, 1 or 2 for x, y or z.
        angle: Angle, shape (...) [rad].

    Returns:
        Rotation matrix, shape (..., 3, 3) [-].

    Raises:
        InputError: `axis` is not 0, 1 or 2.
    """
    if np.ndim(axis) or axis not in (0, 1, 2):
        raise InputError(f"`axis` is {short_repr(axis)}; expected 0, 1 or 2 for x, y or z.")
    s, c = sincos(angle)
    if axis == 0:
        return matrix([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])
    if axis == 1:
        return matrix([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
    return matrix([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


@core_shapes(angles=(3,))
def euler_to_matrix(angles: Array, axes: str) -> Array:
    """The rotation R_i(a1) R_j(a2) R_k(a3) by angles about the axes "ijk".

    Args:
        angles: The three angles, shape (..., 3) [rad].
        axes: Three letters of xyz, neighbours different, such as "zyx": the turns in their order, about moving axes.

    Returns:
        Rotation matrix, shape (..., 3, 3) [-].

    Raises:
        InputError: `axes` is not three letters of xyz with neighbours different.
    """
    i, j, k = _parse(axes)
    first, second, third = (rotation_about(axis, angles[..., n]) for n, axis in enumerate((i, j, k)))
    return first @ (second @ third)


@core_shapes(rotation=(3, 3))
def matrix_to_euler(rotation: Array, axes: str) -> Array:
    """The angles with R = R_i(a1) R_j(a2) R_k(a3) for the axes "ijk".

    The second lies in [-pi/2, pi/2] for three different axes and in [0, pi] when the first and last are the same, the
    others in (-pi, pi]. The first angle is computed from the column of R that does not depend on the last turn; the
    others follow from R_i(-a1) R, which makes them accurate at the singular poses too.

    Args:
        rotation: Rotation matrix, shape (..., 3, 3) [-].
        axes: Three letters of xyz, neighbours different, such as "zyx": the turns in their order, about moving axes.

    Returns:
        The three angles, shape (..., 3) [rad].

    Raises:
        InputError: `axes` is not three letters of xyz with neighbours different.
    """
    i, j, last = _parse(axes)
    k = 3 - i - j
    e = 1.0 if (j - i) % 3 == 1 else -1.0

    def r(row: int, column: int) -> Any:
        return rotation[..., row, column]

    if last == k:
        c1, s1, c2, s2 = r(k, k), -e * r(j, k), None, e * r(i, k)
    else:
        c1, s1, c2, s2 = -e * r(k, i), r(j, i), r(i, i), None
    n2 = c1 * c1 + s1 * s1
    aligned = less(n2, _ALIGNED)
    n = sqrt(where(aligned, 1.0, n2))
    c1, s1, n = where(aligned, 1.0, c1 / n), where(aligned, 0.0, s1 / n), where(aligned, 0.0, n)
    a1 = arctan2(s1, c1)
    a2 = arctan2(s2, n) if c2 is None else arctan2(n, c2)
    c3 = c1 * r(j, j) + e * s1 * r(k, j)
    if last == k:
        s3 = e * (c1 * r(j, i)) + s1 * r(k, i)
    else:
        s3 = -e * (c1 * r(j, k)) - s1 * r(k, k)
    return vector(a1, a2, arctan2(s3, c3))


@core_shapes(angles=(3,))
def euler_rate_matrix(angles: Array, axes: str) -> Array:
    """The matrix E with omega_world = E @ d(angles)/dt for the axes "ijk".

    Its columns are the three axes in the world frame. In the body frame omega is R.T @ E @ d(angles)/dt.
    Source: Siciliano et al., Robotics, section 3.6.

    Args:
        angles: The three angles, shape (..., 3) [rad].
        axes: Three letters of xyz, neighbours different, such as "zyx": the turns in their order, about moving axes.

    Returns:
        E, shape (..., 3, 3) [-].

    Raises:
        InputError: `axes` is not three letters of xyz with neighbours different.
    """
    u1, u2, u3 = _turn_axes(angles, axes)
    return matrix([[u1[..., n], u2[..., n], u3[..., n]] for n in range(3)])


@core_shapes(angles=(3,), rates=(3,))
def euler_rate_matrix_dot(angles: Array, rates: Array, axes: str) -> Array:
    """The time derivative of `euler_rate_matrix`: each axis rotates with the turns before it.

    Args:
        angles: The three angles, shape (..., 3) [rad].
        rates: Their rates, shape (..., 3) [rad/s].
        axes: Three letters of xyz, neighbours different, such as "zyx": the turns in their order, about moving axes.

    Returns:
        dE/dt, shape (..., 3, 3) [1/s].

    Raises:
        InputError: `axes` is not three letters of xyz with neighbours different.
    """
    u1, u2, u3 = _turn_axes(angles, axes)
    before2 = u1 * rates[..., :1]
    before3 = before2 + u2 * rates[..., 1:2]
    columns = 0.0 * u1, cross(before2, u2), cross(before3, u3)
    return matrix([[column[..., n] for column in columns] for n in range(3)])


@core_shapes(angles=(3,))
def euler_rate_matrix_inverse(angles: Array, axes: str) -> Array:
    """The inverse of `euler_rate_matrix`; infinite where the first and last axis are parallel.

    Args:
        angles: The three angles, shape (..., 3) [rad].
        axes: Three letters of xyz, neighbours different, such as "zyx": the turns in their order, about moving axes.

    Returns:
        E^-1, shape (..., 3, 3) [-].

    Raises:
        InputError: `axes` is not three letters of xyz with neighbours different.
    """
    u1, u2, u3 = _turn_axes(angles, axes)
    normal = cross(u2, u3)
    det = dot(u1, normal)
    third = cross(u1, u2)
    return matrix(
        [
            [normal[..., n] / det for n in range(3)],
            [u2[..., n] for n in range(3)],  # u2 is at right angles to both others, so it is its own dual
            [third[..., n] / det for n in range(3)],
        ]
    )


@core_shapes(rpy=(3,))
def rpy_to_matrix(rpy: Array) -> Array:
    """The rotation Rz(yaw) Ry(pitch) Rx(roll) (..., 3, 3) of roll, pitch, yaw (..., 3) [rad], as in URDF."""
    return euler_to_matrix(rpy[..., ::-1], "zyx")


def matrix_to_rpy(rotation: Array) -> Array:
    """Roll, pitch, yaw (..., 3) [rad] with pitch in [-pi/2, pi/2]; yaw is 0 where pitch is +-pi/2."""
    return matrix_to_euler(rotation, "zyx")[..., ::-1]


@core_shapes(rpy=(3,))
def rpy_rate_matrix(rpy: Array) -> Array:
    """The matrix E (..., 3, 3) with omega_world = E @ d(roll, pitch, yaw)/dt."""
    return euler_rate_matrix(rpy[..., ::-1], "zyx")[..., ::-1]


@core_shapes(rpy=(3,))
def rpy_rate_matrix_inverse(rpy: Array) -> Array:
    """The inverse of `rpy_rate_matrix`; infinite where pitch is +-pi/2."""
    return euler_rate_matrix_inverse(rpy[..., ::-1], "zyx")[..., ::-1, :]


@core_shapes(rpy=(3,), rates=(3,))
def rpy_rate_matrix_dot(rpy: Array, rates: Array) -> Array:
    """The time derivative of `rpy_rate_matrix`.

    Args:
        rpy: Roll, pitch, yaw, shape (..., 3) [rad].
        rates: Their rates, shape (..., 3) [rad/s].

    Returns:
        The derivative, shape (..., 3, 3) [1/s].
    """
    return euler_rate_matrix_dot(rpy[..., ::-1], rates[..., ::-1], "zyx")[..., ::-1]


def eul_to_matrix(eul: Array) -> Array:
    """The rotation Rz(phi) Ry(theta) Rz(psi) (..., 3, 3) of ZYZ angles phi, theta, psi (..., 3) [rad]."""
    return euler_to_matrix(eul, "zyz")


def matrix_to_eul(rotation: Array) -> Array:
    """ZYZ angles phi, theta, psi (..., 3) [rad] with theta in [0, pi]; phi is 0 where theta is 0 or pi."""
    return matrix_to_euler(rotation, "zyz")


def eul_rate_matrix(eul: Array) -> Array:
    """The matrix E (..., 3, 3) with omega_world = E @ d(phi, theta, psi)/dt for ZYZ angles."""
    return euler_rate_matrix(eul, "zyz")


def eul_rate_matrix_inverse(eul: Array) -> Array:
    """The inverse of `eul_rate_matrix`; infinite where theta is 0 or pi."""
    return euler_rate_matrix_inverse(eul, "zyz")


@core_shapes(axis=(3,))
def angle_axis_to_matrix(angle: Any, axis: Array) -> Array:
    """The rotation by an angle about a unit vector.

    The axis is not normalised here. Written so that a constant axis along x, y or z leaves nothing but the sine and
    the cosine in traced code. Source: Siciliano et al., Robotics, eq. (2.25).

    Args:
        angle: Angle, shape (...) [rad].
        axis: Unit vector, shape (..., 3) [-].

    Returns:
        Rotation matrix, shape (..., 3, 3) [-].
    """
    s, c = sincos(angle)
    v = 1.0 - c
    x, y, z = axis[..., 0], axis[..., 1], axis[..., 2]
    xx, yy, zz = x * x, y * y, z * z
    xy, xz, yz = (x * y) * v, (x * z) * v, (y * z) * v
    return matrix(
        [
            [xx + (1.0 - xx) * c, xy - z * s, xz + y * s],
            [xy + z * s, yy + (1.0 - yy) * c, yz - x * s],
            [xz - y * s, yz + x * s, zz + (1.0 - zz) * c],
        ]
    )


@core_shapes(rotation=(3, 3))
def matrix_to_angle_axis(rotation: Array) -> tuple[Any, Array]:
    """The angle (...) in [0, pi] [rad] and the unit axis (..., 3); the axis is x where the angle is 0."""
    w = log_of_rotation(rotation)[0]
    angle2 = dot(w, w)
    zero = less(angle2, by_precision(angle2, 1e-300, 1e-36))
    angle = sqrt(where(zero, 1.0, angle2))
    x, y, z = (w[..., n] / angle for n in range(3))
    axis = vector(where(zero, 1.0, x), where(zero, 0.0, y), where(zero, 0.0, z))
    return where(zero, 0.0, angle), axis


def _turn_axes(angles: Array, axes: str) -> tuple[Array, Array, Array]:
    """The axes of the three turns in the world: e_i, R_i e_j, R_i R_j e_k."""
    i, j, k = _parse(axes)
    e = [vector(*(1.0 if n == axis else 0.0 for n in range(3))) for axis in range(3)]
    first = rotation_about(i, angles[..., 0])
    second = rotation_about(j, angles[..., 1])
    return e[i] + 0.0 * angles, apply(first, e[j]), apply(first, apply(second, e[k]))


def _parse(axes: str) -> tuple[int, int, int]:
    """The three axes as numbers."""
    letters = list(axes) if isinstance(axes, (str, list, tuple)) else []
    numbers = [("x", "y", "z").index(letter) if letter in ("x", "y", "z") else -1 for letter in letters]
    if len(numbers) != 3 or min(numbers) < 0 or numbers[0] == numbers[1] or numbers[1] == numbers[2]:
        raise InputError(
            f"`axes` is {axes!r}; expected three of the letters x, y, z with neighbours different, "
            "such as 'zyx', 'xyz' or 'zyz'."
        )
    return numbers[0], numbers[1], numbers[2]
