"""The centre of mass of a robot or of a joint's subtree: position, velocity, acceleration and Jacobian.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| m, c | mass and first moment of all bodies from a step outward, in its frame | (), (3) | [kg], [kg m] | |
| c', c'' | rates of c in the axes of the moving frame | (3) | [kg m/s], [kg m/s^2] | zero for the body itself |
| w, e, l, k | motion of the joint: S v = (l; w), S a = (k; e) | (3) | | |
| R, p | rotation and origin of the moving frame in the parent's | | [m] | P J(q) |
| c_p | first moment passed to the parent | (3) | [kg m] | R c + m p |
| c_p' | | (3) | [kg m/s] | R (c' + w x c + m l) |
| c_p'' | | (3) | [kg m/s^2] | R (c'' + w x (2 c' + w x c) + e x c + m (k + w x l)) |
| J | columns, in world axes | (3, nv) | [m], [1] | R_world (m l + w x c) / (mass of all), s = (l; w) |

The columns of revolute, prismatic and helical joints are written in their fixed frames, where s is the same.

The first moment is summed inward and differentiated at each step, so that the velocity and the acceleration
of no body are needed. Source: Siciliano 2009, eq. 7.2 (first moments); the rates are those of a point in a moving
frame, section 3.1. What no joint moves does not count: the centre is that of the moving bodies.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from ulna.algorithms.multibody.batch_shapes import batch_zeros
from ulna.algorithms.multibody.mass_moments import MassMoments
from ulna.algorithms.multibody.prepared_model import PreparedModel, prepare
from ulna.algorithms.multibody.tree import Step, inward, poses, sum_in_world
from ulna.errors import InputError
from ulna.model import Model
from ulna.numeric import apply, cross, is_symbolic
from ulna.spatial import SE3, Motion
from ulna.typing import Array


class FirstMoment(NamedTuple):
    """c, c' and c''; mass times position, velocity and acceleration."""

    position: Array
    velocity: Array
    acceleration: Array

    def __add__(self, other: Any) -> FirstMoment:
        return FirstMoment(*(a + b for a, b in zip(self, other, strict=True)))


def total_mass(model: Model, subtree: str | None = None) -> Any:
    """The mass of all that moves, or of what one joint moves.

    Args:
        model: The robot.
        subtree: Name of a joint; None for all.

    Returns:
        The mass [kg].

    Raises:
        UnknownName: no such joint.
    """
    return sum((model.inertias[i].mass for i in _joints(model, subtree)), 0.0)


def center_of_mass(model: Model, q: Array, subtree: str | None = None) -> Array:
    """Where the centre of mass is in the world.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        subtree: Name of a joint, for what it moves; None for all.

    Returns:
        Position, shape (..., 3) [m].

    Raises:
        UnknownName: no such joint.
        InputError: there is no mass.
    """
    return _over_mass(model, subtree, first_moment(model, q, subtree=subtree).position, q)


def center_of_mass_velocity(model: Model, q: Array, v: Array, subtree: str | None = None) -> Array:
    """How fast the centre of mass moves in the world.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].
        subtree: Name of a joint, for what it moves; None for all.

    Returns:
        Velocity, shape (..., 3) [m/s].

    Raises:
        UnknownName: no such joint.
        InputError: there is no mass.
    """
    return _over_mass(model, subtree, first_moment(model, q, v, subtree=subtree).velocity, q, v)


def center_of_mass_acceleration(
    model: Model, q: Array, v: Array, a: Array, subtree: str | None = None
) -> Array:
    """How the centre of mass accelerates in the world.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].
        a: Acceleration, shape (..., nv) [rad/s^2, m/s^2].
        subtree: Name of a joint, for what it moves; None for all.

    Returns:
        Acceleration, shape (..., 3) [m/s^2].

    Raises:
        UnknownName: no such joint.
        InputError: there is no mass.
    """
    return _over_mass(model, subtree, first_moment(model, q, v, a, subtree).acceleration, q, v, a)


def center_of_mass_jacobian(model: Model, q: Array, subtree: str | None = None) -> Array:
    """The Jacobian of the centre of mass: `J @ v` is its velocity in the world.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        subtree: Name of a joint, for what it moves; None for all.

    Returns:
        J, shape (..., 3, nv) [m/rad, -].

    Raises:
        UnknownName: no such joint.
        InputError: there is no mass.
    """
    prepared = prepare(model)
    tree = prepared.tree
    masses, firsts = _with_child_masses(tree, _bodies(model, prepared, subtree))
    mass_of = {id(step): m for step, m in zip(tree, masses, strict=True)}
    moments = inward(tree, firsts, lambda step, c: _position(step, mass_of[id(step)], c, q))
    J = batch_zeros((3, model.nv), q)
    T = [*poses(tree, q), SE3.identity()]  # the last one is that of the world, the parent -1
    for i, (step, m, c) in enumerate(zip(tree, masses, moments, strict=True)):
        frame, moment = T[i], c
        if step.moves_along_one_screw:  # the fixed frame depends on one position less
            X = step.transform(q)
            frame, moment = T[step.parent] @ step.placement, apply(X.rotation, c) + m * X.translation
        for k, s in zip(step.indices, step.subspace(), strict=True):
            J[..., :, k] += apply(frame.rotation, (m * s.linear + cross(s.angular, moment)) * step.multiplier)
    return J * _reciprocal(model, subtree)


