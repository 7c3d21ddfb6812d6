"""How accelerations and forces under constraints change with q, v and tau, column by column.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| r, g | derivatives of the residuals of dynamics and of constraints | (nv), (m) | | dynamics_derivatives.py; X g |
| X | rotates forces from the axes of first frames to those of their constraint; blocks of 3 x 3 | (m, m) | | |
| L, D | factors of the mass matrix | (nv, nv), (nv) | | M = L^T D L |
| Y | J^T, solved by the factor L^T | (nv, m) | | Y = L^-T J^T |
| S | inverse of the Delassus matrix | (m, m) | | (Y^T D^-1 Y)^-1 |
| z | | (nv) | | z = L^-T r |
| f' | change of the forces, their axes held | (m) | | f' = S (Y^T D^-1 z - g) |
| da | change of the accelerations | (nv) | | L da = D^-1 (Y f' - z) |
| df | change of the forces; X_q is what the turning of their axes adds | (m) | | f' + X_q |

Source: Carpentier & Mansard 2018, section III; Budhiraja, Carpentier & Mansard 2019, section III.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

import numpy as np

from ulna import numeric
from ulna.algorithms.constraints.damped_dynamics import are_unique, damped_factors
from ulna.algorithms.constraints.dynamics import (
    Product,
    constrained_response,
    delassus_of,
    solve_transposed_columns,
)
from ulna.algorithms.constraints.dynamics_derivatives import BoundTerms, bound_terms
from ulna.algorithms.constraints.frame_errors import frame_of
from ulna.algorithms.constraints.kinematics import constraint_bias, constraint_jacobian
from ulna.algorithms.derivatives.velocity import frame_velocity_derivatives
from ulna.algorithms.dynamics.crba import mass_matrix
from ulna.algorithms.dynamics.mass_matrix_factors import Factors, is_zero
from ulna.algorithms.dynamics.rnea_point_accelerations import bias_forces
from ulna.algorithms.kinematics.forward_kinematics import frame_velocity
from ulna.algorithms.multibody.batch_shapes import batch_zeros
from ulna.compiler.forms.columns import Columns
from ulna.errors import InputError
from ulna.model import Model
from ulna.model.constraint import End, FramePair
from ulna.numeric import matrix, skew, vector
from ulna.spatial import SE3
from ulna.typing import Array


class ConstrainedDerivatives(NamedTuple):
    """Derivatives of accelerations and forces of a robot under constraints."""

    a_q: Any
    """Accelerations by q, (..., nv, nv)."""
    a_v: Any
    """Accelerations by v, (..., nv, nv)."""
    a_tau: Any
    """Accelerations by tau, (..., nv, nv)."""
    forces_q: Any
    """Constraint forces by q, (..., m, nv)."""
    forces_v: Any
    """Constraint forces by v, (..., m, nv)."""
    forces_tau: Any
    """Constraint forces by tau, (..., m, nv)."""


class BoundSolver(NamedTuple):
    """What all columns share."""

    factors: Factors
    Y: Sequence[dict[int, Any]]
    S: Array

    def table(self) -> list[Any]:
        """The numbers, in the order in which `of` reads them."""
        lower = [row[j] for row in self.factors.lower for j in sorted(row)]
        Y = [row[j] for row in self.Y for j in sorted(row)]
        halves = [self.S[i, j] for i in range(len(self.Y)) for j in range(i + 1)]
        return [*lower, *self.factors.reciprocals, *Y, *halves]

    def of(self, table: Iterable[Any]) -> BoundSolver:
        """The same with other numbers."""
        entries = iter(table)
        lower = [{j: next(entries) for j in sorted(row)} for row in self.factors.lower]
        reciprocals = [next(entries) for _ in self.factors.reciprocals]
        Y = [{j: next(entries) for j in sorted(row)} for row in self.Y]
        S = np.zeros((len(Y), len(Y)), dtype=object)
        for i in range(len(Y)):
            for j in range(i + 1):
                S[i, j] = S[j, i] = next(entries)
        return BoundSolver(Factors.of(lower, reciprocals), Y, S)

    def answer(self, column: Sequence[Any]) -> list[Any]:
        """da and df for r, g and a column of X_q."""
        n, m = len(self.factors.reciprocals), len(self.Y)
        z, reciprocals = self.factors.inward(column[:n]), self.factors.reciprocals
        scaled = [0.0 if is_zero(x) else x * r for x, r in zip(z, reciprocals, strict=True)]
        t = [
            _sparse_dot(-column[n + k], ((y, scaled[j]) for j, y in row.items()))
            for k, row in enumerate(self.Y)
        ]
        f = [_sparse_dot(0.0, zip(self.S[k], t, strict=True)) for k in range(m)]
        for k, row in enumerate(self.Y):
            for j, y in row.items():
                z[j] = z[j] - y * f[k]
        a = self.factors.outward(-(x * r) for x, r in zip(z, reciprocals, strict=True))
        return [*a, *(column[n + m + k] + f[k] for k in range(m))]


def _rotate_blocks(X: Array, rows: Array) -> Array:
    """X times rows (m, nv); X has blocks of 3 x 3 on its diagonal."""
    parts = [X[k : k + 3, k : k + 3] @ rows[k : k + 3] for k in range(0, len(rows), 3)]
    return np.concatenate(parts)


def _sparse_dot(start: Any, pairs: Iterable[tuple[Any, Any]]) -> Any:
    """`start` plus a sum of products, without those of a factor that is zero whatever the inputs."""
    for a, b in pairs:
        if not (is_zero(a) or is_zero(b)):
            start = start + a * b
    return start


def columns_of_constrained_derivatives(
    model: Model, q: Array, v: Array, tau: Array, frame_pairs: Sequence[FramePair]
) -> Columns:
    """The derivatives, column by column from those of the residuals of dynamics and constraints, for one sample.

    Args:
        model: The robot; every motion must move some mass or have armature.
        q: Configuration, shape (nq,) [rad, m].
        v: Velocity, shape (nv,) [rad/s, m/s].
        tau: Joint torques, shape (nv,) [N m, N].
        frame_pairs: The constraints.

    Returns:
        Three matrices (nv + m, nv), by q, v and tau: accelerations, then forces.

    Raises:
        InputError: There is a loop between frames.
    """
    solver, terms = _solver(model, q, v, tau, frame_pairs)
    nothing = np.zeros(terms.X_q.shape)
    by_q = np.concatenate([terms.r_q, terms.g_q, terms.X_q])
    by_v = np.concatenate([terms.r_v, terms.g_v, nothing])

    def body(table: Array, column: Array) -> Array:
        return np.array(solver.of(table).answer(list(column)), dtype=object)

    return Columns(solver.table(), [by_q, by_v, -1.0], body, by_q.shape[0], serves_batches=True)


def constrained_dynamics_derivatives(
    model: Model, q: Array, v: Array, tau: Array, frame_pairs: Sequence[FramePair]
) -> tuple[Array, Array, Array]:
    """The derivatives of accelerations and forces of constrained dynamics.

    Args:
        model: The robot; every motion must move some mass or have armature.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].
        tau: Joint torques, shape (..., nv) [N m, N].
        frame_pairs: The constraints.

    Returns:
        By q, v and tau, each of shape (..., nv + m, nv): accelerations, then forces along the axes of constraints.
        Where a constraint depends on others, forces are not unique, and all that depends on them is nan.

    Raises:
        InputError: There is a loop between frames.
    """
    arrays = [np.asarray(x) for x in (q, v, tau)]
    batch = np.broadcast_shapes(*(x.shape[:-1] for x in arrays))
    if not batch:
        return _of_one(model, q, v, tau, frame_pairs)
    rows = [np.broadcast_to(x, (*batch, x.shape[-1])).reshape(-1, x.shape[-1]) for x in arrays]
    m = sum(frame_pair.size for frame_pair in frame_pairs)
    by_q, by_v, by_tau = (np.zeros((len(rows[0]), model.nv + m, model.nv)) for _ in range(3))
    for k in range(len(by_q)):
        by_q[k], by_v[k], by_tau[k] = _of_one(model, rows[0][k], rows[1][k], rows[2][k], frame_pairs)
    shape = (*batch, model.nv + m, model.nv)
    return by_q.reshape(shape), by_v.reshape(shape), by_tau.reshape(shape)


def _of_one(
    model: Model, q: Array, v: Array, tau: Array, frame_pairs: Sequence[FramePair]
) -> tuple[Array, Array, Array]:
    """The derivatives of one sample."""
    solver, terms = _solver(model, q, v, tau, frame_pairs)
    n, m = model.nv, len(solver.Y)
    nothing = np.zeros(m)
    results = []
    by_tau = -np.eye(n), None, None
    for r, g, X_q in ((terms.r_q, terms.g_q, terms.X_q), (terms.r_v, terms.g_v, None), by_tau):
        out = batch_zeros((n + m, n), q, v, tau)
        for k in range(n):
            column = [
                *r[:, k],
                *(nothing if g is None else g[:, k]),
                *(nothing if X_q is None else X_q[:, k]),
            ]
            for i, entry in enumerate(solver.answer(column)):
                out[i, k] = entry
        results.append(out)
    return results[0], results[1], results[2]


def _solver(
    model: Model, q: Array, v: Array, tau: Array, frame_pairs: Sequence[FramePair]
) -> tuple[BoundSolver, BoundTerms]:
    """The factors at a state, and the derivatives of the residuals of dynamics and constraints there."""
    if any(frame_pair.size == 6 and frame_pair.second is not None for frame_pair in frame_pairs):
        raise InputError(
            "`constraints` has a FrameLoop; expected contacts and PointLoops. For the derivatives at a FrameLoop take "
            "differences of forward_dynamics, or compile it and differentiate: ulna.compile(...).jacobian."
        )
    J, g = constraint_jacobian(model, q, frame_pairs), constraint_bias(model, q, v, frame_pairs)
    factors = Factors(mass_matrix(model, q))
    Y = solve_transposed_columns(factors, J)
    m = len(Y)
    G = delassus_of(factors, Y)
    of_forces = damped_factors(G, vector(*[0.0] * m))

    def solve(_G: Array, b: list[Any], _product: Product) -> tuple[Any, ...]:
        return (of_forces.solve(b),)

    a, forces, _ = constrained_response(factors, J, tau - bias_forces(model, q, v), g, solve)
    pairs_with_ends = [
        frame_pair if frame_pair.second else frame_pair._replace(second=End(-1, SE3.identity()))
        for frame_pair in frame_pairs
    ]
    terms = bound_terms(model, q, v, a, forces, np.zeros((len(frame_pairs), 2)), np.zeros(m), pairs_with_ends)
    S = of_forces.inverse()
    unique = are_unique(of_forces, G, S)
    S = matrix([[numeric.where(unique, S[i, j], np.nan) for j in range(m)] for i in range(m)])
    g_q, g_v = _by_state(model, q, v, frame_pairs, terms)
    rotated = terms._replace(g_q=_rotate_blocks(terms.X, g_q), g_v=_rotate_blocks(terms.X, g_v))
    return BoundSolver(factors, Y, S), rotated


def _by_state(
    model: Model, q: Array, v: Array, frame_pairs: Sequence[FramePair], terms: BoundTerms
) -> tuple[Array, Array]:
    """dg/dq and dg/dv where origins of frames accelerate as points: w x u is added to spatial accelerations."""
    g_q, g_v, start = terms.g_q.copy(), terms.g_v.copy(), 0
    for frame_pair in frame_pairs:
        if frame_pair.size == 6:
            frame, rows = frame_of(frame_pair.first), slice(start, start + 3)
            V = frame_velocity(model, q, v, frame, "local")
            V_q, V_v = frame_velocity_derivatives(model, q, v, frame)
            turning, moving = skew(V.angular), skew(V.linear)
            g_q[rows] = g_q[rows] + turning @ V_q[:3] - moving @ V_q[3:]
            g_v[rows] = g_v[rows] + turning @ V_v[:3] - moving @ V_v[3:]
        start += frame_pair.size
    return g_q, g_v
