"""How the accelerations of forward dynamics change with q, v and tau, in closed form.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| M | mass matrix with armature | (nv, nv) | | crba.py, factored as in factors.py |
| a | acceleration | (nv) | [rad/s^2] or [m/s^2] | forward_dynamics.py |
| da/dq, da/dv | | (nv, nv) | | -M^-1 dtau/dq, -M^-1 dtau/dv, at a |
| da/dtau | | (nv, nv) | | M^-1 |

Source: Carpentier & Mansard, Analytical Derivatives of Rigid Body Dynamics Algorithms (2018), section V:
differentiating tau = ID(q, v, FD(q, v, tau)). The matrix is factored once for the acceleration and all columns: in a
trace equal computations are one.
"""

from __future__ import annotations

from copy import copy

from ulna.algorithms.external import External
from ulna.algorithms.factors import Factors
from ulna.algorithms.forward_dynamics import by_mass_matrix
from ulna.algorithms.inverse_dynamics_derivatives import inverse_dynamics_derivatives
from ulna.algorithms.tree import blank
from ulna.model import Model
from ulna.typing import Array


def forward_dynamics_derivatives(
    model: Model, q: Array, v: Array, tau: Array, external: External = None
) -> tuple[Array, Array, Array]:
    """The derivatives of the accelerations by q, v and tau, each (..., nv, nv); the last is the inverse mass matrix.

    Args:
        model: The robot; every motion must move some mass or have armature.
        q: Configuration, shape (..., nq).
        v: Velocity, shape (..., nv).
        tau: Joint torques, shape (..., nv).
        external: As for `inverse_dynamics_derivatives`.
    """
    a = by_mass_matrix(model, q, v, tau, external)
    tau_q, tau_v, M = inverse_dynamics_derivatives(model, q, v, a, external)
    factors = Factors(M)
    negative = copy(factors)
    negative.reciprocals = [-r for r in factors.reciprocals]
    a_q, a_v = (_solved(negative, by, blank(by.shape[-2:], q, v, tau)) for by in (tau_q, tau_v))
    return a_q, a_v, factors.inverse() + blank((model.nv, model.nv), q, v, tau)


def _solved(factors: Factors, b: Array, into: Array) -> Array:
    """M^-1 b, column by column."""
    for k in range(b.shape[-1]):
        for i, value in enumerate(factors.solve([b[..., j, k] for j in range(b.shape[-2])])):
            into[..., i, k] = value
    return into
