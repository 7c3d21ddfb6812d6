"""Control of a frame by joint torques: impedance, and motion in the operational space.

| symbol | meaning | shape, unit | source |
|---|---|---|---|
| e | position p* - p and rotation vector of R* R^T, world axes | (6,) [m, rad] | Siciliano 2009, 3.7.3 |
| V, V* | twist of the frame, and the desired one, world axes | (6,) | |
| K, D | stiffness and damping along the goal's axes | (6,) | |
| F | R* K R*^T e + R* D R*^T (V* - V) | (6,) [N, N m] | Hogan 1985; Siciliano eq. 9.37 |
| impedance | tau = J^T F + C v + g + N tau_0 | (nv,) | Albu-Schaeffer et al. 2003 |
| L | operational inertia (J M^-1 J^T + d^2 I)^-1 | (6, 6) | Khatib 1987, eq. 29 |
| operational_space | tau = J^T L (A* + kd (V* - V) + kp e - J' v) + C v + g + N tau_0 | (nv,) | eq. 36 |
| N | I - J^T L J M^-1, projector onto torques that do not accelerate the frame | (nv, nv) | eq. 44 |
| tau_0 | K_0 (q_rest (-) q) - D_0 v, a posture for joints the frame leaves free | (nv,) | |

Impedance leaves the frame its natural inertia, so that it needs no measured forces and is safe against contact; motion
in the operational space replaces it, follows better, and is stiff against contact. The small `regularisation` d bounds
the inertia where the Jacobian is singular.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ulna import algorithms
from ulna.algorithms.dynamics.operational_space import Task
from ulna.checks.values import checked_robot, flag
from ulna.control.bounds import within_effort
from ulna.control.gains import law_with_gains
from ulna.errors import InputError
from ulna.kernels import frame_of
from ulna.linalg import solve_spd
from ulna.numeric import vector
from ulna.robot import Robot
from ulna.spatial import so3_log
from ulna.typing import Array

_POSTURE = ("q_rest", "stiffness_rest", "damping_rest")


class _TaskError(NamedTuple):
    """The error of a frame, and how it moves, in world axes."""

    e: Array
    V: Array
    J: Array
    R_goal: Array


def impedance(
    robot: Robot, frame: str | None = None, *, regularisation: float = 1e-3, bounded: bool = True
) -> Any:
    """A spring and a damper between a frame and its goal, with gravity and Coriolis forces compensated: a kernel.

    `law(q, v, T_goal, twist_goal, stiffness, damping, q_rest, stiffness_rest, damping_rest)` returns torques (nv,).
    `stiffness` (6,) [N/m, N m/rad] and `damping` (6,) [N s/m, N m s/rad] lie along the goal's axes; `twist_goal` (6,)
    is in world axes. The last three, (nq,), (nv,), (nv,), are a spring and a damper to a posture, in the null space of
    the frame.

    Args:
        robot: The robot.
        frame: Name; None for the tool.
        regularisation: Bounds the inertia in the null space near singular configurations [kg^-1/2].
        bounded: Whether torques are kept within the effort limits.

    Returns:
        The kernel `law`; it refuses negative gains.

    Raises:
        UnknownName: If there is no such frame.
        InputError: If `regularisation` is not above 0.

    Example:
        >>> robot = ulna.load("panda")
        >>> q, rest = robot.configurations["ready"], np.zeros(7)
        >>> law = ulna.control.impedance(robot)
        >>> stiffness, damping = [500.0] * 3 + [30.0] * 3, [40.0] * 3 + [5.0] * 3
        >>> tau = law(q, rest, robot.fk(q), np.zeros(6), stiffness, damping, q, rest, rest)
        >>> np.allclose(tau, robot.gravity_forces(q))  # at its goal, it carries its weight
        True
    """
    _check(regularisation)
    bounded = flag("bounded", bounded)
    model, one = checked_robot(robot).model, frame_of(robot.model, frame)

    def law(
        q: Array, v: Array, T_goal: Array, twist_goal: Array, stiffness: Array, damping: Array,
        q_rest: Array, stiffness_rest: Array, damping_rest: Array,
    ) -> Array:  # fmt: skip
        e, V, J, R = _task_error(robot, one, q, v, T_goal)
        force = _along(R, stiffness, e) + _along(R, damping, twist_goal - V)
        posture_torque = stiffness_rest * algorithms.difference(model, q, q_rest) - damping_rest * v
        tau = (
            J.T @ force
            + _in_null_space(robot, one, q, J, posture_torque, regularisation)
            + algorithms.bias_forces(model, q, v)
        )
        return within_effort(model, tau) if bounded else tau

    return _compiled(law, robot, stiffness=(6,), damping=(6,))


def operational_space(
    robot: Robot, frame: str | None = None, *, regularisation: float = 1e-3, bounded: bool = True
) -> Any:
    """Inverse dynamics of a frame in the loop: it follows its goal like a free unit mass on a spring: a kernel.

    `law(q, v, T_goal, twist_goal, acceleration_goal, kp, kd, q_rest, stiffness_rest, damping_rest)` returns torques
    (nv,). `kp` (6,) [1/s^2] and `kd` (6,) [1/s] are gains of acceleration along the goal's axes; twist and acceleration
    (6,) are in world axes. The last three are as for `impedance`.

    Args:
        robot: The robot.
        frame: Name; None for the tool.
        regularisation: Bounds the inertia near singular configurations [kg^-1/2].
        bounded: Whether torques are kept within the effort limits.

    Returns:
        The kernel `law`; it refuses negative gains.

    Raises:
        UnknownName: If there is no such frame.
        InputError: If `regularisation` is not above 0.
    """
    _check(regularisation)
    bounded = flag("bounded", bounded)
    model, one = checked_robot(robot).model, frame_of(robot.model, frame)

    def law(
        q: Array, v: Array, T_goal: Array, twist_goal: Array, acceleration_goal: Array, kp: Array, kd: Array,
        q_rest: Array, stiffness_rest: Array, damping_rest: Array,
    ) -> Array:  # fmt: skip
        e, V, J, R = _task_error(robot, one, q, v, T_goal)
        drift = algorithms.frame_jacobian_dot(model, q, v, one) @ v
        wanted = acceleration_goal + _along(R, kd, twist_goal - V) + _along(R, kp, e) - drift
        inertia = algorithms.operational_inertia(model, q, Task(one, damping=regularisation))
        posture_torque = stiffness_rest * algorithms.difference(model, q, q_rest) - damping_rest * v
        tau = J.T @ (inertia @ wanted) + algorithms.bias_forces(model, q, v)
        tau = tau + _in_null_space(robot, one, q, J, posture_torque, regularisation)
        return within_effort(model, tau) if bounded else tau

    return _compiled(law, robot, acceleration_goal=(6,), kp=(6,), kd=(6,))


_GAINS = ("stiffness", "damping", "kp", "kd", "stiffness_rest", "damping_rest")


def _check(regularisation: float) -> None:
    if not isinstance(regularisation, (int, float, np.number)) or not 0.0 < regularisation < np.inf:
        raise InputError(
            f"`regularisation` is {regularisation}; expected a small number above 0, such as 1e-3: without it torques "
            "are nan where the Jacobian is singular."
        )


def _compiled(law: Any, robot: Robot, **shapes: Any) -> Any:
    posture = dict(zip(_POSTURE, ((robot.nq,), (robot.nv,), (robot.nv,)), strict=True))
    return law_with_gains(law, robot, _GAINS, T_goal=(4, 4), twist_goal=(6,), **shapes, **posture)


def _task_error(robot: Robot, frame: Any, q: Array, v: Array, T_goal: Array) -> _TaskError:
    pose = algorithms.frame_pose(robot.model, q, frame)
    J = algorithms.frame_jacobian(robot.model, q, frame)
    R_goal = T_goal[:3, :3]
    e = vector(*(T_goal[:3, 3] - pose.translation), *so3_log(R_goal @ pose.rotation.T))
    return _TaskError(e, J @ v, J, R_goal)


def _along(R: Array, gain: Array, x: Array) -> Array:
    """A gain along the axes of R, on linear and angular parts."""
    return vector(*(R @ (gain[:3] * (R.T @ x[:3]))), *(R @ (gain[3:] * (R.T @ x[3:]))))


def _in_null_space(robot: Robot, frame: Any, q: Array, J: Array, tau: Array, regularisation: float) -> Array:
    """The part of torques that does not accelerate the frame: N tau."""
    model = robot.model
    a = solve_spd(algorithms.mass_matrix(model, q), tau)
    inertia = algorithms.operational_inertia(model, q, Task(frame, damping=regularisation))
    return tau - J.T @ (inertia @ (J @ a))
