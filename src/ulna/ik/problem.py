"""A problem of inverse kinematics as numbers: its errors, their Jacobian, and one damped step within the joint limits.

| symbol | meaning | shape, unit | source |
|---|---|---|---|
| e | errors of all frames, weighted | (m,) [m] | goal.py |
| J | their Jacobian by the velocities of the free joints | (m, n) | |
| F | which joints may follow the step: not those at a limit that J^T e pushes outward | (n,) | Bertsekas 1982, eq. 32 |
| lambda | damping | [m^2] | |
| dq | F J^T (J F J^T + lambda I)^-1 e | (n,) | Nakamura & Hanafusa 1986, eq. 16 |

Each step is clipped to the limits, so that whatever is found lies within them.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple, final

import numpy as np

from ulna import algorithms, numeric
from ulna.data_classes import dataclass
from ulna.ik.goal import Distance, Mask, distance
from ulna.linalg import solve_damped
from ulna.model import Frame, Model
from ulna.system.cached import cached_property
from ulna.typing import Array, Floats

_LENGTH = 0.2  # a radian counts as this part of the sum of all link lengths
_HALF_TURN = np.pi


@final
@dataclass(frozen=True, eq=False)
class Problem:
    """Which frames are to go where, by which joints.

    Attributes:
        model: The robot.
        frames: The frames that have goals.
        masks: What counts of each frame's pose.
        joints: Indices of the joints that may move.
        radian: How many metres of error a radian of error is worth; None for a fifth of the reach.
        by_angle: Whether the rotation error is as long as the angle, instead of its chord.
    """

    model: Model
    frames: tuple[Frame, ...]
    masks: tuple[Mask, ...]
    joints: tuple[int, ...]
    radian: float | None = None
    by_angle: bool = False

    @cached_property
    def velocities(self) -> list[int]:
        """Where the joints that may move stand in v."""
        chosen = [self.model.joints[i] for i in self.joints]
        return [j.idx_v + k for j in chosen for k in range(j.nv)]

    @cached_property
    def positions(self) -> list[int]:
        """Where they stand in q."""
        chosen = [self.model.joints[i] for i in self.joints]
        return [j.idx_q + k for j in chosen for k in range(j.nq)]

    @cached_property
    def drawn(self) -> list[int]:
        """Where in q starting points are drawn: joints of one coordinate, and others' coordinates between limits."""
        lower, upper = self.limits
        chosen = [self.model.joints[i] for i in self.joints]
        return [
            j.idx_q + k
            for j in chosen
            for k in range(j.nq)
            if j.nq == j.nv and (j.nq == 1 or upper[j.idx_q + k] - lower[j.idx_q + k] < np.inf)
        ]

    @property
    def limits(self) -> tuple[Floats, Floats]:
        """Least and greatest positions, (nq,); those of mimic joints bind nothing, as everywhere."""
        return self.model.lower_position, self.model.upper_position

    @cached_property
    def turning(self) -> list[int]:
        """Where in q joints without limits turn: their angles mean the same a whole turn on."""
        lower, upper = self.limits
        return [
            i
            for i in self.drawn
            if np.isinf(lower[i]) and np.isinf(upper[i]) and self._kind(i) in ("Revolute", "Continuous")
        ]

    def _kind(self, position: int) -> str:
        return next(
            type(j.kind).__name__
            for j in self.model.joints
            if j.mimic is None and j.idx_q <= position < j.idx_q + j.nq
        )

    @cached_property
    def range(self) -> tuple[Floats, Floats]:
        """Between which positions starting points are drawn, (len(drawn),): the limits, within half a turn of 0.

        From a limit that has no other, a whole turn.
        """
        lower, upper = (x[self.drawn] for x in self.limits)
        low, high = np.maximum(lower, -_HALF_TURN), np.minimum(upper, _HALF_TURN)
        single = np.isfinite(lower) != np.isfinite(upper)
        apart = single | (low >= high)  # limits that lie wholly beyond half a turn
        width = np.minimum(upper - lower, 2 * _HALF_TURN)
        low = np.where(apart, np.where(np.isfinite(lower), lower, upper - width), low)
        return low, np.where(apart, low + width, high)

    @cached_property
    def length(self) -> float:
        """How many metres of position error a radian of rotation error is worth."""
        if self.radian is not None:
            return self.radian
        reach = 0.0
        for frame in self.frames:
            parts = [self.model.joints[i].placement for i in self.model.support(frame.joint)]
            lengths = [float(np.linalg.norm(T.translation)) for T in (*parts[1:], frame.placement)]
            reach = max(reach, sum(lengths))
        return _LENGTH * (reach or 1.0)

    @cached_property
    def rows(self) -> int:
        """How many directions the goals hold."""
        return sum(mask.rows for mask in self.masks)

    @property
    def shapes(self) -> dict[str, tuple[int, ...]]:
        """Shapes of the goals and of q0."""
        k = len(self.frames)
        return {"T": (4, 4) if k == 1 else (k, 4, 4), "q0": (self.model.nq,)}

    def goals(self, T: Array) -> Array:
        """The goals one by one, (k, 4, 4)."""
        return T.reshape(-1, 4, 4)

    def distances(self, q: Array, goals: Array, with_rows: bool = True) -> list[Distance]:
        """How far each frame is from its goal.

        Args:
            q: Configuration (nq,) [rad or m].
            goals: Goals of the frames, (k, 4, 4).
            with_rows: Whether to compute derivatives.

        Returns:
            A `Distance` for each frame.
        """
        return [
            distance(self.model, q, frame, goal, mask, self.length, with_rows, self.by_angle)
            for frame, goal, mask in zip(self.frames, goals, self.masks, strict=True)
        ]

    def clip(self, q: Array) -> Array:
        """`q` (nq,) within the limits of the joints that may move."""
        lower, upper = self.limits
        out = list(q)
        for i in self.positions:
            if np.isfinite(lower[i]):
                out[i] = numeric.maximum(out[i], lower[i])
            if np.isfinite(upper[i]):
                out[i] = numeric.minimum(out[i], upper[i])
        return np.array(out, dtype=object)

    def moved(self, q: Array, dq: Array) -> Array:
        """`q` (nq,) after the step `dq` of the joints that may move.

        Args:
            q: Configuration (nq,) [rad or m].
            dq: Step (n,) [rad or m].

        Returns:
            Configuration (nq,) [rad or m].
        """
        step = np.zeros(self.model.nv, dtype=object)
        step[self.velocities] = dq
        return algorithms.integrate(self.model, q, step)

    def replaced(self, q: Array, values: Any) -> Array:
        """`q` with other positions of the joints that may move.

        Args:
            q: Configuration (nq,) [rad or m].
            values: Their positions, `len(self.positions)` of them [rad or m].

        Returns:
            Configuration (nq,) [rad or m].
        """
        out = np.array(q, dtype=object)
        out[self.positions] = values
        return out


