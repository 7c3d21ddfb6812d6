"""Explains why a step of differential inverse kinematics has no solution: which limits, and which joints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from ulna.errors import InfeasibleError, InputError
from ulna.ik.differential.frames import AxisTask
from ulna.ik.differential.limits import Interval
from ulna.ik.differential.program import CONFLICT, NO_ROTATION, TURNED, Problem, Program
from ulna.ik.qp import solve_rows
from ulna.model import Model
from ulna.typing import Floats


def reason(
    program: Program, problem: Problem, q: Floats, dt: Floats, *inputs: Floats, where: str = ""
) -> InfeasibleError | InputError:
    """What is wrong with one sample that has no solution.

    Args:
        program: Tasks and limits.
        problem: What it made of the sample.
        q: Configuration (nq,) [rad or m].
        dt: Duration () [s].
        *inputs: What was passed, (...) each as `program.inputs` says.
        where: The place in the batch, for the message.

    Returns:
        The error to raise.
    """
    values = dict(zip(program.inputs, inputs, strict=True))
    if problem.status == NO_ROTATION:
        return _no_rotation(program, values, where)
    if problem.status == CONFLICT:
        return _conflict(program, q, dt, values, where)
    if has_nan(problem):
        return _no_numbers(program, values, where)
    if not np.isfinite(problem.H).all() or np.linalg.eigvalsh(problem.H)[0] <= 0.0:
        return InputError(
            f"The tasks do not determine all joints{where}, and `damping` is too small to do so. "
            "Give more damping, or add a PostureTask or a DampingTask."
        )
    return _no_solution(program, q, dt, values, where)


def has_nan(problem: Problem) -> bool:
    """Whether the program of one sample holds nan, as where a direction has no length."""
    return bool(np.isnan(problem.g).any() or np.isnan(problem.lower).any() or np.isnan(problem.A).any())


def _no_numbers(program: Program, values: Mapping[str, Floats], where: str) -> InputError:
    """A direction has no length, or numbers are too large to be computed with."""
    for task in program.objectives:
        if isinstance(task, AxisTask) and not values[task.label].any():
            return InputError(
                f"`{task.label}`{where} holds only zeros; expected a direction, of any length above 0."
            )
    return InputError(
        f"The tasks and limits are nan{where}: an input is too large. Pass numbers in SI units."
    )


def _conflict(
    program: Program, q: Floats, dt: Floats, values: Mapping[str, Floats], where: str
) -> InfeasibleError:
    """Two limits leave a joint no velocity: the worst such joint."""
    model = program.model
    intervals = [
        (limit.label, bound) for limit, bound in program.bounds(q, dt, values) if isinstance(bound, Interval)
    ]
    lower, upper = (np.stack([bound[k][list(program.moving)] for _, bound in intervals]) for k in (0, 1))
    worst = int(np.argmax(lower.max(axis=0) - upper.min(axis=0)))
    least, most = int(np.argmax(lower[:, worst])), int(np.argmin(upper[:, worst]))
    i = program.moving[worst]
    text = (
        f"{_joint(model, i, q)}{where}: {intervals[least][0]} wants a velocity of at least {lower[least, worst]:.6g}, "
        f"{intervals[most][0]} of at most {upper[most, worst]:.6g}. "
        "Change what is asked, take a longer step, or let later limits yield to earlier ones: recover=True."
    )
    return InfeasibleError((intervals[least][0], intervals[most][0]), text)


def _no_solution(
    program: Program, q: Floats, dt: Floats, values: Mapping[str, Floats], where: str
) -> InfeasibleError:
    """Rows and bounds leave nothing: those without any one of which there would be a solution."""
    conflicting = []
    for k, limit in enumerate(program.limits):
        if _feasible(replace(program, limits=_without(program.limits, k)), q, dt, values):
            conflicting.append(limit.label)
    for k, task in enumerate(program.constraints):
        if len(program.constraints) + len(program.tasks) > 1 and _feasible(
            replace(program, constraints=_without(program.constraints, k)), q, dt, values
        ):
            conflicting.append(task.label)
    everything = [part.label for part in (*program.limits, *program.constraints)]
    names = tuple(conflicting or everything)
    joined = ", ".join(names)
    why = f"without any one of these there is: {joined}" if conflicting else f"among: {joined}"
    text = f"No velocity keeps all limits and constraints{where}; {why}. Change what is asked, or take a longer step."
    return InfeasibleError(names, text)


def _no_rotation(program: Program, values: Mapping[str, Floats], where: str) -> InputError:
    """A target is neither a pose nor a rotation."""
    for name in program.rotations:
        target = values[name]
        if len(target) == 4 and np.abs(target[3] - [0.0, 0.0, 0.0, 1.0]).max() >= TURNED:
            row = ", ".join(f"{x:.6g}" for x in target[3])
            return InputError(
                f"`{name}`{where} has the last row [{row}]; expected [0, 0, 0, 1]. Is it transposed?"
            )
    off = {name: _distance_from_rotation(values[name][:3, :3]) for name in program.rotations}
    for name in program.rotations:
        if off[name] < TURNED and np.linalg.det(values[name][:3, :3]) < 0.0:
            return InputError(
                f"`{name}`{where} is not a rotation but a reflection, of determinant -1. Look for a flipped axis."
            )
    name = max(off, key=lambda name: off[name])
    return InputError(
        f"`{name}`{where} is not a rotation: R^T R differs from 1 by {off[name]:.3g}. "
        "The nearest one: SE3.project(matrix).matrix()."
    )


def _distance_from_rotation(R: Floats) -> float:
    return float(np.abs(R.T @ R - np.eye(3)).max())


def _joint(model: Model, i: int, q: Floats) -> str:
    for joint in model.joints:
        if joint.mimic is None and joint.idx_v <= i < joint.idx_v + joint.nv:
            at = ", ".join(f"{x:.6g}" for x in joint.q_of(q))
            lower, upper = joint.limits.lower, joint.limits.upper
            limits = f", limits {lower[0]:.6g} .. {upper[0]:.6g}" if joint.nq == 1 else ""
            return f"Joint {joint.name!r} (at {at}{limits})"
    raise AssertionError(f"no joint has the entry {i} of v")


def _feasible(program: Program, q: Floats, dt: Floats, values: Mapping[str, Floats]) -> bool:
    p = program.problem(q, dt, *(values[name] for name in program.inputs))
    if p.status == CONFLICT:
        return False
    n = len(p.g)
    A = np.ascontiguousarray(p.A)
    return solve_rows(np.eye(n), np.zeros(n), A, p.lower, p.upper, program.equalities) is not None


def _without(parts: Sequence, k: int) -> tuple:
    return (*parts[:k], *parts[k + 1 :])
