"""Inverse dynamics with few operations: Newton-Euler with the accelerations of points instead of spatial ones.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| P, J, p | see tree.py; origin of the moving frame in the parent's | SE3, SE3, (3) | [m] | p = P J 0 |
| x' | a vector of the parent's moving frame in this one | (3) | | (P J)^T x |
| S v, S a | velocity and acceleration of the joint: linear l, angular r | Motion | | constant columns, see tree.py |
| w | angular velocity of the body | (3) | [rad/s] | w = w_p' + r v |
| e | its rate | (3) | [rad/s^2] | e = e_p' + r a + w_p' x r v |
| U | acceleration of a point of the body by its position | (3, 3) | [1/s^2] | U = [e] + [w] [w] |
| b | acceleration of the frame's origin, less g | (3) | [m/s^2] | b = (b_p + U_p p)' + l a + (w_p' + w) x l v |
| m, c, I | mass, first and second moment about the frame's origin | MassMoments | | see mass_moments.py |
| f, n | force and moment about the origin on the body | Force | [N, N m] | m b + U c, I e + w x I w + c x b |
| tau | joint torque | (nv) | [N m] or [N] | S^T (f, n), plus armature times acceleration |

Derivation from rnea.py, table 5.1 of Featherstone 2008: with V = (u; w) and the spatial acceleration A = (d; e) of a
body, the point of the body at the origin accelerates by b = d + w x u (section 2.11). In terms of b the linear velocity
u cancels from I A + V x* I V: its force is m b + U c, its moment I e + w x I w + c x b, which are Newton's and Euler's
equations about the origin. The product U p serves the origin of the next frame, U c the force, and with w = (x, y, z)
the six products of w x I w are entries of U (Khalil & Kleinfinger 1987). Two more things save operations: the frames
are those of link_frames.py, and the inertias are regrouped, which keeps the torques (see regrouped_moments.py).
Gravity is an acceleration of the world, -g, upward. What is at rest folds away, so that the torques against gravity
are the same recursion with v = a = 0.

Source: Luh, Walker & Paul, On-line computational scheme for mechanical manipulators (1980); Featherstone 2008, section
5.3. `tests/laws/test_textbook_dynamics_laws.py` shows that it is equal to `rnea`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ulna.algorithms.multibody.batch_shapes import batch_zeros
from ulna.algorithms.multibody.external_forces import External
from ulna.algorithms.multibody.mass_moments import MassMoments
from ulna.algorithms.multibody.prepared_model import PreparedModel, prepare
from ulna.algorithms.multibody.tree import Step, inward, outward
from ulna.model import Model
from ulna.numeric import apply, cross, matrix, vector
from ulna.spatial import Force
from ulna.spatial.batched import column
from ulna.typing import Array


class PointMotion(NamedTuple):
    """The motion of a body in its moving frame: w, e, b and U."""

    w: Array
    e: Array
    b: Array
    U: Array


def inverse_dynamics(
    model: Model, q: Array, v: Array | None, a: Array | None, external: External = None
) -> Array:
    """The joint torques that produce the acceleration `a`, by the form that is compiled; equal to `rnea`.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s]; None for rest.
        a: Acceleration, shape (..., nv) [rad/s^2, m/s^2]; None for zero.
        external: Forces on the bodies [N, N m]; None for none.

    Returns:
        Joint torques, shape (..., nv) [N m, N].
    """
    prepared = prepare(model)
    forces = _transmitted_forces(prepared, prepared.regrouped_moments, q, v, a, external)
    tau = batch_zeros((model.nv,), q, v, a, external)
    for step, force in zip(prepared.tree, forces, strict=True):
        for k, s in step.columns():
            tau[..., k] += s.dot(force)
    return tau if a is None else tau + a * model.armature


def bias_forces(model: Model, q: Array, v: Array, external: External = None) -> Array:
    """The joint torques at zero acceleration: Coriolis, centrifugal, gravity, minus external.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].
        external: Forces on the bodies [N, N m]; None for none.

    Returns:
        Joint torques, shape (..., nv) [N m, N].
    """
    return inverse_dynamics(model, q, v, None, external)


def gravity_forces(model: Model, q: Array) -> Array:
    """The joint torques that hold the robot against gravity.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].

    Returns:
        Joint torques, shape (..., nv) [N m, N].
    """
    return inverse_dynamics(model, q, None, None)


def static_torque(model: Model, q: Array, external: External) -> Array:
    """The joint torques that hold the robot against gravity and external forces.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        external: Forces on the bodies [N, N m]; None for none.

    Returns:
        Joint torques, shape (..., nv) [N m, N].
    """
    return inverse_dynamics(model, q, None, None, external)


def joint_wrenches(
    model: Model, q: Array, v: Array | None, a: Array | None, external: External = None
) -> list[Force]:
    """The wrench that every joint transmits to the body it moves.

    The inertias are those of the bodies, not regrouped: a bearing carries forces that no joint torque shows.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s]; None for rest.
        a: Acceleration, shape (..., nv) [rad/s^2, m/s^2]; None for zero.
        external: Forces on the bodies [N, N m]; None for none.

    Returns:
        One wrench a joint, in its moving frame, with the batch axes of the inputs [N, N m].
    """
    prepared = prepare(model)
    forces = _transmitted_forces(prepared, prepared.body_moments, q, v, a, external)
    zero = batch_zeros((3,), q, v, a, external)
    return [
        frame.act(force) + Force(zero, zero)
        for step, frame, force in zip(prepared.tree, prepared.frames, forces, strict=True)
        if step.is_last
    ]


def point_motions(
    tree: Sequence[Step], q: Array, v: Array | None, a: Array | None, b_0: Array
) -> list[PointMotion]:
    """The motion of the body of every step.

    Args:
        tree: The steps, parents first.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s]; None for rest.
        a: Acceleration, shape (..., nv) [rad/s^2, m/s^2]; None for zero.
        b_0: Acceleration of the world, minus that of gravity where it counts, shape (3,) [m/s^2].

    Returns:
        One motion a step, in its moving frame.
    """

    def advance(step: Step, parent: PointMotion) -> PointMotion:
        P, J = step.placement, step.transform(q)
        p = P.translation + apply(P.rotation, J.translation)
        w = e = np.zeros(3)
        b = _rotate_from_parent(step, parent.b + apply(parent.U, p), q)
        if v is not None:
            v_J = step.motion(v)
            w_p = _rotate_from_parent(step, parent.w, q)
            w = w_p + v_J.angular
            e = _rotate_from_parent(step, parent.e, q) + cross(w_p, v_J.angular)
            b = b + cross(w_p + w, v_J.linear)
        elif a is not None:
            e = _rotate_from_parent(step, parent.e, q)
        if a is not None:
            a_J = step.motion(a)
            e, b = e + a_J.angular, b + a_J.linear
        return PointMotion(w, e, b, _acceleration_by_position(w, e))

    zero = np.zeros(3)
    return outward(tree, PointMotion(zero, zero, b_0, np.zeros((3, 3))), advance)


def _rotate_from_parent(step: Step, x: Array, q: Array) -> Array:
    """x': a vector of the parent's moving frame, in the moving frame of the step."""
    in_fixed_frame = apply(np.swapaxes(step.placement.rotation, -1, -2), x)
    return apply(np.swapaxes(step.transform(q).rotation, -1, -2), in_fixed_frame)


def _acceleration_by_position(w: Array, e: Array) -> Array:
    """U, shape (..., 3, 3) [1/s^2]."""
    x, y, z = (w[..., i] for i in range(3))
    ex, ey, ez = (e[..., i] for i in range(3))
    xx, yy, zz, xy, xz, yz = x * x, y * y, z * z, x * y, x * z, y * z
    return matrix(
        [[-(yy + zz), xy - ez, xz + ey], [xy + ez, -(xx + zz), yz - ex], [xz - ey, yz + ex, -(xx + yy)]]
    )


def newton_euler(bodies: Sequence[MassMoments], motions: Sequence[PointMotion]) -> list[Force]:
    """The force and moment that each motion takes.

    Args:
        bodies: The inertia of the body of every step, in its moving frame [kg, kg m, kg m^2].
        motions: The motion of each.

    Returns:
        One wrench a step, in its moving frame [N, N m].
    """
    return [_newton_euler(body, motion) for body, motion in zip(bodies, motions, strict=True)]


def _newton_euler(body: MassMoments, motion: PointMotion) -> Force:
    """f and n."""
    U, w, e = motion.U, motion.w, motion.e
    x, y, z = (w[..., i] for i in range(3))
    I = [[body.second[..., i, j] for j in range(3)] for i in range(3)]
    # I e + w x I w, sorted by the entries of I
    moment = vector(
        I[0][0] * e[..., 0]
        + (I[2][2] - I[1][1]) * (y * z)
        - I[0][1] * U[..., 2, 0]
        + I[0][2] * U[..., 1, 0]
        + I[1][2] * (y * y - z * z),
        I[1][1] * e[..., 1]
        + (I[0][0] - I[2][2]) * (x * z)
        + I[0][1] * U[..., 2, 1]
        - I[1][2] * U[..., 0, 1]
        + I[0][2] * (z * z - x * x),
        I[2][2] * e[..., 2]
        + (I[1][1] - I[0][0]) * (x * y)
        - I[0][2] * U[..., 1, 2]
        + I[1][2] * U[..., 0, 2]
        + I[0][1] * (x * x - y * y),
    )
    return Force(column(body.mass) * motion.b + apply(U, body.first), moment + cross(body.first, motion.b))


def _transmitted_forces(
    prepared: PreparedModel,
    bodies: Sequence[MassMoments],
    q: Array,
    v: Array | None,
    a: Array | None,
    external: External,
) -> list[Force]:
    """For every step the sum of the forces on the bodies from it outward, in its moving frame."""
    motions = point_motions(prepared.tree, q, v, a, -np.asarray(prepared.model.gravity))
    forces = subtract_external(prepared, newton_euler(bodies, motions), external)
    return inward(prepared.tree, forces, lambda step, force: step.force_to_parent(force, q))


def subtract_external(prepared: PreparedModel, forces: Sequence[Force], external: External) -> list[Force]:
    """The forces that joints transmit to the bodies: those of Newton and Euler minus those of the surroundings.

    Args:
        prepared: The optimised frames of the model.
        forces: The force that the motion of each body takes, in the optimised frame of its step [N, N m].
        external: Forces on the bodies [N, N m]; None for none.

    Returns:
        One force a step, in the same frames [N, N m].
    """
    of_joints = list(forces)
    for i, force in enumerate(forces):
        f_x = prepared.external_force(i, external)
        if f_x is not None:
            of_joints[i] = force - f_x
    return of_joints
