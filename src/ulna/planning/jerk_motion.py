"""Motion along a planned path under limits of jerk: an S-curve on each straight part, at rest at the corners.

Along a straight part all joints move in proportion to its length, so limits of one joint limit the speed, acceleration
and jerk along the path. Source: Biagiotti and Melchiorri 2008, section 3.4.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.checks.arrays import known_limits
from ulna.model import Model
from ulna.planning.motion_path import distinct_points, motion_path
from ulna.trajectory import Polynomial, Retimed, s_curve
from ulna.trajectory.inputs import positive
from ulna.typing import ArrayLike, Floats

_UNLIMITED = 1e9  # speed that no motion reaches [rad/s, m/s]


def jerk_limited_motion(
    model: Model, points: Floats, velocity: ArrayLike | None, acceleration: ArrayLike, jerk: ArrayLike
) -> Retimed:
    """The fastest motion along a path that rests at its corners, under limits of speed, acceleration and jerk.

    Args:
        model: The robot.
        points: The path, shape (k + 1, nq) [rad, m]; points that repeat count once.
        velocity: Limits of speed, () or (nq,) [rad/s, m/s]; None for the model's.
        acceleration: Limits of acceleration, () or (nq,) [rad/s^2, m/s^2].
        jerk: Limits of jerk, () or (nq,) [rad/s^3, m/s^3].

    Returns:
        The trajectory.

    Raises:
        InputError: If a limit is not above 0, one of acceleration or jerk is infinite, or all points are the same.
    """
    of_model: Any = known_limits(model.velocity_limit)
    n = points.shape[1]
    limits = np.stack(
        [
            np.minimum(positive("velocity", of_model if velocity is None else velocity, n, True), _UNLIMITED),
            positive("acceleration", acceleration, n),
            positive("jerk", jerk, n),
        ]
    )
    points = distinct_points(points)
    edges = np.diff(points, axis=0)
    lengths = np.linalg.norm(edges, axis=1)
    ends = np.concatenate([[0.0], np.cumsum(lengths)])
    clock, pieces = [np.zeros(1)], []
    for k, direction in enumerate(np.abs(edges) / lengths[:, None]):
        moving = direction > 0.0
        shares = (limits[:, moving] / direction[moving]).min(axis=1)
        law = s_curve(ends[k : k + 1], ends[k + 1 : k + 2], *shares)
        clock.append(clock[-1][-1] + law.times[1:])
        pieces.append(law.coefficients)
    law = Polynomial.of(np.concatenate(clock), np.concatenate(pieces), "law")
    return Retimed.of(motion_path(model, points), law, "jerk-limited")
