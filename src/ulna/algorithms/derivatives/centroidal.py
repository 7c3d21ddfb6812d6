"""How the momentum about the centre of mass, its rate, and the velocity of that centre change with q, v and a.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| s, psi, chi, phi, B | a column of step i and what it does | | | see inverse_dynamics.py |
| I, h, F | inertia, momentum and force of all bodies from step i on, without gravity | | | |
| c, m | centre of mass of the robot, its mass | (3), () | [m], [kg] | |
| h_G = (p, n) | momentum about c, in world axes | (6) | [N s, N m s] | |
| F_G = (f, t) | its rate | (6) | [N, N m] | |
| A | centroidal momentum matrix | (6, nv) | | h_G = A v |
| dh/dq | column about the moving centre | Force | | I psi + s x* h, less dc/dq x p in the moment |
| dF/dq | | Force | | B psi + I chi + s x* F, less dc/dq x f in the moment |
| dF/dv, dh/dv = dF/da | | Force | | B s + I phi, I s |
| dc/dq | | (3) | | linear part of I s, over m |

Each column is a force in the moving frame of its step; it is then written about c along the axes of the world.
Derivatives by q are along the tangent space. Source: Orin, Goswami & Lee, Centroidal dynamics of a humanoid robot
(2013), for h_G; Carpentier & Mansard, Analytical Derivatives of Rigid Body Dynamics Algorithms (2018).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ulna.algorithms.derivatives.inverse_dynamics import (
    Subtree,
    column_derivatives,
    states,
    subtree_quantities,
)
from ulna.algorithms.multibody.batch_shapes import batch_zeros
from ulna.algorithms.multibody.prepared_model import prepare
from ulna.algorithms.multibody.tree import Step, poses
from ulna.model import Model
from ulna.numeric import apply, cross, is_symbolic
from ulna.spatial import SE3, Force
from ulna.typing import Array


def centroidal_derivatives(model: Model, q: Array, v: Array, a: Array) -> tuple[Array, Array, Array, Array]:
    """The derivatives of momentum and its rate.

    The momentum is that about the centre of mass along the axes of the world, linear part first. Bodies that no joint
    moves do not count.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].
        a: Acceleration, shape (..., nv) [rad/s^2, m/s^2].

    Returns:
        dh/dq, dF/dq, dF/dv and dF/da, each of shape (..., 6, nv); the last is also dh/dv.
    """
    prepared = prepare(model)
    tree, T = prepared.tree, poses(prepared.tree, q)
    state = states(tree, q, v, a, np.zeros(3))
    subtrees = [one for _, one in subtree_quantities(model, prepared, prepared.body_moments, state, q)][::-1]
    mass, centre, h, F = _totals(tree, T, subtrees)
    share = 1.0 / mass if is_symbolic(mass) or mass else 0.0
    results = [batch_zeros((6, model.nv), q, v, a) for _ in range(4)]
    for i, (step, pose, subtree) in enumerate(zip(tree, T, subtrees, strict=True)):
        about = SE3(pose.rotation, pose.translation - centre)
        for joint_column in column_derivatives(step, state(i)):
            s, psi = joint_column.s, joint_column.psi
            unit = about.act(subtree.body.apply(s))
            c = unit.linear * share
            dh = about.act(subtree.body.apply(psi) + s.cross(subtree.h))
            dF = about.act(subtree.coriolis(psi) + subtree.body.apply(joint_column.chi) + s.cross(subtree.F))
            dF_dv = about.act(subtree.coriolis(s) + subtree.body.apply(joint_column.phi))
            dh = Force(dh.linear, dh.angular - cross(c, h.linear))
            dF = Force(dF.linear, dF.angular - cross(c, F.linear))
            for matrix, column in zip(results, (dh, dF, dF_dv, unit), strict=True):
                matrix[..., :3, joint_column.index] += column.linear
                matrix[..., 3:, joint_column.index] += column.angular
    dh_dq, dF_dq, dF_dv, dF_da = results
    return dh_dq, dF_dq, dF_dv, dF_da


def com_velocity_derivatives(model: Model, q: Array, v: Array) -> tuple[Array, Array]:
    """The derivatives of the velocity of the centre of mass, in world axes.

    Args:
        model: The robot; a robot without mass has zeros here.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].

    Returns:
        The derivatives by q and by v, each of shape (..., 3, nv).
    """
    prepared = prepare(model)
    tree, T = prepared.tree, poses(prepared.tree, q)
    state = states(tree, q, v, 0.0 * v, np.zeros(3))
    subtrees = [one for _, one in subtree_quantities(model, prepared, prepared.body_moments, state, q)][::-1]
    mass = sum(subtree.body.mass for step, subtree in zip(tree, subtrees, strict=True) if step.parent < 0)
    share = 1.0 / mass if is_symbolic(mass) or mass else 0.0
    by_q, by_v = batch_zeros((3, model.nv), q, v), batch_zeros((3, model.nv), q, v)
    for i, (step, pose, subtree) in enumerate(zip(tree, T, subtrees, strict=True)):
        for joint_column in column_derivatives(step, state(i)):
            change = subtree.body.apply(joint_column.psi).linear + cross(
                joint_column.s.angular, subtree.h.linear
            )
            column = subtree.body.apply(joint_column.s).linear
            by_q[..., joint_column.index] += apply(pose.rotation, change) * share
            by_v[..., joint_column.index] += apply(pose.rotation, column) * share
    return by_q, by_v


def _totals(
    tree: Sequence[Step], T: Sequence[SE3], subtrees: Sequence[Subtree]
) -> tuple[Any, Array, Force, Force]:
    """Of all that moves the mass, the centre, and momentum and force about the world's origin, in the world."""
    mass: Any = 0.0
    first, h, F = np.zeros(3), Force.zero(), Force.zero()
    for step, pose, subtree in zip(tree, T, subtrees, strict=True):
        if step.parent < 0:
            body = subtree.body
            mass = mass + body.mass
            first = first + apply(pose.rotation, body.first) + pose.translation * body.mass
            h, F = h + pose.act(subtree.h), F + pose.act(subtree.F)
    if not is_symbolic(mass) and not mass:
        return mass, first, h, F
    return mass, first * (1.0 / mass), h, F
