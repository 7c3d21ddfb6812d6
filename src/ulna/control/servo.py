"""Proportional servoing of a pose: a twist that leads towards the goal."""

from __future__ import annotations

from functools import cache
from typing import Any, Literal, get_args

import numpy as np

from ulna.checks.values import number
from ulna.compiler import compile
from ulna.errors import DtypeError, InputError, ShapeError, UnknownName
from ulna.numeric import maximum, vector
from ulna.spatial import SE3, matrix_to_rpy, so3_log
from ulna.typing import Array, ArrayLike

Method = Literal["rpy", "angle-axis"]
_METHODS: tuple[Method, ...] = get_args(Method)
_ROUGH = 1e-3  # how far R^T R of a pose may be from the identity: poses typed with few digits are poses


def p_servo(
    T: SE3 | ArrayLike,
    T_goal: SE3 | ArrayLike,
    gain: ArrayLike = 1.0,
    threshold: float = 0.1,
    method: Method = "rpy",
) -> tuple[Any, Any]:
    """The twist that leads from one pose towards another, in proportion to the error.

    The method says how the error is expressed, and in whose axes; these meanings are those of the Robotics Toolbox.

    - "rpy": of the goal as seen from the frame, T^-1 T_goal, the position and roll, pitch, yaw (the angles about the
      fixed x, y, z axes, R = Rz(yaw) Ry(pitch) Rx(roll)), in the frame's own axes. The twist belongs with the
      Jacobian of reference "local".
    - "angle-axis": the difference of the positions and the rotation vector of R_goal R^T, in the axes of the world.
      The twist belongs with the Jacobian of reference "local_world_aligned".

    Source: Corke, "Robotics, Vision and Control", 2023, section 15.1.

    Args:
        T: Where the frame is, T_world_frame, an SE3 or an array of shape (..., 4, 4).
        T_goal: Where it should be, T_world_goal, an SE3 or an array of shape (..., 4, 4).
        gain: Gain, one number or six, shape (6,) [1/s]: along x, y, z and about them.
        threshold: The goal counts as reached when the absolute values of the error add up to less [m and rad].
        method: How the error is expressed: "rpy" or "angle-axis".

    Returns:
        The twist, linear part first, shape (..., 6) [m/s, rad/s], and whether the goal is reached, (...).

    Raises:
        ShapeError: A pose is not (..., 4, 4), or the gain is neither one number nor six.
        NonFiniteError: A pose or the gain holds nan or inf.
        InputError: What should be a pose is none: scaled, transposed, or empty. It would seem reached. Or
            `threshold` is negative: no goal would ever be reached.
        UnknownName: There is no such method.
        DtypeError: The gain holds no numbers.

    Example:
        >>> robot = ulna.load("panda")
        >>> q = robot.configurations["ready"]
        >>> twist, arrived = ulna.p_servo(robot.fk(q), robot.fk(q))
        >>> arrived
        True
    """
    if not isinstance(method, str) or method not in _METHODS:
        raise UnknownName("method", method, _METHODS)
    if type(threshold) is not float or not threshold >= 0.0:
        threshold = number("threshold", threshold, "a number of zero or more [m and rad]", least=0.0)
    try:
        factors = gain if type(gain) is float else np.asarray(gain, dtype=float)
    except (TypeError, ValueError):
        raise DtypeError("gain", type(gain).__name__) from None
    shape = () if type(gain) is float else np.shape(factors)
    if shape not in ((), (6,)):
        raise ShapeError("gain", shape, "one number or (6,)")
    twist, total_error, deviation = _kernel(method, shape)(T, T_goal, factors)
    if not (deviation if deviation.ndim == 0 else deviation.max(initial=0.0)) < _ROUGH:
        raise InputError(
            f"`T` or `T_goal` is no pose: R^T R or its last row is off by {np.max(deviation):.3g}. Look whether it is "
            "transposed or scaled; SE3.project(matrix) returns the nearest pose."
        )
    arrived = total_error < threshold
    return twist, bool(arrived) if arrived.ndim == 0 else arrived


@cache
def _kernel(method: Method, gain: tuple[int, ...]) -> Any:
    """The twist and the sum of the absolute errors, compiled when first asked for."""

    def servo(T: Array, T_goal: Array, gain: Any) -> tuple[Array, Any, Any]:
        R, R_goal, offset = T[:3, :3], T_goal[:3, :3], T_goal[:3, 3] - T[:3, 3]
        if method == "rpy":
            error = vector(*(R.T @ offset), *matrix_to_rpy(R.T @ R_goal))
        else:
            error = vector(*offset, *so3_log(R_goal @ R.T))
        deviation = maximum(_deviation_from_pose(T), _deviation_from_pose(T_goal))
        return gain * error, sum(abs(x) for x in error), deviation

    return compile(servo, checked=True, T=(4, 4), T_goal=(4, 4), gain=gain)


def _deviation_from_pose(T: Array) -> Any:
    """How far a matrix is from a pose: R^T R from the identity, the last row from 0, 0, 0, 1."""
    R, worst = T[:3, :3], abs(T[3, 3] - 1.0)
    for i in range(3):
        worst = maximum(worst, abs(T[3, i]))
        for j in range(i + 1):
            worst = maximum(worst, abs(R[:, i] @ R[:, j] - float(i == j)))
    return worst
