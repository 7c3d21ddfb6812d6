"""How accelerations and forces of a robot under constraints change with q, v and tau, in closed form.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| a, f | accelerations; constraint forces, along the axes of the first frames | (nv), (m) | | dynamics.py |
| J | constraint Jacobian, along the same axes | (m, nv) | | frame_errors.py |
| r | what is left of M a + h = tau + J^T f | (nv) | | r = ID(q, v, a) - J^T f - tau |
| g | what is left of the constraints, with gains kp and kd, z wanted | (m) | | g = J a + k + kd c + kp e - z |
| V, A | twist and spatial acceleration of a frame, in the axes of the first one | Motion | | derivatives/velocity.py |
| s | column of J: how the first frame turns for an observer on the second | Motion | | |
| dX_b/dq | of what moves with the second frame, seen from the first | | | dX_b + X_b x s |
| dc/dq | of a frame | Motion | | dV_a - (dV_b + V_b x s) |
| dg/dq | of a frame, kp = kd = 0 | Motion | | dA_a - (dA_b + A_b x s) |
| | and where "local" axes count their turning | | | + dc/dq x V_b + c x (dV_b + V_b x s) |
| dz/dq | of what is wanted along the world's axes | (3) | | z x w |
| de/dq | of a frame; of a point, w being the turning of its axes | | | J_r(e)^-1 s; s + e x w |
| dr/dq | f, unlike its opposite, stays where it is in the axes of the first frame | | | dID - ... + J_b^T (s x* f) |
| S | | (m, m) | | (J M^-1 J^T + mu 1)^-1 |
| P | S after n rounds with damping | (m, m) | | P_1 = S, P_n+1 = S + mu S P_n |
| K, N | | (nv, nv), (m, nv) | | K = M^-1 - M^-1 J^T N, N = P J M^-1 |
| W | how a and f answer to changes of r and g; f is turned by X | (nv + m, nv + m) | | W = [-K, -N^T; X N, -X P] |
| B | changes of r and g by q and v | (nv + m, 2 nv) | | [da; df - (dX f, 0)] = W B |

Forces along the world's axes turn with the first frame: df = R df + w x f. Derivatives by q are along the tangent
space. Source: Carpentier & Mansard 2018, section III; Budhiraja, Carpentier & Mansard, Dynamics consensus between
centroidal and whole-body models for locomotion (2019), section III: differentiating both equations.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from ulna.algorithms.constraints.frame_errors import frame_of, relative_log
from ulna.algorithms.derivatives.inverse_dynamics import inverse_dynamics_derivatives
from ulna.algorithms.derivatives.velocity import (
    frame_acceleration_derivatives,
    frame_velocity_derivatives,
    point_derivatives,
)
from ulna.algorithms.kinematics.forward_kinematics import frame_acceleration, frame_pose, frame_velocity
from ulna.algorithms.multibody.batch_shapes import batch_zeros
from ulna.model import Frame, Model
from ulna.model.constraint import End, FramePair
from ulna.numeric import apply, skew
from ulna.spatial import SE3, Force, Motion
from ulna.spatial.exponential import se3_right_jacobian_inverse
from ulna.typing import Array


class BoundTerms(NamedTuple):
    """What the derivatives are made of."""

    r_q: Array
    """dr/dq, (nv, nv)."""
    r_v: Array
    """dr/dv, (nv, nv)."""
    M: Array
    """The mass matrix, (nv, nv)."""
    J: Array
    """The constraint Jacobian along the axes of the first frames, (m, nv)."""
    c_q: Array
    """dc/dq, (m, nv)."""
    g_q: Array
    """dg/dq, (m, nv)."""
    g_v: Array
    """dg/dv, (m, nv)."""
    X: Array
    """What turns forces from those axes to those of their constraint, (m, m)."""
    X_q: Array
    """The derivative with respect to q of what it gives for the forces f, (m, nv)."""


class _Side(NamedTuple):
    """Twist, acceleration, and their derivatives, of a frame or of a point, in the axes of the first frame."""

    J: Array
    V: Array
    A: Array
    V_q: Array
    A_q: Array
    A_v: Array
    turns: Array
    """How those axes turn with the body, (3, nv)."""


def bound_terms(
    model: Model,
    q: Array,
    v: Array,
    a: Array,
    forces: Array,
    gains: Array,
    wanted: Array,
    frame_pairs: Sequence[FramePair],
    impact: bool = False,
) -> BoundTerms:
    """The derivatives of what is left of dynamics and constraints.

    Args:
        model: The robot.
        q: Configuration, shape (nq,) [rad, m].
        v: Velocity, shape (nv,) [rad/s, m/s].
        a: Acceleration, shape (nv,) [rad/s^2, m/s^2].
        forces: Constraint forces, each along the axes of its constraint, shape (m,) [N, N m].
        gains: kp [1/s^2] and kd [1/s] of each constraint, shape (constraints, 2).
        wanted: The required J a + k + kd c + kp e, each along the axes of its constraint, shape (m,) [m/s^2,
            rad/s^2].
        frame_pairs: The constraints, all with a second frame.
        impact: Whether a is a jump of v and the forces are impulses, so that gravity and v count for nothing in r.

    Returns:
        The derivatives of both residuals, and the matrices they come with.
    """
    external: list[Force | None] = [None] * len(model.joints)
    m, start = sum(frame_pair.size for frame_pair in frame_pairs), 0
    J, c_q, g_q, g_v, X_q = (batch_zeros((m, model.nv), q, v, a, forces) for _ in range(5))
    X = batch_zeros((m, m), q)
    extra = batch_zeros((model.nv, model.nv), q, v, a, forces)
    for k, frame_pair in enumerate(frame_pairs):
        assert frame_pair.second is not None, "the frame that holds it"
        rows = slice(start, start + frame_pair.size)
        f = forces[rows]
        T = frame_pose(model, q, frame_of(frame_pair.first))
        axes = SE3.identity() if frame_pair.local else SE3(np.swapaxes(T.rotation, -1, -2), np.zeros(3))
        in_first = _parts(f, axes)
        second, first = _second(model, q, frame_pair, T), frame_of(frame_pair.first)
        one, other = (_side(model, q, v, a, frame, frame_pair.size) for frame in (first, second))
        _act(external, first, in_first)
        _act(external, second, -in_first)
        s, turn = one.J - other.J, one.turns - other.turns
        J[rows, :] = s
        c_q[rows, :], g_q[rows, :], g_v[rows, :] = _changes(
            model, q, frame_pair, one, other, s, turn, gains[k]
        )
        extra = extra + other.J.T @ _moved(in_first, s, turn)
        X[rows, rows], X_q[rows, :], by_axes = _axes_terms(frame_pair, T.rotation, one.turns, f, wanted[rows])
        g_q[rows, :] = g_q[rows, :] - by_axes
        start += frame_pair.size
    if impact:
        model, v = replace(model, gravity=np.zeros(3)), 0.0 * v
    r_q, r_v, M = inverse_dynamics_derivatives(model, q, v, a, external)
    return BoundTerms(r_q + extra, r_v, M, J, c_q, g_q, g_v, X, X_q)


def _axes_terms(
    frame_pair: FramePair, R: Array, turns: Array, f: Array, wanted: Array
) -> tuple[Any, Any, Any]:
    """X of one constraint, and how X f and the required acceleration change with q as its axes R turn."""
    triples = frame_pair.size // 3
    if frame_pair.local:
        return np.eye(frame_pair.size), 0.0, 0.0
    turned, back = R @ turns, np.swapaxes(R, -1, -2)
    X_q = np.concatenate([-skew(part) @ turned for part in np.split(f, triples)])
    by_axes = np.concatenate([skew(apply(back, part)) @ turns for part in np.split(wanted, triples)])
    return np.kron(np.eye(triples), R), X_q, by_axes


def _second(model: Model, q: Array, frame_pair: FramePair, T: SE3) -> Frame:
    """The second frame, laid on the first one (of a point, only turned like it), as one of the second body."""
    assert frame_pair.second is not None
    joint = frame_pair.second.joint
    carrier = frame_pose(model, q, frame_of(End(joint, SE3.identity())))
    on = carrier.inverse() @ T
    return frame_of(
        End(joint, on if frame_pair.size == 6 else SE3(on.rotation, frame_pair.second.placement.translation))
    )


def _side(model: Model, q: Array, v: Array, a: Array, frame: Frame, size: int) -> _Side:
    V = frame_velocity(model, q, v, frame, "local").vector()
    V_q, V_v = frame_velocity_derivatives(model, q, v, frame)
    if size == 6:
        A = frame_acceleration(model, q, v, a, frame, "local").vector()
        A_q, A_v, _ = frame_acceleration_derivatives(model, q, v, a, frame)
        return _Side(V_v, V, A, V_q, A_q, A_v, V_v[3:, :])
    A = frame_acceleration(model, q, v, a, frame, "local", classical=True).linear
    u_q, u_v, A_q, A_v, _ = point_derivatives(model, q, v, a, frame, "local")
    return _Side(u_v, V[:3], A, u_q, A_q, A_v, V_v[3:, :])


def _changes(
    model: Model,
    q: Array,
    frame_pair: FramePair,
    one: _Side,
    other: _Side,
    s: Array,
    turn: Array,
    gains: Array,
) -> tuple[Array, Array, Array]:
    """dc/dq, dg/dq and dg/dv of one constraint."""
    assert frame_pair.second is not None
    if frame_pair.size == 3:
        V_q = other.V_q + skew(other.V) @ turn
        c_q = one.V_q - V_q
        g_q, g_v = one.A_q - other.A_q - skew(other.A) @ turn, one.A_v - other.A_v
        T, back = (
            frame_pose(model, q, frame_of(frame_pair.first)),
            frame_pose(model, q, frame_of(frame_pair.second)),
        )
        e = apply(np.swapaxes(T.rotation, -1, -2), T.translation - back.translation)
        e_q = s + skew(e) @ one.turns
    else:
        V_q = other.V_q + _cross(other.V) @ s
        c_q = one.V_q - V_q
        g_q, g_v = one.A_q - other.A_q - _cross(other.A) @ s, one.A_v - other.A_v
        if frame_pair.local:
            c = one.V - other.V
            g_q = g_q - _cross(other.V) @ c_q + _cross(c) @ V_q
            g_v = g_v - _cross(other.V) @ s + _cross(c) @ other.J
        e_q = se3_right_jacobian_inverse(relative_log(model, q, frame_pair)) @ s
    kp, kd = gains[0], gains[1]
    return c_q, g_q + kd * c_q + kp * e_q, g_v + kd * s


def _moved(force: Force, s: Array, turn: Array) -> Array:
    """What the opposite of a force does on the second body as the first frame moves for it, along each column."""
    if s.shape[0] == 3:
        return -skew(force.linear) @ turn
    linear = -skew(force.linear) @ s[3:, :]
    return np.concatenate([linear, -skew(force.angular) @ s[3:, :] - skew(force.linear) @ s[:3, :]], axis=0)


def _act(external: list[Any], frame: Frame, force: Force) -> None:
    """Adds a force in a frame to those on the joints."""
    if frame.joint >= 0:
        at_joint, before = frame.placement.act(force), external[frame.joint]
        external[frame.joint] = at_joint if before is None else before + at_joint


def _parts(f: Array, turned: SE3) -> Force:
    """The forces of one constraint as a Force, turned."""
    moment = apply(turned.rotation, f[3:]) if f.shape[0] == 6 else np.zeros(3)
    return Force(apply(turned.rotation, f[:3]), moment)


def _cross(V: Array) -> Array:
    """The matrix of V x."""
    return Motion(V[:3], V[3:]).cross_matrix()
