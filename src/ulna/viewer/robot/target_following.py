"""Following a dragged target with the tool of a robot: closer with each step, without jumps."""

from __future__ import annotations

from typing import Any, NamedTuple, final

import numpy as np

from ulna.spatial import SE3
from ulna.typing import Floats

_MAX_STEP = 0.5  # the most a joint moves in one step [rad or m], 60 times a second
_FRACTIONS = tuple(0.5**k for k in range(10))  # of the way to the target, while more of it would be a jump
_TOLERANCE = 1e-9  # m and rad
_CONVERGED = 1e-7  # rad or m
_RADIAN_WEIGHT = 0.3  # what a radian counts, in metres, for a tool that too few joints carry


class FollowStep(NamedTuple):
    """The result of a step: the configuration (nq,), and whether it converged."""

    q: Floats
    converged: bool


@final
class TargetFollower:
    """Moves the tool of a robot towards a target.

    Joints with one coordinate move; a free-flying base and ball joints stay where they are. Of many configurations for
    one pose it takes one near the last. A tool that fewer than six joint coordinates carry comes as near as it can.

    Args:
        robot: An `ulna.Robot`.
    """

    def __init__(self, robot: Any) -> None:
        self.robot, model = robot, robot.model
        carrying = {model.joints[i].idx_v for i in model.support(model.frame(robot.tool).joint)}
        moving = [
            j for j in model.joints if j.mimic is None and j.kind.nq == j.kind.nv == 1 and j.idx_v in carrying
        ]
        self._joints = tuple(j.name for j in moving)
        self._mask = (
            None if len(moving) >= 6 else (1.0, 1.0, 1.0, _RADIAN_WEIGHT, _RADIAN_WEIGHT, _RADIAN_WEIGHT)
        )

    def step(self, q: Floats, T_goal: Floats) -> FollowStep:
        """One step towards a configuration with the tool at the goal.

        A target out of reach is followed to the nearest configuration that joints reach without a jump.

        Args:
            q: Configuration (nq,) [rad or m].
            T_goal: T_world_goal, (4, 4).

        Returns:
            The next configuration, and whether the tool comes no nearer.
        """
        if not self._joints:
            return FollowStep(q, True)
        start, end = SE3.from_matrix(self.robot.fk(q)), SE3.from_matrix(T_goal)
        for fraction in _FRACTIONS:
            goal = T_goal if fraction == 1.0 else start.interpolate(end, fraction).matrix()
            solution = self.robot.ik(
                goal,
                q,
                mask=self._mask,
                joints=self._joints,
                position_tolerance=_TOLERANCE,
                rotation_tolerance=_TOLERANCE,
                attempts=1,  # from here, and from beside: what lies far away would be a jump
            )
            difference = solution.q - q
            size = float(np.abs(difference).max(initial=0.0))
            if size <= _MAX_STEP:
                return FollowStep(solution.q, size < _CONVERGED)
            if solution.success:
                return FollowStep(q + difference * (_MAX_STEP / size), False)
        return FollowStep(q, True)
