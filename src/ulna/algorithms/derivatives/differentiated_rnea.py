"""The derivatives of inverse and forward dynamics: the lines of the recursive Newton-Euler algorithm, differentiated.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| V, A, f, v_J | as in rnea.py; V', A' of a locked joint | Motion, Force | | V' = X^-1 V_p, A' = X^-1 A_p |
| dq, dv, da | direction, a velocity in the tangent space for q | (nv) | | |
| s | joint motion along dq | Motion | | s = S dq, so that dX = X [s x] and d(X^-1) = -[s x] X^-1 |
| dV | derivative of V along the direction | Motion | | X^-1 dV_p + V' x s + S dv |
| dA | | Motion | | X^-1 dA_p + A' x s + S da + dV x v_J + V x S dv |
| df | | Force | | I dA + dV x* I V + V x* I dV, plus X (df + s x* f) of its children |
| dtau | | (nv) | | S^T df, plus armature times da |

Source: Featherstone 2008, table 5.1, differentiated; Carpentier & Mansard, Analytical Derivatives of Rigid Body
Dynamics Algorithms (2018), section III. This is the form to read, and the reference of the tests: one direction at a
time. What is compiled is inverse_dynamics.py, which finds the entries of all columns in one pass over the tree, and
forward_dynamics.py; `tests/laws/test_textbook_dynamics_laws.py` shows that they are equal.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from ulna.algorithms.dynamics.aba import aba
from ulna.algorithms.multibody.batch_shapes import batch_zeros
from ulna.algorithms.multibody.external_forces import External, at_steps
from ulna.algorithms.multibody.mass_moments import body_moments
from ulna.algorithms.multibody.tree import Step, inward, outward, steps
from ulna.linalg import inverse
from ulna.model import Model
from ulna.spatial import Force, Motion
from ulna.typing import Array


class _Motions(NamedTuple):
    """V, A, dV and dA of a body."""

    V: Motion
    A: Motion
    dV: Motion
    dA: Motion


class _Forces(NamedTuple):
    """f and df at a step; those in one frame are added."""

    f: Force
    df: Force

    def __add__(self, other: Any) -> _Forces:
        return _Forces(self.f + other.f, self.df + other.df)


def _rnea_differential(
    model: Model, q: Array, v: Array, a: Array, direction: Sequence[Array], external: External = None
) -> Array:
    """The derivative of the torques of inverse dynamics along one direction, shape (..., nv).

    Args:
        model: The robot.
        q: Configuration, shape (..., nq).
        v: Velocity, shape (..., nv).
        a: Acceleration, shape (..., nv).
        direction: dq, dv and da, each (..., nv).
        external: Forces on the bodies, fixed in them.
    """
    tree, (dq, dv, da) = steps(model), direction

    def motion(step: Step, parent: _Motions) -> _Motions:
        V_, A_, dV_, dA_ = (step.motion_from_parent(x, q) for x in parent)
        s, v_J, dv_J = step.motion(dq), step.motion(v), step.motion(dv)
        V, dV = V_ + v_J, dV_ + V_.cross(s) + dv_J
        A = A_ + step.motion(a) + V.cross(v_J)
        dA = dA_ + A_.cross(s) + step.motion(da) + dV.cross(v_J) + V.cross(dv_J)
        return _Motions(V, A, dV, dA)

    def to_parent(step: Step, forces: _Forces) -> _Forces:
        df = forces.df + step.motion(dq).cross(forces.f)
        return _Forces(step.force_to_parent(forces.f, q), step.force_to_parent(df, q))

    zero, A_0 = Motion.zero(), Motion(-np.asarray(model.gravity), np.zeros(3))
    motions = outward(tree, _Motions(zero, A_0, zero, zero), motion)
    forces: list[_Forces] = []
    for I, (V, A, dV, dA), f_x in zip(
        body_moments(model, tree), motions, at_steps(model, tree, external), strict=True
    ):
        f = I.apply(A) + V.cross(I.apply(V)) - f_x
        forces.append(_Forces(f, I.apply(dA) + dV.cross(I.apply(V)) + V.cross(I.apply(dV))))
    dtau = batch_zeros((model.nv,), q, v, a, external)
    for step, (_, df) in zip(tree, inward(tree, forces, to_parent), strict=True):
        for k, s in step.columns():
            dtau[..., k] += s.dot(df)
    return dtau + da * model.armature


def rnea_derivatives(
    model: Model, q: Array, v: Array, a: Array, external: External = None
) -> tuple[Array, Array, Array]:
    """The derivatives of the torques of `rnea`, column by column.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].
        a: Acceleration, shape (..., nv) [rad/s^2, m/s^2].
        external: Forces on the bodies, fixed in them [N, N m]; None for none.

    Returns:
        The derivatives with respect to q, v and a, each of shape (..., nv, nv); the last is the mass matrix.
    """
    by_q, by_v, by_a = (batch_zeros((model.nv, model.nv), q, v, a, external) for _ in range(3))
    zero = np.zeros(model.nv)
    for k, e in enumerate(np.eye(model.nv)):
        by_q[..., k] = _rnea_differential(model, q, v, a, (e, zero, zero), external)
        by_v[..., k] = _rnea_differential(model, q, v, a, (zero, e, zero), external)
        by_a[..., k] = _rnea_differential(model, q, v, a, (zero, zero, e), external)
    return by_q, by_v, by_a


def aba_derivatives(
    model: Model, q: Array, v: Array, tau: Array, external: External = None
) -> tuple[Array, Array, Array]:
    """The derivatives of the joint accelerations of `aba`.

    They follow from tau = ID(q, v, FD(q, v, tau)): -M^-1 dtau/dq, -M^-1 dtau/dv and M^-1.

    Args:
        model: The robot, without mimic joints.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].
        tau: Joint torques, shape (..., nv) [N m, N].
        external: Forces on the bodies, fixed in them [N, N m]; None for none.

    Returns:
        The derivatives with respect to q, v and tau, each of shape (..., nv, nv).
    """
    a = aba(model, q, v, tau, external)
    tau_q, tau_v, M = rnea_derivatives(model, q, v, a, external)
    M_inv = inverse(M)
    return -(M_inv @ tau_q), -(M_inv @ tau_v), M_inv
