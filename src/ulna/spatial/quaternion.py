"""Unit quaternions as arrays (..., 4) in the order x, y, z, w: products, and the ways to and from rotations.

`q` and `-q` are the same rotation; the functions that make a quaternion return the one with w >= 0.
The order is in every name, because half of the field writes w first.
"""

from __future__ import annotations

from typing import Any

from ulna.numeric import arctan2, cross, dot, less, matrix, sqrt, vector, where
from ulna.spatial import coefficients
from ulna.spatial.batched import column, core_shapes
from ulna.typing import Array

_SMALL = 1e-3  # squared tangent of the half angle below which the arc tangent is its series


@core_shapes(quat=(4,))
def quat_xyzw_to_matrix(quat: Array) -> Array:
    """The rotation matrix (..., 3, 3) of a unit quaternion (..., 4); it is not normalised here.

    Source: Siciliano et al., Robotics, eq. (2.33).
    """
    x, y, z, w = (quat[..., i] for i in range(4))
    x2, y2, z2 = x + x, y + y, z + z
    xx, yy, zz = x * x2, y * y2, z * z2
    xy, xz, yz = x * y2, x * z2, y * z2
    wx, wy, wz = w * x2, w * y2, w * z2
    return matrix(
        [
            [1.0 - (yy + zz), xy - wz, xz + wy],
            [xy + wz, 1.0 - (xx + zz), yz - wx],
            [xz - wy, yz + wx, 1.0 - (xx + yy)],
        ]
    )


@core_shapes(rotation=(3, 3))
def matrix_to_quat_xyzw(rotation: Array) -> Array:
    """The unit quaternion (..., 4) with w >= 0 of a rotation matrix (..., 3, 3); accurate for every rotation.

    Where w is exactly zero (half turns) the sign is whichever falls out.
    """
    x, y, z, w, t = _multiple(rotation)
    f = 0.5 / sqrt(t)
    f = where(less(w, 0.0), -f, f)
    return vector(x * f, y * f, z * f, w * f)


def _multiple(r: Array) -> tuple[Any, Any, Any, Any, Any]:
    """A multiple x, y, z, w of the quaternion, and the square t of its length, over four.

    Each row of the matrix 4 q q^T is a multiple of q, and its entries are sums of entries of R. Of the four
    rows the one is taken whose entry t on the diagonal is safely away from zero: at least 1.
    Source: M. Day, Converting a Rotation Matrix to a Quaternion, Insomniac Games.
    """
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = ([r[..., i, j] for j in range(3)] for i in range(3))
    plus, minus = xx + yy, xx - yy
    below = less(zz, 0.0)
    x_first, z_first = less(yy, xx), less(xx, -yy)
    tx, ty = (1.0 - zz) + minus, (1.0 - zz) - minus
    tz, tw = (1.0 + zz) - plus, (1.0 + zz) + plus
    wx, wy, wz = zy - yz, xz - zx, yx - xy
    sxy, sxz, syz = xy + yx, xz + zx, yz + zy

    def choose(row_x: Any, row_y: Any, row_z: Any, row_w: Any) -> Any:
        return where(below, where(x_first, row_x, row_y), where(z_first, row_z, row_w))

    x = choose(tx, sxy, sxz, wx)
    y = choose(sxy, ty, syz, wy)
    z = choose(sxz, syz, tz, wz)
    w = choose(wx, wy, wz, tw)
    t = choose(tx, ty, tz, tw)
    return x, y, z, w, t


@core_shapes(a=(4,), b=(4,))
def quat_multiply(a: Array, b: Array) -> Array:
    """The product of two quaternions xyzw: the rotation `b` followed by `a`, as for matrices.

    Args:
        a, b: Quaternions, shape (..., 4) [-].

    Returns:
        a b, shape (..., 4) [-].
    """
    ax, ay, az, aw = (a[..., i] for i in range(4))
    bx, by, bz, bw = (b[..., i] for i in range(4))
    return vector(
        aw * bx + ax * bw + (ay * bz - az * by),
        aw * by + ay * bw + (az * bx - ax * bz),
        aw * bz + az * bw + (ax * by - ay * bx),
        aw * bw - (ax * bx + ay * by + az * bz),
    )


