"""Jerk-limited motion from any state to any state, calculated by Ruckig."""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.checks.values import duration as checked_duration
from ulna.errors import InputError, needed
from ulna.trajectory.inputs import filled, positive, vector
from ulna.trajectory.polynomial import Polynomial
from ulna.typing import ArrayLike, Floats


def jerk_limited(
    q0: ArrayLike,
    v0: ArrayLike | None,
    a0: ArrayLike | None,
    q1: ArrayLike,
    v1: ArrayLike | None,
    a1: ArrayLike | None,
    velocity: ArrayLike,
    acceleration: ArrayLike,
    jerk: ArrayLike,
    duration: float | None = None,
) -> Polynomial:
    """From one state to another as fast as limits of speed, acceleration and jerk allow, all joints arriving together.

    Args:
        q0: Position at the start, (n,) [rad or m].
        v0: Velocity there, one or (n,) [rad/s or m/s]; None for rest.
        a0: Acceleration there, one or (n,) [rad/s^2 or m/s^2]; None for zero.
        q1: Position at the end, (n,) [rad or m].
        v1: Velocity there, one or (n,) [rad/s or m/s]; None for rest.
        a1: Acceleration there, one or (n,) [rad/s^2 or m/s^2]; None for zero.
        velocity: Limits of speed, one or (n,) [rad/s or m/s].
        acceleration: Limits of acceleration, one or (n,) [rad/s^2 or m/s^2].
        jerk: Limits of jerk, one or (n,) [rad/s^3 or m/s^3].
        duration: Time to take where the limits would allow less [s].

    Returns:
        The trajectory.

    Raises:
        InputError: A state that the limits do not allow; says what Ruckig says.
        MissingExtra: Ruckig is not installed.

    Source: Berscheid & Kröger, Jerk-limited real-time trajectory generation with arbitrary target states (2021).
    """
    with needed("ruckig", "trajectory", "A jerk-limited motion between states"):
        import ruckig  # pyright: ignore[reportMissingImports]
    start = vector("q0", q0)
    n = start.size
    task: Any = ruckig.InputParameter(n)
    fields = {
        "current_position": start,
        "target_position": vector("q1", q1, n),
        "current_velocity": filled("v0", v0, n),
        "current_acceleration": filled("a0", a0, n),
        "target_velocity": filled("v1", v1, n),
        "target_acceleration": filled("a1", a1, n),
        "max_velocity": positive("velocity", velocity, n),
        "max_acceleration": positive("acceleration", acceleration, n),
        "max_jerk": positive("jerk", jerk, n),
    }
    for name, values in fields.items():
        setattr(task, name, values.tolist())
    if duration is not None:
        task.minimum_duration = checked_duration("duration", duration)
    motion = _motion(ruckig, task, n)
    rates = fields["current_velocity"], fields["current_acceleration"]
    return _from_profiles(motion.profiles[0], start, rates, float(motion.duration))


def _motion(ruckig: Any, task: Any, n: int) -> Any:
    """Ruckig's trajectory of a task."""
    planner: Any = ruckig.Ruckig(n)
    try:
        planner.validate_input(task, False, True)  # the start may break limits on its way into them
        motion: Any = ruckig.Trajectory(n)
        result = planner.calculate(task, motion)
    except ruckig.RuckigError as error:
        raise InputError(f"Ruckig refuses the motion: {error}") from None
    if result not in (ruckig.Result.Working, ruckig.Result.Finished):
        raise InputError(f"Ruckig finds no motion between the states: {result.name}.")
    if float(motion.duration) <= 0.0:
        raise InputError("Start and end are the same state; expected a motion.")
    return motion


def _from_profiles(profiles: Any, q: Floats, rates: tuple[Floats, Floats], total: float) -> Polynomial:
    """Integrates the phases of constant jerk of all joints, on the times at which any of them changes."""
    ends, jerks = [], []
    for p in profiles:
        ends.append(np.cumsum([*p.brake.t, *p.t]))
        jerks.append(np.array([*p.brake.j, *p.j]))
    knots = np.unique(np.concatenate([[0.0, total], *ends]))
    knots = knots[(knots < total * (1.0 - 1e-12)) & np.append(True, np.diff(knots) > 1e-12 * total)]
    knots = np.append(knots, total)
    h, middle = np.diff(knots), 0.5 * (knots[:-1] + knots[1:])
    j = np.zeros((h.size, q.size))
    for k, (end, value) in enumerate(zip(ends, jerks, strict=True)):
        phase = np.searchsorted(end, middle)
        j[:, k] = np.append(value, 0.0)[phase]
    c, (v, a) = np.empty((h.size, 4, q.size)), rates
    for i, step in enumerate(h):
        c[i] = q, v, 0.5 * a, j[i] / 6.0
        q = q + step * (v + step * (0.5 * a + step * j[i] / 6.0))
        v, a = v + step * (a + 0.5 * step * j[i]), a + step * j[i]
    return Polynomial.of(knots, c, "jerk-limited")
