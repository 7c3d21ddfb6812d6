"""Random paths of every kind for time-optimal parameterisation, and a dense look at what a motion uses of limits."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

import ulna
from ulna import trajectory

Rng = np.random.Generator


def way_points(robot: ulna.Robot, rng: Rng, count: int | None = None) -> np.ndarray:
    """Random configurations in the middle of the joint limits, (count, nq)."""
    low, high = robot.limits.lower, robot.limits.upper
    count = int(rng.integers(2, 7)) if count is None else count
    return low + (high - low) * rng.uniform(0.2, 0.8, (count, robot.nq))


def cornered(points: np.ndarray, rng: Rng) -> trajectory.Polynomial:
    """Straight lines that meet in sharp corners."""
    times = rng.uniform(0.2, 1.5, len(points) - 1)
    c = np.stack([points[:-1], np.diff(points, axis=0) / times[:, None]], axis=1)
    return trajectory.Polynomial.of(np.concatenate([[0.0], np.cumsum(times)]), c)


def _blended(kind: Any) -> Callable[..., trajectory.Trajectory]:
    return lambda robot, p, rng: trajectory.blended(
        p, float(rng.choice([0.01, 0.1, 0.4])), velocity=0.8, kind=kind
    )


def _under_a_law(robot: ulna.Robot, p: np.ndarray, rng: Rng) -> trajectory.Trajectory:
    path = trajectory.blended(p, 0.1, velocity=0.8)
    return path.retimed(trajectory.quintic(0.0, path.duration, 3.0))


PATHS: dict[str, Callable[[ulna.Robot, np.ndarray, Rng], Any]] = {
    "parabolic blends": _blended("parabolic"),
    "quintic blends": _blended("quintic"),
    "quintic": lambda robot, p, rng: trajectory.quintic(
        p[0], p[-1], 1.0, v0=rng.normal(size=7), v1=rng.normal(size=7)
    ),
    "quintic from rest": lambda robot, p, rng: trajectory.quintic(p[0], p[-1], 1.0),
    "cubic spline": lambda robot, p, rng: trajectory.cubic_spline(
        p, duration=float(rng.choice([1e-3, 1.0, 1e3]))
    ),
    "way-points": lambda robot, p, rng: p,
    "minimum jerk": lambda robot, p, rng: trajectory.minimum_jerk(p, duration=1.0),
    "b-spline": lambda robot, p, rng: trajectory.bspline(p, 1.0, degree=int(rng.choice([3, 5]))),
    "corners": lambda robot, p, rng: cornered(p, rng),
    "straight through": lambda robot, p, rng: trajectory.straight_through(robot, p, 1.0),
    "under a law": _under_a_law,
    "there and back": lambda robot, p, rng: cornered(np.concatenate([p, p[-2::-1]]), rng),
}


def dense_times(t: trajectory.Trajectory, count: int = 3000) -> np.ndarray:
    """Even times, twelve between any two knots, and each knot from both sides."""
    knots = t.knots
    between = knots[:-1, None] + np.diff(knots)[:, None] * np.linspace(0.02, 0.98, 12)
    even = np.linspace(0.0, t.duration, count)
    return np.sort(np.concatenate([even, between.reshape(-1), knots, np.nextafter(knots[1:], 0.0)]))


def part(values: np.ndarray, low: np.ndarray, high: np.ndarray) -> float:
    """The greatest part of limits that values (m, n) use."""
    return float(np.maximum(values / high, values / low).max())


def dense_use(
    robot: ulna.Robot, t: trajectory.Trajectory, acceleration: Any, velocity: Any = None, torque: Any = None
) -> dict[str, float]:
    """What a motion uses of limits (2, n), by its own derivatives and by differences of its points."""
    speed = np.stack([-robot.limits.velocity, robot.limits.velocity]) if velocity is None else velocity
    effort = np.stack([-robot.limits.effort, robot.limits.effort]) if torque is None else torque
    q, v, a = t.state(dense_times(t))
    h = t.duration / 20_000
    way = t(np.linspace(0.0, t.duration, 20_001))
    by_points = np.diff(way, axis=0) / h
    return {
        "velocity": max(part(v, *speed), part(by_points, *speed)),
        "acceleration": part(a, *acceleration),
        "acceleration by points": part(np.diff(by_points, axis=0) / h, *acceleration),
        "torque": part(robot.inverse_dynamics(q, v, a), *effort),
    }
