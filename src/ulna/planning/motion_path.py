"""The curve that a motion along a path follows: straight from point to point, with corners cut where that is allowed.

| symbol | meaning | shape | unit |
|---|---|---|---|
| u, w | directions before and after a corner | (n,) | [-] |
| b | how far before and after the corner the blend begins and ends | () | [rad, m] |

A blend is a parabola whose velocity turns from u to w, so it deviates from the corner's two edges by at most
b |w - u| / 4 in each coordinate. Source: Biagiotti and Melchiorri 2008, section 3.2 (linear with parabolic blends).
"""

from __future__ import annotations

import numpy as np

from ulna.errors import InputError
from ulna.model import Model
from ulna.trajectory import Polynomial
from ulna.trajectory.space import Configurations
from ulna.typing import Floats

_MIN_BLEND_LENGTH = 1e-6  # shorter ones stay corners [rad, m]


def distinct_points(points: Floats) -> Floats:
    """A path without the points that do not move on.

    Args:
        points: The path, shape (n, nq) [rad, m].

    Returns:
        Points, shape (k + 1, nq) [rad, m].

    Raises:
        InputError: If all points are the same.
    """
    moves = np.linalg.norm(np.diff(points, axis=0), axis=1) > 0.0
    if not moves.any():
        raise InputError("The start is the goal; there is nothing to move.")
    return points[np.concatenate([[True], moves])]


def motion_path(model: Model, points: Floats, deviation_bounds: Floats | None = None) -> Polynomial:
    """The curve through a path's points, by its length, in plain numbers: continuous joints turn as the points say.

    Args:
        model: The robot.
        points: The path, shape (k + 1, nq) [rad, m]; points that repeat count once.
        deviation_bounds: Rows (m, nq): the curve may deviate by d where all of `deviation_bounds @ abs(d)` are at most
            1 [1/rad, 1/m]; None for no deviation.

    Returns:
        The curve; its tangent jumps at corners that are not cut.

    Raises:
        InputError: If all points are the same.
    """
    points = distinct_points(points)
    edges = np.diff(points, axis=0)
    lengths = np.linalg.norm(edges, axis=1)
    u = edges / lengths[:, None]
    b = np.zeros(len(points))
    if deviation_bounds is not None and len(u) > 1:
        turn = np.abs(np.diff(u, axis=0))
        most = (turn @ deviation_bounds.T).max(axis=1)
        allowed = np.divide(4.0, most, out=np.full(len(turn), np.inf), where=most > 0.0)
        b[1:-1] = np.minimum(allowed, 0.5 * np.minimum(lengths[:-1], lengths[1:]))
        b[b < _MIN_BLEND_LENGTH] = 0.0
    clock, pieces = [0.0], []
    for k, direction in enumerate(u):
        straight = lengths[k] - b[k] - b[k + 1]
        if straight > 1e-9 * lengths[k]:
            pieces.append([points[k] + b[k] * direction, direction, np.zeros_like(direction)])
            clock.append(clock[-1] + straight)
        if b[k + 1] > 0.0:
            curvature = (u[k + 1] - direction) / (4.0 * b[k + 1])
            pieces.append([points[k + 1] - b[k + 1] * direction, direction, curvature])
            clock.append(clock[-1] + 2.0 * b[k + 1])
    return Polynomial.of(clock, pieces, "planned", Configurations.of(model))
