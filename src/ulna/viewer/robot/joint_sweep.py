"""A motion that moves each coordinate of a robot through its range, one after the other."""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.sim import Recording
from ulna.typing import Floats
from ulna.viewer.robot.slider_coordinates import slider_coordinates

_JOINT_DURATION, _MAX_DURATION = 1.6, 14.0  # s for a joint, and at most for all
_RATE = 25.0  # rows a second


def joint_sweep(robot: Any, q: Floats) -> Recording:
    """A recording that begins and ends at a configuration; of a robot without joints it lasts a second.

    Args:
        robot: The robot.
        q: Configuration (nq,) [rad or m].

    Returns:
        The recording.
    """
    out, numbers, k = Recording(), slider_coordinates(robot), 0
    count = max(round(min(_JOINT_DURATION, _MAX_DURATION / max(len(numbers), 1)) * _RATE), 8)
    wave = np.sin(2 * np.pi * np.arange(count) / count)
    for dial in numbers:
        start = dial.read(q)
        for phase in wave:  # up to 0.8 of the way to either limit, at most half a turn
            amplitude = min(dial.high - start, np.pi / 2) if phase > 0 else min(start - dial.low, np.pi / 2)
            out.add(k / _RATE, dial.write(q, start + 0.8 * phase * max(amplitude, 0.0)))
            k += 1
    out.add(max(k / _RATE, 0.0), q)
    if not numbers:
        out.add(1.0, q)
    return out
