"""The analytical Jacobian: what each joint velocity adds to the rates of position and of a set of angles.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| R | rotation of the frame in the world | (3, 3) | | |
| J | Jacobian in local_world_aligned, rows linear and angular | (6, nv) | | see jacobian.py |
| w | angular velocity of the frame in world axes | (3) | [rad/s] | |
| "rpy/zyx" | roll r, pitch p, yaw y | (3) | [rad] | R = Rz(y) Ry(p) Rx(r), cos p >= 0 |
| "rpy/xyz" | roll r, pitch p, yaw y | (3) | [rad] | R = Rx(y) Ry(p) Rz(r), cos p >= 0 |
| "eul" | phi, theta, psi | (3) | [rad] | R = Rz(phi) Ry(theta) Rz(psi), sin theta >= 0 |
| "exp" | rotation vector u | (3) | [rad] | R = exp(skew(u)), norm(u) <= pi |
| u1, u2, u3 | axes of the three turns in the world | (3) | | u1 = e_i, u3 = R e_k, u2 = sign u1 x u3 / s |
| s | sine of the angle between first and last axis | () | | s = norm(u1 x u3) |
| B | rates of the angles = B w | (3, 3) | | Siciliano section 3.6, inverted |
| | its rows: the dual basis of u1, u2, u3 | (3) | | -sign (u2 x u3) / s, u2, -sign (u1 x u2) / s |
| | for "exp", t = norm(u) | (3, 3) | | I - U/2 + D U^2, U = skew(u), D = (1 - (t/2) cot(t/2)) / t^2 |
| J_a | analytical Jacobian | (6, nv) | | J_a = [J_lin; B J_ang] |

The three axes are read from R, so no angle is computed. Where first and last axis are in line (s = 0: pitch
+-pi/2, theta 0 or pi) the angles are singular and the result is inf or nan. The rotation vector jumps where
norm(u) = pi.
"""

from __future__ import annotations

from typing import Any, Literal, NamedTuple, TypeAlias, get_args

import numpy as np

from ulna.algorithms.kinematics.forward_kinematics import frame_pose, frame_velocity
from ulna.algorithms.kinematics.jacobian import frame_jacobian
from ulna.algorithms.kinematics.jacobian_dot import frame_jacobian_dot
from ulna.algorithms.multibody.batch_shapes import batch_zeros
from ulna.errors import UnknownName
from ulna.model import Frame, Model
from ulna.numeric import apply, cross, dot, skew, sqrt
from ulna.spatial import coefficients, so3_left_jacobian_inverse, so3_log
from ulna.spatial.batched import column
from ulna.typing import Array

Representation: TypeAlias = Literal["rpy/xyz", "rpy/zyx", "eul", "exp"]


class _Turns(NamedTuple):
    """First and last axis, the sign of e_i x e_k against the second, and which rate stands in which row."""

    first: int
    last: int
    sign: float
    rows: tuple[int, int, int]


_TURNS = {
    "rpy/zyx": _Turns(first=2, last=0, sign=1.0, rows=(2, 1, 0)),
    "rpy/xyz": _Turns(first=0, last=2, sign=-1.0, rows=(2, 1, 0)),
    "eul": _Turns(first=2, last=2, sign=1.0, rows=(0, 1, 2)),
}


def analytical_jacobian(
    model: Model, q: Array, frame: Frame, representation: Representation = "rpy/xyz"
) -> Array:
    """The Jacobian of a frame's position and angles.

    The last three rows give the rates of roll, pitch, yaw; of phi, theta, psi; or of the rotation vector.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        frame: A frame of the model.
        representation: "rpy/xyz", "rpy/zyx", "eul" or "exp".

    Returns:
        Shape (..., 6, nv); inf or nan in the last three rows where the angles are singular.

    Raises:
        UnknownName: no such representation.
    """
    J = frame_jacobian(model, q, frame)
    B = rate_matrix(frame_pose(model, q, frame).rotation, representation)
    J_a = batch_zeros((6, model.nv), q)
    J_a[..., :3, :] = J[..., :3, :]
    J_a[..., 3:, :] = B @ J[..., 3:, :]
    return J_a


