"""How the momentum about the centre of mass, its rate, and the velocity of that centre change with q, v and a.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| s, psi, chi, phi, B | a column of step i and what it does | | | see inverse_dynamics.py |
| I, h, F | inertia, momentum and force of all bodies from step i on, without gravity | | | |
| u | velocity of the observer of step i, in world axes | (3) | [m/s] | sum of those of inverse_dynamics.py |
| c, m | centre of mass of the robot, its mass | (3), () | [m], [kg] | |
| h_G = (p, n) | momentum about c, in world axes | (6) | [N s, N m s] | |
| F_G = (f, t) | its rate | (6) | [N, N m] | |
| A | centroidal momentum matrix | (6, nv) | | h_G = A v |
| r | column of dh/dv = dF/da = A | Force | | I s |
| dh/dq | column about the moving centre | Force | | I psi + s x* h, and r.linear x (u - p / m) in the moment |
| dF/dq | | Force | | B psi + I chi + s x* F, less r.linear x f / m in the moment |
| dF/dv | | Force | | B s + I phi = 2 (I psi + s x* h) + I (S_i v_i x s) + (0; B^T s) |

Each column is a force in the moving frame of its step, as observed by somebody who moves on evenly with its origin; it
is then written about c along the axes of the world. Forces are the same to that observer; momentum is not, hence u. The
centre moves by dc/dq = r.linear / m. The results belong to the whole robot, so regrouped inertias serve, but for m and
c (see regrouped_moments.py). Derivatives by q are along the tangent space. Source: Orin, Goswami & Lee, Centroidal
dynamics of a humanoid robot (2013), for h_G; Carpentier & Mansard, Analytical Derivatives of Rigid Body Dynamics
Algorithms (2018).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from ulna.algorithms.derivatives.inverse_dynamics import (
    State,
    Subtree,
    column_derivatives,
    states_of_moving_observers,
    subtree_quantities,
)
from ulna.algorithms.dynamics.center_of_mass import first_moment, total_mass
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
    state = states_of_moving_observers(tree, q, v, a, np.zeros(3))
    subtrees = _subtrees(model, q, state)
    share = _reciprocal_mass(model)
    c = first_moment(model, q).position * share
    drift, pull = (force * share for force in _momentum_and_rate(tree, subtrees, state, q))
    observers = _observers(tree, T, state)
    results = [batch_zeros((6, model.nv), q, v, a) for _ in range(4)]
    for i, (step, pose, subtree, u) in enumerate(zip(tree, T, subtrees, observers, strict=True)):
        about = SE3(pose.rotation, pose.translation - c)
        for joint_column in column_derivatives(step, state(i)):
            s, psi = joint_column.s, joint_column.psi
            r = about.act(subtree.body.apply(s))
            dh = about.act(subtree.body.apply(psi) + s.cross(subtree.h))
            dF = about.act(subtree.coriolis(psi) + subtree.body.apply(joint_column.chi) + s.cross(subtree.F))
            rest = subtree.body.apply(step.motion(v).cross(s))
            rest = about.act(rest + Force(np.zeros(3), subtree.coriolis_transposed(s)))
            dF_dv = Force(2.0 * dh.linear + rest.linear, 2.0 * dh.angular + rest.angular)
            dh = Force(dh.linear, dh.angular + cross(r.linear, u - drift))
            dF = Force(dF.linear, dF.angular - cross(r.linear, pull))
            for matrix, column in zip(results, (dh, dF, dF_dv, r), strict=True):
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
        The derivatives with respect to q and v, each of shape (..., 3, nv).
    """
    tree = prepare(model).tree
    T, state = poses(tree, q), states_of_moving_observers(tree, q, v, 0.0 * v, np.zeros(3))
    share = _reciprocal_mass(model)
    by_q, by_v = batch_zeros((3, model.nv), q, v), batch_zeros((3, model.nv), q, v)
    for i, (step, pose, subtree) in enumerate(zip(tree, T, _subtrees(model, q, state), strict=True)):
        for joint_column in column_derivatives(step, state(i)):
            change = subtree.body.apply(joint_column.psi).linear + cross(
                joint_column.s.angular, subtree.h.linear
            )
            column = subtree.body.apply(joint_column.s).linear
            by_q[..., joint_column.index] += apply(pose.rotation, change) * share
            by_v[..., joint_column.index] += apply(pose.rotation, column) * share
    return by_q, by_v


def _subtrees(model: Model, q: Array, state: Callable[[int], State]) -> list[Subtree]:
    """The quantities of all bodies from each step outward, in the order of the steps."""
    prepared = prepare(model)
    quantities = subtree_quantities(model, prepared, prepared.regrouped_moments, state, q)
    return [subtree for _, subtree in quantities][::-1]


def _reciprocal_mass(model: Model) -> Any:
    """1 / m; zero for a robot without mass."""
    mass = total_mass(model)
    return 1.0 / mass if is_symbolic(mass) or mass else 0.0


def _momentum_and_rate(
    tree: Sequence[Step], subtrees: Sequence[Subtree], state: Callable[[int], State], q: Array
) -> tuple[Array, Array]:
    """p and f of all that moves, in the world."""
    p, f = np.zeros(3), np.zeros(3)
    for i, (step, subtree) in enumerate(zip(tree, subtrees, strict=True)):
        if step.parent < 0:
            whole = subtree.to_parent(step, q, state(i).u)
            p, f = p + whole.h.linear, f + whole.F.linear
    return p, f


def _observers(tree: Sequence[Step], T: Sequence[SE3], state: Callable[[int], State]) -> list[Array]:
    """u of every step."""
    observers: list[Array] = []
    for i, step in enumerate(tree):
        u = state(i).u
        observers.append(u if step.parent < 0 else observers[step.parent] + apply(T[step.parent].rotation, u))
    return observers
