"""Jerk-limited motion from any state to any state, calculated by Ruckig."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from ulna.checks.values import duration as checked_duration
from ulna.errors import InputError, needed
from ulna.trajectory.inputs import filled, positive, vector
from ulna.trajectory.polynomial import Polynomial
from ulna.typing import ArrayLike, Floats

_Units = tuple[float, Floats]
"""Units of time [s] and of the ways of joints, (n,) [rad or m]."""

_POWERS = {"position": 0, "velocity": 1, "acceleration": 2, "jerk": 3}
"""Of quantities, the power of the time in their units."""

_WRONG = 1e-6  # by how much the end or a limit may be missed, in parts of the way and of the limits


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

    A start that is faster than the limits, or accelerates so that it will be, is first brought within them at the limit
    of jerk; until then the motion exceeds them.

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
    return _motion(ruckig, fields, None if duration is None else checked_duration("duration", duration))


def _motion(ruckig: Any, fields: Mapping[str, Floats], least_duration: float | None) -> Polynomial:
    """Ruckig's motion between states, in the first units in which it finds one that is right.

    Ruckig compares with lengths of time and ways of its own, such as 1e-12, so that it fails, or misses the end or the
    limits, where numbers are very small or large, as those of motions of micrometres are.
    """
    failure: InputError | None = None
    for units in _units(fields):
        try:
            profiles, total = _calculated(ruckig, fields, least_duration, units)
        except InputError as error:
            failure = failure or error
            continue
        motion = _from_profiles(profiles, fields, total, units)
        if _is_right(motion, fields):
            return motion
    raise failure or InputError(
        "Ruckig finds no motion that ends where it should within the limits; expected states and limits that differ by "
        "fewer orders of magnitude."
    )


def _units(fields: Mapping[str, Floats]) -> Iterator[_Units]:
    """SI units; then such in which the motion takes about a unit of time, and goes about as far as a unit of length."""
    way = np.abs(fields["target_position"] - fields["current_position"])
    yield 1.0, np.ones(way.size)
    v, a, j = (fields[f"max_{name}"] for name in ("velocity", "acceleration", "jerk"))
    speeds = np.maximum(np.abs(fields["current_velocity"]), np.abs(fields["target_velocity"]))
    changes = np.maximum(np.abs(fields["current_acceleration"]), np.abs(fields["target_acceleration"]))
    times = (way / v, np.sqrt(way / a), np.cbrt(way / j), speeds / a, np.sqrt(speeds / j), changes / j)
    time = float(np.max(times))
    if not 0.0 < time < np.inf:
        return
    reach = np.maximum(np.maximum(way, speeds * time), changes * time**2)
    reach = np.where(reach > 0.0, reach, v * time)
    yield time, reach
    yield time, np.where(way > 0.0, way, reach)


def _calculated(
    ruckig: Any, fields: Mapping[str, Floats], least_duration: float | None, units: _Units
) -> tuple[Any, float]:
    """The phases of all joints, and how long they take, in units of time and length; positions count from the start."""
    time, length = units
    task: Any = ruckig.InputParameter(length.size)
    for name, values in fields.items():
        power = _POWERS[name.partition("_")[2]]
        start = fields["current_position"] if power == 0 else 0.0
        setattr(task, name, ((values - start) * (time**power / length)).tolist())
    if least_duration is not None:
        task.minimum_duration = least_duration / time
    planner: Any = ruckig.Ruckig(length.size)
    try:
        planner.validate_input(task, False, True)  # the start may break limits on its way into them
        motion: Any = ruckig.Trajectory(length.size)
        result = planner.calculate(task, motion)
    except ruckig.RuckigError as error:
        raise InputError(f"Ruckig refuses the motion: {error}") from None
    except ValueError as error:  # a result that its binding has no name for, as that for motions of hours
        raise InputError(f"Ruckig finds no motion between the states: {error}") from None
    if result not in (ruckig.Result.Working, ruckig.Result.Finished):
        raise InputError(f"Ruckig finds no motion between the states: {result.name}.")
    if float(motion.duration) <= 0.0:
        raise InputError("Start and end are the same state; expected a motion.")
    return motion.profiles[0], float(motion.duration)


def _from_profiles(profiles: Any, fields: Mapping[str, Floats], total: float, units: _Units) -> Polynomial:
    """Integrates the phases of constant jerk of all joints, on the times at which any of them changes."""
    q, (time, length) = fields["current_position"], units
    ends, jerks = [], []
    for p in profiles:
        ends.append(np.cumsum([*p.brake.t, *p.t]))
        jerks.append(np.array([*p.brake.j, *p.j]))
    knots = np.unique(np.concatenate([[0.0, total], *ends]))
    knots = knots[(knots < total * (1.0 - 1e-12)) & np.append(True, np.diff(knots) > 1e-12 * total)]
    knots = np.append(knots, total)
    middle = 0.5 * (knots[:-1] + knots[1:])
    j = np.zeros((middle.size, q.size))
    for k, (end, value) in enumerate(zip(ends, jerks, strict=True)):
        phase = np.searchsorted(end, middle)
        j[:, k] = np.append(value, 0.0)[phase]
    knots, j = knots * time, j * (length / time**3)
    c, v, a = np.empty((middle.size, 4, q.size)), fields["current_velocity"], fields["current_acceleration"]
    for i, step in enumerate(np.diff(knots)):
        c[i] = q, v, 0.5 * a, j[i] / 6.0
        q = q + step * (v + step * (0.5 * a + step * j[i] / 6.0))
        v, a = v + step * (a + 0.5 * step * j[i]), a + step * j[i]
    return Polynomial.of(knots, c, "jerk-limited")


def _is_right(motion: Polynomial, fields: Mapping[str, Floats]) -> bool:
    """Whether a motion ends in the state that it should, within the limits but for what the ends themselves ask for."""
    v, a, j = (fields[f"max_{name}"] for name in ("velocity", "acceleration", "jerk"))
    speed, strongest = v, a
    for end in ("current", "target"):  # an acceleration that only fades carries the speed so far
        v_end, a_end = np.abs(fields[f"{end}_velocity"]), np.abs(fields[f"{end}_acceleration"])
        speed, strongest = np.maximum(speed, v_end + a_end**2 / (2.0 * j)), np.maximum(strongest, a_end)
    rows = motion._at(motion.instants(2), 3)
    way = np.abs(rows[0] - fields["current_position"]).max(axis=0)
    rounding = np.maximum(np.abs(fields["current_position"]), np.abs(fields["target_position"])) * 1e-13
    ends = motion._at(motion.knots[-1:], 2)
    for value, name, size in zip(ends, list(_POWERS)[:3], (way + rounding / _WRONG, v, a), strict=True):
        if (np.abs(value[0] - fields[f"target_{name}"]) > _WRONG * size).any():
            return False
    within = zip(rows[1:], (speed, strongest, j), strict=True)
    return all((np.abs(row).max(axis=0) <= (1.0 + _WRONG) * limit).all() for row, limit in within)
