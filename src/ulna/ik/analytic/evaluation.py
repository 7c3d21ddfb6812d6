"""Evaluator of candidates, compiled: angles moved into the limits, errors by the robot's own forward kinematics."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ulna import algorithms
from ulna.ik.analytic.chain import Arm
from ulna.model import Frame, Model
from ulna.numeric import arctan2, ceil, minimum, sqrt, vector, where
from ulna.typing import Array, Floats

RIM = 1e-9
"""How far outside its limits a joint may come out; it is then set on them [rad or m]."""

Evaluator = Callable[[Array, Array, Array], tuple[Array, Array]]


def candidate_evaluator(model: Model, frame: Frame, arm: Arm) -> Evaluator:
    """The function (q, T, centre) to (q, evaluation), generic in the scalar.

    `q` (nq,) is a candidate, `T` (4, 4) its goal, `centre` (n,) where the arm's coordinates are wanted: a joint that
    turns comes out within half a turn of it, or, if that is outside its limits and a turn more or less is not, there.
    `evaluation` (3,) is the distance [m] and the angle [rad] to the goal, and 1 within the limits, else 0; both are
    large for what is no pose, whatever the candidate.

    Args:
        model: The robot.
        frame: The frame to place.
        arm: The joints that move.

    Returns:
        The function.
    """
    places = arm.indices
    turns = periods(arm)
    lower, upper = model.lower_position[list(places)], model.upper_position[list(places)]

    def evaluate(q: Array, T: Array, centre: Array) -> tuple[Array, Array]:
        entries = [q[i] for i in range(model.nq)]
        inside: Any = 1.0
        for k, place in enumerate(places):
            x, ok = _within(entries[place], float(turns[k]), float(lower[k]), float(upper[k]), centre[k])
            entries[place], inside = x, where(ok, inside, 0.0)
        out = vector(*entries)
        pose = algorithms.frame_pose(model, out, frame)
        gap = vector(*(T[:3, 3] - pose.translation), *(T[3] - np.array([0.0, 0.0, 0.0, 1.0])))
        rotation_error = T[:3, :3] - pose.rotation
        chord = (rotation_error * rotation_error).sum() / 8.0  # the square of sin(angle / 2)
        angle = 2.0 * arctan2(sqrt(chord), sqrt(1.0 - minimum(chord, 1.0)))
        return out, vector(sqrt((gap * gap).sum()), angle, inside)

    return evaluate


def periods(arm: Arm) -> Floats:
    """By how much each coordinate may change without a change of pose, (n,) [rad]; inf where by nothing."""
    return np.array([_period(arm, index) for index in arm.indices])


def _period(arm: Arm, index: int) -> float:
    rotating = [axis for axis in arm.axes if axis.index == index]
    alone = len(rotating) == 1 and rotating[0].motion == "turn" and rotating[0].scale != 0.0
    return 2.0 * np.pi / abs(rotating[0].scale) if alone else np.inf


def _within(x: Any, period: float, lower: float, upper: float, centre: Any) -> tuple[Any, Any]:
    """x by whole periods near `centre` and within the limits, and whether it is."""
    if np.isfinite(period):
        x = x - period * ceil((x - centre) / period - 0.5)
        if np.isfinite(upper):
            x = where((upper + RIM < x) & (lower - RIM <= x - period), x - period, x)
        if np.isfinite(lower):
            x = where((x < lower - RIM) & (x + period <= upper + RIM), x + period, x)
    ok = (lower - RIM <= x) & (x <= upper + RIM)
    if np.isfinite(upper):
        x = where(ok & (upper < x), upper, x)
    if np.isfinite(lower):
        x = where(ok & (x < lower), lower, x)
    return x, ok
