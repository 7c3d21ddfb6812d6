"""Candidates for configurations that reach a pose: from a closed form, elimination, or many starts."""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import lru_cache
from typing import Any, final

import numpy as np

from ulna import kernels
from ulna.algorithms.multibody.tree import chain
from ulna.compiler import compile
from ulna.errors import InputError, UnknownName
from ulna.ik.analytic import general
from ulna.ik.analytic.chain import Arm, arm_of, usual
from ulna.ik.analytic.closed import branch_numbers, closed_form
from ulna.ik.analytic.evaluation import candidate_evaluator, periods
from ulna.ik.analytic.geometry import EXACT, ArmGeometry, arm_geometries, remaining
from ulna.ik.analytic.refine import refined
from ulna.ik.singular import any_singular
from ulna.model import Model
from ulna.spatial import SE3
from ulna.system.cached import cached_property
from ulna.typing import Floats

_STARTS = 256
_STEPS = 60
_FEW_STEPS = 20
_MORE_STARTS = 128  # where elimination may have lost some
_MET = 1e-9  # errors below which a candidate counts as at the goal [m and rad]
_MAX_CONDITION = 1e9
"""Condition number up to which elimination is trusted to have found every solution."""


class Source(ABC):
    """Configurations that may put a frame at a pose.

    Attributes:
        arm: The joints that move.
        free: The joint of a redundant arm that is given values; None where there is none.
        index: Places of the arm's coordinates in q.
        periods: By how much each may change without a change of pose, (n,) [rad]; inf where by nothing.
        lower, upper: Their limits, (n,).
        centre: Where they are wanted if nothing is said: at 0, or the limit next to it, (n,).
        refine_threshold: Errors up to which Newton's method is tried on a candidate [m and rad].
        takes_base: Whether a joint that is free in a singular pose takes its value from the base configuration, and no
            other joint is given values.
        evaluate: The kernel (q, T, centre) to (q, evaluation); see evaluation.py.

    Args:
        model: The robot.
        frame: Name of the frame.
        arm: The joints that move.
        free: The joint of a redundant arm that values are passed for, as an index into the arm's axes; None for none.
    """

    refine_threshold = 1e-3
    takes_base = False

    def __init__(self, model: Model, frame: str, arm: Arm, free: int | None) -> None:
        self.arm, self.free = arm, free
        self._evaluator = candidate_evaluator(model, model.frame(frame), arm)
        self._model, self._frame = model, frame
        self.index = list(arm.indices)
        self.periods = periods(arm)
        self.lower, self.upper = model.lower_position[self.index], model.upper_position[self.index]
        self.centre = np.clip(0.0, self.lower, self.upper)
        free_index = -1 if free is None else arm.axes[free].index
        solved = [i for i, index in enumerate(self.index) if index != free_index]
        self._columns = [self.index[i] for i in solved], [arm.indices_v[i] for i in solved]

    @property
    @abstractmethod
    def method(self) -> str:
        """The method, as text."""

    @property
    @abstractmethod
    def max_candidates(self) -> int:
        """The largest number of candidates for a pose and a value of the free joint."""

    @abstractmethod
    def candidates(
        self, T: Floats, base: Floats, centre: Floats, free_values: Floats, seed: int
    ) -> tuple[Floats, Floats, bool]:
        """Candidates (m, groups, k, nq) for m goals, their evaluations, and whether all branches are among them.

        Args:
            T: The goals, (m, 4, 4).
            base: Configurations (m, nq) of the other joints; the entries of the arm choose among infinitely many
                solutions, as there are in singular configurations.
            centre: Where the arm's coordinates are wanted, (m, n).
            free_values: Values of the free coordinate, (groups,); (1,) where there is none.
            seed: For what is drawn at random.

        Returns:
            q (m, groups, k, nq); evaluation (m, groups, k, 3) as in evaluation.py; whether all branches are among them.
        """

    @cached_property
    def evaluate(self) -> Any:
        """The kernel (q, T, centre) to (q, evaluation)."""
        return compile(self._evaluator, q=(self._model.nq,), T=(4, 4), centre=(len(self.arm.indices),))

    @cached_property
    def _kernels(self) -> tuple[Any, Any]:
        """Those of the frame's pose and Jacobian, made when they are first needed."""
        fk = kernels.kernel(self._model, "fk", frame=self._frame)
        aligned = "local_world_aligned"
        return fk, kernels.kernel(self._model, "jacobian", frame=self._frame, reference=aligned)

    def _is_singular(self, q: Floats) -> bool:
        """Whether in any of the configurations (m, nq) the arm moves without moving the frame, or nearly so."""
        return len(q) > 0 and any_singular(self._kernels[1](q)[..., self._columns[1]])

    def refine(self, q: Floats, T: Floats, iterations: int) -> Floats:
        """Configurations (m, nq) led nearer to goals (m, 4, 4); the free joint stays where it is.

        Args:
            q: Configurations, (m, nq) [rad or m].
            T: Goals, (m, 4, 4).
            iterations: Largest number of Newton steps.

        Returns:
            The nearest configurations that were reached, (m, nq).
        """
        fk, jacobian = self._kernels
        return refined(fk, jacobian, q, T, self._columns, iterations)


