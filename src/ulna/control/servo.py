"""Proportional servoing of a pose: a twist that leads towards the goal."""

from __future__ import annotations

from typing import Literal

import numpy as np

from ulna.errors import InputError, NonFiniteError, ShapeError, UnknownName
from ulna.spatial import matrix_to_rpy, so3_log
from ulna.typing import ArrayLike, Floats


def p_servo(
    T: ArrayLike,
    T_goal: ArrayLike,
    gain: ArrayLike = 1.0,
    threshold: float = 0.1,
    method: Literal["rpy", "angle-axis"] = "rpy",
) -> tuple[Floats, bool]:
    """The twist that leads from one pose towards another, in proportion to what lacks.

    The error is that of the goal as seen from the frame, T^-1 T_goal: its position, and its rotation as
    roll, pitch, yaw ("rpy": the angles about the fixed x, y, z axes with R = Rz(yaw) Ry(pitch) Rx(roll)) or
    as rotation vector ("angle-axis"). The twist belongs with the Jacobian in the frame's own axes, reference
    "local".

    Args:
        T: Where the frame is, T_world_frame, shape (4, 4).
        T_goal: Where it should be, T_world_goal, shape (4, 4).
        gain: Gain [1/s], one or six of them: along x, y, z and about them.
        threshold: The goal counts as reached when the absolute values of the error add up to less [m and
            rad].
        method: How the rotation error is expressed.

    Returns:
        The twist, linear part first, shape (6,) [m/s, rad/s], and whether the goal is reached.

    Raises:
        ShapeError: A pose is not (4, 4), or the gain is neither one number nor six.
        NonFiniteError: A pose or the gain holds nan or inf.
        UnknownName: There is no such method.

    Source: Corke, "Robotics, Vision and Control", 2023, section 15.1 (position-based servoing); with method
        "rpy" the
    same numbers as `p_servo` of the Robotics Toolbox.
    """
    here, there = _pose("T", T), _pose("T_goal", T_goal)
    factors = np.asarray(gain, dtype=float)
    if factors.shape not in ((), (6,)):
        raise ShapeError("gain", factors.shape, "one number or (6,)")
    if not np.isfinite(factors).all():
        raise InputError(f"`gain` is {gain}; expected finite numbers [1/s].")
    turn = here[:3, :3].T
    rotation = turn @ there[:3, :3]
    if method == "rpy":
        angles = matrix_to_rpy(rotation)
    elif method == "angle-axis":
        angles = so3_log(rotation)
    else:
        raise UnknownName("method", method, ("rpy", "angle-axis"))
    error = np.concatenate([turn @ (there[:3, 3] - here[:3, 3]), angles])
    return factors * error, bool(np.abs(error).sum() < threshold)


def _pose(name: str, value: ArrayLike) -> Floats:
    pose = np.asarray(value, dtype=float)
    if pose.shape != (4, 4):
        raise ShapeError(name, pose.shape, "(4, 4), a pose in the world", "Pass one pose at a time.")
    if not np.isfinite(pose).all():
        where = tuple(int(i) for i in np.argwhere(~np.isfinite(pose))[0])
        raise NonFiniteError(name, where, float(pose[where]))
    return pose
