"""Roll, pitch and yaw: R = Rz(yaw) Ry(pitch) Rx(roll)."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from pinocchio._containers.arguments import ArgumentError, check_text, checks_itself
from pinocchio._containers.arrays import exact, matrix, real
from pinocchio._containers.enums import ReferenceFrame, reference_of
from pinocchio._containers.keywords import by_name
from pinocchio._spatial.bound_functions import BoundFunctions, directly, without_gaps
from ulna import numeric, spatial
from ulna.compiler.runtime.repeated_calls import CallCache, call_cache, repeated_calls
from ulna.errors import UnknownName
from ulna.typing import Floats


def _split(R: Any) -> Any:
    """Source: Siciliano et al., Robotics, eq. (2.22), with roll by the matrix turned back by yaw."""
    yaw = numeric.arctan2(R[1, 0], R[0, 0])
    s, c = numeric.sincos(yaw)
    pitch = numeric.arctan2(-R[2, 0], numeric.sqrt(R[2, 1] * R[2, 1] + R[2, 2] * R[2, 2]))
    return numeric.vector(numeric.arctan2(s * R[0, 2] - c * R[1, 2], c * R[1, 1] - s * R[0, 1]), pitch, yaw)


def _local_rates(rpy: Any) -> Any:
    return spatial.rpy_to_matrix(rpy).T @ spatial.rpy_rate_matrix(rpy)


def _local_derivative(rpy: Any, rates: Any) -> Any:
    """The rate of R^T E, where R turns with E rates."""
    E = spatial.rpy_rate_matrix(rpy)
    turning: Any = numeric.skew(E @ rates)
    return spatial.rpy_to_matrix(rpy).T @ (spatial.rpy_rate_matrix_dot(rpy, rates) - turning @ E)


_EXACT = BoundFunctions(
    {
        "matrix": (spatial.rpy_to_matrix, (3,)),
        "of angles": (lambda *rpy: spatial.rpy_to_matrix(numeric.vector(*rpy)), (), (), ()),
        "rpy": (_split, (3, 3)),
        "local rates": (_local_rates, (3,)),
        "world rates": (spatial.rpy_rate_matrix, (3,)),
        "local inverse": (lambda x: spatial.rpy_rate_matrix_inverse(x) @ spatial.rpy_to_matrix(x), (3,)),
        "world inverse": (spatial.rpy_rate_matrix_inverse, (3,)),
        "local derivative": (_local_derivative, (3,), (3,)),
        "world derivative": (spatial.rpy_rate_matrix_dot, (3,), (3,)),
    },
    exact=True,
)
_AXES = ("x", "y", "z")
_TURNS = BoundFunctions(
    {axis: (partial(spatial.rotation_about, k), ()) for k, axis in enumerate(_AXES)}, exact=True
)


@directly(_EXACT.row("of angles", float, float, float), _EXACT.row("matrix", np.ndarray))
@by_name("roll pitch yaw", "rpy")
def rpyToMatrix(*rpy: Any) -> Floats:
    """The rotation matrix (3, 3) of roll, pitch, yaw [rad]: three numbers, or an array (3,)."""
    if len(rpy) not in (1, 3):
        raise ArgumentError(
            f"rpyToMatrix was given {len(rpy)} arguments; expected three angles, or an array (3,)."
        )
    if len(rpy) == 1:
        R = _EXACT["matrix"](rpy[0])
        if R is not NotImplemented:
            return R
    return _EXACT["matrix"](exact(rpy if len(rpy) == 3 else rpy[0], 3, "rpy"))


@directly(_EXACT.row("rpy", np.ndarray))
def matrixToRpy(R: Any) -> Floats:
    """Roll, pitch, yaw (3,) [rad] of a rotation matrix; where pitch is +-pi/2 its first column divides the turn."""
    rpy = without_gaps(_EXACT["rpy"], R)
    if rpy is NotImplemented:
        rpy = _EXACT["rpy"](np.array(matrix(R, (3, 3), "R"), dtype=float, order="C"))
    return rpy


def rotate(axis: str, angle: float) -> Floats:
    """The rotation matrix (3, 3) about 'x', 'y' or 'z' by an angle [rad].

    Args:
        axis: "x", "y" or "z".
        angle: Angle [rad].

    Returns:
        Rotation matrix (3, 3).

    Raises:
        UnknownAxis: Another axis.
    """
    if type(angle) is float and type(axis) is str and axis in _AXES:
        return _TURNS[axis](angle)
    turn = real(angle, "angle")
    check_text(axis, "axis")
    if axis not in _AXES:
        raise UnknownAxis("axis", axis, _AXES)
    return _TURNS[axis](turn)


class UnknownAxis(UnknownName, ValueError):
    """An axis other than x, y and z."""


_jacobian_calls, _inverse_calls = (call_cache(1, weak=0, kernel_argument=0) for _ in range(2))


@repeated_calls(_jacobian_calls)
def computeRpyJacobian(rpy: Any, reference_frame: ReferenceFrame = ReferenceFrame.LOCAL) -> Floats:
    """The matrix from the rates of roll, pitch and yaw to the angular velocity.

    Args:
        rpy: Roll, pitch and yaw, (3,) [rad].
        reference_frame: LOCAL (default) for angular velocity in the moving frame, WORLD or LOCAL_WORLD_ALIGNED
            for world axes.

    Returns:
        Matrix (3, 3).
    """
    return _answer("rates", reference_frame, _jacobian_calls, rpy)


@repeated_calls(_inverse_calls)
def computeRpyJacobianInverse(rpy: Any, reference_frame: ReferenceFrame = ReferenceFrame.LOCAL) -> Floats:
    """The inverse of `computeRpyJacobian`.

    Args:
        rpy: Roll, pitch and yaw, (3,) [rad].
        reference_frame: LOCAL (default) for angular velocity in the moving frame, WORLD or LOCAL_WORLD_ALIGNED
            for world axes.

    Returns:
        Matrix (3, 3).
    """
    return _answer("inverse", reference_frame, _inverse_calls, rpy)


@directly(_EXACT.row("local derivative", np.ndarray, np.ndarray))
@checks_itself
def computeRpyJacobianTimeDerivative(
    rpy: Any, rpydot: Any, reference_frame: ReferenceFrame = ReferenceFrame.LOCAL
) -> Floats:
    """The time derivative of `computeRpyJacobian`.

    Args:
        rpy: Roll, pitch and yaw, (3,) [rad].
        rpydot: Rates of roll, pitch and yaw, (3,) [rad/s].
        reference_frame: LOCAL (default) for angular velocity in the moving frame, WORLD or LOCAL_WORLD_ALIGNED
            for world axes.

    Returns:
        Matrix (3, 3) [1/s].
    """
    return _answer("derivative", reference_frame, None, rpy, rpydot)


def _answer(function: str, reference_frame: Any, calls: CallCache | None, *angles: Any) -> Floats:
    """One of the functions of angles, and of their rates; calls of one argument like it run no Python any more."""
    kernel = _EXACT[f"{'local' if reference_of(reference_frame) == 'local' else 'world'} {function}"]
    if calls is not None and isinstance(reference_frame, ReferenceFrame):
        calls.add(kernel, 1, reference_frame)
        if reference_frame is ReferenceFrame.LOCAL:
            calls.add(kernel, 1)
    found = kernel(*angles)
    if found is NotImplemented:
        found = kernel(*(exact(x, 3, name) for x, name in zip(angles, ("rpy", "rpydot"), strict=False)))
    return found
