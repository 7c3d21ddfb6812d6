"""Point to point by one polynomial: cubics and quintics with given states at both ends."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

from ulna import numeric
from ulna.checks.values import duration as checked_duration
from ulna.compiler import compile
from ulna.trajectory.inputs import filled, vector
from ulna.trajectory.polynomial import Polynomial, hermite, hermite_coefficients, horner
from ulna.trajectory.trajectory import END_TOLERANCE
from ulna.typing import Array, ArrayLike, Floats


def cubic(
    q0: ArrayLike, q1: ArrayLike, duration: float, v0: ArrayLike | None = None, v1: ArrayLike | None = None
) -> Polynomial:
    """From one point to another by a cubic, with given velocities at the ends; the acceleration jumps there.

    Args:
        q0: Start, (n,) [rad or m].
        q1: End, (n,) [rad or m].
        duration: Time it takes [s].
        v0: Velocity at the start, one or (n,) [rad/s or m/s]; None for rest.
        v1: Velocity at the end, one or (n,) [rad/s or m/s]; None for rest.

    Returns:
        The trajectory.

    Raises:
        InputError: Shapes do not fit, nan, or a duration that is not above zero.

    Source: Biagiotti & Melchiorri 2008, section 2.1.2.
    """
    start = vector("q0", q0)
    end, n = vector("q1", q1, start.size), start.size
    v = _both(("v0", v0), ("v1", v1), n)
    return hermite(
        np.array([0.0, checked_duration("duration", duration)]), np.array([start, end]), v, kind="cubic"
    )


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
        q1: End, (n,) [rad or m].
        duration: Time it takes [s].
        v0: Velocity at the start, one or (n,) [rad/s or m/s]; None for rest.
        v1: Velocity at the end, one or (n,) [rad/s or m/s]; None for rest.
        a0: Acceleration at the start, one or (n,) [rad/s^2 or m/s^2]; None for zero.
        a1: Acceleration at the end, one or (n,) [rad/s^2 or m/s^2]; None for zero.

    Returns:
        The trajectory.

    Raises:
        InputError: Shapes do not fit, nan, or a duration that is not above zero.

    Source: Biagiotti & Melchiorri 2008, section 2.1.3.

    Example:
        >>> move = ulna.trajectory.quintic(np.zeros(2), np.ones(2), duration=2.0)
        >>> move(1.0), move.v(1.0)
        (array([0.5, 0.5]), array([0.9375, 0.9375]))
    """
    start = vector("q0", q0)
    end, n = vector("q1", q1, start.size), start.size
    v = _both(("v0", v0), ("v1", v1), n)
    a = _both(("a0", a0), ("a1", a1), n)
    times = np.array([0.0, checked_duration("duration", duration)])
    return hermite(times, np.array([start, end]), v, a, kind="quintic")


def quintic_states(
    q0: ArrayLike,
    q1: ArrayLike,
    duration: float,
    t: ArrayLike,
    v0: ArrayLike | None = None,
    v1: ArrayLike | None = None,
) -> tuple[Floats, Floats, Floats]:
    """What `quintic(q0, q1, duration, v0, v1).state(t)` is, in one compiled evaluation: for rows, and no trajectory.

    Args:
        q0: Start, (n,) [rad or m].
        q1: End, (n,).
        duration: Time it takes [s].
        t: Times, (m,) [s].
        v0: Velocity at the start, (n,) [rad/s or m/s]; None for rest.
        v1: Velocity at the end, (n,) [rad/s or m/s]; None for rest.

    Returns:
        Points, velocities and accelerations, (m, n) each.

    Raises:
        InputError: As `quintic`.
    """
    start, end, at = np.asarray(q0), np.asarray(q1), np.asarray(t)
    first, last = (np.zeros(start.shape) if v is None else np.asarray(v) for v in (v0, v1))
    ends, n = (start, end, first, last), start.size
    is_usual = all(x.shape == (n,) and x.dtype == np.float64 for x in ends) and at.ndim == 1
    is_usual = is_usual and not any(isinstance(x, np.ma.MaskedArray) for x in (q0, q1, t, v0, v1))
    if is_usual and n and at.size and at.dtype.kind in "fiu":
        q, v, a = _states(n)(*ends, checked_duration("duration", duration), at)
        if np.isfinite(q).all() and np.isfinite(at).all():
            return q, v, a
    return quintic(q0, q1, duration, v0, v1).state(t)  # which converts, or says what is wrong


@lru_cache(maxsize=64)
def _states(n: int) -> Any:
    def states(q0: Array, q1: Array, v0: Array, v1: Array, h: Any, t: Any) -> tuple[Array, ...]:
        tau = numeric.clip(t, 0.0, h)
        rest = 0.0 * q0
        q, v, a = horner(hermite_coefficients(h, q0, q1, v0, v1, rest, rest), tau, 2)
        is_still = numeric.less(END_TOLERANCE * h, abs(t - tau))
        return q, numeric.where(is_still, rest, v), numeric.where(is_still, rest, a)

    shapes: dict[str, Any] = dict.fromkeys(("q0", "q1", "v0", "v1"), (n,))
    return compile(states, **shapes, h=(), t=()).gufunc


def _both(start: tuple[str, ArrayLike | None], end: tuple[str, ArrayLike | None], n: int) -> Floats:
    """Rates at both ends, (2, n)."""
    if start[1] is None and end[1] is None:
        return np.zeros((2, n))
    return np.array([filled(*start, n), filled(*end, n)])
