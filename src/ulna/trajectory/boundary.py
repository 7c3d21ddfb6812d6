"""Point to point by one polynomial: cubics and quintics with given states at both ends."""

from __future__ import annotations

import numpy as np

from ulna.trajectory.inputs import filled, seconds, vector
from ulna.trajectory.polynomial import Polynomial, hermite
from ulna.typing import ArrayLike, Floats


def cubic(
    q0: ArrayLike, q1: ArrayLike, duration: float, v0: ArrayLike | None = None, v1: ArrayLike | None = None
) -> Polynomial:
    """From one point to another by a cubic, with given velocities at the ends; the acceleration jumps there.

    Args:
        q0: Start, (n,) [rad or m].
        q1: End, (n,).
        duration: Time it takes [s].
        v0: Velocity at the start, one or (n,) [rad/s or m/s]; None for rest.
        v1: Velocity at the end.

    Raises:
        InputError: Shapes do not fit, nan, or a duration that is not above zero.

    Source: Biagiotti & Melchiorri 2008, section 2.1.2.
    """
    start = vector("q0", q0)
    end, n = vector("q1", q1, start.size), start.size
    v = _both(("v0", v0), ("v1", v1), n)
    return hermite(np.array([0.0, seconds("duration", duration)]), np.array([start, end]), v, kind="cubic")


def quintic(
    q0: ArrayLike,
    q1: ArrayLike,
    duration: float,
    v0: ArrayLike | None = None,
    v1: ArrayLike | None = None,
    a0: ArrayLike | None = None,
    a1: ArrayLike | None = None,
) -> Polynomial:
    """From one point to another by a quintic, with given velocities and accelerations at the ends.

    At rest at both ends it is the motion of least squared jerk.

    Args:
        q0: Start, (n,) [rad or m].
        q1: End, (n,).
        duration: Time it takes [s].
        v0: Velocity at the start, one or (n,) [rad/s or m/s]; None for rest.
        v1: Velocity at the end.
        a0: Acceleration at the start, one or (n,) [rad/s^2 or m/s^2]; None for zero.
        a1: Acceleration at the end.

    Raises:
        InputError: Shapes do not fit, nan, or a duration that is not above zero.

    Source: Biagiotti & Melchiorri 2008, section 2.1.3.
    """
    start = vector("q0", q0)
    end, n = vector("q1", q1, start.size), start.size
    v = _both(("v0", v0), ("v1", v1), n)
    a = _both(("a0", a0), ("a1", a1), n)
    times = np.array([0.0, seconds("duration", duration)])
    return hermite(times, np.array([start, end]), v, a, kind="quintic")


def _both(start: tuple[str, ArrayLike | None], end: tuple[str, ArrayLike | None], n: int) -> Floats:
    """Rates at both ends, (2, n)."""
    if start[1] is None and end[1] is None:
        return np.zeros((2, n))
    return np.array([filled(*start, n), filled(*end, n)])
