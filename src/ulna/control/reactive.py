"""Reactive control: joint velocities that follow a twist, keep away from limits and obstacles, and stay dexterous.

| symbol | meaning | shape, unit | source |
|---|---|---|---|
| v | joint velocities | (nv,) | |
| V | twist wanted of the frame, world axes | (6,) | |
| J, j_m | Jacobian of the frame, gradient of its manipulability | (6, nv), (nv,) | |
| objective | w_v |v|^2 / 2 + w_s |V - J v|^2 / 2 - w_m j_m v | | Haviland & Corke 2021 (NEO), eq. 12, without slack |
| rho, rho_i, rho_s | distance of a joint from its limit, where that begins to count, where it stops | [rad or m] | |
| eta | v <= eta (rho - rho_s) / (rho_i - rho_s) | [1/s] | eq. 15, velocity dampers of Faverjon & Tournassoud 1987 |
| A, b | rows A v <= b, of obstacles say | (k, nv), (k,) | eq. 19 |

The paper's slack is eliminated: the twist is reduced, never the limits. With limits alone the quadratic program is
solved inside the kernel; rows are left to daqp.
"""

from __future__ import annotations

from typing import Any, final

import numpy as np

from ulna import algorithms, numeric
from ulna.checks.attributes import FixedAttributes
from ulna.checks.values import checked_robot
from ulna.errors import InputError, NonFiniteError, ShapeError
from ulna.ik.qp import solve_box, solve_rows
from ulna.kernels import frame_of
from ulna.robot import Robot, compile
from ulna.typing import Array, ArrayLike, Floats


