"""Accelerations, forces and impulses of a robot under constraints.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| M, h | mass matrix; torques that give no acceleration | (nv, nv), (nv) | | M = L^T D L, see mass_matrix_factors.py |
| J, k, c, e | Jacobian, bias, velocity, error of the constraints | (m, nv), (m) | | kinematics.py |
| g | constraint drift, with stabilisation | (m) | [m/s^2] | g = k + kd c + kp e |
| R | compliance | () | [1/kg] | J a + g + R f = 0 |
| f | constraint forces | (m) | [N], [N m] | M a + h = tau + J^T f |
| Y, y | J^T and tau - h, solved by the factor L^T | (nv, m), (nv) | | Y = L^-T J^T, y = L^-T (tau - h) |
| G | Delassus matrix | (m, m) | [1/kg] ... | G = J M^-1 J^T = Y^T D^-1 Y |
| a | joint accelerations | (nv) | [rad/s^2], [m/s^2] | (G + R) f = -(Y^T D^-1 y + g), L a = D^-1 (y + Y f) |
| v+, i | velocity after an impact; impulses | (nv), (m) | [N s], [N m s] | M (v+ - v) = J^T i, J v+ = -restitution c |

Column i of Y is zero except for joints that move a frame of constraint i, which shortens the sums of G; no inverse of
M is formed. With gains kp and kd the error follows e'' + kd e' + kp e = 0 (exactly for points): critically damped for
kd = 2 sqrt(kp). Source: Featherstone 2008, sections 8.1 to 8.4 and 11.7; Baumgarte 1972; Carpentier, Budhiraja &
Mansard, RSS 2021.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from ulna.algorithms.constraints.kinematics import (
    along_axes,
    constraint_bias,
    constraint_error,
    constraint_jacobian,
)
from ulna.algorithms.constraints.proximal_solver import Proximal, largest_entry, solve_proximal
from ulna.algorithms.dynamics.crba import mass_matrix
from ulna.algorithms.dynamics.mass_matrix_factors import Factors, is_zero
from ulna.algorithms.dynamics.rnea_point_accelerations import bias_forces
from ulna.algorithms.multibody.external_forces import External
from ulna.model import Model
from ulna.model.constraint import FramePair
from ulna.numeric import apply, matrix, vector
from ulna.typing import Array

Product = Callable[[Sequence[Any]], list[Any]]
"""The product of the Delassus matrix with a vector, entry by entry."""


class ConstrainedMotion(NamedTuple):
    """How a bound robot accelerates."""

    a: Any
    """Joint accelerations, (..., nv) [rad/s^2 or m/s^2]."""
    forces: Any
    """What the constraints exert on their first frames, one after the other, (..., m) [N, N m]."""
    residual: Any
    """The largest entry of J a + g + R f, (...) [m/s^2, rad/s^2]: how far the constraints are from being kept."""
    iterations: Any
    """How many rounds the proximal solver took, (...), as a float."""


class Impact(NamedTuple):
    """The velocity of a robot after an impact on constraints."""

    v: Any
    """Velocity after it, (..., nv) [rad/s or m/s]."""
    impulses: Any
    """The impulses that the constraints exert on their first frames, one after the other, (..., m) [N s, N m s]."""
    residual: Any
    """The largest entry of J v + restitution c, (...) [m/s, rad/s]."""
    iterations: Any
    """How many rounds the proximal solver took, (...), as a float."""


class Stabilisation(NamedTuple):
    """Baumgarte stabilisation: the gains that reduce errors of constraints, and where contacts are held."""

    anchors: Array | None
    """Where the contacts hold, in their order, (..., contacts, 4, 4); None when there is no contact."""
    gains: Array
    """kp [1/s^2] and kd [1/s] of every constraint, (..., constraints, 2)."""


def constrained_dynamics(
    model: Model,
    q: Array,
    v: Array,
    tau: Array,
    frame_pairs: Sequence[FramePair],
    external: External = None,
    stabilisation: Stabilisation | None = None,
    settings: Proximal = Proximal(),  # noqa: B008 - frozen
) -> ConstrainedMotion:
    """Forward dynamics under constraints.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].
        tau: Joint torques, shape (..., nv) [N m, N].
        frame_pairs: The constraints.
        external: Forces on the bodies [N, N m]; None for none.
        stabilisation: Gains against drift; None for none.
        settings: How the forces are computed.

    Returns:
        Accelerations, constraint forces along the axes of their constraints, residual and rounds.
    """
    J = constraint_jacobian(model, q, frame_pairs, local_axes=False)
    g = constraint_bias(model, q, v, frame_pairs, local_axes=False)
    if stabilisation is not None:
        gains = expanded_to_rows(stabilisation.gains, frame_pairs)
        kp, kd = gains[..., 0], gains[..., 1]
        error = constraint_error(model, q, stabilisation.anchors, frame_pairs, local_axes=False)
        g = g + kd * apply(J, v) + kp * error
    motion = forward_dynamics_with_jacobian(model, q, v, tau, J, g, 0.0, external, settings)
    forces = along_axes(model, q, motion.forces[..., None], frame_pairs)[..., 0]
    return motion._replace(forces=forces)


def expanded_to_rows(numbers: Array, frame_pairs: Sequence[FramePair]) -> Array:
    """Numbers of constraints, for each of their rows.

    Args:
        numbers: Shape (..., constraints, n).
        frame_pairs: The constraints.

    Returns:
        Shape (..., m, n).
    """
    return numbers[..., [i for i, pair in enumerate(frame_pairs) for _ in range(pair.size)], :]


def forward_dynamics_with_jacobian(
    model: Model,
    q: Array,
    v: Array,
    tau: Array,
    J: Array,
    g: Array,
    compliance: Any = 0.0,
    external: External = None,
    settings: Proximal = Proximal(),  # noqa: B008 - frozen
) -> ConstrainedMotion:
    """Forward dynamics under J a + g + R f = 0.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].
        tau: Joint torques, shape (..., nv) [N m, N].
        J: Constraint Jacobian, shape (..., m, nv).
        g: Constraint drift, shape (..., m) [m/s^2, rad/s^2].
        compliance: R, a number or shape (...) [1/kg].
        external: Forces on the bodies [N, N m]; None for none.
        settings: How the forces are computed.

    Returns:
        Accelerations, constraint forces along the rows of J, residual and rounds.
    """
    factors = Factors(mass_matrix(model, q))
    drive = tau - bias_forces(model, q, v, external)
    a, forces, iterations = _response(factors, J, drive, g, compliance, settings)
    compliance_term = forces * (compliance[..., None] if isinstance(compliance, np.ndarray) else compliance)
    residual = apply(J, a) + g + compliance_term
    return ConstrainedMotion(a, forces, largest_entry(residual), iterations)


def impulse_dynamics(
    model: Model,
    q: Array,
    v: Array,
    frame_pairs: Sequence[FramePair],
    restitution: Array | None = None,
    settings: Proximal = Proximal(),  # noqa: B008 - frozen
) -> Impact:
    """The velocity after constraints are imposed on a moving robot within an instant (impact).

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity before, shape (..., nv) [rad/s, m/s].
        frame_pairs: The constraints.
        restitution: The fraction of its velocity that each constraint returns, shape (..., constraints) [-]; None for
            none.
        settings: How the impulses are computed.

    Returns:
        Velocity after the impact, impulses, residual and rounds.
    """
    J = constraint_jacobian(model, q, frame_pairs, local_axes=False)
    returned: Any = 0.0
    if restitution is not None:
        returned = expanded_to_rows(restitution[..., None], frame_pairs)[..., 0]
    before = apply(J, v)
    factors = Factors(mass_matrix(model, q))
    gain, impulses, iterations = _response(factors, J, 0.0 * v, (1.0 + returned) * before, 0.0, settings)
    after = v + gain
    residual = apply(J, after) + returned * before
    impulses = along_axes(model, q, impulses[..., None], frame_pairs)[..., 0]
    return Impact(after, impulses, largest_entry(residual), iterations)


def delassus_matrix(model: Model, q: Array, frame_pairs: Sequence[FramePair]) -> Array:
    """The Delassus matrix J M^-1 J^T of constraints.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        frame_pairs: The constraints.

    Returns:
        G, shape (..., m, m) [1/kg]: symmetric, semidefinite, singular where constraints depend on each other.
    """
    factors = Factors(mass_matrix(model, q))
    return delassus_of(factors, solve_transposed_columns(factors, constraint_jacobian(model, q, frame_pairs)))


def _response(
    factors: Factors, J: Array, drive: Array, g: Array, compliance: Any, settings: Proximal
) -> tuple[Array, Array, Any]:
    """a, f and the rounds, for M a = drive + J^T f and J a + g + R f = 0."""

    def solve(G: Array, b: list[Any], product: Product) -> tuple[Any, ...]:
        if is_zero(compliance):
            return solve_proximal(G, b, settings, product)
        R = compliance[..., None, None] if isinstance(compliance, np.ndarray) else compliance

        def softened(f: Sequence[Any]) -> list[Any]:
            return [x + compliance * entry for x, entry in zip(product(f), f, strict=True)]

        return solve_proximal(G + R * np.eye(len(b)), b, settings, softened)

    a, forces, (iterations,) = constrained_response(factors, J, drive, g, solve)
    return a, forces, iterations


def constrained_response(
    factors: Factors,
    J: Array,
    drive: Array,
    g: Array,
    solve: Callable[[Array, list[Any], Product], tuple[Any, ...]],
) -> tuple[Array, Array, tuple[Any, ...]]:
    """The motion a and the forces f of M a = drive + J^T f and J a + g = 0.

    Args:
        factors: L and D of the mass matrix M.
        J: Constraint Jacobian, shape (..., m, nv).
        drive: Torques, shape (..., nv) [N m, N].
        g: Constraint drift, shape (..., m) [m/s^2, rad/s^2].
        solve: Solves G f = b for the Delassus matrix G, given also f -> G f; returns the entries of f and whatever
            else there is.

    Returns:
        a, shape (..., nv), f, shape (..., m), and what else `solve` returned.
    """
    Y = solve_transposed_columns(factors, J)
    y = factors.inward([drive[..., k][()] for k in range(len(factors.lower))])
    z = [entry * reciprocal for entry, reciprocal in zip(y, factors.reciprocals, strict=True)]
    b = [-sum((entry * z[k] for k, entry in column.items()), g[..., i][()]) for i, column in enumerate(Y)]
    forces, *more = solve(delassus_of(factors, Y), b, delassus_product(factors, Y))
    for column, force in zip(Y, forces, strict=True):
        for k, entry in column.items():
            y[k] = y[k] + entry * force
    a = factors.outward(entry * reciprocal for entry, reciprocal in zip(y, factors.reciprocals, strict=True))
    return vector(*a), vector(*forces), tuple(more)


def solve_transposed_columns(factors: Factors, J: Array) -> list[dict[int, Any]]:
    """The columns of Y = L^-T J^T.

    Args:
        factors: L and D of the mass matrix.
        J: Constraint Jacobian, shape (..., m, nv).

    Returns:
        For each constraint the entries of its column by row; entries that are zero by the tree are missing.
    """
    columns = []
    for i in range(J.shape[-2]):
        column = factors.inward([J[..., i, k][()] for k in range(J.shape[-1])])
        columns.append({k: entry for k, entry in enumerate(column) if not is_zero(entry)})
    return columns


def delassus_of(factors: Factors, Y: Sequence[dict[int, Any]]) -> Array:
    """The Delassus matrix G = Y^T D^-1 Y.

    Args:
        factors: L and D of the mass matrix.
        Y: What `solve_transposed_columns` returns.

    Returns:
        G, shape (..., m, m) [1/kg].
    """
    m = len(Y)
    G: list[list[Any]] = [[0.0] * m for _ in range(m)]
    for i, column in enumerate(Y):
        scaled = {k: entry * factors.reciprocals[k] for k, entry in column.items()}
        for j in range(i + 1):
            G[i][j] = G[j][i] = sum(scaled[k] * entry for k, entry in Y[j].items() if k in scaled)
    return matrix(G)


def delassus_product(factors: Factors, Y: Sequence[dict[int, Any]]) -> Product:
    """The product Y^T (D^-1 (Y f)), which has no rounding errors of the Delassus matrix.

    Args:
        factors: L and D of the mass matrix.
        Y: What `solve_transposed_columns` returns.

    Returns:
        G f as a function of f.
    """

    def product(f: Sequence[Any]) -> list[Any]:
        y: dict[int, Any] = {}
        for column, force in zip(Y, f, strict=True):
            for k, entry in column.items():
                y[k] = y[k] + entry * force if k in y else entry * force
        z = {k: entry * factors.reciprocals[k] for k, entry in y.items()}
        return [sum(entry * z[k] for k, entry in column.items()) for column in Y]

    return product
