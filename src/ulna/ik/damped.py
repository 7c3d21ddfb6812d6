"""One damped-least-squares step of a robot towards a goal, for following a target that someone drags.

| symbol | meaning | shape, unit | source |
|---|---|---|---|
| e | position error and rotation vector from the frame to the goal, world axes | (6,), m and rad | Siciliano
3.7.3 |
| J | Jacobian at the origin of the frame, world axes | (6, nv) | |
| lambda | damping: grows with the error, vanishes at the goal | 1 | Sugihara 2011, eq. 18 |
| dq | J^T (J J^T + lambda^2 I)^-1 e | (nv,), rad and m | Nakamura & Hanafusa 1986, eq. 16 |
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ulna.errors import ShapeError
from ulna.spatial import so3_log
from ulna.typing import ArrayLike, Floats

_HALVINGS = 6


class DampedStep(NamedTuple):
    """What a step led to.

    `q` is the new configuration (nq,); the errors are those before the step [m] and [rad].
    """

    q: Floats
    position_error: float
    rotation_error: float


def damped_step(
    robot: Any,
    q: ArrayLike,
    T_goal: ArrayLike,
    frame: str | None = None,
    *,
    damping: float = 0.02,
    largest: float = 0.25,
    rotation_weight: float = 0.3,
) -> DampedStep:
    """One step from `q` towards a configuration that puts the frame at the goal.

    Joints stay within their limits: one that the step would push out of them stands at its limit and the
    others take over its part. Only joints with one coordinate move (a free-flying base stays where it is).

    Args:
        robot: An `ulna.Robot`.
        q: Configuration, shape (nq,).
        T_goal: The pose to reach, T_world_goal, shape (4, 4).
        frame: The frame to put there; the tool when not given.
        damping: Least damping (without unit); more is calmer near singular configurations.
        largest: Largest step of a joint [rad or m].
        rotation_weight: How many metres of position error a radian of rotation error is worth [m].
    """
    q = np.array(q, dtype=float)
    goal = np.asarray(T_goal, dtype=float)
    if goal.shape != (4, 4):
        raise ShapeError("T_goal", goal.shape, "(4, 4), a pose in the world")
    weight = np.repeat((1.0, rotation_weight), 3)
    error = _error(robot.fk(q, frame), goal)
    weighted = weight * error
    here = float(weighted @ weighted)
    joints = [j for j in robot.model.joints if j.mimic is None and j.kind.nq == 1 and j.kind.nv == 1]
    at_q = np.array([j.idx_q for j in joints], dtype=int)
    at_v = np.array([j.idx_v for j in joints], dtype=int)
    lower, upper = robot.model.lower_position[at_q], robot.model.upper_position[at_q]
    columns = robot.jacobian(q, frame, "local_world_aligned")[:, at_v] * weight[:, None]
    step = _solve(columns, weighted, damping**2 + 0.1 * here, lower - q[at_q], upper - q[at_q], largest)
    out = q
    for _ in range(_HALVINGS):  # far from straight, near the edge of reach, a whole step may lead away
        trial = q.copy()
        trial[at_q] = np.clip(q[at_q] + step, lower, upper)
        there = weight * _error(robot.fk(trial, frame), goal)
        if float(there @ there) < here:
            out = trial
            break
        step = 0.5 * step
    return DampedStep(out, float(np.linalg.norm(error[:3])), float(np.linalg.norm(error[3:])))


def _error(pose: Floats, goal: Floats) -> Floats:
    return np.concatenate([goal[:3, 3] - pose[:3, 3], so3_log(goal[:3, :3] @ pose[:3, :3].T)])


def _solve(
    columns: Floats, error: Floats, damping: float, low: Floats, high: Floats, largest: float
) -> Floats:
    """The damped step within bounds: joints that would leave them stay there, the others take their part over."""
    step = np.zeros(columns.shape[1])
    free = np.ones(len(step), dtype=bool)
    for _ in range(len(step) + 1):
        part = columns[:, free]
        rest = error - columns[:, ~free] @ step[~free]
        move = part.T @ np.linalg.solve(part @ part.T + damping * np.eye(6), rest)
        step[free] = move * min(1.0, largest / max(float(np.abs(move).max(initial=0.0)), 1e-300))
        out = free & ((step < low) | (step > high))
        if not out.any():
            break
        step[out] = np.clip(step[out], low[out], high[out])
        free &= ~out
    return step