class Errors(NamedTuple):
    """All errors at a configuration."""

    squared: Any
    """Squared length of e [m^2]."""
    is_met: Any
    """Whether every goal is met."""
    e: Array
    J: Array


def errors(problem: Problem, q: Array, goals: Array, tolerances: Array) -> Errors:
    """The weighted errors of all frames and their Jacobian at `q`.

    Args:
        problem: The problem.
        q: Configuration (nq,) [rad or m].
        goals: Goals of the frames, (k, 4, 4).
        tolerances: Those of `goal.squared_tolerances`, (2,) [m^2, rad^2].

    Returns:
        Errors, Jacobian, and whether all goals are met.
    """
    each = problem.distances(q, goals)
    e = np.array([x for d in each for x in d.weighted], dtype=object)
    J = np.array([row[problem.velocities] for d in each for row in d.rows], dtype=object)
    return Errors((e * e).sum(), are_met(each, tolerances), e, J)


def are_met(each: Sequence[Distance], tolerances: Array) -> Any:
    """Whether every frame is at its goal; `tolerances` as for `errors`.

    Args:
        each: How far each frame is from its goal.
        tolerances: Those of `goal.squared_tolerances`, (2,) [m^2, rad^2].

    Returns:
        Truth value, traced.
    """
    met: Any = True
    for d in each:
        met = met & (d.position <= tolerances[0]) & (d.rotation <= tolerances[1]) & d.is_near
    return met


def step(problem: Problem, q: Array, at: Errors, damping: Any) -> Array:
    """The configuration after one damped step within the limits.

    Args:
        problem: The problem, with the limits.
        q: Configuration (nq,) [rad or m].
        at: Errors and Jacobian at `q`.
        damping: lambda of the table above [m^2].

    Returns:
        Configuration (nq,) [rad or m].
    """
    moved = problem.moved(q, _step(problem, q, at, damping))
    return problem.clip(problem.replaced(q, moved[problem.positions]))


def _step(problem: Problem, q: Array, at: Errors, damping: Any) -> Array:
    slope = at.J.T @ at.e
    lower, upper = problem.limits
    free = np.ones(len(problem.velocities), dtype=object)
    joints = [problem.model.joints[i] for i in problem.joints]
    place = dict(zip(problem.velocities, range(len(free)), strict=True))
    for joint in joints:
        if joint.nq != joint.nv:
            continue
        for k in range(joint.nv):
            i, j = joint.idx_q + k, place[joint.idx_v + k]
            blocked: Any = False
            if np.isfinite(lower[i]):
                blocked = ((q[i] <= lower[i]) & (slope[j] < 0.0)) | blocked
            if np.isfinite(upper[i]):
                blocked = ((q[i] >= upper[i]) & (slope[j] > 0.0)) | blocked
            free[j] = numeric.where(blocked, 0.0, 1.0)
    return solve_damped(at.J * free, at.e, damping)