@final
class Reactive(FixedAttributes):
    """A reactive controller of one frame, after Haviland & Corke's NEO.

    Args:
        robot: The robot; its joints must have one coordinate each.
        frame: Name; None for the tool.
        influence: How near to a limit a joint begins to slow down [rad or m].
        stop: How near it comes at most [rad or m].
        gain: Speed allowed at `influence` [rad/s or m/s].
        velocity_weight: What a squared joint velocity costs [s^2/rad^2, s^2/m^2].
        manipulability_weight: What manipulability is worth [any]; 0 for nothing.

    Raises:
        UnknownName: If there is no such frame.
        InputError: If a joint has several coordinates, `stop` is not less than `influence`, or a gain or a weight
            makes no sense.
    """

    robot: Robot
    """The robot."""

    def __init__(
        self,
        robot: Robot,
        frame: str | None = None,
        *,
        influence: float = 0.9,
        stop: float = 0.05,
        gain: float = 1.0,
        velocity_weight: float = 0.01,
        manipulability_weight: float = 1.0,
    ) -> None:
        if checked_robot(robot).nq != robot.nv:
            raise InputError(f"{robot.name} has joints of several coordinates; lock them: robot.lock([...]).")
        if not 0.0 <= stop < influence < np.inf:
            raise InputError(f"`stop` is {stop} and `influence` {influence}; expected 0 <= stop < influence.")
        for what, number in {"gain": gain, "velocity_weight": velocity_weight}.items():
            if not 0.0 < number < np.inf:
                raise InputError(f"`{what}` is {number}; expected a finite number above 0.")
        if not 0.0 <= manipulability_weight < np.inf:
            raise InputError(
                f"`manipulability_weight` is {manipulability_weight}; expected a finite number, 0 for nothing."
            )
        self.robot = robot
        self._frame = frame_of(robot.model, frame)
        self._numbers = influence, stop, gain, velocity_weight, manipulability_weight
        self._kernel = compile(self._program, robot, checked=True, twist=(6,), slack_weight=())

    def __reduce__(self) -> tuple[Any, ...]:
        return _rebuilt, (self.robot, self.robot.model.frame_name(self._frame), *self._numbers)

    def __call__(
        self,
        q: ArrayLike,
        twist: ArrayLike,
        slack_weight: float = 10.0,
        rows: tuple[ArrayLike, ArrayLike] | None = None,
    ) -> Floats:
        """Joint velocities that follow a twist within the limits.

        Args:
            q: Configuration, shape (nq,) [rad, m]; (..., nq) without rows.
            twist: Desired twist of the frame in "local_world_aligned", shape (6,) [m/s, rad/s].
            slack_weight: What a squared difference from the twist costs [s^2/m^2, s^2/rad^2]. The paper takes the
                inverse of the distance from the goal, so that far from it the arm has more freedom.
            rows: A (k, nv) and b (k,) with A v <= b; see `obstacle_rows`.

        Returns:
            Joint velocities, shape (nv,) [rad/s, m/s].

        Raises:
            InputError: If no velocity is within the limits and the rows, or the weight is negative.
            ShapeError, NonFiniteError: If rows are not (k, nv) and (k,), or hold nan.
            MissingExtra: If there are rows, and daqp is not installed.
        """
        if slack_weight < 0.0 if type(slack_weight) is float else np.any(np.less(slack_weight, 0.0)):
            raise InputError(f"`slack_weight` is {slack_weight}; expected no number below 0.")
        v, H, g, lower, upper, solved = self._kernel(q, twist, slack_weight)
        if rows is None:
            if not np.all(solved):
                raise InputError("The quadratic program has no optimum; look for nan in the weights.")
            return v
        A, b = self._rows(rows, v.shape)
        if not len(A) or (A @ v <= b).all():  # the optimum within the limits already keeps the rows
            return v
        below = np.full(len(b), -np.inf)
        velocity = solve_rows(H, g, A, np.concatenate([lower, below]), np.concatenate([upper, b]), 0)
        if velocity is None:
            raise InputError(
                "No joint velocity keeps all rows within the velocity limits: an obstacle approaches faster "
                "than the arm can avoid it, or two require opposite motions. Stop the arm, or remove rows."
            )
        return velocity

    def _rows(self, rows: tuple[ArrayLike, ArrayLike], shape: tuple[int, ...]) -> tuple[Floats, Floats]:
        """A and b, checked: a row that is misread would be an obstacle that is not seen."""
        A, b, n = np.ascontiguousarray(rows[0], dtype=float), np.asarray(rows[1], dtype=float), self.robot.nv
        if len(shape) > 1:
            raise ShapeError("q", shape, f"({n},)", "With rows, pass one configuration at a time.")
        if A.shape[1:] != (n,) or A.ndim != 2:
            raise ShapeError("rows[0]", A.shape, f"(k, {n}), one row for each bound")
        if b.shape != (len(A),):
            raise ShapeError("rows[1]", b.shape, f"({len(A)},), one for each row")
        wrong = ~(np.isfinite(A).all(axis=1) & (b > -np.inf))
        if wrong.any():
            k = int(np.argmax(wrong))
            bad = np.append(A[k], b[k])
            raise NonFiniteError("rows", (k,), float(bad[~np.isfinite(bad)][0]))
        return A, b

    def _program(self, q: Array, twist: Array, slack_weight: Any) -> tuple[Any, ...]:
        influence, stop, gain, velocity_weight, manipulability_weight = self._numbers
        model, n = self.robot.model, self.robot.nv
        J = algorithms.frame_jacobian(model, q, self._frame)
        H = slack_weight * (J.T @ J) + velocity_weight * np.eye(n)
        g = -slack_weight * (J.T @ twist)
        if manipulability_weight:
            g = g - manipulability_weight * algorithms.manipulability_gradient(model, q, self._frame)
        lower, upper = [], []
        for i in range(n):
            fastest = model.velocity_limit[i] if model.velocity_limit[i] > 0.0 else np.inf
            low, high = model.lower_position[i], model.upper_position[i]
            down = gain * (q[i] - low - stop) / (influence - stop) if np.isfinite(low) else np.inf
            up = gain * (high - q[i] - stop) / (influence - stop) if np.isfinite(high) else np.inf
            # Nearer than `stop` the formula is negative, and would demand a motion away; 0 only forbids to come nearer.
            lower.append(-numeric.clip(_damped(q[i] - low, down, influence), 0.0, fastest))
            upper.append(numeric.clip(_damped(high - q[i], up, influence), 0.0, fastest))
        bounds = numeric.vector(*lower), numeric.vector(*upper)
        boxed = solve_box(H, g, *bounds)
        return boxed.x, H, g, *bounds, boxed.solved


def _damped(distance: Any, speed: Any, influence: float) -> Any:
    """The speed allowed at a distance from a limit: any beyond the influence."""
    return numeric.where(distance < influence, speed, np.inf)


def _rebuilt(robot: Robot, frame: str, *numbers: float) -> Reactive:
    names = ("influence", "stop", "gain", "velocity_weight", "manipulability_weight")
    return Reactive(robot, frame, **dict(zip(names, numbers, strict=True)))
