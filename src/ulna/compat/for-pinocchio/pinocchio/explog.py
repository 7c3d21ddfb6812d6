"""Exponentials and logarithms of SO(3) and SE(3), and their Jacobians on the right."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from pinocchio._containers.arguments import OMITTED, ArgumentError, WrongShape, is_number
from pinocchio._containers.arrays import matrix, numbers, vector
from pinocchio._containers.keywords import by_name
from pinocchio._spatial.bound_functions import BoundFunctions, directly, without_gaps
from pinocchio._spatial.motion_force import Motion
from pinocchio._spatial.rotations import UNIT_TOLERANCE, Quaternion, check_unit
from pinocchio._spatial.se3 import SE3, as_placement
from ulna import spatial
from ulna.compiler import compile as compile_function
from ulna.compiler import trace
from ulna.typing import Array, Floats

__all__ = [
    "Hlog3",
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


def _twist(T: Array) -> Array:
    return spatial.se3_log(spatial.SE3(T[:3, :3], T[:3, 3])).vector()


def _placement_in_seven(v: Array) -> Array:
    return np.concatenate([spatial.se3_exp(v).translation, spatial.quat_exp(v[3:])])


def _twist_of_seven(x: Array) -> tuple[Array, Any]:
    """The logarithm of a position and a quaternion, and a number above zero where its length is close to 1."""
    T = spatial.SE3.from_quat_xyzw(x[3:], x[:3])
    off = x[3:] @ x[3:] - (1.0 + UNIT_TOLERANCE**2)
    return spatial.se3_log(T).vector(), (2.0 * UNIT_TOLERANCE) ** 2 - off * off


_FUNCTIONS: dict[str, tuple[Any, ...]] = {
    "exp3 as quaternion": (spatial.quat_exp, (3,)),
    "exp6 as seven": (_placement_in_seven, (6,)),
    "exp3": (spatial.so3_exp, (3,)),
    "log3": (spatial.so3_log, (3, 3)),
    "exp6": (lambda x: spatial.se3_exp(x).matrix(), (6,)),
    "log6": (_twist, (4, 4)),
    "Jexp3": (spatial.so3_right_jacobian, (3,)),
    "Jlog3": (lambda R: spatial.so3_right_jacobian_inverse(spatial.so3_log(R)), (3, 3)),
    "Jexp6": (spatial.se3_right_jacobian, (6,)),
    "Jlog6": (lambda T: spatial.se3_right_jacobian_inverse(_twist(T)), (4, 4)),
}


_EXACT = BoundFunctions(_FUNCTIONS, exact=True)
_CONVERTING = BoundFunctions(_FUNCTIONS)
_PLACEMENTS = BoundFunctions({"exp6": _FUNCTIONS["exp6"]}, holder=SE3)
_MOTIONS = BoundFunctions(
    {"log6": _FUNCTIONS["log6"], "log6 of seven": (_twist_of_seven, (7,))}, holder=Motion
)


@directly(_EXACT.row("exp3", np.ndarray))
def exp3(w: Any) -> Floats:
    """The rotation matrix (3, 3) of a rotation vector (3,) [rad]."""
    R = _EXACT["exp3"](w)
    return _CONVERTING["exp3"](vector(w, 3, "w")) if R is NotImplemented else R


@directly(_EXACT.row("log3", np.ndarray))
@by_name("R theta", "quat theta")
def log3(R: Any, theta: Any = OMITTED) -> Floats:
    """The rotation vector of a rotation.

    Args:
        R: Rotation matrix (3, 3), a Quaternion, or its coefficients x, y, z, w, (4,); as in Pinocchio, the vector is
            as much too long as the quaternion is.
        theta: An array (1,) that takes the angle [rad]; it may be left out.

    Returns:
        Rotation vector (3,) [rad].

    Raises:
        ArgumentError: `theta` is no such array.
    """
    if theta is OMITTED:
        turn = without_gaps(_EXACT["log3"], R)
        if turn is not NotImplemented:
            return turn
    turned, length = R.coeffs() if isinstance(R, Quaternion) else numbers(R, "R"), 1.0
    if turned.shape in ((4,), (4, 1)):
        length = check_unit(turned.ravel(), "log3")
        turned = Quaternion(turned / length).matrix()
    turn = _CONVERTING["log3"](matrix(turned, (3, 3), "R"))
    if isinstance(theta, np.ndarray) and theta.dtype == float and theta.size == 1:
        theta[...] = np.linalg.norm(turn)
    elif theta is not OMITTED:
        raise ArgumentError(f"`theta` is {theta!r}; expected an array (1,) of floats, which takes the angle.")
    return length * turn


@directly(_EXACT.row("exp3 as quaternion", np.ndarray))
def exp3_quat(w: Any) -> Floats:
    """The quaternion xyzw (4,) of a rotation vector (3,) [rad]."""
    return _CONVERTING["exp3 as quaternion"](vector(w, 3, "w"))


@directly(_PLACEMENTS.row("exp6", Motion), _PLACEMENTS.row("exp6", np.ndarray))
@by_name("v", "motion")
def exp6(v: Any) -> SE3:
    """The placement reached in one second with a Motion (or six numbers)."""
    return _PLACEMENTS["exp6"](_six(v))


@directly(_EXACT.row("exp6 as seven", Motion), _EXACT.row("exp6 as seven", np.ndarray))
def exp6_quat(v: Any) -> Floats:
    """The same as position and quaternion xyzw (7,)."""
    return _CONVERTING["exp6 as seven"](_six(v))


@directly(_MOTIONS.row("log6", SE3), _MOTIONS.row("log6", np.ndarray))
@by_name("M", "homegeneous_matrix")
def log6(M: Any) -> Motion:
    """The Motion that leads to a placement (SE3 or 4x4) in one second."""
    return _MOTIONS["log6"](M._m if type(M) is SE3 else _placement(M)._m)


@directly(_MOTIONS.row("log6 of seven", np.ndarray))
@by_name("q", "xyzquat")
def log6_quat(xyzquat: Any) -> Motion:
    """The Motion that leads to a position and quaternion xyzw (7,) in one second; the quaternion is scaled."""
    values = vector(xyzquat, 7, "xyzquat")
    check_unit(values[3:], "log6_quat")
    return Motion._from(spatial.se3_log(spatial.SE3.from_quat_xyzw(values[3:], values[:3])))


@directly(_EXACT.row("Jexp3", np.ndarray))
def Jexp3(w: Any) -> Floats:
    """The right Jacobian (3, 3) of the exponential of SO(3)."""
    return _CONVERTING["Jexp3"](vector(w, 3, "w"))


@directly(_EXACT.row("Jlog3", np.ndarray))
def Jlog3(R: Any) -> Floats:
    """The right Jacobian (3, 3) of the logarithm of SO(3)."""
    J = without_gaps(_EXACT["Jlog3"], R)
    return _CONVERTING["Jlog3"](matrix(R, (3, 3), "R")) if J is NotImplemented else J


@directly(_EXACT.row("Jexp6", Motion), _EXACT.row("Jexp6", np.ndarray))
@by_name("v", "motion")
def Jexp6(v: Any) -> Floats:
    """The right Jacobian (6, 6) of the exponential of SE(3)."""
    return _CONVERTING["Jexp6"](_six(v))


@directly(_EXACT.row("Jlog6", SE3))
def Jlog6(M: Any) -> Floats:
    """The right Jacobian (6, 6) of the logarithm of SE(3)."""
    return _CONVERTING["Jlog6"](_placement(M)._m)


def Hlog3(R: Any, v: Any) -> Floats:
    """The derivative (3, 3) of Jlog3(R) as R turns on along v (3,).

    Args:
        R: Rotation matrix (3, 3).
        v: Direction (3,), in any unit [-].

    Returns:
        Derivative (3, 3).
    """
    rotation = matrix(R, (3, 3), "R")
    return _bend()(log3(rotation)) @ (Jlog3(rotation) @ vector(v, 3, "v"))


@cache
def _bend() -> Any:
    """The derivative (3, 3, 3) of the inverse right Jacobian at w by w."""
    return compile_function(trace(spatial.so3_right_jacobian_inverse, w=(3,)).jacobian("w"))


def exp(x: Any) -> Any:
    """`exp3` of three numbers, `exp6` of a Motion or of six, the exponential of one number."""
    if isinstance(x, Motion):
        return exp6(x)
    if not isinstance(x, np.ndarray) and not is_number(x):
        raise ArgumentError(f"`x` is {x!r}; expected a Motion, a number, or an array of 3 or 6.")
    array = numbers(x, "x")
    if array.ndim == 0:
        return float(np.exp(array))
    flat = array.reshape(-1)
    if flat.size == 3:
        return exp3(flat)
    if flat.size == 6:
        return exp6(flat)
    raise WrongShape("x", array.shape, "a Motion, or 1, 3 or 6 numbers")


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
    raise WrongShape("x", array.shape, "an SE3, (3, 3) or (4, 4)")


def _six(v: Any) -> Floats:
    return v._v if isinstance(v, Motion) else vector(v, 6, "v")


def _placement(M: Any) -> SE3:
    M = as_placement(M)
    return M if isinstance(M, SE3) else SE3(matrix(M, (4, 4), "M"))