@core_shapes(quat=(4,))
def quat_conjugate(quat: Array) -> Array:
    """The conjugate of a quaternion xyzw: for a unit quaternion, the inverse rotation."""
    return vector(-quat[..., 0], -quat[..., 1], -quat[..., 2], quat[..., 3])


@core_shapes(quat=(4,))
def quat_normalize(quat: Array) -> Array:
    """The quaternion xyzw scaled to unit length."""
    return quat / column(sqrt(dot(quat, quat)))


@core_shapes(quat=(4,), v=(3,))
def quat_rotate(quat: Array, v: Array) -> Array:
    """A vector rotated by a unit quaternion.

    Args:
        quat: Unit quaternion xyzw, shape (..., 4) [-].
        v: Vector in any unit, such as [m], shape (..., 3).

    Returns:
        The rotated vector, shape (..., 3), in the same unit.
    """
    u = quat[..., :3]
    t = 2.0 * cross(u, v)
    return v + quat[..., 3:] * t + cross(u, t)


@core_shapes(w=(3,))
def quat_exp(w: Array) -> Array:
    """The unit quaternion xyzw of a rotation vector `w` (..., 3) [rad]: axis times angle."""
    s, c = coefficients.half(dot(w, w))
    s = 0.5 * s
    return vector(s * w[..., 0], s * w[..., 1], s * w[..., 2], c)


@core_shapes(quat=(4,))
def quat_log(quat: Array) -> Array:
    """The rotation vector (..., 3) [rad], no longer than pi, of a quaternion xyzw of any length but zero."""
    return _log(quat[..., 0], quat[..., 1], quat[..., 2], quat[..., 3])[0]


def log_of_rotation(rotation: Array) -> tuple[Array, Any]:
    """The rotation vector (..., 3) of a rotation (..., 3, 3), and (t/2) cot(t/2) of its length t.

    The quaternion in between need not be normalised, which spares a square root and a division.
    """
    x, y, z, w, _ = _multiple(rotation)
    return _log(x, y, z, w)


def _log(x: Any, y: Any, z: Any, w: Any) -> tuple[Array, Any]:
    """The rotation vector of a multiple of a quaternion, and (t/2) cot(t/2) of its length t.

    With n = |(x, y, z)| and t/2 = atan2(n, |w|), the vector is t/n (x, y, z), with the sign of w.
    """
    n2, w2 = x * x + y * y + z * z, w * w
    small = less(n2, _SMALL * w2)
    safe_w, n = where(small, w, 1.0), sqrt(where(small, 1.0, n2))
    tan2 = where(small, n2, 0.0) / (safe_w * safe_w)
    series = 1.0 + tan2 * (-1 / 3 + tan2 * (1 / 5 + tan2 * (-1 / 7 + tan2 * (1 / 9))))
    negative = less(w, 0.0)
    half_angle = arctan2(n, where(negative, -w, w)) / n
    f = where(small, series / safe_w, where(negative, -half_angle, half_angle))
    return vector(2.0 * f * x, 2.0 * f * y, 2.0 * f * z), f * w


@core_shapes(a=(4,), b=(4,))
def quat_slerp(a: Array, b: Array, t: Any) -> Array:
    """The quaternion at a fraction of the shorter path from `a` to `b`, at constant rate.

    Args:
        a, b: Unit quaternions xyzw, shape (..., 4) [-].
        t: The fraction, shape (...) [-]: 0 at `a`, 1 at `b`.

    Returns:
        Unit quaternion xyzw, shape (..., 4) [-].
    """
    step = quat_log(quat_multiply(quat_conjugate(a), b))
    return quat_multiply(a, quat_exp(column(t) * step))
