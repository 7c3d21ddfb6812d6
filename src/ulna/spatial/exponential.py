"""The exponential maps of SO(3) and SE(3) on bare arrays, their inverses, and the derivatives of both.

| symbol | meaning                                                    | shape       | source                |
|--------|------------------------------------------------------------|-------------|-----------------------|
| w      | rotation vector [rad]                                      | (..., 3)    |                       |
| W      | skew(w)                                                    | (..., 3, 3) |                       |
| exp    | I + A W + B W^2                                            | (..., 3, 3) | Rodrigues             |
| J_l    | I + B W + C W^2: exp(w + dw) = exp(J_l dw) exp(w)          | (..., 3, 3) | Barfoot, eq. (7.77)   |
| J_r    | J_l(-w): exp(w + dw) = exp(w) exp(J_r dw)                  | (..., 3, 3) | Barfoot, section 7.1  |
| Q      | derivative of J_l along v, the corner of the 6x6 Jacobian  | (..., 3, 3) | Barfoot, eq. (7.86)   |

Twists (..., 6) hold the linear part v [m] first, then the angular part w [rad].
Barfoot: State Estimation for Robotics, 2017. The coefficients A to F are those of `coefficients`.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.numeric import cross, dot, matrix
from ulna.spatial import coefficients
from ulna.spatial.batched import column, core_shapes
from ulna.spatial.quaternion import log_of_rotation
from ulna.typing import Array


@core_shapes(w=(3,))
def so3_exp(w: Array) -> Array:
    """The rotation (..., 3, 3) about the direction of `w` (..., 3) by its length [rad]."""
    a, b = coefficients.first_second(dot(w, w))
    return _rodrigues(w, a, b)


@core_shapes(rotation=(3, 3))
def so3_log(rotation: Array) -> Array:
    """The rotation vector w (..., 3) [rad] of a rotation (..., 3, 3), no longer than pi.

    Accurate for every rotation, also next to the identity and to half turns, because it goes by the
    quaternion. At a half turn exactly, w and -w are both right, and either is returned.
    """
    return log_of_rotation(rotation)[0]


@core_shapes(w=(3,))
def so3_left_jacobian(w: Array) -> Array:
    """J_l (..., 3, 3): the angular velocity in the fixed frame is J_l(w) @ dw/dt."""
    _, b, c = _abc(dot(w, w))
    return _rodrigues(w, b, c)


@core_shapes(w=(3,))
def so3_right_jacobian(w: Array) -> Array:
    """J_r (..., 3, 3): the angular velocity in the moving frame is J_r(w) @ dw/dt."""
    _, b, c = _abc(dot(w, w))
    return _rodrigues(w, -b, c)


@core_shapes(w=(3,))
def so3_left_jacobian_inverse(w: Array) -> Array:
    """The inverse of J_l (..., 3, 3); infinite where the angle is a whole number of turns but zero."""
    return _rodrigues(w, -0.5, _d(w))


@core_shapes(w=(3,))
def so3_right_jacobian_inverse(w: Array) -> Array:
    """The inverse of J_r (..., 3, 3); infinite where the angle is a whole number of turns but zero."""
    return _rodrigues(w, 0.5, _d(w))


def exp_parts(linear: Array, angular: Array) -> tuple[Array, Array]:
    """The exponential of a twist on SE(3): exp(w) and J_l(w) v.

    Args:
        linear: v, shape (..., 3) [m].
        angular: w, shape (..., 3) [rad].

    Returns:
        Rotation, shape (..., 3, 3) [-], and translation, shape (..., 3) [m].
    """
    a, b, c = _abc(dot(angular, angular))
    u = cross(angular, linear)
    return _rodrigues(angular, a, b), linear + column(b) * u + column(c) * cross(angular, u)


def log_parts(rotation: Array, translation: Array) -> tuple[Array, Array]:
    """The logarithm on SE(3): J_l(w)^-1 p and w.

    Args:
        rotation: Rotation matrix, shape (..., 3, 3) [-].
        translation: p, shape (..., 3) [m].

    Returns:
        Linear and angular part, each of shape (..., 3) [m], [rad].
    """
    w, half_cot = log_of_rotation(rotation)
    d = coefficients.inverse(dot(w, w), half_cot)
    u = cross(w, translation)
    return translation - 0.5 * u + column(d) * cross(w, u), w


@core_shapes(twist=(6,))
def se3_left_jacobian(twist: Array) -> Array:
    """The 6x6 left Jacobian (..., 6, 6): exp(x + dx) = exp(J dx) exp(x). Source: Barfoot, eq. (7.85)."""
    v, w = twist[..., :3], twist[..., 3:]
    t2 = dot(w, w)
    _, b, c = _abc(t2)
    e = coefficients.fourth(t2, b)
    f = coefficients.fifth(t2, b, c)
    return _upper(_rodrigues(w, b, c), _derivative(v, w, (b, c), (2.0 * e - c, -2.0 * f)))


@core_shapes(twist=(6,))
def se3_right_jacobian(twist: Array) -> Array:
    """The 6x6 right Jacobian (..., 6, 6): exp(x + dx) = exp(x) exp(J dx)."""
    return se3_left_jacobian(-twist)


@core_shapes(twist=(6,))
def se3_left_jacobian_inverse(twist: Array) -> Array:
    """The inverse of the 6x6 left Jacobian (..., 6, 6).

    Its corner, -J_l^-1 Q J_l^-1 in Barfoot's eq. (7.95), is computed as what it is: the derivative of J_l^-1
    along v, at half the cost.
    """
    v, w = twist[..., :3], twist[..., 3:]
    t2 = dot(w, w)
    s, c = coefficients.half(t2)
    d = coefficients.inverse(t2, c / s)
    g = coefficients.inverse_slope(t2, c / s, d)
    return _upper(_rodrigues(w, -0.5, d), _derivative(v, w, (-0.5, d), (0.0, g)))


@core_shapes(twist=(6,))
def se3_right_jacobian_inverse(twist: Array) -> Array:
    """The inverse of the 6x6 right Jacobian (..., 6, 6)."""
    return se3_left_jacobian_inverse(-twist)


def _rodrigues(w: Array, first: Any, second: Any) -> Array:
    """I + first W + second W^2."""
    x, y, z = w[..., 0], w[..., 1], w[..., 2]
    sx, sy, sz = second * x, second * y, second * z
    xx, yy, zz, xy, xz, yz = sx * x, sy * y, sz * z, sx * y, sx * z, sy * z
    x, y, z = first * x, first * y, first * z
    return matrix(
        [
            [1.0 - (yy + zz), xy - z, xz + y],
            [xy + z, 1.0 - (xx + zz), yz - x],
            [xz - y, yz + x, 1.0 - (xx + yy)],
        ]
    )


def _abc(t2: Any) -> tuple[Any, Any, Any]:
    a, b = coefficients.first_second(t2)
    return a, b, coefficients.third(t2, a)


def _d(w: Array) -> Any:
    t2 = dot(w, w)
    s, c = coefficients.half(t2)
    return coefficients.inverse(t2, c / s)


def _derivative(v: Array, w: Array, factors: tuple[Any, Any], slopes: tuple[Any, Any]) -> Array:
    """The derivative along `v` of I + first W + second W^2; the slopes are d(factor)/dt, over t.

    It is first V + second (W V + V W) + (w.v) (first_slope W + second_slope W^2), where
    W V + V W = w v^T + v w^T - 2 (w.v) I and W^2 = w w^T - t^2 I.
    """
    (first, second), (first_slope, second_slope) = factors, slopes
    t2, wv = dot(w, w), dot(w, v)
    turn = column(first) * v + column(first_slope * wv) * w  # of the skew part
    x, y, z = (turn[..., n] for n in range(3))
    half_slope = 0.5 * (second_slope * wv)
    u = column(second) * v + column(half_slope) * w  # of the symmetric part, w u^T + u w^T - trace I
    p = [[w[..., i] * u[..., j] + u[..., i] * w[..., j] for j in range(3)] for i in range(3)]
    trace = 2.0 * (second * wv + half_slope * t2)
    return matrix(
        [
            [p[0][0] - trace, p[0][1] - z, p[0][2] + y],
            [p[0][1] + z, p[1][1] - trace, p[1][2] - x],
            [p[0][2] - y, p[1][2] + x, p[2][2] - trace],
        ]
    )


def _upper(diagonal: Array, corner: Array) -> Array:
    """The matrix [[diagonal, corner], [0, diagonal]]."""
    zero = np.zeros_like(corner)
    top = np.concatenate(np.broadcast_arrays(diagonal, corner), axis=-1)
    return np.concatenate([top, np.concatenate(np.broadcast_arrays(zero, diagonal), axis=-1)], axis=-2)
