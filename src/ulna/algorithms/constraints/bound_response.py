"""How accelerations and forces change with the residuals; the symbols are those of dynamics_derivatives.py."""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from typing import Any, NamedTuple

import numpy as np

from ulna import numeric
from ulna.algorithms.constraints.damped_dynamics import damped_factors
from ulna.algorithms.constraints.dynamics import delassus_of, solve_transposed_columns
from ulna.algorithms.constraints.dynamics_derivatives import BoundTerms
from ulna.algorithms.dynamics.mass_matrix_factors import Factors
from ulna.numeric import matrix, vector
from ulna.typing import Array

_MAX_ITERATIONS = 2**30
"""Rounds at most."""


class BoundResponse(NamedTuple):
    """How a bound robot answers to changes of what is left of dynamics and constraints."""

    W: Array
    """(nv + m, nv + m)."""
    B: Array
    """(nv + m, 2 nv)."""
    X_q: Array
    """What turning the forces adds to df/dq, (m, nv)."""
    a_tau: Array
    """da/dtau, (nv, nv)."""
    f_tau: Array
    """df/dtau, (m, nv)."""
    S: Array
    """The inverse of the damped Delassus matrix, along the axes of the constraints, (m, m)."""
    unique: Any
    """Above 0 where no constraint depends on others; elsewhere their forces are not unique, and have no derivatives."""


def bound_response(terms: BoundTerms, mu: Any = 0.0, rounds: Any = 1) -> BoundResponse:
    """How accelerations and forces of damped constrained dynamics respond to changes of the residuals.

    Args:
        terms: The derivatives of the residuals.
        mu: Damping [1/kg].
        rounds: The number of rounds that the solver makes.

    Returns:
        The response, and the derivatives with respect to tau.
    """
    m, n = terms.J.shape
    factors = Factors(terms.M)
    Y = solve_transposed_columns(factors, terms.J)
    MJ = [factors.outward(column.get(k, 0.0) * r for k, r in enumerate(factors.reciprocals)) for column in Y]
    of_forces = damped_factors(delassus_of(factors, Y), vector(*[mu] * m))
    S = of_forces.inverse()
    P = _after(S, mu, rounds)
    N = P @ matrix(MJ)
    rows = [list(row) for row in factors.inverse()]
    for i in range(n):
        for j in range(i + 1):
            rows[i][j] = rows[j][i] = rows[i][j] - sum(MJ[k][i] * N[k, j] for k in range(m))
    K, X = matrix(rows), terms.X
    XN = X @ N
    W = np.concatenate([np.concatenate([-K, -N.T], axis=1), np.concatenate([XN, -(X @ P)], axis=1)])
    by_q, by_v = np.concatenate([terms.r_q, terms.g_q]), np.concatenate([terms.r_v, terms.g_v])
    B = np.concatenate([by_q, by_v], axis=1)
    return BoundResponse(W, B, terms.X_q, K, -XN, X @ S @ X.T, reduce(numeric.minimum, of_forces.reciprocals))


def _after(S: Array, mu: Any, rounds: Any) -> Array:
    """P, symmetric as S is."""
    m = len(S)
    places = [(i, j) for i in range(m) for j in range(i + 1)]

    def symmetric(state: Sequence[Any]) -> list[list[Any]]:
        rows: list[list[Any]] = [[0.0] * m for _ in range(m)]
        for (i, j), entry in zip(places, state, strict=False):
            rows[i][j] = rows[j][i] = entry
        return rows

    def step(*state: Any) -> tuple[Any, ...]:
        P = symmetric(state)
        return (
            *(S[i, j] + mu * sum(S[i, k] * P[k][j] for k in range(m)) for i, j in places),
            state[-1] + 1.0,
        )

    start = (*(S[i, j] for i, j in places), 1.0)
    return matrix(
        symmetric(numeric.loop(lambda *state: numeric.less(state[-1], rounds), step, start, _MAX_ITERATIONS))
    )
