"""The matrices by which torques, energies and the centre of mass are linear in the masses and inertias of the bodies.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| p_i | m, m c, Ixx, Ixy, Iyy, Ixz, Iyz, Izz of body i in its joint's frame | (10) | [kg], [kg m], [kg m^2] | |
| p | those of all bodies, in the order of the joints | (10 nbodies) | | |
| V_i, A_i | twist and acceleration of body i in its frame, that of free fall taken off | Motion | | A_0 = -g |
| a, w, e | acceleration of the frame's origin, angular velocity, angular acceleration | (3) | | a = A.linear + w x v |
| D | what m c is multiplied by in the force | (3, 3) | [1/s^2] | D = [e] + [w][w] |
| M | what the inertias are multiplied by in the moment | (3, 6) | [1/s^2] | M p_I = I e + w x I w |
| Y_i | body regressor: wrench = Y_i p_i | (6, 10) | | [[a, D, 0], [0, -[a], M]] |
| Y | joint torque regressor: tau = Y p | (nv, 10 nbodies) | | sum of S_k^T Y_i over k below i |

A body is all that a movable joint carries rigidly, as in `model.inertias`; mimic joints carry bodies, too. The
inertia of the drives (armature) and friction are not in p: they add their own columns. Source: Atkeson, An &
Hollerbach, Estimation of inertial parameters of manipulator loads and links (1986); Siciliano, section 7.2.2. The
subspaces S_k travel outward into the frame of each body: one twist a pair, instead of ten wrenches inward.
"""

from __future__ import annotations

from typing import Any, cast

import numpy as np

from ulna.algorithms.dynamics.center_of_mass import total_mass
from ulna.algorithms.multibody.batch_shapes import batch_zeros
from ulna.algorithms.multibody.tree import Step, chain, outward, poses, steps
from ulna.model import Frame, Model
from ulna.numeric import apply, cross, dot, matrix, vector
from ulna.spatial import Motion
from ulna.typing import Array

PARAMETERS = ("m", "mx", "my", "mz", "Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz")
"""Names of the ten parameters of a body: mass, mass times centre of mass, inertia about the frame's origin."""

_Column = tuple[int, Motion]


def body_regressor(V: Motion, A: Motion) -> Array:
    """The regressor of one body: the wrench it needs, in its frame, is `Y @ Inertia.parameters()`.

    Args:
        V: Its twist, in its frame [m/s, rad/s].
        A: Its spatial acceleration, in its frame, minus that of free fall [m/s^2, rad/s^2].

    Returns:
        Y, shape (..., 6, 10), linear rows first.
    """
    a, D, M = _terms(V, A)
    zero = 0.0 * a[..., 0]
    rows = [[a[..., i], *(D[..., i, k] for k in range(3)), *[zero] * 6] for i in range(3)]
    x, y, z = a[..., 0], a[..., 1], a[..., 2]
    turn = ((zero, z, -y), (-z, zero, x), (y, -x, zero))
    rows += [[zero, *turn[i], *(M[..., i, k] for k in range(6))] for i in range(3)]
    return matrix(rows)


def joint_torque_regressor(model: Model, q: Array, v: Array | None = None, a: Array | None = None) -> Array:
    """The regressor of inverse dynamics: the torques without armature are `Y @ p`.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s]; None for rest.
        a: Acceleration, shape (..., nv) [rad/s^2, m/s^2]; None for zero.

    Returns:
        Y, shape (..., nv, 10 nbodies).
    """
    inputs = [x for x in (q, v, a) if x is not None]
    tree = steps(model)
    root = cast("tuple[_Column, ...]", ())
    subspaces = outward(tree, root, lambda step, below: _subspaces_up_to(step, below, q))
    Y = batch_zeros((model.nv, 10 * len(model.joints)), *inputs)
    for step, (V, A), columns in zip(tree, _motions(model, tree, q, v, a), subspaces, strict=True):
        if not step.is_last:
            continue
        first = 10 * model.joint_index(step.joint.name)
        terms = _terms(V, A)
        for row, S in columns:
            here = slice(first, first + 10)
            Y[..., row, here] = Y[..., row, here] + _projected(S, *terms)
    return Y


def gravity_regressor(model: Model, q: Array) -> Array:
    """The regressor at rest: the torques that hold the robot against gravity are `Y @ p`.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].

    Returns:
        Y, shape (..., nv, 10 nbodies).
    """
    return joint_torque_regressor(model, q)


def frame_regressor(model: Model, q: Array, v: Array, a: Array, frame: Frame) -> Array:
    """The regressor of a body attached to a frame, its parameters and its wrench written in that frame.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].
        a: Acceleration, shape (..., nv) [rad/s^2, m/s^2].
        frame: A frame of the model.

    Returns:
        Y, shape (..., 6, 10), linear rows first.
    """
    tree = chain(model, frame)
    motions = _motions(model, tree, q, v, a)
    V, A = motions[-1] if motions else _at_rest(model)
    Y = body_regressor(frame.placement.act_inverse(V), frame.placement.act_inverse(A))
    return Y + batch_zeros((6, 10), q, v, a)


