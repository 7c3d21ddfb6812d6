"""Servoing towards a pose."""

from __future__ import annotations

from typing import Any, cast

from roboticstoolbox._common.errors import UnknownOption
from roboticstoolbox._common.poses import array
from ulna.control import p_servo as _servo
from ulna.typing import Floats


def p_servo(
    wTe: Any, wTep: Any, gain: Any = 1.0, threshold: float = 0.1, method: Any = "rpy"
) -> tuple[Floats, bool]:
    """The twist that leads from one pose towards another, and whether it is reached.

    Args:
        wTe: Where the end is, an SE3 or (4, 4).
        wTep: Where it should be.
        gain: One gain or six [1/s].
        threshold: Reached when the absolute errors add up to less [m and rad].
        method: "rpy": in the end's axes, for `jacobe`; "angle-axis" or its beginning, such as "a": in the base's axes,
            for `jacob0`.

    Returns:
        Twist (6,) [m/s and rad/s], and whether the pose is reached.

    Raises:
        UnknownOption: There is no such method.
    """
    if method != "rpy":
        if not (isinstance(method, str) and method and "angle-axis".startswith(method)):
            raise UnknownOption("method", method, ("rpy", "angle-axis"))
        method = "angle-axis"
    factor = float(gain) if isinstance(gain, (int, float)) else gain
    return _servo(array(wTe), array(wTep), factor, threshold, cast(Any, method))


def angle_axis(T: Any, Td: Any) -> Floats:
    """The difference of positions and the rotation vector from one pose to another, in the base's axes.

    Args:
        T: Pose, an SE3 or (4, 4).
        Td: Another pose, an SE3 or (4, 4).

    Returns:
        Vector (6,) [m and rad].
    """
    return p_servo(T, Td, 1.0, 0.0, "angle-axis")[0]


angle_axis_python = angle_axis
