"""How the accelerations of forward dynamics change with q, v and tau, in closed form.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| M | mass matrix with armature | (nv, nv) | | crba.py, factored as in mass_matrix_factors.py |
| a | acceleration | (nv) | [rad/s^2] or [m/s^2] | forward_dynamics.py |
| da/dq, da/dv | | (nv, nv) | | -M^-1 dtau/dq, -M^-1 dtau/dv, at a |
| da/dtau | | (nv, nv) | | M^-1 |
| E, d | factors of the inverse | (nv, nv), (nv) | | M^-1 = E diag(1 / d) E^T |

Source: Carpentier & Mansard, Analytical Derivatives of Rigid Body Dynamics Algorithms (2018), section V:
differentiating tau = ID(q, v, FD(q, v, tau)). The matrix is factored once for the acceleration and all columns: in a
trace equal computations are one.
"""

from __future__ import annotations

from typing import Any

from ulna.algorithms.derivatives.inverse_dynamics import inverse_dynamics_derivatives
from ulna.algorithms.dynamics.forward_dynamics import by_mass_matrix
from ulna.algorithms.dynamics.mass_matrix_factors import Factors, is_zero
from ulna.algorithms.multibody.batch_shapes import batch_zeros
from ulna.algorithms.multibody.external_forces import External
from ulna.compiler.forms.columns import Columns
from ulna.model import Model
from ulna.typing import Array


def forward_dynamics_derivatives(
    model: Model, q: Array, v: Array, tau: Array, external: External = None
) -> tuple[Array, Array, Array]:
    """The derivatives of the joint accelerations (Carpentier & Mansard 2018, section III).

    Args:
        model: The robot; every motion must move some mass or have armature.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].
        tau: Joint torques, shape (..., nv) [N m, N].
        external: As for `inverse_dynamics_derivatives`.

    Returns:
        The derivatives with respect to q, v and tau, each of shape (..., nv, nv); the last is the inverse mass matrix.
    """
    a = by_mass_matrix(model, q, v, tau, external)
    a_q, a_v, a_tau, *_ = derivatives_at_acceleration(model, q, v, a, external)
    return a_q, a_v, a_tau


def derivatives_at_acceleration(
    model: Model, q: Array, v: Array, a: Array, external: External = None
) -> tuple[Array, ...]:
    """The same where the accelerations are known and the torques are not.

    Args:
        model: The robot; every motion must move some mass or have armature.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].
        a: Acceleration, shape (..., nv) [rad/s^2, m/s^2].
        external: As for `inverse_dynamics_derivatives`.

    Returns:
        The derivatives of the accelerations with respect to q, v and tau, and those of inverse dynamics with respect to
        q and v, each of shape (..., nv, nv).
    """
    tau_q, tau_v, M = inverse_dynamics_derivatives(model, q, v, a, external)
    factors = Factors(M)
    a_q, a_v = (
        _negative(factors, by, batch_zeros(by.shape[-2:], q, v, a, external)) for by in (tau_q, tau_v)
    )
    inverse = factors.inverse() + batch_zeros((model.nv, model.nv), q, v, a, external)
    return a_q, a_v, inverse, tau_q, tau_v


def columns_of_derivatives(
    model: Model, q: Array, v: Array, tau: Array, external: External = None
) -> Columns:
    """The derivatives of the joint accelerations as solutions of M x = b, column by column, for one sample.

    Args:
        model: The robot; every motion must move some mass or have armature.
        q: Configuration, shape (nq,) [rad, m].
        v: Velocity, shape (nv,) [rad/s, m/s].
        tau: Joint torques, shape (nv,) [N m, N].
        external: As for `inverse_dynamics_derivatives`.

    Returns:
        The factors of M, and the right-hand sides: dtau/dq, dtau/dv and minus the unit matrix, with sign -1.
    """
    a = by_mass_matrix(model, q, v, tau, external)
    tau_q, tau_v, M = inverse_dynamics_derivatives(model, q, v, a, external)
    return Factors(M).columns([tau_q, tau_v, -1.0], sign=-1.0)


def _negative(factors: Factors, b: Array, into: Array) -> Array:
    """-M^-1 b = -E diag(1 / d) E^T b.

    A column of b is zero except for the ancestors and descendants of its joint, and so is E^T b; an entry of the
    result is then a sum over the common ancestors of two joints, fewer terms than in an elimination.
    """
    E = factors.unit_inverse()
    negative = [-r for r in factors.reciprocals]
    n = b.shape[-1]
    for k in range(n):
        z: dict[int, Any] = {}
        for i in range(n):
            x = b[..., i, k]
            if not is_zero(x):
                for j, e in [(i, 1.0), *E[i].items()]:
                    z[j] = z[j] + e * x if j in z else e * x
        z = {j: x * negative[j] for j, x in z.items()}
        for i in range(n):
            total = z.get(i, 0.0)
            for j, e in E[i].items():
                if j in z:
                    total = total + e * z[j]
            into[..., i, k] = total
    return into
