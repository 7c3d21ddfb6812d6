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
from ulna.ik.analytic.chain import Arm
from ulna.ik.analytic.evaluation import Evaluator
from ulna.ik.analytic.geometry import EXACT, ArmGeometry, remaining
from ulna.ik.analytic.lines import Line, turn_about
from ulna.ik.analytic.pieper import solve
from ulna.linalg import solve_spd
from ulna.numeric import cross, dot, less, vector, where
from ulna.spatial import SE3
from ulna.typing import Array, Floats

_DAMPING = 1e-12


def closed_form(geometry: ArmGeometry, arm: Arm, evaluate: Evaluator, nq: int) -> Any:
    """The kernel of a geometry: (T, T_base, free_value, branch, base, centre) to a candidate (q, evaluation).

    Both are those of `candidate_evaluator`. T is the goal, T_base the pose of the arm's base, both in the world;
    `free_value` (1,) the position of the joint that it leaves free (anything where there is none); `branch` a row
    of `branch_numbers(geometry)`; `base` (nq,) the other joints, and angles to take where any would do; `centre` (n,)
    where the arm's coordinates are wanted.

    Args:
        geometry: The relations that the closed form uses.
        arm: The arm.
        evaluate: The function of `candidate_evaluator`.
        nq: Number of entries of a configuration.

    Returns:
        The kernel.
    """
    others = [axis for i, axis in enumerate(arm.axes) if i != geometry.free]

    def candidate(
        T: Array, T_base: Array, free_value: Array, branch: Array, base: Array, centre: Array
    ) -> tuple[Array, Array]:
        local = SE3(T_base[:3, :3], T_base[:3, 3]).inverse() @ SE3(T[:3, :3], T[:3, 3])
        near = vector(*(base[axis.index] * axis.scale + axis.offset for axis in others))
        q = [base[i] for i in range(nq)]
        x = free_value[0]
        if geometry.free is not None:
            free = arm.axes[geometry.free]
            q[free.index], x = x, x * free.scale + free.offset
        angles = branch_of(geometry, arm, local, x, branch, near)
        for axis, angle in zip(others, angles, strict=True):
            q[axis.index] = (angle - axis.offset) / axis.scale
        return evaluate(vector(*q), T, centre)

    shapes = {
        "T": (4, 4),
        "T_base": (4, 4),
        "free_value": (1,),
        "branch": (3,),
        "base": (nq,),
        "centre": (len(arm.axes),),
    }
    return compile(candidate, **shapes)


def branch_of(geometry: ArmGeometry, arm: Arm, T: SE3, free_value: Any, branch: Array, near: Array) -> Array:
    """Own positions (6,) of the other joints, for one branch.

    Args:
        geometry: The relations that the closed form uses.
        arm: The arm.
        T: The goal in the arm's base.
        free_value: Own position of the joint whose value is chosen.
        branch: A row of `branch_numbers(geometry)`, (3,).
        near: Own positions (6,) to take where any would do.

    Returns:
        Positions (6,) [rad].
    """
    lines = remaining(arm, geometry.free, free_value)
    G = T @ arm.end.inverse()
    if geometry.free is not None:
        G = G @ arm.axes[geometry.free].move(-free_value)
    q = solve(geometry, lines, G, branch, near)
    for _ in range(1 if geometry.deviation <= EXACT else 3):
        q = _polished(lines, G, q)
    return q


def branch_numbers(geometry: ArmGeometry) -> Floats:
    """Every branch of a closed form, (8, 3): which of its solutions each equation takes."""
    return np.array(list(product(*map(range, geometry.solution_counts))), dtype=float)


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
