"""Inverse kinematics of a robot: from poses of its frames to configurations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING, Any

import numpy as np

from ulna.checks.first_error import without_context
from ulna.checks.values import names as checked_names
from ulna.checks.values import number
from ulna.quantities.part import Part
from ulna.typing import ArrayLike

if TYPE_CHECKING:
    from ulna.ik.classic import Method
    from ulna.ik.result import IKSolution


class InverseKinematics(Part):
    """Which configuration puts a frame at a goal."""

    __slots__ = ()

    def ik(
        self,
        T: Any,
        q0: ArrayLike | None = None,
        frame: str | Sequence[str] | None = None,
        *,
        mask: Any = None,
        joints: Sequence[str] | None = None,
        position_tolerance: float = 1e-6,
        rotation_tolerance: float = 1e-6,
        seed: int = 0,
        attempts: int = 400,
        threads: int | None = None,
    ) -> IKSolution:
        """Inverse kinematics: a configuration within the joint limits that puts a frame at a goal.

        Args:
            T: The goal, T_world_frame, (..., 4, 4) [m]; a batch is solved together. For several frames at once a
                dictionary {frame: T}, or (..., k, 4, 4) with their names in `frame`. Where `mask` leaves the rotation
                free, points (..., 3); where it leaves the position free, rotations (..., 3, 3).
            q0: Configuration to stay near, (..., nq) [rad or m]: the search starts from it and returns the nearest of
                the solutions found there. Without it, from a named rest configuration, then from drawn points; then
                the first solution met is returned.
            frame: Name; None for the tool, a list of names for several.
            mask: What counts of the goal: "pose" (the default), "position", "rotation", "position+z" (and where the
                tool's z axis points; likewise x, y), "z" (the direction alone), or weights (x, y, z, rx, ry, rz), 0
                where it is free, in world axes. For several frames a list or a dictionary of such.
            joints: Names of the joints that may move; the others stay as in `q0`, wherever that is. None for all that
                carry a frame.
            position_tolerance: Greatest distance from the goal that counts as met [m].
            rotation_tolerance: Greatest angle from the goal that counts as met [rad].
            seed: Chooses the starting points, a whole number, 0 or more; the same seed gives the same answer.
            attempts: About how many starting points are tried before the goal counts as out of reach.
            threads: How many threads a large batch may use.

        Returns:
            A solution with `.q` (..., nq), `.success`, `.position_error`, `.rotation_error`, `.iterations`,
            `.restarts` and `.reason`. Where no solution is found, `success` is False and `q` is the nearest
            configuration that is.

        Raises:
            InputError: If a goal is no pose, a mask or tolerance means nothing, or the frame has too few joints for the
                whole pose and `mask` does not say what counts.
            ShapeError, DtypeError, NonFiniteError: If `T` or `q0` is not of that shape or not finite.
            UnknownName: If there is no such frame, joint or mask.

        Reference: Sugihara 2011 (damping); the search runs in the SIMD lanes, see `ulna.ik.search`.

        Example:
            >>> robot = ulna.load("panda")
            >>> T = robot.fk(robot.configurations["qr"])
            >>> solution = robot.ik(T)
            >>> solution.success, np.allclose(robot.fk(solution.q), T, atol=1e-5)
            (True, True)
        """
        try:
            solver = self._searches[type(T) is not np.ndarray and isinstance(T, Mapping), frame, mask, joints]
        except (KeyError, TypeError):
            with without_context():
                T, solver = self._solver(T, frame, mask, joints)
        return solver(T, q0, position_tolerance, rotation_tolerance, seed, attempts, threads)

    def ik_classic(
        self,
        T: Any,
        method: Method = "chan",
        q0: ArrayLike | None = None,
        frame: str | Sequence[str] | None = None,
        *,
        mask: Any = None,
        joints: Sequence[str] | None = None,
        damping: float | None = None,
        limit_gain: float = 0.0,
        influence: float = 0.3,
        manipulability_gain: float = 0.0,
        iterations: int = 30,
        searches: int = 100,
        position_tolerance: float = 1e-6,
        rotation_tolerance: float = 1e-6,
        seed: int = 0,
        threads: int | None = None,
    ) -> IKSolution:
        """Inverse kinematics by a solver of the textbooks, to compare with; `ik` is faster and finds more.

        Args:
            T: The goals, as for `ik`.
            method: "newton_raphson", "gauss_newton", "wampler", "chan", "sugihara" or "qp"; see `ulna.ik.classic`.
            q0: Where the first search begins, (..., nq); the others begin at drawn configurations.
            frame: As for `ik`.
            mask: As for `ik`.
            joints: As for `ik`.
            damping: The method's lambda [-]; None for 1 ("chan", "qp"), 1e-4 ("wampler", "sugihara").
            limit_gain: How strongly joints keep away from their limits in the null space of the Jacobian [rad or m].
            influence: How near to a limit that begins [rad or m].
            manipulability_gain: How strongly joints seek manipulability in the null space of the frame [-].
            iterations: Steps of a search.
            searches: How many are made before the goal counts as out of reach.
            position_tolerance: As for `ik` [m].
            rotation_tolerance: As for `ik` [rad].
            seed: Chooses where searches begin.
            threads: How many threads a large batch may use.

        Returns:
            A solution as from `ik`; its `restarts` are the searches that failed, its `iterations` those of all.
        """
        from ulna.ik.classic import DAMPING

        limit_gain = number("limit_gain", limit_gain)
        manipulability_gain = number("manipulability_gain", manipulability_gain)
        has_null_motion = bool(limit_gain or manipulability_gain)
        goals, solver = self._classic_solver(T, frame, mask, joints, method, has_null_motion)
        settings = {
            "position_tolerance": position_tolerance,
            "rotation_tolerance": rotation_tolerance,
            "iterations": iterations,
            "searches": searches,
            "damping": DAMPING[method] if damping is None else damping,
            "limit_gain": limit_gain,
            "influence": influence,
            "manipulability_gain": manipulability_gain,
        }
        return solver(goals, q0, settings, seed, threads)

    def _classic_solver(
        self, T: Any, frame: Any, mask: Any, joints: Any, method: Method, has_null_motion: bool
    ) -> tuple[Any, Any]:
        """The goals as the classic solver takes them, and that solver."""
        from ulna.ik.arguments import named_goals
        from ulna.ik.classic import ClassicSolver

        goals, names, masks = named_goals(T, frame, mask, self.model.tool)
        moving = None if joints is None else checked_names("joints", joints)
        key = ("classic", method, names, masks, moving, has_null_motion)
        solver = self._searches.get(key) if isinstance(method, str) else None
        if solver is None:
            solver = ClassicSolver(self.model, names, masks, moving, method, has_null_motion)
            self._searches[key] = solver
        return goals, solver

    def _solver(self, T: Any, frame: Any, mask: Any, joints: Any) -> tuple[Any, Any]:
        from ulna.ik.arguments import named_goals
        from ulna.ik.solve import Solver

        goals, names, masks = named_goals(T, frame, mask, self.model.tool)
        moved = None if joints is None else checked_names("joints", joints)
        key = (names, masks, moved)
        solver = self._searches.get(key)
        if solver is None:
            solver = self._searches[key] = Solver(self.model, names, masks, moved)
        if not isinstance(T, Mapping) and isinstance(frame, (str, type(None))):
            with suppress(TypeError):  # a list of weights is no key: it is understood anew at each call
                self._searches[False, frame, mask, moved] = solver
        return goals, solver
