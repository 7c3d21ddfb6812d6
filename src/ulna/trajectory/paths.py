"""Paths of one second that a law of time turns into trajectories, and the laws for them."""

from __future__ import annotations

from abc import ABC
from typing import Any

import numpy as np

from ulna.checks.values import duration as checked_duration
from ulna.errors import InputError
from ulna.trajectory.boundary import quintic
from ulna.trajectory.inputs import positive
from ulna.trajectory.polynomial import Polynomial
from ulna.trajectory.profiles import s_curve, trapezoidal
from ulna.trajectory.trajectory import Trajectory
from ulna.typing import Floats


class UnitPath(Trajectory, ABC):
    """A smooth path whose parameter runs from 0 to 1."""

    duration = 1.0

    @property
    def knots(self) -> Floats:
        """Start and end."""
        return np.array([0.0, 1.0])

    @property
    def order(self) -> int:
        """2: no jerk."""
        return 2


def law(lengths: Floats, duration: Any, velocity: Any, acceleration: Any, jerk: Any) -> Polynomial:
    """The law from 0 to 1, from rest to rest, for a path that moves several things along paths of those lengths.

    With a duration alone it is a quintic; with limits, one or one for each thing, as fast as they allow:
    trapezoidal, or an S-curve where jerk is limited.

    Args:
        lengths: Lengths of the paths of the things that move, (k,) [m, rad].
        duration: Time it takes [s], or None.
        velocity: Limits of speed, one or (k,) [m/s, rad/s], or None.
        acceleration: Limits of acceleration, one or (k,) [m/s^2, rad/s^2], or None.
        jerk: Limits of jerk, one or (k,) [m/s^3, rad/s^3], or None.

    Returns:
        s(t), from 0 to 1.

    Raises:
        InputError: Neither a duration nor both limits, or limits where nothing moves.
    """
    if velocity is None and acceleration is None and jerk is None:
        if duration is None:
            raise InputError(
                "Expected a `duration`, or limits `velocity` and `acceleration`; neither was given."
            )
        return quintic(0.0, 1.0, checked_duration("duration", duration))
    if velocity is None or acceleration is None:
        raise InputError("Limits need both `velocity` and `acceleration`.")
    limits = {"velocity": velocity, "acceleration": acceleration} | ({} if jerk is None else {"jerk": jerk})
    moving = lengths > 0.0
    if not moving.any():
        raise InputError("Start and end are the same; expected different ones, or a `duration` to wait.")
    shares = [
        float((positive(name, limit, lengths.size)[moving] / lengths[moving]).min())
        for name, limit in limits.items()
    ]
    return (trapezoidal if jerk is None else s_curve)(0.0, 1.0, *shares, duration=duration)
