"""The branches of the Puma 560 by letters, with which scripts choose one."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from roboticstoolbox._common.poses import matrices
from roboticstoolbox._ets.ik_solution import IKSolution
from roboticstoolbox._ik.analytic import wrapped
from roboticstoolbox._mixins.robot_mixin import RobotMixin
from ulna.typing import Floats

_STRAIGHT = 1e-9  # [rad] below which both letters for a joint hold


class PumaBranches(RobotMixin):
    """The branches of the Puma 560, which scripts choose by letters."""

    def ikine_a(self, T: Any, config: str = "lun", tol: float = 1e-6) -> IKSolution:
        """The configuration of that branch for a pose, or for each of several; joint limits do not count.

        Args:
            T: The pose of the end, or poses: an SE3, (4, 4) or (m, 4, 4).
            config: "l" or "r", the arm to the left or to the right; "u" or "d", elbow up or down; "n" or "f", wrist as
                it is or flipped. What is missing is "l", "u", "n".
            tol: Greatest E = e^T e / 2 that counts as reached [-].

        Returns:
            Configuration (n,), or (m, n) for m poses; nan where there is none.

        Source: Paul & Zhang, Computationally efficient kinematics for manipulators with spherical wrists (1986).
        """
        letters = set(self.config_validate(config, ("lr", "ud", "nf")))
        goals = matrices(T)
        rows, reason, residual = [], "", 0.0
        for goal in goals.reshape(-1, 4, 4):
            solutions = self._chain(None, None).arm.ik_all(goal, np.zeros(self.n), limits=False)
            matching = [i for i, q in enumerate(solutions.q) if letters <= self._branch(q)]
            if not matching:
                reason, residual = "Out of reach", math.inf
                rows.append(np.full(self.n, np.nan))
                continue
            q = wrapped(solutions.q[matching[0]])
            if abs(math.sin(q[4])) < _STRAIGHT:  # any turns of the fourth and sixth joint with that sum
                q = wrapped([*q[:3], 0.0, q[4], q[5] + q[3] * math.cos(q[4])])
            q[:3] = np.where(q[:3] > math.pi - _STRAIGHT, -math.pi, q[:3])  # from -pi up to pi, as there
            rows.append(q)
            e = solutions.position_error[matching[0]], solutions.rotation_error[matching[0]]
            E = 0.5 * (e[0] * e[0] + e[1] * e[1])
            if tol < E:
                reason = f"Solution does not reach the pose, residual {E:.3g}"
            residual = max(residual, E)
        q = np.array(rows)
        return IKSolution(q[0] if goals.ndim == 2 else q, not reason, residual=residual, reason=reason)

    def _branch(self, q: Floats) -> set[str]:
        """The letters that hold at a configuration; both of a pair where a joint is straight."""
        x, y, z = self.A([0, 3], q).t  # the wrist's centre
        ahead = x * math.cos(q[0]) + y * math.sin(q[0])
        left = ahead < 0.0
        lift = float(wrapped(q[1] - math.atan2(z - self._links[0].d, ahead))) * (-1.0 if left else 1.0)  # type: ignore[attr-defined]
        bent = math.sin(q[4])
        out = {"l" if left else "r"}
        out |= {letter for letter, there in (("u", lift > -_STRAIGHT), ("d", lift < _STRAIGHT)) if there}
        return out | {
            letter for letter, there in (("n", bent < _STRAIGHT), ("f", bent > -_STRAIGHT)) if there
        }
