"""Acceptance test of an answer: errors computed anew, whether it meets the goals, and whether these are poses."""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna import numeric
from ulna.compiler import Function, trace
from ulna.ik.problem import Problem, are_met
from ulna.typing import Array

_ROTATION_TOLERANCE = 1e-6  # entry by entry of R^T R


def unwound(problem: Problem, q: Array, home: Array, near: Any) -> Array:
    """`q` with angles without limits within half a turn of 0, or with `near` of `home`.

    Args:
        problem: The problem, whose turning joints these are.
        q: Configuration (nq,) [rad or m].
        home: Configuration (nq,) [rad or m].
        near: 1 for half a turn about `home`, 0 for half a turn about 0.

    Returns:
        The same configuration with other whole turns, (nq,) [rad or m].
    """
    out = list(q)
    for i in problem.turning:
        middle = near * home[i]
        out[i] = out[i] - 2.0 * np.pi * np.floor((out[i] - middle) * (0.5 / np.pi) + 0.5)
    return np.array(out, dtype=object)


def acceptance(
    problem: Problem, q: Array, goals: Array, tolerances: Array, is_valid: Any, steps: Any, number: Any
) -> list[Any]:
    """Status (1 met, 0 not met, -1 a goal is no rotation), steps, starting point, and the errors at `q`.

    Args:
        problem: The problem.
        q: Configuration (nq,) [rad or m].
        goals: Goals of the frames, (k, 4, 4).
        tolerances: Those of `goal.squared_tolerances`, (2,) [m^2, rad^2].
        is_valid: Whether the rotations of the goals are rotations.
        steps: Number of steps taken.
        number: Number of the starting point.

    Returns:
        [status, steps, starting point, distance [m] and angle [rad] of each frame].
    """
    each = problem.distances(q, goals, with_rows=False)
    status = numeric.where(is_valid, numeric.where(are_met(each, tolerances), 1.0, 0.0), -1.0)
    parts = [x for d in each for x in (numeric.sqrt(d.position), d.angle)]
    return [status, steps, number, *parts]


def are_rotations(goals: Array) -> Any:
    """Whether the upper left of every goal is a rotation, and its last row 0, 0, 0, 1."""
    good: Any = True
    for goal in goals:
        R = goal[:3, :3]
        for i in range(3):
            for j in range(i + 1):
                off = numeric.dot(R[:, i], R[:, j]) - float(i == j)
                good = good & (off < _ROTATION_TOLERANCE) & (off > -_ROTATION_TOLERANCE)
        good = good & (numeric.dot(numeric.cross(R[:, 0], R[:, 1]), R[:, 2]) > 0.0)
        for j in range(4):
            good = good & (goal[3, j] <= float(j == 3)) & (goal[3, j] >= float(j == 3))
    return good


def acceptance_kernel(problem: Problem) -> Function:
    """The acceptance test of a configuration, as a kernel.

    Inputs: T, q0 and settings as those of `search.multi_start`, the configuration q (nq,), and counts (2,):
    steps and number of the starting point. Output as that of `search.multi_start`.
    """

    def accept(T: Array, q0: Array, settings: Array, q: Array, counts: Array) -> Array:
        goals = problem.goals(T)
        q = unwound(problem, q, q0, settings[2])
        report = acceptance(problem, q, goals, settings[:2], are_rotations(goals), counts[0], counts[1])
        return numeric.vector(*q, *report)

    shapes: dict[str, Any] = {**problem.shapes, "settings": (4,), "q": (problem.model.nq,), "counts": (2,)}
    return trace(accept, name="ik_acceptance", **shapes)
