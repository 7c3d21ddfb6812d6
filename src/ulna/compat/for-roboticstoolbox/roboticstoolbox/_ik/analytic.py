"""Inverse kinematics in closed form: all branches for a pose, or the one nearest to a configuration."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from roboticstoolbox._common.errors import WrongShape
from roboticstoolbox._common.poses import matrices, matrix, pose
from roboticstoolbox._ets.ik_solution import IKSolution
from roboticstoolbox._mixins.robot_mixin import RobotMixin
from ulna.errors import InputError
from ulna.spatial import matrix_to_euler
from ulna.typing import Floats


def wrapped(angles: Any) -> Floats:
    """Angles in (-pi, pi]."""
    out = np.asarray(angles, dtype=float)
    return out - 2.0 * math.pi * np.ceil(out / (2.0 * math.pi) - 0.5)


class AnalyticIK:
    """All configurations of an arm for a pose; those of six turning joints in closed form or by elimination."""

    def __init__(self, robot: Any) -> None:
        self.robot = robot
        self._turns = np.array(robot.revolutejoints)

    def _branches(self, T: Floats, near: Floats, joint_limits: bool) -> Any:
        return self.robot._chain(None, None).arm.ik_all(T, near, limits=joint_limits)

    def solve(self, T: Any, joint_limits: bool = True) -> IKSolution:
        """All configurations for one pose, as the rows of `q`.

        Args:
            T: The pose of the end, an SE3 or (4, 4).
            joint_limits: Whether to leave out solutions beyond the limits.

        Returns:
            Configurations (k, n) in `q`, and why there is none.
        """
        solutions = self._branches(matrix(T), np.zeros(self.robot.n), joint_limits)
        return IKSolution(solutions.q, solutions.count > 0, reason=solutions.reason)

    def ikine(self, T: Any, q0: Any = None, joint_limits: bool = True, weights: Any = None) -> IKSolution:
        """The configuration nearest to `q0` for a pose; along a trajectory, nearest to the one before.

        Args:
            T: The pose of the end, or poses.
            q0: The configuration to be near to, (n,); default zeros.
            joint_limits: Whether to leave out solutions beyond the limits.
            weights: Weight of the difference of each joint, (n,); default 1.

        Returns:
            Configuration (n,), or (m, n) for m poses; nan where there is none.

        Raises:
            WrongShape: `q0` or `weights` has another shape.
        """
        goals, n = matrices(T), self.robot.n
        near = np.zeros(n) if q0 is None else np.asarray(q0, dtype=float).ravel()
        scale = np.ones(n) if weights is None else np.asarray(weights, dtype=float).ravel()
        for name, vector in (("q0", near), ("weights", scale)):
            if vector.shape != (n,):
                raise WrongShape(name, vector.shape, f"({n},)")
        rows, reason, residual = [], "", 0.0
        for k, goal in enumerate(goals.reshape(-1, 4, 4)):
            solutions = self._branches(goal, near, joint_limits)
            if not solutions.count:
                reason = reason or (solutions.reason if goals.ndim == 2 else f"pose {k}: {solutions.reason}")
                rows.append(np.full(n, np.nan))
                continue
            away = solutions.q - near
            away = np.where(self._turns, wrapped(away), away)
            best = int(np.argmin(np.linalg.norm(scale * away, axis=1)))
            near = solutions.q[best]
            rows.append(near)
            residual = max(
                residual, math.hypot(solutions.position_error[best], solutions.rotation_error[best])
            )
        q = np.array(rows)
        return IKSolution(q[0] if goals.ndim == 2 else q, not reason, residual=residual, reason=reason)

    def validate(self, trials: int = 100, seed: int = 1) -> float:
        """Tries random configurations: whether they are among the solutions for their poses.

        Args:
            trials: Number of configurations.
            seed: Seed of the random numbers.

        Returns:
            The fraction that is found [-].
        """
        draw, count = np.random.default_rng(seed), 0
        for _ in range(trials):
            q = np.where(self._turns, draw.uniform(-math.pi, math.pi, self.robot.n), draw.uniform(0.2, 0.6))
            rows = self._branches(self.robot._chain(None, None).fk(q), q, False).q
            count += bool(len(rows)) and bool((np.abs(rows - q).max(axis=1) < 1e-5).any())
        return count / trials

    def generate(self, language: str = "python", name: str = "ikine") -> str:
        """Source code of the closed form, which needs no library: a function from a pose to all configurations.

        Args:
            language: "python", "c" or "c++".
            name: Name of the function.

        Returns:
            The source.
        """
        from roboticstoolbox._ik.branch_source import closed_form_source

        return closed_form_source(self.robot, language, name)

    def __repr__(self) -> str:
        return f"AnalyticIK({self.robot.name!r})"


class Analytic(RobotMixin):
    """Closed forms of DH robots."""

    def analytic_ik(self) -> AnalyticIK:
        """A solver that returns all configurations for a pose."""
        return AnalyticIK(self)

    def ikine_analytic(
        self, T: Any, q0: Any = None, joint_limits: bool = True, weights: Any = None
    ) -> IKSolution:
        """The configuration nearest to `q0` among all for a pose; see `AnalyticIK.ikine`.

        Args:
            T: Pose of the end, an SE3, (4, 4) or (m, 4, 4).
            q0: The configuration to be near to, (n,) [rad or m]; zeros by default.
            joint_limits: Whether to leave out solutions beyond the limits.
            weights: Weight of the difference of each joint, (n,); 1 by default.

        Returns:
            Configuration (n,), or (m, n) for m poses; nan where there is none.
        """
        return self.analytic_ik().ikine(T, q0, joint_limits, weights)

    def config_validate(self, config: str, allowables: Sequence[str]) -> str:
        """`config` with the first letter of each of `allowables` that has none of its letters.

        Args:
            config: Letters that choose a branch.
            allowables: For each choice the letters that it has.

        Returns:
            One letter for each choice.

        Raises:
            InputError: A letter is in none of them.
        """
        for letter in config:
            if not any(letter in allowed for allowed in allowables):
                known = ", ".join("".join(allowed) for allowed in allowables)
                raise InputError(
                    f"`config` {config!r} has the letter {letter!r}; expected letters of {known}."
                )
        missing = [allowed[0] for allowed in allowables if not set(allowed) & set(config)]
        return "".join([config, *missing])

    def ikine_6s(self, T: Any, config: str, ikfunc: Callable[..., Any]) -> IKSolution:
        """Closed form of an arm with a spherical wrist whose first three joints `ikfunc(robot, T, config)` solves.

        Args:
            T: The pose of the end, or poses.
            config: Letters that choose the branch; "f" turns the wrist over.
            ikfunc: Returns three angles, offsets included, or the reason why there is no solution.

        Returns:
            Configuration (n,), or (m, n) for m poses; nan where there is none.
        """
        warnings.warn(
            "ikine_6s is kept for old scripts; write the closed form of a robot as Puma560.ikine_a does, or take "
            "ikine_analytic",
            DeprecationWarning,
            stacklevel=2,
        )
        goals = matrices(T)
        base = np.eye(4) if self._base is None else self._base
        tool = np.eye(4) if self._tool is None else self._tool
        wrist, last = self._links[3], self._links[5]
        lift, end = np.eye(4), last.A(0.0).A
        lift[2, 3] = wrist.d  # type: ignore[attr-defined]
        rows, reason = [], ""
        for goal in goals.reshape(-1, 4, 4):
            arm = np.linalg.solve(base, goal) @ np.linalg.inv(tool)
            first = ikfunc(self, pose(arm), config)
            if first is None or isinstance(first, str):
                reason = reason or first or "no solution"
                rows.append(np.full(6, np.nan))
                continue
            before = self.A([0, 2], np.asarray(first, dtype=float) - self.offset[:3]).A
            R = np.linalg.solve(before @ lift, arm) @ np.linalg.inv(end)
            turns = matrix_to_euler(R[:3, :3], "zyz")
            if "f" in config:
                turns = wrapped(turns * [1.0, -1.0, 1.0] + np.array([math.pi, 0.0, math.pi]))
            turns = turns * [1.0, -1.0 if wrist.alpha > 0 else 1.0, 1.0]  # type: ignore[attr-defined]
            rows.append(np.concatenate([first, turns]) - self.offset)
        q = np.array(rows)
        return IKSolution(q[0] if goals.ndim == 2 else q, not reason, reason=reason)
