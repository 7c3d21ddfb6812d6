"""Operational-space dynamics of a frame: its inertia, Coriolis matrix, gravity and acceleration.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| x' | twist of the frame, or rates of its position and angles | (6) | | x' = J v |
| M, C, g | mass matrix, Coriolis matrix, gravity torques | | | crba.py, coriolis.py, rnea.py |
| d | damping | () | [kg^-1/2], [kg^-1/2 m^-1] | |
| L | operational-space inertia | (6, 6) | [kg, kg m, kg m^2] | (J M^-1 J^T + d^2 1)^-1 |
| J+ | dynamically consistent inverse of J | (nv, 6) | | M^-1 J^T L |
| C_x | Coriolis matrix | (6, 6) | | L (J M^-1 C - dJ/dt) J+ |
| g_x | gravity | (6) | [N, N m] | J+^T g |
| x'' | acceleration | (6) | | J a + dJ/dt v, a by forward dynamics |

So f = L x'' + C_x x' + g_x is the force at the frame that a motion takes, exactly for as many joints as the task has
dimensions, and up to motions of the null space for more. Where the Jacobian is singular L is infinite unless the
damping d is given. Source: Khatib, A unified approach for motion and force control of robot manipulators (1987);
Siciliano 2009, section 7.8.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ulna.algorithms.dynamics.coriolis import coriolis_matrix
from ulna.algorithms.dynamics.crba import mass_matrix
from ulna.algorithms.dynamics.forward_dynamics import forward_dynamics
from ulna.algorithms.dynamics.mass_matrix_factors import Factors
from ulna.algorithms.dynamics.rnea_point_accelerations import gravity_forces
from ulna.algorithms.kinematics.analytical_jacobian import (
    Representation,
    analytical_jacobian,
    analytical_jacobian_dot,
)
from ulna.algorithms.kinematics.jacobian import frame_jacobian
from ulna.algorithms.kinematics.jacobian_dot import frame_jacobian_dot
from ulna.algorithms.multibody.references import Reference
from ulna.errors import InputError
from ulna.linalg import solve_spd
from ulna.model import Frame, Model
from ulna.numeric import apply, vector
from ulna.typing import Array

_INFINITE = (
    "The frame cannot move in some of the six directions; its inertia there is infinite. Give damping > 0, e.g. "
    "damping=0.01."
)


class Task(NamedTuple):
    """The motion x' of a frame that is meant.

    Attributes:
        frame: A frame of the model.
        reference: Of the twist: "world", "local" or "local_world_aligned".
        representation: None for the twist; else x' are the rates of position and of these angles, and `reference` is
            not used.
        damping: d, which bounds the inertia near singular configurations [kg^-1/2].
    """

    frame: Frame
    reference: Reference = "local_world_aligned"
    representation: Representation | None = None
    damping: float = 0.0

    def jacobian(self, model: Model, q: Array) -> Array:
        """The Jacobian of the task.

        Args:
            model: The robot.
            q: Configuration, shape (..., nq) [rad, m].

        Returns:
            J, shape (..., 6, nv), linear part first.
        """
        if self.representation is not None:
            return analytical_jacobian(model, q, self.frame, self.representation)
        return frame_jacobian(model, q, self.frame, self.reference)

    def jacobian_dot(self, model: Model, q: Array, v: Array) -> Array:
        """The time derivative of the Jacobian of the task.

        Args:
            model: The robot.
            q: Configuration, shape (..., nq) [rad, m].
            v: Velocity, shape (..., nv) [rad/s, m/s].

        Returns:
            dJ/dt, shape (..., 6, nv), linear part first.
        """
        if self.representation is not None:
            return analytical_jacobian_dot(model, q, v, self.frame, self.representation)
        return frame_jacobian_dot(model, q, v, self.frame, self.reference)


def operational_inertia(model: Model, q: Array, task: Task) -> Array:
    """The operational-space inertia of a frame: L = (J M^-1 J^T + damping^2 1)^-1.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        task: Which motion of which frame.

    Returns:
        L, shape (..., 6, 6).

    Raises:
        InputError: the frame cannot move in all six directions, and there is no damping.
    """
    mobility = _mobility(model, q, task)[0]
    return _solve(mobility, np.broadcast_to(np.eye(6), mobility.shape))


def operational_coriolis(model: Model, q: Array, v: Array, task: Task) -> Array:
    """The Coriolis matrix in the coordinates of the task.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].
        task: Which motion of which frame.

    Returns:
        C_x, shape (..., 6, 6).

    Raises:
        InputError: the frame cannot move in all six directions, and there is no damping.
    """
    mobility, Minv_JT = _mobility(model, q, task)
    J_Minv = np.swapaxes(Minv_JT, -1, -2)
    bias_map = J_Minv @ coriolis_matrix(model, q, v) - task.jacobian_dot(model, q, v)
    J_plus = np.swapaxes(_solve(mobility, J_Minv), -1, -2)  # for L is symmetric
    return _solve(mobility, bias_map @ J_plus)


def operational_gravity(model: Model, q: Array, task: Task) -> Array:
    """The forces at the frame that hold the robot against gravity.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        task: Which motion of which frame.

    Returns:
        g_x, shape (..., 6) [N, N m].

    Raises:
        InputError: the frame cannot move in all six directions, and there is no damping.
    """
    mobility, Minv_JT = _mobility(model, q, task)
    return _solve(mobility, apply(np.swapaxes(Minv_JT, -1, -2), gravity_forces(model, q)))


def operational_acceleration(model: Model, q: Array, v: Array, tau: Array, task: Task) -> Array:
    """How the frame accelerates under joint torques.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].
        tau: Joint torques, shape (..., nv) [N m, N].
        task: Which motion of which frame; its damping plays no part.

    Returns:
        x'', shape (..., 6), linear part first.
    """
    a = forward_dynamics(model, q, v, tau)
    return apply(task.jacobian(model, q), a) + apply(task.jacobian_dot(model, q, v), v)


def _solve(mobility: Array, b: Array) -> Array:
    try:
        return solve_spd(mobility, b)
    except (ZeroDivisionError, np.linalg.LinAlgError):
        raise InputError(_INFINITE) from None


def _mobility(model: Model, q: Array, task: Task) -> tuple[Array, Array]:
    """J M^-1 J^T + d^2 1, and M^-1 J^T."""
    if model.nv < 6 and not task.damping:
        raise InputError(_INFINITE)
    J = task.jacobian(model, q)
    factors = Factors(mass_matrix(model, q))
    columns = [vector(*factors.solve([J[..., i, k] for k in range(model.nv)])) for i in range(6)]
    Minv_JT = np.stack(columns, axis=-1)
    return J @ Minv_JT + task.damping**2 * np.eye(6), Minv_JT
