"""The nearest that can be had where a goal is out of reach: a local minimum of the squared error within the limits."""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna import numeric
from ulna.compiler import Function, trace
from ulna.ik.problem import Problem, errors, step
from ulna.typing import Array

_STEPS = 200
_FIRST, _LEAST, _MOST = 0.03, 1e-9, 1e6  # damping, in squares of the problem's length


def approach(problem: Problem) -> Function:
    """The nearest that can be had around a configuration: a local minimum of the squared error within the limits.

    Inputs: T and q0 as those of `race`. Output: q (nq,). The damping follows Marquardt's rule, so that no step leads
    away (Nocedal & Wright 2006, section 10.3).
    """
    n = len(problem.positions)

    def descend(T: Array, q0: Array) -> Array:
        goals, scale = problem.goals(T), problem.length**2
        none = np.zeros(2)

        def body(*flat: Any) -> tuple[Any, ...]:
            q, damping = problem.replaced(q0, flat[:n]), flat[n]
            at = errors(problem, q, goals, none)
            trial = step(problem, q, at, damping)
            there = errors(problem, trial, goals, none).squared
            better = there < at.squared
            slow = at.squared - there < 1e-12 * at.squared
            damping = numeric.where(better, damping * 0.2, damping * 5.0)
            damping = numeric.maximum(damping, _LEAST * scale)
            return (
                *numeric.where(better, trial, q)[problem.positions],
                damping,
                numeric.where(better & slow, 1.0, 0.0),
            )

        start_at = problem.clip(q0)
        out = numeric.loop(
            lambda *flat: (flat[-1] < 0.5) & (flat[-2] < _MOST * scale),
            body,
            (*start_at[problem.positions], _FIRST * scale, 0.0),
            _STEPS,
        )
        return problem.replaced(start_at, out[:n])

    return trace(descend, name="ik_approach", **dict[str, Any](problem.shapes))
