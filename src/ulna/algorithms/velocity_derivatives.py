"""How the twist and the acceleration of a frame change with q and v, in closed form.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| J_k | column of the Jacobian in "local" | Motion | | see jacobian.py |
| U_k, C_k | twist and spatial acceleration of the body before step k | Motion | | sums over steps < k |
| V, V_k | twist of the frame; of the body behind step k | Motion | | V_k: sum over steps <= k |
| dV/dq_k | | Motion | | U_k x J_k |
| dV/dv_k | | Motion | | J_k |
| dA/dq_k | | Motion | | C_k x J_k + (U_k x J_k) x (V - U_k) |
| dA/dv_k | | Motion | | U_k x J_k + J_k x (V - V_k) |
| dA/da_k | | Motion | | J_k |

All are seen from the frame. Source: Carpentier & Mansard, Analytical Derivatives of Rigid Body Dynamics
Algorithms (2018), section III. Derivatives by q are along the tangent space, as in hessian.py.
"""

from __future__ import annotations

from ulna.algorithms.jacobian import by_step, local_columns
from ulna.algorithms.jacobian_dot import partial_twists, step_twist
from ulna.algorithms.tree import blank, chain
from ulna.model import Frame, Model
from ulna.spatial import Motion
from ulna.typing import Array


def frame_velocity_derivatives(model: Model, q: Array, v: Array, frame: Frame) -> tuple[Array, Array]:
    """The derivatives of the twist of a frame, in "local", by q and by v, each (..., 6, nv).

    Args:
        model: The robot.
        q: Configuration, shape (..., nq).
        v: Velocity, shape (..., nv).
        frame: A frame of the model.
    """
    groups = by_step(local_columns(chain(model, frame), q, frame.placement))
    dV_dq, dV_dv = blank((6, model.nv), q, v), blank((6, model.nv), q, v)
    before = Motion.zero()
    for group in groups:
        for c in group:
            _add(dV_dq, c.index, before.cross(c.motion))
            _add(dV_dv, c.index, c.motion)
        before = before + step_twist(group, v)
    return dV_dq, dV_dv


def frame_acceleration_derivatives(
    model: Model, q: Array, v: Array, a: Array, frame: Frame
) -> tuple[Array, Array, Array]:
    """The derivatives of the spatial acceleration of a frame, in "local", by q, v and a, each (..., 6, nv).

    Args:
        model: The robot.
        q: Configuration, shape (..., nq).
        v: Velocity, shape (..., nv).
        a: Acceleration, shape (..., nv).
        frame: A frame of the model.
    """
    groups = by_step(local_columns(chain(model, frame), q, frame.placement))
    upto, beyond = partial_twists(groups, v)
    dA_dq, dA_dv, dA_da = (blank((6, model.nv), q, v, a) for _ in range(3))
    U, C = Motion.zero(), Motion.zero()
    for group, V_k, rest in zip(groups, upto, beyond, strict=True):
        own = step_twist(group, v)
        for c in group:
            change = U.cross(c.motion)
            _add(dA_dq, c.index, C.cross(c.motion) + change.cross(own + rest))
            _add(dA_dv, c.index, change + c.motion.cross(rest))
            _add(dA_da, c.index, c.motion)
        C = C + step_twist(group, a) + V_k.cross(own)
        U = V_k
    return dA_dq, dA_dv, dA_da


def _add(matrix: Array, index: int, motion: Motion) -> None:
    matrix[..., :3, index] += motion.linear
    matrix[..., 3:, index] += motion.angular
