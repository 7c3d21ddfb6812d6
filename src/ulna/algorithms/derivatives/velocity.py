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
| u, w | linear and angular part of V | (3) | [m/s], [rad/s] | |
| dA'/dx | of the point at the frame's origin, A' = A.linear + w x u | (3) | | dA/dx + dw/dx x u + w x du/dx |
| in the world's axes | a vector R y changes with q_k also as R turns | (3) | | R dy/dq_k + R (J_k.angular x y) |
| in a reference | X of `in_reference` | (6, 6) | | X dV/dv, X (dV/dq + J_k x V) |

All are seen from the frame. Source: Carpentier & Mansard, Analytical Derivatives of Rigid Body Dynamics
Algorithms (2018), section III. Derivatives by q are along the tangent space, as in hessian.py.
"""

from __future__ import annotations

from typing import Literal, NamedTuple

from ulna.algorithms.kinematics.forward_kinematics import frame_acceleration, frame_pose, frame_velocity
from ulna.algorithms.kinematics.jacobian import by_step, local_columns
from ulna.algorithms.kinematics.jacobian_dot import partial_twists, step_twist
from ulna.algorithms.multibody.batch_shapes import add_column, batch_zeros
from ulna.algorithms.multibody.references import Reference, check_reference
from ulna.algorithms.multibody.tree import chain
from ulna.errors import UnknownName
from ulna.model import Frame, Model
from ulna.numeric import skew
from ulna.spatial import SE3, Motion
from ulna.typing import Array


def frame_velocity_derivatives(model: Model, q: Array, v: Array, frame: Frame) -> tuple[Array, Array]:
    """The derivatives of the twist of a frame, in "local".

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].
        frame: A frame of the model.

    Returns:
        The derivatives with respect to q and v, each of shape (..., 6, nv).
    """
    groups = by_step(local_columns(chain(model, frame), q, frame.placement))
    dV_dq, dV_dv = batch_zeros((6, model.nv), q, v), batch_zeros((6, model.nv), q, v)
    before = Motion.zero()
    for group in groups:
        for c in group:
            add_column(dV_dq, c.index, before.cross(c.motion))
            add_column(dV_dv, c.index, c.motion)
        before = before + step_twist(group, v)
    return dV_dq, dV_dv


def frame_acceleration_derivatives(
    model: Model, q: Array, v: Array, a: Array, frame: Frame
) -> tuple[Array, Array, Array]:
    """The derivatives of the spatial acceleration of a frame, in "local".

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].
        a: Acceleration, shape (..., nv) [rad/s^2, m/s^2].
        frame: A frame of the model.

    Returns:
        The derivatives with respect to q, v and a, each of shape (..., 6, nv).
    """
    groups = by_step(local_columns(chain(model, frame), q, frame.placement))
    upto, beyond = partial_twists(groups, v)
    dA_dq, dA_dv, dA_da = (batch_zeros((6, model.nv), q, v, a) for _ in range(3))
    U, C = Motion.zero(), Motion.zero()
    for group, V_k, rest in zip(groups, upto, beyond, strict=True):
        joint_twist = step_twist(group, v)
        state = ColumnState(U, C, joint_twist + rest, rest)
        for c in group:
            for matrix, change in zip(
                (dA_dq, dA_dv, dA_da), acceleration_changes(c.motion, state), strict=True
            ):
                add_column(matrix, c.index, change)
        C = C + step_twist(group, a) + V_k.cross(joint_twist)
        U = V_k
    return dA_dq, dA_dv, dA_da


class ColumnState(NamedTuple):
    """What the change of an acceleration with the coordinate of a column depends on.

    Attributes:
        U: Twist of the body before its step [m/s, rad/s].
        C: Spatial acceleration of that body [m/s^2, rad/s^2].
        onward: What its step and those beyond add to the twist [m/s, rad/s].
        rest: What the steps beyond add [m/s, rad/s].
    """

    U: Motion
    C: Motion
    onward: Motion
    rest: Motion


def acceleration_changes(J: Motion, state: ColumnState) -> tuple[Motion, Motion, Motion]:
    """How the acceleration of a frame changes with q, v and a of a column; see the table of the module.

    Args:
        J: The column of the Jacobian in "local", or a batch of columns.
        state: What it depends on, as many.

    Returns:
        The derivatives with respect to q, v and a.
    """
    change = state.U.cross(J)
    by_q = state.C.cross(J) + change.cross(state.onward)
    return by_q, change + J.cross(state.rest), J


def motion_derivatives(
    model: Model, q: Array, v: Array, a: Array, frame: Frame, reference: Reference = "local_world_aligned"
) -> tuple[Array, Array, Array, Array, Array]:
    """The derivatives of the twist and of the spatial acceleration of a frame in a reference.

    In "local_world_aligned" they are those of "world", moved to the frame's origin: the origin itself is held.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].
        a: Acceleration, shape (..., nv) [rad/s^2, m/s^2].
        frame: A frame of the model.
        reference: "world", "local" or "local_world_aligned".

    Returns:
        Of the twist by q and v; of the acceleration by q, v and a; each of shape (..., 6, nv).
    """
    check_reference(reference)
    V_q, J = frame_velocity_derivatives(model, q, v, frame)
    A_q, A_v, A_a = frame_acceleration_derivatives(model, q, v, a, frame)
    if reference == "local":
        return V_q, J, A_q, A_v, A_a
    V_q = V_q - frame_velocity(model, q, v, frame, "local").cross_matrix() @ J  # + J x V
    A_q = A_q - frame_acceleration(model, q, v, a, frame, "local").cross_matrix() @ J
    T = frame_pose(model, q, frame)
    X = (T if reference == "world" else SE3(T.rotation, 0.0 * T.translation)).adjoint()
    return X @ V_q, X @ J, X @ A_q, X @ A_v, X @ A_a


def point_derivatives(
    model: Model,
    q: Array,
    v: Array,
    a: Array,
    frame: Frame,
    reference: Literal["local", "local_world_aligned"] = "local_world_aligned",
) -> tuple[Array, Array, Array, Array, Array]:
    """The derivatives of how the origin of a frame moves, as a point.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].
        a: Acceleration, shape (..., nv) [rad/s^2, m/s^2].
        frame: A frame of the model.
        reference: In whose axes: the frame's ("local") or the world's.

    Returns:
        Of its velocity by q and v; of its acceleration by q, v and a; each of shape (..., 3, nv).

    Raises:
        UnknownName: `reference` is neither "local" nor "local_world_aligned".
    """
    if reference not in ("local", "local_world_aligned"):
        raise UnknownName("reference", reference, ("local", "local_world_aligned"), "A point has no twist.")
    V_q, V_v = frame_velocity_derivatives(model, q, v, frame)
    A_q, A_v, A_a = (A[..., :3, :] for A in frame_acceleration_derivatives(model, q, v, a, frame))
    V = frame_velocity(model, q, v, frame, "local")
    A = frame_acceleration(model, q, v, a, frame, "local", classical=True).linear
    A_q, A_v = (x + _turning(V, dV) for x, dV in ((A_q, V_q), (A_v, V_v)))
    u_q, u_v = V_q[..., :3, :], V_v[..., :3, :]
    if reference == "local":
        return u_q, u_v, A_q, A_v, A_a
    R = frame_pose(model, q, frame).rotation
    turns = V_v[..., 3:, :]  # the angular part of the Jacobian
    u_q, A_q = u_q - skew(V.linear) @ turns, A_q - skew(A) @ turns
    return R @ u_q, R @ u_v, R @ A_q, R @ A_v, R @ A_a


def _turning(V: Motion, dV: Array) -> Array:
    """The derivative of w x u, from the derivative of the twist (u; w)."""
    return skew(V.angular) @ dV[..., :3, :] - skew(V.linear) @ dV[..., 3:, :]