def first_moment(
    model: Model, q: Array, v: Array | None = None, a: Array | None = None, subtree: str | None = None
) -> FirstMoment:
    """Mass times position, velocity and acceleration of the centre of mass in the world.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s]; None for rest.
        a: Acceleration, shape (..., nv) [rad/s^2, m/s^2]; None for zero.
        subtree: Name of a joint, for what it moves; None for all.

    Returns:
        The three vectors, each of shape (..., 3) [kg m], [kg m/s], [kg m/s^2].
    """
    prepared = prepare(model)
    tree = prepared.tree
    masses, firsts = _with_child_masses(tree, _bodies(model, prepared, subtree))
    still = np.zeros(3)
    ground = sum(
        (m * s.placement.translation for s, m in zip(tree, masses, strict=True) if s.parent < 0), still
    )
    mass_of = {id(step): m for step, m in zip(tree, masses, strict=True)}

    def move(step: Step, moment: FirstMoment) -> FirstMoment:
        c, c1, c2 = moment
        m = mass_of[id(step)]
        if v is not None:
            v_J = step.motion(v)
            a_J = Motion(still, still) if a is None else step.motion(a)
            w, l = v_J.angular, v_J.linear
            tangential = cross(w, c)
            c2 = c2 + cross(w, 2.0 * c1 + tangential) + cross(a_J.angular, c)
            c2 = c2 + m * (a_J.linear + cross(w, l))
            c1 = c1 + tangential + m * l
        R, J = step.placement.rotation, step.transform(q).rotation
        rates = (apply(R, apply(J, x)) for x in (c1, c2))
        return FirstMoment(_position(step, m, c, q), *rates)

    values = [FirstMoment(c, still, still) for c in firsts]
    return sum_in_world(tree, values, FirstMoment(ground, still, still), move)


def _position(step: Step, m: Any, c: Array, q: Array) -> Array:
    """R c + m p, without the constant part of p, which the parent has counted already."""
    J = step.transform(q)
    return apply(step.placement.rotation, apply(J.rotation, c) + m * J.translation)


def _with_child_masses(tree: Sequence[Step], bodies: Sequence[MassMoments]) -> tuple[list[Any], list[Array]]:
    """The masses from every step outward; each body's first moment with its children's masses at their fixed frames."""
    masses, firsts = [body.mass for body in bodies], [body.first for body in bodies]
    for i, step in reversed(list(enumerate(tree))):
        if step.parent >= 0:
            masses[step.parent] = masses[step.parent] + masses[i]
            firsts[step.parent] = firsts[step.parent] + masses[i] * step.placement.translation
    return masses, firsts


def _bodies(model: Model, prepared: PreparedModel, subtree: str | None) -> list[MassMoments]:
    """The bodies that count, nothing for the others."""
    counted = {model.joints[i].name for i in _joints(model, subtree)}
    return [
        body if step.joint.name in counted else MassMoments.zero()
        for step, body in zip(prepared.tree, prepared.body_moments, strict=True)
    ]


def _joints(model: Model, subtree: str | None) -> tuple[int, ...]:
    return model.subtree(-1 if subtree is None else model.joint_index(subtree))


def over_total_mass(model: Model, moment: Array) -> Array:
    """A first moment of all that moves, over its mass.

    Args:
        model: The robot.
        moment: Mass times position, shape (..., 3) [kg m].

    Returns:
        Position, shape (..., 3) [m].

    Raises:
        InputError: there is no mass.
    """
    return moment * _reciprocal(model, None)


def _over_mass(model: Model, subtree: str | None, moment: Array, *inputs: Array) -> Array:
    return moment * _reciprocal(model, subtree) + batch_zeros((3,), *inputs)


def _reciprocal(model: Model, subtree: str | None) -> Any:
    mass = total_mass(model, subtree)
    if not is_symbolic(mass) and not mass > 0.0:
        what = f"What joint {subtree!r} moves" if subtree else f"What moves of {model.name!r}"
        raise InputError(f"{what} has no mass, hence no centre of mass; give its links inertias.")
    return 1.0 / mass
