"""How the accelerations of forward dynamics change with q, v and tau, in closed form.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| M | mass matrix with armature | (nv, nv) | | see inverse_dynamics_derivatives.py |
| L, d | its factors, L unit lower triangular | (nv, nv), (nv) | | M = L^T diag(d) L |
| b | torques at rest of the joints' accelerations | (nv) | [N m] or [N] | inverse dynamics at a = 0 |
| a | acceleration | (nv) | [rad/s^2] or [m/s^2] | M a = tau - b |
| da/dq, da/dv | | (nv, nv) | | -M^-1 dtau/dq, -M^-1 dtau/dv at a |
| da/dtau | | (nv, nv) | | M^-1 |

An entry of L is zero where neither of two joints stands on the other: the elimination from the leaves inward fills
nothing in (Featherstone, section 6.5), and such zeros fold away in a trace. Source of the derivatives: Carpentier &
Mansard, Analytical Derivatives of Rigid Body Dynamics Algorithms (2018), section V: differentiating tau = ID(q, v,
FD(q, v, tau)).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ulna.algorithms.inverse_dynamics_derivatives import (
    gather,
    inverse_dynamics_derivatives,
    mass_matrix_of,
    relative_states,
    torques_of,
)
from ulna.algorithms.lumps import felt
from ulna.algorithms.tidy import tidy
from ulna.model import Model
from ulna.numeric import apply, is_symbolic, matrix, vector
from ulna.spatial import Force
from ulna.typing import Array


def forward_dynamics_derivatives(
    model: Model, q: Array, v: Array, tau: Array, external: Sequence[Force | None] | None = None
) -> tuple[Array, Array, Array]:
    """The derivatives of the accelerations by q, v and tau, each (..., nv, nv); the last is the inverse mass matrix.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq).
        v: Velocity, shape (..., nv).
        tau: Joint torques, shape (..., nv).
        external: As for `inverse_dynamics_derivatives`.
    """
    if not model.nv:
        a, by_q, by_v, _ = tau, *inverse_dynamics_derivatives(model, q, v, tau, external)
        return by_q, by_v, by_v
    tidied = tidy(model)
    tree = tidied.tree
    rest = 0.0 * v if not is_symbolic(q, v, tau) else np.zeros(model.nv)
    state = relative_states(tree, q, v, rest, model.gravity)
    beyond = [one for _, one in gather(model, tidied, felt(model, tidied), state, q, external)][::-1]
    bias = torques_of(model, tree, beyond, rest, q, v)
    M = mass_matrix_of(model, tree, beyond, q, v, tau)
    if not is_symbolic(q, v, tau):
        inverse = np.linalg.inv(M)
        a = apply(inverse, tau - bias)
        by_q, by_v, _ = inverse_dynamics_derivatives(model, q, v, a, external)
        return -inverse @ by_q, -inverse @ by_v, inverse
    factors = _Factors(M)
    a = vector(*factors.solve_negative(list(bias - tau)))
    by_q, by_v, _ = inverse_dynamics_derivatives(model, q, v, a, external)
    return factors.solve_negative_matrix(by_q), factors.solve_negative_matrix(by_v), factors.inverse()


class _Factors:
    """-L and -1/d of a matrix of symbols; what is zero is left out."""

    def __init__(self, M: Array) -> None:
        n = len(M)
        rows = [[M[i, j] for j in range(i + 1)] for i in range(n)]
        self.lower: list[dict[int, Any]] = [{} for _ in range(n)]
        self.reciprocals: list[Any] = [None] * n
        for k in reversed(range(n)):
            self.reciprocals[k] = -1.0 / rows[k][k]
            filled = [j for j in range(k) if not _is_zero(rows[k][j])]
            self.lower[k] = {j: rows[k][j] * self.reciprocals[k] for j in filled}
            for i in filled:
                for j in filled:
                    if j <= i:
                        rows[i][j] = rows[i][j] + self.lower[k][i] * rows[k][j]

    def solve_negative(self, b: list[Any], upto: int | None = None) -> list[Any]:
        """x with M x = -b; only its first entries `upto`, where that is given."""
        y = list(b)
        for k in reversed(range(len(b))):
            if not _is_zero(y[k]):
                for j, l in self.lower[k].items():
                    y[j] = y[j] + l * y[k]
        x: list[Any] = []
        for k in range(len(b) if upto is None else upto):
            value = y[k] * self.reciprocals[k]
            for j, l in self.lower[k].items():
                value = value + l * x[j]
            x.append(value)
        return x

    def solve_negative_matrix(self, b: Array) -> Array:
        """The same for every column."""
        columns = [self.solve_negative(list(b[:, k])) for k in range(b.shape[1])]
        return matrix([list(row) for row in zip(*columns, strict=True)])

    def inverse(self) -> Array:
        """M^-1, each of its two equal halves computed once."""
        n = len(self.lower)
        columns = [self.solve_negative([-1.0 if i == k else 0.0 for i in range(n)], k + 1) for k in range(n)]
        return matrix([[columns[max(i, j)][min(i, j)] for j in range(n)] for i in range(n)])


def _is_zero(x: Any) -> bool:
    return isinstance(x, (int, float)) and x == 0.0
