"""What is said of an answer: its errors computed anew, whether it meets the goals, and whether these are poses."""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna import numeric
from ulna.compiler import Function, trace
from ulna.ik.problem import Problem, are_met
from ulna.typing import Array

_ROTATION_TOLERANCE = 1e-6  # entry by entry of R^T R


def unwound(problem: Problem, q: Array, home: Array, near: Any) -> Array:
    """`q` with angles without limits within half a turn of 0, or with `near` of `home`."""
    out = list(q)
    for i in problem.turning:
        middle = near * home[i]
        out[i] = out[i] - 2.0 * np.pi * np.floor((out[i] - middle) * (0.5 / np.pi) + 0.5)
    return np.array(out, dtype=object)


def verdict(
    problem: Problem, q: Array, goals: Array, tolerances: Array, is_valid: Any, steps: Any, number: Any
) -> list[Any]:
    """What is said of an answer beside its configuration; the errors are those at `q`, computed anew."""
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


def judge(problem: Problem) -> Function:
    """The verdict on a configuration, as a kernel.

    Inputs: T, q0 and settings as those of `search.race`, the configuration q (nq,), and what is told beside it: steps
    and number of the starting point. Output as that of `search.race`.
    """

    def say(T: Array, q0: Array, settings: Array, q: Array, told: Array) -> Array:
        goals = problem.goals(T)
        q = unwound(problem, q, q0, settings[2])
        said = verdict(problem, q, goals, settings[:2], are_rotations(goals), told[0], told[1])
        return numeric.vector(*q, *said)

    shapes: dict[str, Any] = {**problem.shapes, "settings": (4,), "q": (problem.model.nq,), "told": (2,)}
    return trace(say, name="ik_judge", **shapes)
