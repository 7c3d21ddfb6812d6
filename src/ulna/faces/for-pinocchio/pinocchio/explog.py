"""Exponentials and logarithms of SO(3) and SE(3), and their Jacobians on the right."""

from __future__ import annotations

from typing import Any

import numpy as np

from pinocchio._arrays import matrix, numbers, vector
from pinocchio._se3 import SE3, SE3ToXYZQUAT
from pinocchio._vectors import Motion
from ulna import spatial
from ulna.errors import ShapeError
from ulna.typing import Floats

__all__ = [
    "Jexp3",
    "Jexp6",
    "Jlog3",
    "Jlog6",
    "exp",
    "exp3",
    "exp3_quat",
    "exp6",
    "exp6_quat",
    "log",
    "log3",
    "log6",
    "log6_quat",
]


def exp3(w: Any) -> Floats:
    """The rotation matrix (3, 3) of a rotation vector (3,) [rad]."""
    return np.array(spatial.so3_exp(vector(w, 3, "w")))


def log3(R: Any, theta: Any = None) -> Floats:
    """The rotation vector (3,) [rad] of a rotation matrix."""
    return np.array(spatial.so3_log(matrix(R, (3, 3), "R")))


def exp3_quat(w: Any) -> Floats:
    """The quaternion xyzw (4,) of a rotation vector (3,) [rad]."""
    return np.array(spatial.quat_exp(vector(w, 3, "w")))


def exp6(v: Any) -> SE3:
    """The placement reached in one second with a Motion (or six numbers)."""
    return SE3._of(np.array(spatial.se3_exp(_six(v)).matrix()))


def exp6_quat(v: Any) -> Floats:
    """The same as position and quaternion xyzw (7,)."""
    return SE3ToXYZQUAT(exp6(v))


def log6(M: Any) -> Motion:
    """The Motion that leads to a placement (SE3 or 4x4) in one second."""
    return Motion._from(spatial.se3_log(_placement(M)._pose()))


def log6_quat(xyzquat: Any) -> Motion:
    """The Motion that leads to a position and quaternion xyzw (7,) in one second."""
    given = vector(xyzquat, 7, "xyzquat")
    return Motion._from(spatial.se3_log(spatial.SE3.from_quat_xyzw(given[3:], given[:3])))


def Jexp3(w: Any) -> Floats:
    """The right Jacobian (3, 3) of the exponential of SO(3)."""
    return np.array(spatial.so3_right_jacobian(vector(w, 3, "w")))


def Jlog3(R: Any) -> Floats:
    """The right Jacobian (3, 3) of the logarithm of SO(3)."""
    return np.array(spatial.so3_right_jacobian_inverse(log3(R)))


def Jexp6(v: Any) -> Floats:
    """The right Jacobian (6, 6) of the exponential of SE(3)."""
    return np.array(spatial.se3_right_jacobian(_six(v)))


def Jlog6(M: Any) -> Floats:
    """The right Jacobian (6, 6) of the logarithm of SE(3)."""
    return np.array(spatial.se3_right_jacobian_inverse(log6(M)._v))


def exp(x: Any) -> Any:
    """`exp3` of three numbers, `exp6` of a Motion or of six, the exponential of one number."""
    if isinstance(x, Motion):
        return exp6(x)
    array = numbers(x, "x")
    if array.ndim == 0:
        return float(np.exp(array))
    flat = array.reshape(-1)
    if flat.size == 3:
        return exp3(flat)
    if flat.size == 6:
        return exp6(flat)
    raise ShapeError("x", array.shape, "a Motion, or 1, 3 or 6 numbers")


def log(x: Any) -> Any:
    """`log6` of an SE3 or 4x4 matrix, `log3` of a rotation matrix, the logarithm of one number."""
    if isinstance(x, SE3):
        return log6(x)
    array = numbers(x, "x")
    if array.ndim == 0:
        return float(np.log(array))
    if array.shape == (4, 4):
        return log6(array)
    if array.shape == (3, 3):
        return log3(array)
    raise ShapeError("x", array.shape, "an SE3, (3, 3) or (4, 4)")


def _six(v: Any) -> Floats:
    return v._v if isinstance(v, Motion) else vector(v, 6, "v")


def _placement(M: Any) -> SE3:
    return M if isinstance(M, SE3) else SE3(M)
