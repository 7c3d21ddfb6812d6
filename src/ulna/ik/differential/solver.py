"""The solver of differential inverse kinematics: tasks and limits compiled into one kernel, called in a loop."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, final

import numpy as np

from ulna.checks.attributes import FixedAttributes
from ulna.checks.values import flag
from ulna.compiler import compile, trace
from ulna.errors import InputError, UnknownName
from ulna.ik.differential import explain
from ulna.ik.differential.limits import Limit, PositionLimit, VelocityLimit
from ulna.ik.differential.program import SOLVED, Problem, Program
from ulna.ik.differential.task import Task, as_array
from ulna.ik.qp import solve_rows
from ulna.model import Model
from ulna.model.of_robot import model_of
from ulna.typing import ArrayLike, Floats


@final
class DifferentialIK(FixedAttributes):
    """Computes the joint velocities that best fulfil some tasks within some limits.

        ik = DifferentialIK(robot, [FrameTask("panda_hand"), PostureTask(1e-3, target="qr")])
        while True:
            q = ik.step(q, 1e-3, T_goal)

    Everything between q and the velocity is one compiled kernel: kinematics, errors, Jacobians, objective, bounds, and
    their active-set solver. Rows (constraints, planes) are handed to daqp when they matter (extra `qp`).

    What must be passed at every step are the `inputs`, in their order: `ik.step(q, dt, T_left, T_right)`, or by name:
    `ik.step(q, dt, left=T_left, right=T_right)`; those with a default may be left out. Batches broadcast: q (..., nq)
    and targets with leading axes give velocities (..., nv).

    Args:
        robot: A Robot, or a Model.
        tasks: What to reach, weighed by their costs.
        limits: What to stay within. By default the model's limits of velocity and position.
        constraints: Tasks to be met exactly (J dq = gain e); their costs only leave rows out, where they are 0.
        damping: What a squared radian or metre of motion costs [1/rad^2, 1/m^2]: makes the solution unique where
            joints are free.
        locked: Names of joints that stand still.
        recover: What happens when the limits of a joint contradict each other, as when it stands far beyond a
            limit of position: False raises InfeasibleError; True lets limits that are listed later yield to those
            listed before.

    Raises:
        UnknownName: If there is no such frame or joint.
        InputError: If a task or limit does not fit the robot, or two go by one name.

    Example:
        >>> from ulna.ik import DifferentialIK, FrameTask, PostureTask
        >>> robot = ulna.load("panda")
        >>> q = robot.configurations["ready"]
        >>> ik = DifferentialIK(robot, [FrameTask("panda_hand"), PostureTask(1e-3, target="ready")])
        >>> T_goal = ulna.SE3(0.0, 0.0, 0.05) @ robot.fk(q, "panda_hand")  # 5 cm higher
        >>> for _ in range(100):
        ...     q = ik.step(q, 0.01, T_goal)
        >>> np.allclose(robot.fk(q, "panda_hand"), T_goal.matrix(), atol=1e-5)
        True
    """

    __slots__ = ("_defaults", "_dt", "_kernel", "_kernels", "_open", "program")

    def __init__(
        self,
        robot: Any,
        tasks: Sequence[Task],
        limits: Sequence[Limit] | None = None,
        *,
        constraints: Sequence[Task] = (),
        damping: float = 1e-8,
        locked: Sequence[str] = (),
        recover: bool = False,
    ) -> None:
        model = model_of(robot)
        limits = (VelocityLimit(), PositionLimit()) if limits is None else limits
        _check_kinds("tasks", tasks, Task)
        _check_kinds("constraints", constraints, Task)
        _check_kinds("limits", limits, Limit)
        self._set_program(
            Program(
                model,
                tuple(tasks),
                tuple(constraints),
                tuple(limits),
                damping,
                flag("recover", recover),
                _moving(model, locked),
            )
        )

    def _set_program(self, program: Program) -> None:
        self.program = program
        self._defaults = tuple(program.defaults[name] for name in program.inputs if name in program.defaults)
        self._open = len(program.inputs) - len(self._defaults)
        self._kernels: dict[str, Any] = {}
        self._kernel = self._compiled("problem" if program.equalities else "step")
        self._dt = (np.nan, np.zeros(()))  # equal to no duration

    def __reduce__(self) -> tuple[Any, ...]:
        return _of_program, (self.program,)

    def __repr__(self) -> str:
        parts = ", ".join(part.label for part in self.program.parts)
        inputs = ", ".join(self.inputs) or "nothing"
        return f"<differential IK of {self.program.model.name!r}: {parts}; inputs {inputs}>"

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of what is passed after q and dt, in order; those with a default come last."""
        return tuple(self.program.inputs)

    @property
    def operations(self) -> int:
        """How many scalar operations the kernel has; those of its loop count once."""
        return self._kernel.operations

    def velocity(self, q: ArrayLike, dt: float, *targets: Any, **named: Any) -> Floats:
        """The velocity (..., nv) to move with for `dt` [rad/s or m/s].

        Args:
            q: Configuration (..., nq) [rad or m].
            dt: Duration of the step [s].
            *targets: The inputs that have no default, in order; or all.
            **named: Inputs by name.

        Returns:
            Velocity (..., nv) [rad/s or m/s].

        Raises:
            InfeasibleError: If limits and constraints leave no velocity at all; names them, and the sample of a
                batch.
            UnknownName, InputError: If an input is missing, unknown, or cannot be one.
            MissingExtra: If rows matter and daqp is not installed.

        Example:
            >>> robot = ulna.load("panda")
            >>> q = robot.configurations["ready"]
            >>> ik = ulna.ik.DifferentialIK(robot, [ulna.ik.FrameTask("panda_hand")])
            >>> T_goal = ulna.SE3(0.0, 0.0, 0.05) @ robot.fk(q, "panda_hand")  # 5 cm higher
            >>> v = ik.velocity(q, 0.1, T_goal)
            >>> (robot.jacobian(q, "panda_hand") @ v)[:3].round(2)  # 5 cm in 0.1 s
            array([0. , 0. , 0.5])
        """
        return self._solve(q, dt, targets, named)[0]

    def step(self, q: ArrayLike, dt: float, *targets: Any, **named: Any) -> Floats:
        """The configuration after moving for `dt` with `velocity`; raises what `velocity` raises.

        Args:
            q: Configuration (..., nq) [rad or m].
            dt: Duration of the step [s].
            *targets: The inputs that have no default, in order; or all.
            **named: Inputs by name.

        Returns:
            Configuration (..., nq) [rad or m].
        """
        return self._solve(q, dt, targets, named)[1]

    def errors(self, q: ArrayLike, *targets: Any, **named: Any) -> dict[str, Floats]:
        """The errors of tasks and constraints at `q`, by name, not weighted: (..., k) each [m or rad].

        Args:
            q: Configuration (..., nq) [rad or m].
            *targets: The inputs that have no default, in order; or all.
            **named: Inputs by name.

        Returns:
            Errors (..., k) [m or rad] by name of the task.
        """
        values = self._compiled("errors")(q, *self._input_values(targets, named))
        return dict(zip((task.label for task in self.program.objectives), values, strict=True))

    def problem(self, q: ArrayLike, dt: float, *targets: Any, **named: Any) -> Problem:
        """The quadratic program over the velocities of the joints that may move; see `Problem`.

        Args:
            q: Configuration (..., nq) [rad or m].
            dt: Duration of the step [s].
            *targets: The inputs that have no default, in order; or all.
            **named: Inputs by name.

        Returns:
            Objective, bounds, rows and status, each with leading axes (...).
        """
        return Problem(*self._compiled("problem")(q, self._seconds(dt), *self._input_values(targets, named)))

    def targets_at(self, q: ArrayLike) -> dict[str, Floats]:
        """The targets that `q` fulfils, by name: `ik.step(q, dt, **(ik.targets_at(q0) | {"left": T}))`."""
        model, targets = self.program.model, {}
        for task in self.program.objectives:
            targets |= task.reached_by(model, np.asarray(q, dtype=float))
        return targets

    def _solve(self, q: Any, dt: float, targets: tuple[Any, ...], named: dict[str, Any]) -> tuple[Any, Any]:
        if named or len(targets) != self._open:
            inputs = self._input_values(targets, named)
        else:
            for target in targets:
                if type(target) is not np.ndarray:
                    inputs = self._input_values(targets, named)
                    break
            else:
                inputs = (*targets, *self._defaults)
        last_dt = self._dt
        seconds = last_dt[1] if type(dt) is float and last_dt[0] == dt else self._seconds(dt)
        if self.program.equalities:
            return self._by_rows(q, seconds, inputs)
        v, following, status = self._kernel(q, seconds, *inputs)
        if status.any() if status.ndim else status:
            return self._by_rows(q, seconds, inputs, status, v)
        return v, following

    def _by_rows(
        self, q: Any, seconds: Any, inputs: Sequence[Any], status: Any = None, v: Any = None
    ) -> tuple[Floats, Floats]:
        """The same by daqp; of a batch only the samples whose status is not 0, `v` has the solutions of the others."""
        problem = Problem(*self._compiled("problem")(q, seconds, *inputs))
        batch = problem.g.shape[:-1]
        if not batch:
            v = self._optimum(problem, (q, seconds, *inputs))
        else:
            v = np.empty((*batch, self.program.model.nv)) if v is None else v
            for index in np.ndindex(batch):
                if status is None or status[index]:
                    sample = Problem(*(field[index] for field in problem))
                    v[index] = self._optimum(sample, (q, seconds, *inputs), batch, index)
        return v, self._compiled("move")(q, v, seconds)

    def _optimum(
        self, p: Problem, arguments: Sequence[Any], batch: tuple[int, ...] = (), index: tuple[int, ...] = ()
    ) -> Floats:
        """The velocity (nv,) of one program; `arguments` are q, dt and the inputs of the batch it is out of."""
        program = self.program
        is_known = p.status == SOLVED and not explain.has_nan(p)
        x = solve_rows(p.H, p.g, p.A, p.lower, p.upper, program.equalities) if is_known else None
        if x is not None:
            return x if len(x) == program.model.nv else program.full_velocity(x, p.g)
        shapes = ((program.model.nq,), (), *program.inputs.values())
        sample = [
            np.broadcast_to(np.asarray(value, dtype=float), (*batch, *shape))[index]
            for value, shape in zip(arguments, shapes, strict=True)
        ]
        raise explain.reason(program, p, *sample, where=f" at index {index}" if batch else "")

    def _input_values(self, targets: Sequence[Any], named: Mapping[str, Any]) -> tuple[Any, ...]:
        """Every input as an array, in order."""
        names = self.inputs
        if len(targets) > len(names):
            raise InputError(
                f"{len(targets)} targets are passed; expected at most {len(names)}: {', '.join(names)}."
            )
        values = dict(zip(names, targets, strict=False))
        for name, value in named.items():
            if name not in names:
                raise UnknownName("target", name, names)
            if name in values:
                raise InputError(f"The target {name!r} is passed twice, by its position and by its name.")
            values[name] = value
        values = {**self.program.defaults, **values}
        missing = [name for name in names if name not in values]
        if missing:
            raise InputError(
                f"Missing targets: {', '.join(map(repr, missing))}; expected: {', '.join(names)}."
            )
        return tuple(as_array(values[name]) for name in names)

    def _seconds(self, dt: Any) -> Any:
        """The duration as an array, stored for the next step."""
        try:
            seconds = np.asarray(dt, dtype=float)
        except (TypeError, ValueError):
            seconds = np.zeros(())
        if not (seconds > 0.0).all():
            raise InputError(f"`dt` is {dt!r}; expected a duration above 0 s.")
        if not seconds.ndim:
            self._dt = (float(seconds), seconds)
        return seconds

    def _compiled(self, name: str) -> Any:
        """The kernel of a function of the program."""
        kernel = self._kernels.get(name)
        if kernel is None:
            program = self.program
            q, dt = {"q": (program.model.nq,)}, {"dt": ()}
            shapes = {
                "errors": {**q, **program.inputs},
                "move": {**q, "v": (program.model.nv,), **dt},
            }.get(name, {**q, **dt, **program.inputs})
            traced = trace(getattr(program, name), name=f"differential_ik_{name}", **shapes)
            kernel = compile(traced, checked=True, unit_entries=program.unit_vectors(tuple(shapes)))
            self._kernels[name] = kernel
        return kernel


def _of_program(program: Program) -> DifferentialIK:
    ik = DifferentialIK.__new__(DifferentialIK)
    ik._set_program(program)
    return ik


def _check_kinds(what: str, parts: Sequence[Any], kind: type) -> None:
    if not isinstance(parts, (list, tuple)):
        raise InputError(f"`{what}` is {parts!r}; expected a list of objects of kind {kind.__name__}.")
    for part in parts:
        if not isinstance(part, kind):
            raise InputError(f"`{what}` holds {part!r}; expected objects of kind {kind.__name__}.")


def _moving(model: Model, locked: Sequence[str]) -> tuple[int, ...]:
    """Where the joints stand in v that are not locked."""
    names = (locked,) if isinstance(locked, str) else locked
    still = {i for joint in map(model.joint, names) for i in range(joint.idx_v, joint.idx_v + joint.kind.nv)}
    moving = tuple(i for i in range(model.nv) if i not in still)
    if not moving:
        raise InputError(f"All joints of {model.name!r} are locked, or it has none; expected one that moves.")
    return moving
