"""Centroidal dynamics as in the literature: sums over the bodies, and the recursion of composite rigid bodies.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| T_i | pose of the moving frame of step i in the world | SE3 | [m] | see tree.py |
| c | centre of mass of all that moves | (3) | [m] | sum of the first moments in the world, over the mass |
| X_i | pose of the moving frame in the frame at c along the axes of the world | SE3 | [m] | (R_i, p_i - c) |
| V_i, A_i | velocity and acceleration of body i, without gravity | Motion | | see body_motions.py |
| h_G | centroidal momentum, linear part first | (6) | [N s, N m s] | sum of X_i I_i V_i |
| dh_G/dt | its rate | (6) | [N, N m] | sum of X_i (I_i A_i + V_i x* I_i V_i) |
| A_G | centroidal momentum matrix, h_G = A_G v; its column for s | (6, nv) | | X_i I_i^c s |

Source: Orin, Goswami & Lee, Centroidal dynamics of a humanoid robot (2013), sections 3 and 4. The rate about the moving
centre is that about a fixed point, since the momentum is parallel to the velocity of the centre. This is the form to
read, and the reference of the tests; centroidal.py, which is compiled, takes fewer operations, as
`tests/laws/test_textbook_dynamics_laws.py` shows.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ulna.algorithms.dynamics.crba import composite_moments
from ulna.algorithms.multibody.batch_shapes import add_column, batch_zeros
from ulna.algorithms.multibody.body_motions import body_accelerations, body_velocities
from ulna.algorithms.multibody.mass_moments import MassMoments, body_moments
from ulna.algorithms.multibody.tree import Step, poses, steps
from ulna.model import Model
from ulna.spatial import SE3, Force
from ulna.typing import Array


def momentum_about_com(model: Model, q: Array, v: Array) -> Array:
    """The momentum about the centre of mass, in world axes, as the sum over the bodies.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].

    Returns:
        h_G, shape (..., 6) [N s, N m s], linear part first.
    """
    tree = steps(model)
    I, V = body_moments(model, tree), body_velocities(tree, q, v)
    h = (X_i.act(I_i.apply(V_i)) for X_i, I_i, V_i in zip(_poses_from_com(tree, I, q), I, V, strict=True))
    return sum(h, Force.zero()).vector()


def momentum_rate_about_com(model: Model, q: Array, v: Array, a: Array) -> Array:
    """The rate of the momentum about the centre of mass, in world axes, as the sum over the bodies.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].
        a: Acceleration, shape (..., nv) [rad/s^2, m/s^2].

    Returns:
        dh_G/dt, shape (..., 6) [N, N m], linear part first.
    """
    tree = steps(model)
    I, motions = body_moments(model, tree), body_accelerations(tree, q, v, a)
    rate = Force.zero()
    for X_i, I_i, (V_i, A_i) in zip(_poses_from_com(tree, I, q), I, motions, strict=True):
        rate = rate + X_i.act(I_i.apply(A_i) + V_i.cross(I_i.apply(V_i)))
    return rate.vector()


def momentum_matrix_about_com(model: Model, q: Array) -> Array:
    """The centroidal momentum matrix, column by column.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].

    Returns:
        A_G, shape (..., 6, nv), linear part first.
    """
    tree = steps(model)
    I = body_moments(model, tree)
    A_G = batch_zeros((6, model.nv), q)
    for step, I_c, X_i in zip(tree, composite_moments(tree, I, q), _poses_from_com(tree, I, q), strict=True):
        for k, s in step.columns():
            add_column(A_G, k, X_i.act(I_c.apply(s)))
    return A_G


def _poses_from_com(tree: Sequence[Step], I: Sequence[MassMoments], q: Array) -> list[SE3]:
    """X of every step."""
    T = poses(tree, q)
    total = sum((I_i.to_outer_frame(T_i) for I_i, T_i in zip(I, T, strict=True)), MassMoments.zero())
    c = total.first / np.asarray(total.mass)
    return [SE3(T_i.rotation, T_i.translation - c) for T_i in T]
