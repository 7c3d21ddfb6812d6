"""Inverse dynamics by the recursive Newton-Euler algorithm: the joint torques that a motion takes.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| P, J, p | see tree.py; origin of the moving frame in the parent's | SE3, SE3, (3) | [m] | p = P J 0 |
| x' | a vector of the parent's moving frame in this one | (3) | | (P J)^T x |
| S v, S a | what the joint adds: linear l, angular r | Motion | | constant columns, see tree.py |
| w | angular velocity of the body | (3) | [rad/s] | w = w_p' + r v |
| e | its rate | (3) | [rad/s^2] | e = e_p' + r a + w_p' x r v |
| U | what an arm fixed in the body is accelerated by | (3, 3) | [1/s^2] | U = [e] + [w] [w] |
| b | acceleration of the frame's origin, less g | (3) | [m/s^2] | b = (b_p + U_p p)' + l a + (w_p' + w) x l v |
| m, c, I | mass, first and second moment about the frame's origin | Lump | | see mass_moments.py |
| f, n | force and moment about the origin on the body | Force | [N, N m] | m b + U c, I e + w x I w + c x b |
| tau | joint torque | (nv) | [N m] or [N] | S^T (f, n), plus armature times acceleration |

Source: Luh, Walker & Paul, On-line computational scheme for mechanical manipulators (1980); Featherstone 2008, section
5.3, whose spatial accelerations are written here as the accelerations of points, so that no linear velocity is needed.
U serves the next origin, the force, and the moment (Khalil & Kleinfinger 1987, see mass_moments.py): with w = (x,
y, z) the
six products of w x I w are those of U. The frames are those of link_frames.py, and the inertias those a joint can feel.
Gravity is an acceleration of the world, -g, upward. What is at rest folds away, so that the torques against gravity
are the same recursion with v = a = 0.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from ulna.algorithms.multibody.external_forces import External, batches
from ulna.algorithms.multibody.link_frames import Tidy, tidy
from ulna.algorithms.multibody.mass_moments import Lump, felt, lumps
from ulna.algorithms.multibody.tree import Step, blank, inward, outward
from ulna.model import Model
from ulna.numeric import apply, cross, matrix, vector
from ulna.spatial import Force
from ulna.typing import Array


class Rates(NamedTuple):
    """How a body moves, in its moving frame: w, e, b and U."""

    w: Array
    e: Array
    b: Array
    U: Array


def inverse_dynamics(
    model: Model, q: Array, v: Array | None, a: Array | None, external: External = None
) -> Array:
    """The joint torques that give the acceleration `a`, shape (..., nv) [N m or N].

    Args:
        model: The robot.
        q: Configuration, shape (..., nq).
        v: Velocity, shape (..., nv); None for rest.
        a: Acceleration, shape (..., nv); None for zero.
        external: Forces on the bodies.
    """
    tidied = tidy(model)
    moving = rates(tidied.tree, q, v, a, -np.asarray(model.gravity))
    forces = [wrench(body, rate) for body, rate in zip(felt(model, tidied), moving, strict=True)]
    inputs = [x for x in (q, v, a) if x is not None]
    inputs += batches(external)
    tau = project(model, tidied, q, less_external(model, tidied, forces, external), inputs)
    return tau if a is None else tau + a * model.armature


def bias_forces(model: Model, q: Array, v: Array, external: External = None) -> Array:
    """The torques that give no acceleration: Coriolis, centrifugal, gravity, minus external; (..., nv) [N m or N].

    Args:
        model: The robot.
        q: Configuration, shape (..., nq).
        v: Velocity, shape (..., nv).
        external: Forces on the bodies.
    """
    return inverse_dynamics(model, q, v, None, external)


def gravity_forces(model: Model, q: Array) -> Array:
    """The torques that hold the robot against gravity, shape (..., nv) [N m or N].

    Args:
        model: The robot.
        q: Configuration, shape (..., nq).
    """
    return inverse_dynamics(model, q, None, None)


def static_torque(model: Model, q: Array, external: External) -> Array:
    """The torques that hold the robot against gravity and external forces, shape (..., nv) [N m or N].

    Args:
        model: The robot.
        q: Configuration, shape (..., nq).
        external: Forces on the bodies.
    """
    return inverse_dynamics(model, q, None, None, external)


def joint_wrenches(
    model: Model, q: Array, v: Array | None, a: Array | None, external: External = None
) -> list[Force]:
    """What every joint passes on to the body it moves, in its moving frame [N, N m]; see `inverse_dynamics`.

    The inertias are those of the bodies, not the ones that a joint can feel: bearings carry what no joint feels.
    """
    tidied = tidy(model)
    moving = rates(tidied.tree, q, v, a, -np.asarray(model.gravity))
    forces = [wrench(body, rate) for body, rate in zip(lumps(model, tidied), moving, strict=True)]
    gathered = _gathered(tidied, q, less_external(model, tidied, forces, external))
    inputs = [*(x for x in (q, v, a) if x is not None), *batches(external)]
    return [
        frame.act(force) + Force(blank((3,), *inputs), blank((3,), *inputs))
        for step, frame, force in zip(tidied.tree, tidied.frames, gathered, strict=True)
        if step.is_last
    ]


def rates(tree: Sequence[Step], q: Array, v: Array | None, a: Array | None, world: Array) -> list[Rates]:
    """How the body of every step moves when the world accelerates by `world`."""

    def advance(step: Step, before: Rates) -> Rates:
        P, J = step.placement, step.transform(q)
        arm = P.translation + apply(P.rotation, J.translation)
        w = e = np.zeros(3)
        b = into(step, before.b + apply(before.U, arm), q)
        if v is not None:
            own = step.motion(v)
            carried = into(step, before.w, q)
            w = carried + own.angular
            e = into(step, before.e, q) + cross(carried, own.angular)
            b = b + cross(carried + w, own.linear)
        elif a is not None:
            e = into(step, before.e, q)
        if a is not None:
            gain = step.motion(a)
            e, b = e + gain.angular, b + gain.linear
        return Rates(w, e, b, spin(w, e))

    still = np.zeros(3)
    return outward(tree, Rates(still, still, world, np.zeros((3, 3))), advance)


def into(step: Step, x: Array, q: Array) -> Array:
    """x': a vector of the parent's moving frame, in the moving frame of the step."""
    turned = apply(np.swapaxes(step.placement.rotation, -1, -2), x)
    return apply(np.swapaxes(step.transform(q).rotation, -1, -2), turned)


def spin(w: Array, e: Array) -> Array:
    """U."""
    x, y, z = (w[..., i] for i in range(3))
    ex, ey, ez = (e[..., i] for i in range(3))
    xx, yy, zz, xy, xz, yz = x * x, y * y, z * z, x * y, x * z, y * z
    return matrix(
        [[-(yy + zz), xy - ez, xz + ey], [xy + ez, -(xx + zz), yz - ex], [xz - ey, yz + ex, -(xx + yy)]]
    )


def wrench(body: Lump, rate: Rates) -> Force:
    """The force that moves a body."""
    U, w, e = rate.U, rate.w, rate.e
    x, y, z = (w[..., i] for i in range(3))
    I = [[body.second[..., i, j] for j in range(3)] for i in range(3)]
    # I e + w x I w, sorted by the entries of I
    turning = vector(
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
    mass = body.mass[..., None] if isinstance(body.mass, np.ndarray) and body.mass.ndim else body.mass
    return Force(mass * rate.b + apply(U, body.first), turning + cross(body.first, rate.b))


def project(model: Model, tidied: Tidy, q: Array, forces: Sequence[Force], inputs: Sequence[Array]) -> Array:
    """tau without armature: the forces on the bodies, gathered inward and felt at the joints."""
    tau = blank((model.nv,), *inputs)
    for step, force in zip(tidied.tree, _gathered(tidied, q, forces), strict=True):
        for k, S in zip(step.indices, step.subspace(), strict=True):
            tau[..., k] += S.dot(force) * step.multiplier
    return tau


def _gathered(tidied: Tidy, q: Array, forces: Sequence[Force]) -> list[Force]:
    """For every step, what moves all bodies from it outward."""
    return inward(tidied.tree, forces, lambda step, force: step.placement.act(step.transform(q).act(force)))


def less_external(model: Model, tidied: Tidy, forces: Sequence[Force], external: External) -> list[Any]:
    """The forces that joints must pass on to the bodies: those that move them, without those from elsewhere."""
    if external is None:
        return list(forces)
    left: list[Force] = []
    for step, frame, force in zip(tidied.tree, tidied.frames, forces, strict=True):
        given = external[model.joint_index(step.joint.name)] if step.is_last else None
        left.append(force if given is None else force - frame.act_inverse(given))
    return left
