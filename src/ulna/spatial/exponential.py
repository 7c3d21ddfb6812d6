"""The exponential maps of SO(3) and SE(3) on bare arrays, their inverses, and the derivatives of both.

| symbol | meaning                                                    | shape     | source                  |
|--------|------------------------------------------------------------|-----------|-------------------------|
| w      | rotation vector [rad]                                      | (..., 3)  |                         |
| W      | skew(w)                                                    | (..., 3, 3) |                       |
| exp    | I + A W + B W^2                                            | (..., 3, 3) | Rodrigues             |
| J_l    | left Jacobian I + B W + C W^2: exp(w + dw) = exp(J_l dw) exp(w) | (..., 3, 3) | Barfoot, eq. (7.77a) |
| J_r    | right Jacobian J_l(-w):        exp(w + dw) = exp(w) exp(J_r dw) | (..., 3, 3) | Barfoot, section 7.1.5 |
| Q      | the derivative of J_l along v, corner of the 6x6 Jacobian  | (..., 3, 3) | Barfoot, eq. (7.86)   |

Twists (..., 6) hold the linear part v [m] first, then the angular part w [rad].
Barfoot: State Estimation for Robotics, 2017. The coefficients A to F are those of `coefficients`.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.numeric import cross, dot, is_symbolic, matrix
from ulna.spatial import coefficients
from ulna.spatial.batched import column
from ulna.spatial.quaternion import _log, _multiple
from ulna.typing import Array


def so3_exp(w: Array) -> Array:
    """The rotation (..., 3, 3) about the direction of `w` (..., 3) by its length [rad]."""
    a, b = coefficients.first_second(dot(w, w))
    return _rodrigues(w, a, b)


def so3_log(rotation: Array) -> Array:
    """The rotation vector w (..., 3) [rad] of a rotation (..., 3, 3), no longer than pi.

    Accurate for every rotation, also next to the identity and to half turns, because it goes by the quaternion. At a
    half turn exactly, w and -w are both right, and either is returned.
    """
    return _log(*_multiple(rotation)[:4])[0]


def so3_left_jacobian(w: Array) -> Array:
    """J_l (..., 3, 3): the angular velocity in the fixed frame is J_l(w) @ dw/dt."""
    _, b, c = _abc(w)
    return _rodrigues(w, b, c)


def so3_right_jacobian(w: Array) -> Array:
    """J_r (..., 3, 3): the angular velocity in the moving frame is J_r(w) @ dw/dt."""
    _, b, c = _abc(w)
    return _rodrigues(w, -b, c)


def so3_left_jacobian_inverse(w: Array) -> Array:
    """The inverse of J_l (..., 3, 3); infinite where the angle is a whole number of turns but zero."""
    return _rodrigues(w, -0.5, _d(w))


def so3_right_jacobian_inverse(w: Array) -> Array:
    """The inverse of J_r (..., 3, 3); infinite where the angle is a whole number of turns but zero."""
    return _rodrigues(w, 0.5, _d(w))


def exp_parts(linear: Array, angular: Array) -> tuple[Array, Array]:
    """Rotation and translation of the SE(3) exponential of a twist: exp(w) and J_l(w) v."""
    a, b, c = _abc(angular)
    u = cross(angular, linear)
    return _rodrigues(angular, a, b), linear + column(b) * u + column(c) * cross(angular, u)


def log_parts(rotation: Array, translation: Array) -> tuple[Array, Array]:
    """Linear and angular part of the SE(3) logarithm: J_l(w)^-1 p and w."""
    w, half_cot = _log(*_multiple(rotation)[:4])
    d = coefficients.inverse(dot(w, w), half_cot)
    u = cross(w, translation)
    return translation - 0.5 * u + column(d) * cross(w, u), w


def se3_left_jacobian(twist: Array) -> Array:
    """The 6x6 left Jacobian (..., 6, 6): exp(x + dx) = exp(J dx) exp(x). Source: Barfoot, eq. (7.85)."""
    v, w = twist[..., :3], twist[..., 3:]
    return _upper(so3_left_jacobian(w), _q(v, w))


def se3_right_jacobian(twist: Array) -> Array:
    """The 6x6 right Jacobian (..., 6, 6): exp(x + dx) = exp(x) exp(J dx)."""
    return se3_left_jacobian(-twist)


def se3_left_jacobian_inverse(twist: Array) -> Array:
    """The inverse of the 6x6 left Jacobian (..., 6, 6). Source: Barfoot, eq. (7.95)."""
    v, w = twist[..., :3], twist[..., 3:]
    inverse = so3_left_jacobian_inverse(w)
    return _upper(inverse, -(inverse @ _q(v, w) @ inverse))


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


def _abc(w: Array) -> tuple[Any, Any, Any]:
    t2 = dot(w, w)
    a, b = coefficients.first_second(t2)
    return a, b, coefficients.third(t2, a)


def _d(w: Array) -> Any:
    t2 = dot(w, w)
    s, c = coefficients.half(t2)
    return coefficients.inverse(t2, c / s)


def _q(v: Array, w: Array) -> Array:
    """B V + C (W V + V W) + (w.v) ((2 E - C) W - 2 F W^2): Barfoot's corner block, with the triple products undone.

    W V W = -(w.v) W, and W V + V W = w v^T + v w^T - 2 (w.v) I.
    """
    _, b, c = _abc(w)
    t2, wv = dot(w, w), dot(w, v)
    e = coefficients.fourth(t2, b)
    f = coefficients.fifth(t2, b, c)
    skew_part = column(b) * v + column(wv * (2.0 * e - c)) * w
    x, y, z = (skew_part[..., n] for n in range(3))
    g = -2.0 * (f * wv)
    # The symmetric part C (w v^T + v w^T) + g w w^T, written as w u^T + u w^T.
    u = column(c) * v + column(0.5 * g) * w
    p = [[w[..., i] * u[..., j] + u[..., i] * w[..., j] for j in range(3)] for i in range(3)]
    diagonal = 2.0 * (c * wv) + g * t2
    return matrix(
        [
            [p[0][0] - diagonal, p[0][1] - z, p[0][2] + y],
            [p[0][1] + z, p[1][1] - diagonal, p[1][2] - x],
            [p[0][2] - y, p[1][2] + x, p[2][2] - diagonal],
        ]
    )


def _upper(diagonal: Array, corner: Array) -> Array:
    """The matrix [[diagonal, corner], [0, diagonal]]."""
    zero = np.zeros_like(corner) if not is_symbolic(corner) else np.full(corner.shape, 0.0, dtype=object)
    top = np.concatenate(np.broadcast_arrays(diagonal, corner), axis=-1)
    return np.concatenate([top, np.concatenate(np.broadcast_arrays(zero, diagonal), axis=-1)], axis=-2)
