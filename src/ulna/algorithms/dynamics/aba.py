"""Forward dynamics by the articulated-body algorithm, in the form of Featherstone 2008, table 7.1.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| X | motion transform, parent's to step's moving frame (tree.py: Ad(X)^-1); X^T takes forces back | (6, 6) | | |
| S | motion subspace in the moving frame, constant | (6, n) | [1] or [m/rad] | |
| V, c | velocity of the body; velocity-product acceleration | (6) | | c = V x S v |
| I^A, p^A | articulated-body inertia, bias force | (6, 6), (6) | | I, V x* I V - f_x, plus those of the children |
| U, D, u | | (6, n), (n, n), (n) | | U = I^A S, D = S^T U + armature, u = tau - S^T p^A |
| I^a, p^a | what the parent receives | (6, 6), (6) | | I^a = I^A - U D^-1 U^T, p^a = p^A + I^a c + U D^-1 u |
| a' | acceleration of the body for zero joint acceleration, `a_free` | (6) | | a' = X A_p + c, A_0 = -g |
| a | joint acceleration | (n) | [rad/s^2] or [m/s^2] | a = D^-1 (u - U^T a'), A = a' + S a |

Source: Featherstone 2008, section 7.3, table 7.1. This is the form to read, and the reference of the tests. The one
that is compiled is aba_relative_accelerations.py, which works on blocks of (3, 3) and one column of S at a time.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ulna.algorithms.dynamics.aba_relative_accelerations import check_no_mimics
from ulna.algorithms.dynamics.mass_matrix_factors import ZeroPivot, is_zero
from ulna.algorithms.multibody.batch_shapes import batch_zeros
from ulna.algorithms.multibody.body_motions import body_velocities
from ulna.algorithms.multibody.external_forces import External, at_steps
from ulna.algorithms.multibody.mass_moments import body_moments
from ulna.algorithms.multibody.tree import Step, steps
from ulna.linalg import inverse
from ulna.model import Model
from ulna.numeric import apply
from ulna.typing import Array


class _Joint(NamedTuple):
    """Quantities of a joint that the outward pass uses."""

    S: Array
    U: Array
    D_inv: Array
    u: Array


def aba(model: Model, q: Array, v: Array, tau: Array, external: External = None) -> Array:
    """The joint accelerations (Featherstone 2008, table 7.1).

    Args:
        model: The robot, without mimic joints.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].
        tau: Joint torques, shape (..., nv) [N m, N].
        external: For each joint the force on its body, in its moving frame, as `external_forces.at_joints` returns
            them [N, N m]; None for none.

    Returns:
        Joint accelerations, shape (..., nv) [rad/s^2, m/s^2].

    Raises:
        InputError: The model has mimic joints; `forward_dynamics` takes them.
        ZeroPivot: An entry of the diagonal of D is zero, whatever the inputs. Another singular D is not found.
    """
    check_no_mimics(model)
    tree = steps(model)
    V, I, f_x = body_velocities(tree, q, v), body_moments(model, tree), at_steps(model, tree, external)
    X = [(step.placement @ step.transform(q)).inverse().adjoint() for step in tree]
    c = [V_i.cross(step.motion(v)).vector() for step, V_i in zip(tree, V, strict=True)]
    I_A = [I_i.matrix() for I_i in I]
    p_A = [(V_i.cross(I_i.apply(V_i)) - f).vector() for I_i, V_i, f in zip(I, V, f_x, strict=True)]

    joints: dict[int, _Joint] = {}
    for i, step in reversed(list(enumerate(tree))):
        joints[i] = S, U, D_inv, u = _joint(step, I_A[i], p_A[i], tau, model.armature)
        if step.parent >= 0:
            I_a = I_A[i] - U @ D_inv @ U.mT
            p_a = p_A[i] + apply(I_a, c[i]) + apply(U @ D_inv, u)
            I_A[step.parent] = I_A[step.parent] + X[i].mT @ I_a @ X[i]
            p_A[step.parent] = p_A[step.parent] + apply(X[i].mT, p_a)

    a, A = batch_zeros((model.nv,), q, v, tau, external), []
    A_0 = np.concatenate([-np.asarray(model.gravity), np.zeros(3)])
    for i, step in enumerate(tree):
        S, U, D_inv, u = joints[i]
        a_free = apply(X[i], A[step.parent] if step.parent >= 0 else A_0) + c[i]
        a_i = apply(D_inv, u - apply(U.mT, a_free))
        a[..., list(step.indices)] = a_i
        A.append(a_free + apply(S, a_i))
    return a


def _joint(step: Step, I_A: Array, p_A: Array, tau: Array, armature: Array) -> _Joint:
    """S, U, D^-1 and u of a step."""
    indices = list(step.indices)
    S = np.stack([s.vector() for s in step.subspace()], axis=-1)
    U = I_A @ S
    D = S.T @ U + np.diag(armature[indices])
    for k, index in enumerate(indices):
        if is_zero(D[..., k, k]):
            raise ZeroPivot(index)
    return _Joint(S, U, inverse(D), tau[..., indices] - apply(S.T, p_A))