@final
class ClosedForm(Source):
    """Branches of a closed form, one in each lane of a compiled kernel.

    Args:
        model: The robot.
        frame: Name of the frame.
        arm: The joints that move.
        geometry: The relations that the closed form uses.
    """

    def __init__(self, model: Model, frame: str, arm: Arm, geometry: ArmGeometry) -> None:
        super().__init__(model, frame, arm, geometry.free)
        self.geometry, self.takes_base = geometry, geometry.free is None
        if geometry.deviation <= EXACT:
            self.refine_threshold = 1e-6  # what is off by more has no solution
        self.kernel = closed_form(geometry, arm, self._evaluator, model.nq)
        self.numbers = branch_numbers(geometry)
        self._base = np.array(arm.base(np.array(model.neutral)).matrix())

    def base(self, q: Floats) -> Floats:
        """T_world_base for configurations (..., nq): (..., 4, 4), or (4, 4) where no joint is before the arm."""
        return self.arm.base(q).matrix() if self.arm.before else self._base

    @cached_property
    def method(self) -> str:
        """The method, as text."""
        method = self.geometry.describe(self.arm.names)
        return (
            method
            if self.geometry.deviation <= EXACT
            else f"{method}, axes off by {self.geometry.deviation:.1g}, refined"
        )

    @property
    def max_candidates(self) -> int:
        """The largest number of candidates; see `Source.max_candidates`."""
        return len(self.numbers)

    def candidates(
        self, T: Floats, base: Floats, centre: Floats, free_values: Floats, seed: int
    ) -> tuple[Floats, Floats, bool]:
        """Candidates; see `Source.candidates`."""
        goals, base, centre = T[:, None, None], base[:, None, None], centre[:, None, None]
        q, evaluation = self.kernel.gufunc(
            goals, self.base(base), free_values[:, None, None], self.numbers, base, centre
        )
        return q, evaluation, self.geometry.deviation <= EXACT


@final
class Elimination(Source):
    """Branches of six revolute joints in general positions, from eigenvalues; see general.py. A seventh is held."""

    @cached_property
    def method(self) -> str:
        """The method, as text."""
        return "six general axes: elimination to an eigenvalue problem, refined by Newton's method"

    @property
    def max_candidates(self) -> int:
        """The largest number of candidates; see `Source.max_candidates`."""
        return 32  # 16 solutions [Raghavan & Roth 1993], each at most twice where two nearly meet

    def candidates(
        self, T: Floats, base: Floats, centre: Floats, free_values: Floats, seed: int
    ) -> tuple[Floats, Floats, bool]:
        """Candidates; see `Source.candidates`."""
        SE3.from_matrix(T)  # eigenvalues want finite numbers
        starts: dict[tuple[int, int], Floats] = {}
        complete = True
        free = None if self.free is None else self.arm.axes[self.free]
        for i, goal in enumerate(T):
            local = self.arm.base(base[i]).inverse() @ SE3(goal[:3, :3], goal[:3, 3]) @ self.arm.end.inverse()
            for j, value in enumerate(free_values):
                x = 0.0 if free is None else value * free.scale + free.offset
                G = local if free is None else local @ free.move(-x)
                starts[i, j], condition = general.starts(remaining(self.arm, self.free, x), G)
                if condition >= _MAX_CONDITION:
                    complete = False
                    drawn = np.random.default_rng(seed).uniform(-np.pi, np.pi, (_MORE_STARTS, 6))
                    starts[i, j] = np.concatenate([starts[i, j], drawn])
        most = max((len(start) for start in starts.values()), default=0)
        q = np.full((len(T), len(free_values), max(most, 1), base.shape[-1]), np.nan)
        for (i, j), start in starts.items():
            q[i, j, : len(start)] = base[i]
            others = [axis for axis in self.arm.axes if axis is not free]
            for k, axis in enumerate(others):
                q[i, j, : len(start), axis.index] = (start[:, k] - axis.offset) / axis.scale
            if free is not None:
                q[i, j, : len(start), free.index] = free_values[j]
        goals = np.broadcast_to(T[:, None, None], (*q.shape[:-1], 4, 4))
        known = np.isfinite(q).all(axis=-1)
        q[known] = self.refine(q[known], goals[known], _FEW_STEPS)
        q, evaluation = self.evaluate(q, goals, centre[:, None, None])
        return q, evaluation, complete and not self._is_singular(q[evaluation[..., :2].max(axis=-1) < _MET])


