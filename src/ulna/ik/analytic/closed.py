"""A closed form as a compiled kernel: one call takes a pose and the number of a branch, lanes take all of them.

| symbol | meaning | shape, unit | source |
|---|---|---|---|
| G | the goal as a motion of the axes, E_1 ... E_6 = G | SE3 | pieper.py |
| D | what is left, G (E_1 ... E_6)^-1 | SE3 | |
| J | space Jacobian: columns (p_i x h_i, h_i) of the axes where they are | (6, 6) | Murray, Li & Sastry 1994, 3.4 |
| dq | (J^T J + mu I)^-1 J^T log(D), to first order | (6,) [rad] | Newton; Levenberg 1944 |
"""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np

from ulna.compiler import compile
from ulna.ik.analytic.certify import Certificate
from ulna.ik.analytic.chain import Arm
from ulna.ik.analytic.geometry import EXACT, Plan, remaining
from ulna.ik.analytic.lines import Line, turn_about
from ulna.ik.analytic.pieper import solve
from ulna.linalg import solve_spd
from ulna.numeric import cross, dot, less, vector, where
from ulna.spatial import SE3
from ulna.typing import Array, Floats

_DAMPING = 1e-12


def closed_form(plan: Plan, arm: Arm, certified: Certificate, nq: int) -> Any:
    """The kernel of a plan: (T, T_base, free_value, branch, base, centre) to a candidate (q, worth).

    These are as `certificate` has them. T is the goal, T_base the pose of the arm's base, both in the world;
    `free_value` (1,) the position of the joint that the plan leaves free (anything where there is none); `branch` a row
    of `branch_numbers(plan)`; `base` (nq,) the other joints, and angles to take where any would do; `centre` (n,) where
    the arm's coordinates are wanted.

    Args:
        plan: The closed form.
        arm: The arm.
        certified: The function from `certificate`.
        nq: Number of entries of a configuration.

    Returns:
        The kernel.
    """
    others = [axis for i, axis in enumerate(arm.axes) if i != plan.free]

    def candidate(
        T: Array, T_base: Array, free_value: Array, branch: Array, base: Array, centre: Array
    ) -> tuple[Array, Array]:
        local = SE3(T_base[:3, :3], T_base[:3, 3]).inverse() @ SE3(T[:3, :3], T[:3, 3])
        near = vector(*(base[axis.index] * axis.scale + axis.offset for axis in others))
        q = [base[i] for i in range(nq)]
        x = free_value[0]
        if plan.free is not None:
            free = arm.axes[plan.free]
            q[free.index], x = x, x * free.scale + free.offset
        angles = branch_of(plan, arm, local, x, branch, near)
        for axis, angle in zip(others, angles, strict=True):
            q[axis.index] = (angle - axis.offset) / axis.scale
        return certified(vector(*q), T, centre)

    shapes = {
        "T": (4, 4),
        "T_base": (4, 4),
        "free_value": (1,),
        "branch": (3,),
        "base": (nq,),
        "centre": (len(arm.axes),),
    }
    return compile(candidate, **shapes)


def branch_of(plan: Plan, arm: Arm, T: SE3, free_value: Any, branch: Array, near: Array) -> Array:
    """Own positions (6,) of the other joints, for one branch.

    Args:
        plan: The closed form.
        arm: The arm.
        T: The goal in the arm's base.
        free_value: Own position of the joint whose value is chosen.
        branch: A row of `branch_numbers(plan)`, (3,).
        near: Own positions (6,) to take where any would do.

    Returns:
        Positions (6,) [rad].
    """
    lines = remaining(arm, plan.free, free_value)
    G = T @ arm.end.inverse()
    if plan.free is not None:
        G = G @ arm.axes[plan.free].move(-free_value)
    q = solve(plan, lines, G, branch, near)
    for _ in range(1 if plan.off <= EXACT else 3):
        q = _polished(lines, G, q)
    return q


def branch_numbers(plan: Plan) -> Floats:
    """Every branch of a plan, (8, 3): which of its solutions each equation takes."""
    return np.array(list(product(*map(range, plan.counts))), dtype=float)


def _polished(lines: list[Line], G: SE3, q: Array) -> Array:
    """One Newton step (6,) towards G, where it leads nearer."""
    D, J = _state(lines, G, q)
    error = _first_order(D)
    normal = J.T @ J + _DAMPING * np.eye(6)
    moved = q + solve_spd(normal, J.T @ error)
    after = _first_order(_residual_pose(lines, G, moved))
    better = less(dot(after, after), dot(error, error))
    return vector(*(where(better, new, old) for new, old in zip(moved, q, strict=True)))


def _state(lines: list[Line], G: SE3, q: Array) -> tuple[SE3, Array]:
    E = SE3.identity()
    columns = []
    for line, angle in zip(lines, q, strict=True):
        now = line.moved(E)
        columns.append(vector(*cross(now.point, now.direction), *now.direction))
        E = E @ turn_about(line, angle)
    return G @ E.inverse(), np.stack(columns, axis=-1)


def _residual_pose(lines: list[Line], G: SE3, q: Array) -> SE3:
    E = SE3.identity()
    for line, angle in zip(lines, q, strict=True):
        E = E @ turn_about(line, angle)
    return G @ E.inverse()


def _first_order(D: SE3) -> Array:
    R, t = D.rotation, D.translation
    half = vector(R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1])
    return vector(*t, *(0.5 * half))
