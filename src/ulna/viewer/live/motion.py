"""Motions that a page plays: times and configurations, no denser than a screen shows them."""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.errors import InputError
from ulna.typing import Floats
from ulna.viewer.robot.handle_motion import handle_motions
from ulna.viewer.robot.robot_handle import RobotHandle
from ulna.viewer.robot.robot_visual import RobotVisual

_RATE = 60.0  # rows a second, at most
_MAX_DURATION = 600.0  # s


def motion_rows(visual: RobotVisual, played: Any) -> tuple[Floats, Floats]:
    """Times from 0, (n,) [s], and configurations, (n, nq), of a motion.

    Args:
        visual: The robot.
        played: A recording, a trajectory of joints, a plan, or configurations (n, nq) [rad, m].

    Returns:
        The times, (n,) [s], and the configurations, (n, nq) [rad, m].

    Raises:
        InputError: It cannot be played, lasts no time, or longer than ten minutes.
        ShapeError: It is a motion of another robot.
    """
    times, q = handle_motions(played, [RobotHandle(visual)])[0].rows()
    if len(times) < 2 or not times[-1] > times[0]:
        raise InputError(
            f"`recorded` has {len(times)} configuration{'s' * (len(times) != 1)}; "
            "expected two or more, at rising times."
        )
    if times[-1] - times[0] > _MAX_DURATION:
        raise InputError(
            f"`recorded` lasts {times[-1] - times[0]:.0f} s; expected at most {_MAX_DURATION:.0f} s for a page."
        )
    slots = np.floor((times - times[0]) * _RATE + 1e-6).astype(np.int64)
    chosen = np.flatnonzero(np.concatenate([[True], np.diff(slots) > 0]))
    chosen = np.unique(np.append(chosen, len(times) - 1))
    return times[chosen] - times[0], q[chosen]