def static_regressor(model: Model, q: Array) -> Array:
    """The matrix that makes the centre of mass in the world out of each body's m and m c.

    It is that of all that moves; multiply by the first four parameters of each body.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].

    Returns:
        The matrix, shape (..., 3, 4 nbodies) [m/kg, 1/kg].
    """
    tree = steps(model)
    total = total_mass(model)
    out = batch_zeros((3, 4 * len(model.joints)), q)
    for step, T in zip(tree, poses(tree, q), strict=True):
        if step.is_last:
            first = 4 * model.joint_index(step.joint.name)
            out[..., first] = T.translation / total
            out[..., first + 1 : first + 4] = T.rotation / total
    return out


def kinetic_energy_regressor(model: Model, q: Array, v: Array) -> Array:
    """The row that makes the kinetic energy out of p, without that of the drives.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].

    Returns:
        The row, shape (..., 10 nbodies).
    """
    tree = steps(model)
    out = batch_zeros((10 * len(model.joints),), q, v)
    for step, (V, _) in zip(tree, _motions(model, tree, q, v, None), strict=True):
        if step.is_last:
            first = 10 * model.joint_index(step.joint.name)
            w = V.angular
            x, y, z = w[..., 0], w[..., 1], w[..., 2]
            lever = cross(V.linear, w)
            out[..., first : first + 10] = vector(
                0.5 * dot(V.linear, V.linear),
                *(lever[..., k] for k in range(3)),
                *(0.5 * x * x, x * y, 0.5 * y * y, x * z, y * z, 0.5 * z * z),
            )
    return out


def potential_energy_regressor(model: Model, q: Array) -> Array:
    """The row that makes the potential energy out of p; zero at the world's origin.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].

    Returns:
        The row, shape (..., 10 nbodies).
    """
    tree = steps(model)
    out = batch_zeros((10 * len(model.joints),), q)
    for step, T in zip(tree, poses(tree, q), strict=True):
        if step.is_last:
            first = 10 * model.joint_index(step.joint.name)
            out[..., first] = -dot(T.translation, model.gravity)
            out[..., first + 1 : first + 4] = -apply(np.swapaxes(T.rotation, -1, -2), model.gravity)
    return out


def _subspaces_up_to(step: Step, below: tuple[_Column, ...], q: Array) -> tuple[_Column, ...]:
    """The columns of S of the steps up to and with `step`, in its frame, each with its place in v."""
    carried = [(row, step.motion_from_parent(S, q)) for row, S in below]
    columns = [(row, S * step.multiplier) for row, S in zip(step.indices, step.subspace(), strict=True)]
    return (*carried, *columns)


def _at_rest(model: Model) -> tuple[Motion, Motion]:
    return Motion.zero(), Motion(-model.gravity, np.zeros(3))


def _motions(
    model: Model, tree: tuple[Step, ...], q: Array, v: Array | None, a: Array | None
) -> list[tuple[Motion, Motion]]:
    """V and A of every step."""

    def advance(step: Step, before: tuple[Motion, Motion]) -> tuple[Motion, Motion]:
        V, A = before[0], step.motion_from_parent(before[1], q)
        if v is not None:
            v_J = step.motion(v)
            V = step.motion_from_parent(V, q) + v_J
            A = A + V.cross(v_J)
        return V, A if a is None else A + step.motion(a)

    return outward(tree, _at_rest(model), advance)


def _terms(V: Motion, A: Motion) -> tuple[Array, Array, Array]:
    """a, D and M."""
    w, e = V.angular, A.angular
    x, y, z = w[..., 0], w[..., 1], w[..., 2]
    ex, ey, ez = e[..., 0], e[..., 1], e[..., 2]
    xx, yy, zz, xy, xz, yz = x * x, y * y, z * z, x * y, x * z, y * z
    D = matrix(
        [[-(yy + zz), xy - ez, xz + ey], [xy + ez, -(xx + zz), yz - ex], [xz - ey, yz + ex, -(xx + yy)]]
    )
    M = matrix(
        [
            [ex, ey - xz, -yz, ez + xy, yy - zz, yz],
            [xz, ex + yz, ey, zz - xx, ez - xy, -xz],
            [-xy, xx - yy, xy, ex - yz, ey + xz, ez],
        ]
    )
    return A.linear + cross(w, V.linear), D, M


def _projected(S: Motion, a: Array, D: Array, M: Array) -> Array:
    """S^T Y_i, (..., 10)."""
    first_moments = _times(S.linear, D) + cross(a, S.angular)
    parts: list[Any] = [dot(S.linear, a)]
    parts += [first_moments[..., k] for k in range(3)]
    inertias = _times(S.angular, M)
    parts += [inertias[..., k] for k in range(6)]
    return vector(*parts)


def _times(row: Array, m: Array) -> Array:
    return (row[..., None, :] @ m)[..., 0, :]
