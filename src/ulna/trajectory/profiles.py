"""Point to point at rest under limits: trapezoidal velocities, and S-curves of limited jerk.

| symbol | meaning | unit |
|---|---|---|
| d | displacement of one joint | [rad] |
| v, a, j | limits of speed, acceleration and jerk | [rad/s] to [rad/s^3] |
| Ta | time of speeding up, as of slowing down | [s] |
| Tj | time in which the acceleration rises, as in which it falls | [s] |
| Tv | time at full speed | [s] |

Source: Biagiotti & Melchiorri 2008, sections 3.2 (trapezoidal) and 3.4 (double S), for zero speed at the ends.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

import numpy as np

from ulna.checks.values import duration as checked_duration
from ulna.errors import InputError, UnknownName
from ulna.trajectory.inputs import positive, vector
from ulna.trajectory.polynomial import Polynomial, shifted
from ulna.typing import ArrayLike, Floats

Together = Literal["phase", "time", "none"]
_PHASES = ("phase", "time", "none")


def trapezoidal(
    q0: ArrayLike,
    q1: ArrayLike,
    velocity: ArrayLike | None = None,
    acceleration: ArrayLike | None = None,
    duration: float | None = None,
    synchronise: Together = "phase",
) -> Polynomial:
    """From rest to rest with constant acceleration, constant speed, constant deceleration (LSPB).

    With limits `velocity` and `acceleration` the motion is as fast as they allow, or lasts `duration` when that is
    longer. With a duration alone a third of the time each goes into speeding up, cruising, slowing down. With
    a duration and a velocity, that is the cruising speed.

    Args:
        q0: Start, (n,) [rad or m].
        q1: End, (n,) [rad or m].
        velocity: Limits of speed, one or (n,) [rad/s or m/s].
        acceleration: Limits of acceleration, one or (n,) [rad/s^2 or m/s^2].
        duration: Time it takes [s].
        synchronise: "phase": all joints share one law, so the path is straight; "time": each by its own law,
            stretched to arrive together; "none": each as fast as it can, and then it waits.

    Returns:
        The trajectory.

    Raises:
        InputError: Neither limits nor duration; limits not above zero; a duration or speed that cannot be kept.

    Source: Biagiotti & Melchiorri 2008, section 3.2.

    Example:
        >>> move = ulna.trajectory.trapezoidal([0.0], [1.0], velocity=1.0, acceleration=4.0)
        >>> move.duration
        1.25
    """
    start = vector("q0", q0)
    displacement = vector("q1", q1, start.size) - start
    n = start.size
    if acceleration is None:
        if duration is None:
            raise InputError(
                "Expected limits `velocity` and `acceleration`, or a `duration`; neither was given."
            )
        total = checked_duration("duration", duration)
        speed = 1.5 * np.abs(displacement) / total if velocity is None else positive("velocity", velocity, n)
        return _with_cruising_speed(start, displacement, speed, total)
    if velocity is None:
        raise InputError("`acceleration` was given without `velocity`; expected both limits.")
    limits = np.stack([positive("velocity", velocity, n), positive("acceleration", acceleration, n)])
    return _within_limits(start, displacement, limits, _trapezoid, duration, synchronise, "trapezoidal")


def s_curve(
    q0: ArrayLike,
    q1: ArrayLike,
    velocity: ArrayLike,
    acceleration: ArrayLike,
    jerk: ArrayLike,
    duration: float | None = None,
    synchronise: Together = "phase",
) -> Polynomial:
    """From rest to rest as fast as limits of speed, acceleration and jerk allow: seven phases of constant jerk.

    Args:
        q0: Start, (n,) [rad or m].
        q1: End, (n,) [rad or m].
        velocity: Limits of speed, one or (n,) [rad/s or m/s].
        acceleration: Limits of acceleration, one or (n,) [rad/s^2 or m/s^2].
        jerk: Limits of jerk, one or (n,) [rad/s^3 or m/s^3].
        duration: Time to take where the limits would allow less [s].
        synchronise: As for `trapezoidal`.

    Returns:
        The trajectory.

    Raises:
        InputError: Limits not above zero; a duration shorter than the limits allow.

    Source: Biagiotti & Melchiorri 2008, section 3.4.

    Example:
        >>> move = ulna.trajectory.s_curve([0.0], [1.0], velocity=1.0, acceleration=4.0, jerk=40.0)
        >>> round(move.duration, 3)
        1.35
    """
    start = vector("q0", q0)
    displacement = vector("q1", q1, start.size) - start
    bounds = {"velocity": velocity, "acceleration": acceleration, "jerk": jerk}
    limits = np.stack([positive(name, value, start.size) for name, value in bounds.items()])
    return _within_limits(start, displacement, limits, _double_s, duration, synchronise, "s-curve")


Phases = tuple[Floats, Floats, int]
"""How long each phase lasts, the value in it, and of which derivative that is."""


def _trapezoid(d: float, limits: Floats) -> Phases:
    """Durations and accelerations of the three phases that cover the displacement `d`."""
    v, a = limits
    v = min(v, np.sqrt(d * a))
    ta = v / a
    return np.array([ta, d / v - ta, ta]), np.array([a, 0.0, -a]), 2


def _double_s(d: float, limits: Floats) -> Phases:
    """Durations and jerks of the seven phases that cover the displacement `d`."""
    v, a, j = limits
    tj, ta = (np.sqrt(v / j), 2.0 * np.sqrt(v / j)) if v * j < a * a else (a / j, a / j + v / a)
    tv = d / v - ta
    if tv < 0.0:  # full speed is not reached
        tv, tj = 0.0, a / j
        ta = 0.5 * tj + np.sqrt(0.25 * tj * tj + d / a)
        if d < 2.0 * a**3 / j**2:  # nor is full acceleration
            tj = np.cbrt(d / (2.0 * j))
            ta = 2.0 * tj
    constant = ta - 2.0 * tj
    return np.array([tj, constant, tj, tv, tj, constant, tj]), j * np.array([1.0, 0, -1, 0, -1, 0, 1]), 3


def _within_limits(
    start: Floats,
    displacement: Floats,
    limits: Floats,
    profile: Callable[[float, Floats], Phases],
    duration: float | None,
    synchronise: str,
    kind: str,
) -> Polynomial:
    if synchronise not in _PHASES:
        raise UnknownName("kind of synchronisation", synchronise, _PHASES)
    moving = np.abs(displacement) > 0.0
    if not moving.any():
        if duration is None:
            raise InputError(
                "`q0` and `q1` are the same point; expected points that differ, or a `duration` to wait."
            )
        return Polynomial.of([0.0, checked_duration("duration", duration)], start[None, None], kind)
    size = np.abs(displacement[moving])
    if synchronise == "phase":
        phases = profile(1.0, (limits[:, moving] / size).min(axis=1))
        displacements, all_phases = [displacement], [phases]
    else:
        displacements = list(np.diag(displacement)[moving])
        all_phases = [profile(1.0, limit / d) for limit, d in zip(limits[:, moving].T, size, strict=True)]
    total = max(float(phases[0].sum()) for phases in all_phases)
    profiles = [_integrated(*phases) for phases in all_phases]
    if synchronise == "time":
        profiles = [p._stretched(total / p.duration) for p in profiles]
    motion = _combined(start, displacements, profiles, total, kind)
    if duration is None:
        return motion
    chosen_duration = checked_duration("duration", duration)
    if chosen_duration < total * (1.0 - 1e-12):
        raise InputError(f"`duration` is {chosen_duration:g} s, but the limits take at least {total:.6g} s.")
    return motion._stretched(chosen_duration / total)


def _with_cruising_speed(start: Floats, displacement: Floats, speed: Floats, total: float) -> Polynomial:
    """LSPB of given duration and cruising speeds, joint by joint."""
    size = np.abs(displacement)
    moving = size > 0.0
    mean = size / total
    wrong = moving & ((speed <= mean) | (speed > 2.0 * mean * (1.0 + 1e-12)))
    if wrong.any():
        k = int(np.argmax(wrong))
        raise InputError(
            f"`velocity[{k}]` is {speed[k]:g}, but to cover {size[k]:g} in {total:g} s from rest to rest the cruising "
            f"speed must be above {mean[k]:.6g} and at most {2.0 * mean[k]:.6g}."
        )
    if not moving.any():
        return Polynomial.of([0.0, total], start[None, None], "trapezoidal")
    profiles = []
    for fraction in (speed / np.where(moving, size, 1.0))[moving]:  # of the displacement per second
        ta = total - 1.0 / fraction
        profiles.append(
            _integrated(np.array([ta, total - 2.0 * ta, ta]), fraction / ta * np.array([1.0, 0, -1]), 2)
        )
    return _combined(start, list(np.diag(displacement)[moving]), profiles, total, "trapezoidal")


def _integrated(durations: Floats, values: Floats, order: int) -> Polynomial:
    """A profile from 0 to 1 whose derivative of that order is constant in each phase; empty phases are left out."""
    nonzero = durations > 1e-12 * durations.sum()
    durations, values = durations[nonzero], values[nonzero]
    c, state = np.zeros((durations.size, order + 1, 1)), np.zeros(order)
    powers = np.array([1.0, 1.0, 2.0, 6.0])[: order + 1]
    for k, (h, value) in enumerate(zip(durations, values, strict=True)):
        c[k, :, 0] = np.append(state, value) / powers
        state = np.array([sum(c[k, i, 0] * np.prod(np.arange(i - d + 1, i + 1)) * h ** (i - d)
                              for i in range(d, order + 1)) for d in range(order)])  # fmt: skip
    return Polynomial.of(np.concatenate([[0.0], np.cumsum(durations)]), c, "law")


def _combined(
    start: Floats, displacements: list[Floats], profiles: list[Polynomial], total_time: float, kind: str
) -> Polynomial:
    """start + sum of displacement times profile, each profile constant after its end, on the knots of all."""
    knots = np.unique(np.concatenate([profile.times for profile in profiles]))
    knots = knots[np.append(True, np.diff(knots) > 1e-12 * total_time)]
    knots[-1] = total_time
    rows = max(profile.coefficients.shape[1] for profile in profiles)
    total = np.zeros((knots.size - 1, rows, start.size))
    total[:, 0] = start
    middle = 0.5 * (knots[:-1] + knots[1:])  # safely inside one piece of each profile
    for displacement, profile in zip(displacements, profiles, strict=True):
        piece = np.searchsorted(profile.times[1:-1], middle, side="right")
        c = shifted(profile.coefficients[piece], knots[:-1] - profile.times[piece])
        c[middle > profile.duration] = 0.0
        c[middle > profile.duration, 0] = 1.0
        total[:, : c.shape[1]] += c * displacement
    return Polynomial.of(knots, total, kind)
