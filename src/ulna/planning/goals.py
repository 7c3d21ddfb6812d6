"""Goals of planning: configurations, or poses that configurations are searched for."""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.errors import InputError, ShapeError
from ulna.spatial import SE3
from ulna.typing import Floats

_ATTEMPTS = 12  # different starts from which a pose is solved
_SEARCHES = 64  # from each, before it is given up


def goal_configurations(robot: Any, goal: Any, frame: str | None, q0: Floats, seed: int) -> Floats:
    """The configurations that a goal allows.

    Args:
        robot: The robot.
        goal: A configuration (nq,), several (n, nq), an SE3 or pose (4, 4), or several poses (n, 4, 4) [rad, m].
        frame: Which frame a pose is for; None for the robot's tip.
        q0: Where the motion begins, shape (nq,) [rad, m].
        seed: Seed of the starts from which poses are solved.

    Returns:
        Configurations, shape (n, nq), nearest to `q0` first; none where a pose cannot be reached.

    Raises:
        ShapeError: If the goal is none of these.
        InputError: If it holds nan, or `frame` is given for configurations.
    """
    nq = robot.model.nq
    poses = goal.matrix() if isinstance(goal, SE3) else np.asarray(goal, dtype=float)
    if not np.isfinite(poses).all():
        raise InputError("`goal` holds nan or inf; expected finite numbers.")
    is_pose = poses.shape[-2:] == (4, 4) and poses.ndim in (2, 3)
    if is_pose and nq == 4 and poses.ndim == 2 and not isinstance(goal, SE3):
        raise InputError(
            "`goal` of shape (4, 4) may be a pose or four configurations. Pass SE3.from_matrix(goal) or goal[None] "
            "for a pose; plan to the configurations one by one."
        )
    if is_pose:
        return _solved(robot, poses.reshape(-1, 4, 4), frame, q0, seed)
    if poses.shape not in ((nq,),) and not (poses.ndim == 2 and poses.shape[1] == nq and len(poses)):
        raise ShapeError(
            "goal",
            poses.shape,
            f"a configuration ({nq},), several (n, {nq}), a pose (4, 4) or several (n, 4, 4)",
        )
    if frame is not None:
        raise InputError(
            "`frame` says whose pose the goal is; the goal here is a configuration. Leave it out."
        )
    return poses.reshape(-1, nq)


def _solved(robot: Any, poses: Floats, frame: str | None, q0: Floats, seed: int) -> Floats:
    """Different configurations for poses, nearest to q0 first."""
    random = np.random.default_rng([seed, 2])
    lower = np.maximum(robot.model.lower_position, q0 - np.pi)
    upper = np.minimum(robot.model.upper_position, q0 + np.pi)
    solutions: list[Floats] = []
    for T in poses:
        for k in range(_ATTEMPTS):
            start = q0 if k == 0 else random.uniform(lower, upper)
            solution = robot.ik(T, start, frame, seed=seed + k, attempts=_SEARCHES)
            near = [np.abs(solution.q - q).max() for q in solutions]
            if solution.success and min(near, default=1.0) > 1e-3:
                solutions.append(np.asarray(solution.q))
    solutions.sort(key=lambda q: float(np.linalg.norm(q - q0)))
    return np.array(solutions).reshape(-1, robot.model.nq)
