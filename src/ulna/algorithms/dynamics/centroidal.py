"""The momentum about the centre of mass, its matrix, and how both change.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| T_i | pose of the moving frame of step i in the world | SE3 | [m] | |
| c | centre of mass of all moving bodies | (3) | [m] | see center_of_mass.py |
| G_i | pose of step i in the centroidal frame (origin c, world axes): (R_i, p_i - c) | SE3 | [m] | |
| I, h, D | composite inertia, momentum, rate of the second moment of step i | MovingBodies | | see coriolis.py |
| A | centroidal momentum matrix; its column for s | (6, nv) | | G_i I s, or of fixed frames, where s is the same |
| h_G | centroidal momentum, linear part first, in world axes | (6) | [N s, N m s] | A v |
| dA/dt | its column for s | (6, nv) | | G_i (I (V_i x s) + dI/dt s) - (0; dc/dt x f), f = linear of A's column |
| I_G | locked rotational inertia about c, in world axes | (3, 3) | [kg m^2] | that about 0, minus that of m in c |
| dh_G/dt | rate of the momentum | (6) | [N, N m] | forces of inverse dynamics without gravity, about c; A a + dA/dt v |

Source: Orin, Goswami & Lee, Centroidal dynamics of a humanoid robot (2013); Wensing & Orin, Improved computation of the
humanoid centroidal dynamics (2016). The momentum is that of all that moves, and neither it nor A change when inertia
is regrouped (see regrouped_moments.py): those inertias are used. A robot without mass has no centre.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ulna.algorithms.dynamics.center_of_mass import (
    center_of_mass,
    center_of_mass_velocity,
    over_total_mass,
)
from ulna.algorithms.dynamics.coriolis import MovingBodies
from ulna.algorithms.dynamics.crba import composite_moments
from ulna.algorithms.dynamics.rnea_point_accelerations import newton_euler, point_motions
from ulna.algorithms.multibody.batch_shapes import add_column, batch_zeros
from ulna.algorithms.multibody.body_motions import body_velocities
from ulna.algorithms.multibody.mass_moments import MassMoments, in_fixed_frame, in_parent_frame, steiner
from ulna.algorithms.multibody.prepared_model import PreparedModel, prepare
from ulna.algorithms.multibody.tree import Step, inward, outward, sum_in_world
from ulna.model import FreeFlyer, Model
from ulna.numeric import apply, cross
from ulna.spatial import SE3, Force
from ulna.typing import Array


def centroidal_matrix(model: Model, q: Array) -> Array:
    """The centroidal momentum matrix: `A @ v` is the momentum about the centre of mass, in world axes.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].

    Returns:
        A, shape (..., 6, nv), linear part first.
    """
    prepared = prepare(model)
    tree = prepared.tree
    subtrees = composite_moments(tree, prepared.regrouped_moments, q)
    A = batch_zeros((6, model.nv), q)
    G = _centred(prepared, subtrees, q)
    for i, (step, body) in enumerate(zip(tree, subtrees, strict=True)):
        frame, inertia = G[i], body
        if step.moves_along_one_screw:  # the fixed frame depends on one position less
            frame, inertia = G[step.parent] @ step.placement, in_fixed_frame(step, body, q)
        for k, s in step.columns():
            add_column(A, k, frame.act(inertia.apply(s)))
    return A


def centroidal_matrix_dot(model: Model, q: Array, v: Array) -> Array:
    """The time derivative of the centroidal momentum matrix along a velocity.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].

    Returns:
        dA/dt, shape (..., 6, nv), linear part first.
    """
    prepared = prepare(model)
    tree = prepared.tree
    V = body_velocities(tree, q, v)
    moving_bodies = [
        MovingBodies.at(body, twist) for body, twist in zip(prepared.regrouped_moments, V, strict=True)
    ]
    subtrees = inward(tree, moving_bodies, lambda step, moving: moving.to_parent(step, q))
    drift = center_of_mass_velocity(model, q, v)
    A = batch_zeros((6, model.nv), q, v)
    *centred, _ = _centred(prepared, [subtree.body for subtree in subtrees], q)
    for step, subtree, twist, G in zip(tree, subtrees, V, centred, strict=True):
        for k, s in step.columns():
            change = G.act(subtree.body.apply(twist.cross(s)) + subtree.rate(s))
            f = apply(G.rotation, subtree.body.apply(s).linear)
            add_column(A, k, Force(change.linear, change.angular - cross(drift, f)))
    return A


def centroidal_momentum(model: Model, q: Array, v: Array) -> Array:
    """The momentum about the centre of mass, in world axes.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].

    Returns:
        h_G, shape (..., 6) [N s, N m s], linear part first.
    """
    prepared = prepare(model)
    V = body_velocities(prepared.tree, q, v)
    momenta = [body.apply(twist) for body, twist in zip(prepared.regrouped_moments, V, strict=True)]
    return _about_centre(model, prepared.tree, momenta, q) + batch_zeros((6,), q, v)


def centroidal_momentum_rate(model: Model, q: Array, v: Array, a: Array) -> Array:
    """The rate of the momentum about the centre of mass, in world axes: all that acts on the robot, weight included.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].
        a: Acceleration, shape (..., nv) [rad/s^2, m/s^2].

    Returns:
        dh_G/dt, shape (..., 6) [N, N m], linear part first.
    """
    prepared = prepare(model)
    motions = point_motions(prepared.tree, q, v, a, np.zeros(3))
    forces = newton_euler(prepared.regrouped_moments, motions)
    return _about_centre(model, prepared.tree, forces, q) + batch_zeros((6,), q, v, a)


def centroidal_inertia(model: Model, q: Array) -> Array:
    """The locked inertia: the rotational inertia about the centre of mass with all joints locked, in world axes.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].

    Returns:
        I_G, shape (..., 3, 3) [kg m^2].
    """
    prepared = prepare(model)
    total = sum_in_world(
        prepared.tree,
        prepared.body_moments,
        MassMoments.zero(),
        lambda step, body: in_parent_frame(step, body, q),
    )
    about_centre = steiner(total.first, center_of_mass(model, q) * 0.5)
    return total.second - about_centre + batch_zeros((3, 3), q)


def _centred(prepared: PreparedModel, subtrees: Sequence[MassMoments], q: Array) -> list[SE3]:
    """G of every step, then that of the world, the parent -1, whose origin is at -c.

    Nothing depends on the pose of a robot whose root joint is a free flyer that carries all mass: its poses begin at c,
    and that of the world is not needed.
    """
    model, tree = prepared.model, prepared.tree
    if tree and isinstance(tree[0].kind, FreeFlyer) and all(step.parent >= 0 for step in tree[1:]):
        R = tree[0].pose(None, q).rotation
        root = SE3(R, -apply(R, over_total_mass(model, subtrees[0].first)))
        world = SE3.identity()
        return [*outward(tree, world, lambda step, G: root if step.parent < 0 else step.pose(G, q)), world]
    first = prepared.moments_at_rest.first
    for step, body in zip(tree, subtrees, strict=True):
        if step.parent < 0:
            first = first + in_parent_frame(step, body, q).first
    world = SE3(np.eye(3), -over_total_mass(model, first))
    return [*outward(tree, world, lambda step, G: step.pose(G, q)), world]


def _about_centre(model: Model, tree: Sequence[Step], forces: Sequence[Force], q: Array) -> Array:
    """The sum of forces or momenta in the frames of the bodies, about c along the axes of the world, (..., 6)."""
    total = sum_in_world(tree, forces, Force.zero(), lambda step, force: step.force_to_parent(force, q))
    f = total.linear
    return Force(f, total.angular - cross(center_of_mass(model, q), f)).vector()
