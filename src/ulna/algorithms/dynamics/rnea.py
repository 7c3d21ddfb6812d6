"""Inverse dynamics by the recursive Newton-Euler algorithm, as in the book.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| X_i | pose of the moving frame in the parent's | SE3 | [m] | see tree.py |
| S_i | motion subspace in the moving frame, constant | nv Motions | [1] or [m/rad] | |
| v_J | velocity of the joint | Motion | [m/s, rad/s] | v_J = S_i v |
| V_i | velocity of the body | Motion | [m/s, rad/s] | V_i = X_i^-1 V_p + v_J |
| A_i | acceleration of the body, gravity as an upward acceleration of the world | Motion | | |
| | | | | A_i = X_i^-1 A_p + S_i a + V_i x v_J, A_0 = -g |
| I_i | inertia of the body | MassMoments | | |
| f_i | force across the joint | Force | [N, N m] | I_i A_i + V_i x* I_i V_i - f_x, plus X_j f_j of its children |
| tau_i | joint torque | () | [N m] or [N] | S_i^T f_i, plus armature times a |

Source: Featherstone 2008, section 5.3, table 5.1. Each S_i is constant in its moving frame, so c_J = 0. This is the
form to read, and the reference of the tests. The one that is compiled is rnea_point_accelerations.py, which takes fewer
operations; `tests/laws/test_textbook_dynamics_laws.py` shows that the two are equal.
"""

from __future__ import annotations

import numpy as np

from ulna.algorithms.multibody.batch_shapes import batch_zeros
from ulna.algorithms.multibody.external_forces import External, at_steps
from ulna.algorithms.multibody.mass_moments import body_moments
from ulna.algorithms.multibody.tree import Step, inward, outward, steps
from ulna.model import Model
from ulna.spatial import Motion
from ulna.typing import Array


def rnea(model: Model, q: Array, v: Array, a: Array, external: External = None) -> Array:
    """The joint torques that produce the acceleration `a` (Featherstone 2008, table 5.1).

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].
        a: Acceleration, shape (..., nv) [rad/s^2, m/s^2].
        external: Forces on the bodies [N, N m]; None for none.

    Returns:
        Joint torques, shape (..., nv) [N m, N].
    """
    tree = steps(model)

    def motion(step: Step, parent: tuple[Motion, Motion]) -> tuple[Motion, Motion]:
        V_p, A_p = parent
        v_J = step.motion(v)
        V = step.motion_from_parent(V_p, q) + v_J
        A = step.motion_from_parent(A_p, q) + step.motion(a) + V.cross(v_J)
        return V, A

    A_0 = Motion(-np.asarray(model.gravity), np.zeros(3))
    motions = outward(tree, (Motion.zero(), A_0), motion)
    bodies = zip(body_moments(model, tree), motions, at_steps(model, tree, external), strict=True)
    f = [I.apply(A) + V.cross(I.apply(V)) - f_x for I, (V, A), f_x in bodies]
    f = inward(tree, f, lambda step, f_i: step.force_to_parent(f_i, q))

    tau = batch_zeros((model.nv,), q, v, a, external)
    for step, f_i in zip(tree, f, strict=True):
        for k, s in step.columns():
            tau[..., k] += s.dot(f_i)
    return tau + a * model.armature
