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

    The method says how the error is expressed, and in whose axes; these meanings are those of the Robotics Toolbox.

    - "rpy": of the goal as seen from the frame, T^-1 T_goal, the position and roll, pitch, yaw (the angles about the
      fixed x, y, z axes, R = Rz(yaw) Ry(pitch) Rx(roll)), in the frame's own axes. The twist belongs with the
      Jacobian of reference "local".
    - "angle-axis": the difference of the positions and the rotation vector of R_goal R^T, in the axes of the world.
      The twist belongs with the Jacobian of reference "local_world_aligned".

    Args:
        T: Where the frame is, T_world_frame, shape (4, 4).
        T_goal: Where it should be, T_world_goal, shape (4, 4).
        gain: Gain [1/s], one or six of them: along x, y, z and about them.
        threshold: The goal counts as reached when the absolute values of the error add up to less [m and
            rad].
        method: How the error is expressed: "rpy" or "angle-axis".

    Returns:
        The twist, linear part first, shape (6,) [m/s, rad/s], and whether the goal is reached.

    Raises:
        ShapeError: A pose is not (4, 4), or the gain is neither one number nor six.
        NonFiniteError: A pose or the gain holds nan or inf.
        UnknownName: There is no such method.

    Source: Corke, "Robotics, Vision and Control", 2023, section 15.1.
    """
    here, there = _pose("T", T), _pose("T_goal", T_goal)
    factors = np.asarray(gain, dtype=float)
    if factors.shape not in ((), (6,)):
        raise ShapeError("gain", factors.shape, "one number or (6,)")
    if not np.isfinite(factors).all():
        raise InputError(f"`gain` is {gain}; expected finite numbers [1/s].")
    if method == "rpy":
        turn = here[:3, :3].T
        place, angles = turn @ (there[:3, 3] - here[:3, 3]), matrix_to_rpy(turn @ there[:3, :3])
    elif method == "angle-axis":
        place, angles = there[:3, 3] - here[:3, 3], so3_log(there[:3, :3] @ here[:3, :3].T)
    else:
        raise UnknownName("method", method, ("rpy", "angle-axis"))
    error = np.concatenate([place, angles])
    return factors * error, bool(np.abs(error).sum() < threshold)


def _pose(name: str, value: ArrayLike) -> Floats:
    pose = np.asarray(value, dtype=float)
    if pose.shape != (4, 4):
        raise ShapeError(name, pose.shape, "(4, 4), a pose in the world", "Pass one pose at a time.")
    if not np.isfinite(pose).all():
        where = tuple(int(i) for i in np.argwhere(~np.isfinite(pose))[0])
        raise NonFiniteError(name, where, float(pose[where]))
    return pose