def analytical_jacobian_dot(
    model: Model, q: Array, v: Array, frame: Frame, representation: Representation = "rpy/xyz"
) -> Array:
    """The time derivative of `analytical_jacobian` along `v`.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].
        frame: A frame of the model.
        representation: "rpy/xyz", "rpy/zyx", "eul" or "exp".

    Returns:
        Shape (..., 6, nv); inf or nan in the last three rows where the angles are singular.

    Raises:
        UnknownName: no such representation.
    """
    J, dJ = frame_jacobian(model, q, frame), frame_jacobian_dot(model, q, v, frame)
    R, w = frame_pose(model, q, frame).rotation, frame_velocity(model, q, v, frame).angular
    B, dB = rate_matrix(R, representation), _rate_matrix_dot(R, w, representation)
    result = batch_zeros((6, model.nv), q, v)
    result[..., :3, :] = dJ[..., :3, :]
    result[..., 3:, :] = B @ dJ[..., 3:, :] + dB @ J[..., 3:, :]
    return result


def rate_matrix(R: Array, representation: Representation) -> Array:
    """The matrix that takes an angular velocity in world axes to the rates of the angles.

    Args:
        R: Rotation of the frame in the world, shape (..., 3, 3) [-].
        representation: "rpy/xyz", "rpy/zyx", "eul" or "exp".

    Returns:
        B, shape (..., 3, 3) [-]; inf or nan where the angles are singular.
    """
    if representation == "exp":
        return so3_left_jacobian_inverse(so3_log(R))
    turns = _turns(representation)
    rows = _rows(turns, *_axes(R, turns))
    return np.stack([rows[i] for i in turns.rows], axis=-2)


def _rate_matrix_dot(R: Array, w: Array, representation: Representation) -> Array:
    """The time derivative of `rate_matrix` while the frame turns.

    Args:
        R: Rotation of the frame in the world, shape (..., 3, 3) [-].
        w: Its angular velocity in world axes, shape (..., 3) [rad/s].
        representation: "rpy/xyz", "rpy/zyx", "eul" or "exp".

    Returns:
        dB/dt, shape (..., 3, 3) [1/s].
    """
    if representation == "exp":
        return _inverse_left_jacobian_dot(so3_log(R), w)
    turns = _turns(representation)
    u1, u2, u3, s = _axes(R, turns)
    first, _, last = _rows(turns, u1, u2, u3, s)
    du2 = column(dot(first, w)) * cross(u1, u2)  # the second axis turns about the first
    du3 = cross(w, u3)
    growth = column(-dot(u1, u3) * dot(u1, du3) / (s * s))  # s^2 = 1 - (u1 . u3)^2
    factor = column(-turns.sign / s)
    rows = [
        factor * (cross(du2, u3) + cross(u2, du3)) - growth * first,
        du2,
        factor * cross(u1, du2) - growth * last,
    ]
    return np.stack([rows[i] for i in turns.rows], axis=-2)


def _axes(R: Array, turns: _Turns) -> tuple[Array, Array, Array, Any]:
    """u1, u2, u3 and s."""
    u1, u3 = np.eye(3)[turns.first], R[..., turns.last]
    normal = cross(u1, u3)
    s = sqrt(dot(normal, normal))
    return u1, column(turns.sign / s) * normal, u3, s


def _rows(turns: _Turns, u1: Array, u2: Array, u3: Array, s: Any) -> list[Array]:
    """What takes w to the rates of the first, second and last turn."""
    factor = column(-turns.sign / s)
    return [factor * cross(u2, u3), u2, factor * cross(u1, u2)]


def _turns(representation: str) -> _Turns:
    if representation not in _TURNS:
        raise UnknownName("representation", representation, get_args(Representation))
    return _TURNS[representation]


def _inverse_left_jacobian_dot(u: Array, w: Array) -> Array:
    """d/dt (I - U/2 + D U^2), by dD/dt = G (u . du/dt); D and G are those of `ulna.spatial.coefficients`."""
    du = apply(so3_left_jacobian_inverse(u), w)
    t2 = dot(u, u)
    s, c = coefficients.half(t2)
    D = coefficients.inverse(t2, c / s)
    G = coefficients.inverse_slope(t2, c / s, D)
    U, dU = skew(u), skew(du)
    return -0.5 * dU + column(G * dot(u, du), 2) * (U @ U) + column(D, 2) * (dU @ U + U @ dU)
