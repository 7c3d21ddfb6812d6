"""From tasks and limits of a robot to the functions that are compiled: the quadratic program, and one step.

| symbol | meaning | shape, unit | equation |
|---|---|---|---|
| v | velocity to be chosen, of the joints that may move | (n,), rad/s or m/s | dq = v dt |
| w, J, e, alpha, lambda | of each task | | see task.py |
| mu | damping: of the whole, and of the tasks | 1 | mu = damping + sum lambda (w alpha e)^2 |
| H | | (n, n) | sum (w J)^T (w J) + mu |
| g | | (n,) | - sum (w J)^T (w alpha e) / dt |
| l, u | the tightest of the limits of each joint | (n,) | |
| A, a, b | rows: of limits, then of constraints | (k, n), (k,), (k,) | a <= A v <= b |

The program: minimise v^T H v / 2 + g^T v with l <= v <= u and a <= A v <= b. Source: Nakamura 1991, section 4.2;
Kanoun, Lamiraux, Wieber, Kinematic control of redundant manipulators: generalizing the task-priority framework to
inequality tasks (2011).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from functools import reduce
from typing import Any, NamedTuple

import numpy as np

from ulna.algorithms import integrate
from ulna.algorithms.multibody.batch_shapes import batch_zeros
from ulna.data_classes import dataclass
from ulna.errors import InputError
from ulna.ik.differential.joints import PostureTask
from ulna.ik.differential.limits import Interval, Limit, Strip
from ulna.ik.differential.task import Rows, Shapes, Task
from ulna.ik.qp import solve_box
from ulna.model import Model
from ulna.numeric import apply, clip, cross, is_symbolic, less, maximum, vector, where
from ulna.system.cached import cached_property
from ulna.typing import Array, Floats

GAP = 1e-9  # limits may miss each other by so much, in rad/s or m/s, before it is called a conflict
SLACK = 1e-9  # rows may be missed by so much
TURNED = 1e-6  # by how much R^T R of a target may differ from 1

SOLVED, CONFLICT, UNSOLVED, ROWS, NO_ROTATION = range(5)
"""Status of a step: solved; limits of a joint contradict; no optimum; rows are violated; bad target."""

_RESERVED = ("q", "dt", "name", "doc", "rules")


class Problem(NamedTuple):
    """The program: H (n, n), g (n,), A (k, n), and bounds (n + k,) of v and of A v, those of constraints last.

    `status` says what is wrong with it before it is solved: 0 where nothing is, CONFLICT where limits of a joint
    contradict each other, NO_ROTATION where a target is none.
    """

    H: Array
    g: Array
    A: Array
    lower: Array
    upper: Array
    status: Any

    @property
    def verdict(self) -> Any:
        """The former name of `status`."""
        return self.status


@dataclass(frozen=True, eq=False)
class Program:
    """Tasks and limits, checked against a model."""

    model: Model
    tasks: tuple[Task, ...]
    constraints: tuple[Task, ...]
    limits: tuple[Limit, ...]
    damping: float
    recover: bool
    moving: tuple[int, ...]
    """Where the joints that may move stand in v."""

    def __post_init__(self) -> None:
        if not 0.0 < self.damping < np.inf:
            raise InputError(f"`damping` is {self.damping}; expected a number above 0, such as 1e-8.")
        if not self.tasks and not self.constraints:
            raise InputError("There is no task; expected at least one, such as FrameTask(robot.tool).")
        for task in self.objectives:
            costs = task.costs(self.model)
            if costs.size and not costs.any():
                raise InputError(
                    f"{task.label}: all costs are 0, so it would have no effect; give one above 0, or leave it out. "
                    "One that is `adjustable` fades out with a factor of 0."
                )
        for task in self.constraints:
            if task.adjustable:
                raise InputError(
                    f"{task.label}: a constraint is met exactly; its costs cannot be `adjustable`."
                )
        values = Counter(name for part in self.parts for name in part.inputs(self.model))
        values.update(task.scale for task in self._adjustable)
        values.update(task.label for task in self.objectives if not task.inputs(self.model))
        for name, count in values.items():
            if count > 1 or name in _RESERVED:
                why = "belongs to two tasks or limits" if count > 1 else "is reserved"
                raise InputError(f"The name {name!r} {why}; give one another: name='...'.")

    @property
    def objectives(self) -> tuple[Task, ...]:
        """Tasks and constraints."""
        return (*self.tasks, *self.constraints)

    @property
    def _adjustable(self) -> tuple[Task, ...]:
        return tuple(task for task in self.tasks if task.adjustable)

    @property
    def parts(self) -> tuple[Task | Limit, ...]:
        """Whatever may have inputs."""
        return (*self.objectives, *self.limits)

    @cached_property
    def defaults(self) -> Mapping[str, Floats]:
        """Values of the inputs that need not be passed."""
        defaults: dict[str, Any] = {task.scale: np.ones(()) for task in self._adjustable}
        for part in self.parts:
            defaults |= part.defaults(self.model)
        return defaults

    @cached_property
    def inputs(self) -> Shapes:
        """Names and shapes of all inputs: first those that must be passed."""
        shapes = {name: shape for part in self.parts for name, shape in part.inputs(self.model).items()}
        shapes |= {task.scale: () for task in self._adjustable}
        return dict(sorted(shapes.items(), key=lambda item: item[0] in self.defaults))

    @cached_property
    def equalities(self) -> int:
        """How many rows of constraints there are."""
        return sum(int((task.costs(self.model) > 0.0).sum()) for task in self.constraints)

    @cached_property
    def rotations(self) -> tuple[str, ...]:
        """The inputs that are poses or rotations."""
        shapes = {name: shape for task in self.objectives for name, shape in task.inputs(self.model).items()}
        return tuple(name for name, shape in shapes.items() if shape in ((4, 4), (3, 3)))

    def unit_vectors(self, arguments: Sequence[str]) -> tuple[tuple[int, tuple[int, ...]], ...]:
        """Where the arguments of a kernel hold unit vectors of q: (number of the argument, entries), ..."""
        configurations = ["q", *(task.label for task in self.objectives if isinstance(task, PostureTask))]
        return tuple(
            (k, entries)
            for k, name in enumerate(arguments)
            if name in configurations
            for entries in self.model.unit_vectors
        )

    def of(self, part: Task | Limit, values: Mapping[str, Array]) -> list[Array]:
        """The inputs of a part, in its order.

        Args:
            part: The task or the limit.
            values: Values of all inputs by name, (...) each.

        Returns:
            The values of its inputs, (...) each.
        """
        return [values[name] for name in part.inputs(self.model)]

    def errors(self, q: Array, *inputs: Array) -> tuple[Array, ...]:
        """The error of each task and constraint, not weighted.

        Args:
            q: Configuration (nq,) [rad or m].
            *inputs: Values of `self.inputs` in this order, each of its shape (...).

        Returns:
            e of each, (k,) [m or rad].
        """
        values = dict(zip(self.inputs, inputs, strict=True))
        return tuple(task.rows(self.model, q, *self.of(task, values)).e for task in self.objectives)

    def bounds(
        self, q: Array, dt: Any, values: Mapping[str, Array]
    ) -> Iterator[tuple[Limit, Interval | Strip]]:
        """What each limit allows.

        Args:
            q: Configuration (nq,) [rad or m].
            dt: Duration of the step [s].
            values: Values of all inputs by name, (...) each.

        Yields:
            Each limit with the velocities that it allows.
        """
        for limit in self.limits:
            yield limit, limit.bounds(self.model, q, dt, *self.of(limit, values))

    def problem(self, q: Array, dt: Any, *inputs: Array) -> Problem:
        """The quadratic program at `q` for a step of `dt`; of one sample, or traced.

        Args:
            q: Configuration (nq,) [rad or m].
            dt: Duration of the step [s].
            *inputs: Values of `self.inputs` in this order, each of its shape (...).

        Returns:
            Objective, bounds, rows and status; see `Problem`.
        """
        values = dict(zip(self.inputs, inputs, strict=True))
        bounds = [bound for _, bound in self.bounds(q, dt, values)]
        lower, upper, gap = self._box([b for b in bounds if isinstance(b, Interval)])
        rows = [np.zeros((0, len(self.moving)))]
        low, high = [lower], [upper]
        for strip in bounds:
            if isinstance(strip, Strip):
                rows.append(strip.A[..., self.moving])
                low.append(strip.lower)
                high.append(strip.upper)
        for task in self.constraints:
            J, e, _ = self._chosen(task, task.constraint_rows(self.model, q, *self.of(task, values)))
            rows.append(J)
            low.append(e / dt)
            high.append(e / dt)
        turned = reduce(maximum, (_from_rotation(values[name]) for name in self.rotations), 0.0)
        status = where(less(GAP, gap), float(CONFLICT), float(SOLVED))
        status = where(less(turned, TURNED), status, float(NO_ROTATION))
        H, g = self._objective(q, dt, values)
        return Problem(H, g, np.concatenate(rows), np.concatenate(low), np.concatenate(high), status)

    def step(self, q: Array, dt: Any, *inputs: Array) -> tuple[Array, Array, Any]:
        """v (nv,), the configuration after dt (nq,), and the status; traced.

        Rows are only looked at: where the optimum without them keeps them, it is the optimum.

        Args:
            q: Configuration (nq,) [rad or m].
            dt: Duration of the step [s].
            *inputs: Values of `self.inputs` in this order, each of its shape (...).

        Returns:
            v (nv,) [rad/s or m/s], configuration (nq,) [rad or m], status.
        """
        problem = self.problem(q, dt, *inputs)
        n = len(self.moving)
        x, solved = solve_box(problem.H, problem.g, problem.lower[:n], problem.upper[:n])
        missed: Any = 0.0
        if len(problem.A):
            rows = apply(problem.A, x)
            missed = reduce(maximum, [*(problem.lower[n:] - rows), *(rows - problem.upper[n:])])
        status = where(less(missed, SLACK), problem.status, float(ROWS))
        status = where(less(0.5, solved), status, float(UNSOLVED))
        status = where(less(0.5, problem.status), problem.status, status)
        v = self.full_velocity(x, q)
        return v, self.move(q, v, dt), status

    def move(self, q: Array, v: Array, dt: Any) -> Array:
        """The configuration after `dt`.

        Args:
            q: Configuration (nq,) [rad or m].
            v: Velocity (nv,) [rad/s or m/s].
            dt: Duration of the step [s].

        Returns:
            Configuration (nq,) [rad or m].
        """
        return integrate(self.model, q, v * dt)

    def full_velocity(self, x: Array, q: Array) -> Array:
        """The velocity (nv,) of the whole robot: joints that may not move stand still.

        Args:
            x: Velocity (n,) of the joints that may move [rad/s or m/s].
            q: Configuration (nq,) [rad or m], for the batch axes.

        Returns:
            Velocity (nv,) [rad/s or m/s].
        """
        v = batch_zeros((self.model.nv,), q)
        v[..., self.moving] = x
        return v

    def _objective(self, q: Array, dt: Any, values: Mapping[str, Array]) -> tuple[Array, Array]:
        n = len(self.moving)
        H, g, damping = np.zeros((n, n)), np.zeros(n), self.damping
        for task in self.tasks:
            J, e, costs = self._chosen(task, task.rows(self.model, q, *self.of(task, values)))
            if task.adjustable:
                costs = costs * values[task.scale]
            A, b = J * costs[:, None], e * costs
            H = H + A.T @ A
            g = g - A.T @ (b / dt)
            if task.damping:
                damping = damping + task.damping * (b * b).sum()
        return H + damping * np.eye(n), g

    def _chosen(self, task: Task, asked: Rows) -> tuple[Array, Array, Floats]:
        """J, alpha e and w of the rows that cost something."""
        costs = task.costs(self.model)
        rows = np.flatnonzero(costs > 0.0)
        return asked.J[..., rows, :][..., self.moving], task.gain * asked.e[..., rows], costs[rows]

    def _box(self, intervals: list[Interval]) -> tuple[Array, Array, Any]:
        """The tightest bounds. Where two contradict each other, the later holds; with `recover`, the earlier."""
        lower: list[Any] = [-np.inf] * len(self.moving)
        upper: list[Any] = [np.inf] * len(self.moving)
        gap: Any = -1.0
        for interval in intervals:
            for k, i in enumerate(self.moving):
                low, high = interval.lower[..., i][()], interval.upper[..., i][()]
                if _is(low, -np.inf) and _is(high, np.inf):
                    continue
                if _is(lower[k], -np.inf) and _is(upper[k], np.inf):
                    lower[k], upper[k] = low, high
                elif self.recover:
                    lower[k], upper[k] = (clip(x, lower[k], upper[k]) for x in (low, high))
                else:
                    gap = maximum(gap, maximum(low - upper[k], lower[k] - high))
                    lower[k], upper[k] = (clip(x, low, high) for x in (lower[k], upper[k]))
        return vector(*lower), vector(*upper), gap


def _is(bound: Any, value: float) -> bool:
    return not is_symbolic(bound) and bool(bound == value)


def _from_rotation(pose: Array) -> Any:
    """The largest entry of R^T R - 1, and of what a reflection or the last row of a pose (4, 4) is off."""
    R = pose[..., :3, :3]
    off = abs(np.swapaxes(R, -1, -2) @ R - np.eye(3))
    entries = [off[..., i, j] for i in range(3) for j in range(i + 1)]
    entries += [abs(e) for e in cross(R[..., :, 0], R[..., :, 1]) - R[..., :, 2]]
    if pose.shape[-1] == 4:
        entries += [abs(pose[..., 3, j] - float(j == 3)) for j in range(4)]
    return reduce(maximum, entries)