@final
class ManyStarts(Source):
    """What Newton's method finds from random starts: for prismatic joints, few joints, or joints that mimic others.

    Args:
        model: The robot.
        frame: Name of the frame.
        arm: The joints that move.
    """

    def __init__(self, model: Model, frame: str, arm: Arm) -> None:
        super().__init__(model, frame, arm, None)
        half_width = np.where(np.isfinite(self.periods), np.pi, 1.0)
        self._low = np.where(
            np.isfinite(self.lower), self.lower, np.minimum(-half_width, self.upper - 2.0 * half_width)
        )
        self._high = np.where(
            np.isfinite(self.upper), self.upper, np.maximum(half_width, self.lower + 2.0 * half_width)
        )

    @cached_property
    def method(self) -> str:
        """The method, as text."""
        return f"Newton's method from {_STARTS} random starts"

    @property
    def max_candidates(self) -> int:
        """The largest number of candidates; see `Source.max_candidates`."""
        return _STARTS

    def candidates(
        self, T: Floats, base: Floats, centre: Floats, free_values: Floats, seed: int
    ) -> tuple[Floats, Floats, bool]:
        """Candidates; see `Source.candidates`."""
        SE3.from_matrix(T)
        drawn = np.random.default_rng(seed).uniform(self._low, self._high, (_STARTS, len(self._low)))
        q = np.repeat(base[:, None], _STARTS, axis=1)
        q[..., self.index] = drawn
        goals = np.broadcast_to(T[:, None], (*q.shape[:-1], 4, 4))
        q = self.refine(q.reshape(-1, q.shape[-1]), goals.reshape(-1, 4, 4), _STEPS).reshape(q.shape)
        q, evaluation = self.evaluate(q, goals, centre[:, None])
        return q[:, None], evaluation[:, None], False


@lru_cache(maxsize=128)
def source_of(
    model: Model, frame: str, joints: tuple[str, ...] | None, free: str | None, fixed: tuple[float, ...]
) -> Source:
    """The best source for an arm.

    Args:
        model: The robot.
        frame: Name of the frame to place.
        joints: Names of the joints that move; None for the usual ones; see `usual`.
        free: Name of the joint of a seven-joint arm that is given values; None for the one that suits best.
        fixed: Values of the coordinates that `between` names.

    Returns:
        A closed form, elimination, or many starts.

    Raises:
        UnknownName: a joint does not move the frame, or `free` is none of them.
        InputError: `free` is given for an arm that is not redundant, or cannot be held.
    """
    end = model.frame(frame)
    names = joints if joints is not None else usual(model, end)
    q_fixed = np.array(model.neutral)
    q_fixed[list(between(model, frame, joints))] = fixed
    arm = arm_of(model, end, names, q_fixed)
    count = len(arm.axes)
    chosen = None
    if free is not None:
        if free not in arm.names:
            raise UnknownName("joint of the arm", free, arm.names)
        if count != 7:
            raise InputError(
                f"`free` is {free!r}, but the arm has {count} joints; only one of seven joints is free."
            )
        chosen = arm.names.index(free)
    if arm.is_independent:
        fitting = arm_geometries(arm, chosen)
        if fitting:
            return ClosedForm(model, frame, arm, fitting[0])
        is_revolute = [axis.motion == "turn" for axis in arm.axes]
        if count == 6 and all(is_revolute):
            return Elimination(model, frame, arm, None)
        if count == 7 and sum(is_revolute) >= 6:
            hold = chosen if chosen is not None else (2 if all(is_revolute) else is_revolute.index(False))
            if all(is_revolute) or not is_revolute[hold]:
                return Elimination(model, frame, arm, hold)
    if free is not None:
        raise InputError(
            f"`free` is {free!r}, which cannot be held: the other six joints have no closed form, and are not six "
            "revolute joints that move by themselves. Leave `free` out, or lock the joint: robot.lock([...])."
        )
    return ManyStarts(model, frame, arm)


@lru_cache(maxsize=128)
def between(model: Model, frame: str, joints: tuple[str, ...] | None) -> tuple[int, ...]:
    """Places in q of the joints that are held between those of the arm: its shape depends on where.

    Args:
        model: The robot.
        frame: Name of the frame.
        joints: Names of the joints of the arm; None for the usual ones; see `usual`.

    Returns:
        The places, from the base outwards.
    """
    steps = chain(model, model.frame(frame))
    names = joints if joints is not None else usual(model, model.frame(frame))
    moves = [step.joint.name in names and step.kind.nq == 1 for step in steps]
    if True not in moves:
        return ()
    first = moves.index(True)
    inside = [step for step, is_arm in zip(steps[first:], moves[first:], strict=True) if not is_arm]
    return tuple(i for step in inside for i in range(step.joint.idx_q, step.joint.idx_q + step.joint.kind.nq))
