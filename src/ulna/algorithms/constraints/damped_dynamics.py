"""Constrained dynamics with a damping that the caller chooses, and with it the accuracy.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| M, h, J, G | as in dynamics.py | | | |
| g | what the constraint acceleration must be the opposite of | (m) | [m/s^2] | J a + g = 0 |
| mu | damping | () | [1/kg] ... | |
| b | acceleration that the forces must bring about | (m) | [m/s^2] | b = -(J M^-1 (tau - h) + g) |
| f_n | forces of round n | (m) | [N], [N m] | (G + mu 1) f_n = b + mu f_n-1, f_0 = 0 |
| r_n | what is left of the constraints then | (m) | [m/s^2] | r_n = J a_n + g = mu (f_n-1 - f_n) |

The rounds end when the largest entry of f_n - f_n-1, or that of r_n, is small enough. mu = 0 is one factorisation; a
row that depends on rows after it then gets no force. `constrained_dynamics` chooses mu by itself. Source: Carpentier,
Budhiraja & Mansard, Proximal and sparse resolution of constrained dynamic equations, RSS 2021, section IV.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from typing import Any, NamedTuple, final

import numpy as np

from ulna import numeric
from ulna.algorithms.constraints.dynamics import Product, constrained_response
from ulna.algorithms.constraints.proximal_solver import dependent_part, largest, largest_entry
from ulna.algorithms.dynamics.crba import mass_matrix
from ulna.algorithms.dynamics.mass_matrix_factors import Factors
from ulna.algorithms.dynamics.rnea_point_accelerations import bias_forces
from ulna.algorithms.multibody.external_forces import External
from ulna.data_classes import dataclass
from ulna.model import Model
from ulna.numeric import apply, vector
from ulna.typing import Array


@final
@dataclass(frozen=True)
class Damped:
    """When the rounds end.

    Attributes:
        mu: Damping, a number or shape (...), not below 0.
        change: The largest change of a force in a round that is small enough [N, N m], the same.
        residual: The largest residual that is small enough [m/s^2, rad/s^2], the same.
        rounds: How many at most, 1 or more.
    """

    mu: Any
    change: Any
    residual: Any
    rounds: int


class DampedMotion(NamedTuple):
    """How a bound robot accelerates, or how its velocity jumps."""

    a: Any
    """Joint accelerations, (..., nv); of an impact the jump of v."""
    forces: Any
    """Constraint forces, (..., m); of an impact impulses."""
    rounds: Any
    """How many rounds it took, (...), as a float."""
    change: Any
    """The largest change of a force in the last round, (...)."""
    residual: Any
    """The largest entry of what is left of the constraints, (...)."""


_IMMOVABLE = 1e-24
"""A pivot that is not above this is that of something no force moves."""
_LARGEST_GROWTH = 2.0**15
"""In single precision: the largest S_ii G_ii with which forces have derivatives."""


def damped_dynamics(
    model: Model,
    q: Array,
    v: Array,
    tau: Array,
    J: Array,
    g: Array,
    damped: Damped,
    external: External = None,
) -> DampedMotion:
    """Forward dynamics under J a + g = 0.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        v: Velocity, shape (..., nv) [rad/s, m/s].
        tau: Joint torques, shape (..., nv) [N m, N].
        J: Constraint Jacobian, shape (..., m, nv).
        g: Constraint drift, shape (..., m) [m/s^2, rad/s^2].
        damped: The damping, and when the rounds end.
        external: Forces on the bodies [N, N m]; None for none.

    Returns:
        Accelerations, constraint forces, and how accurate they are.
    """
    drive = tau - bias_forces(model, q, v, external)
    return _damped_response(mass_matrix(model, q), J, drive, g, damped)


def damped_impact(model: Model, q: Array, J: Array, jump: Array, damped: Damped) -> DampedMotion:
    """The jump of the velocity, and impulses, under J dv + jump = 0.

    Args:
        model: The robot.
        q: Configuration, shape (..., nq) [rad, m].
        J: Constraint Jacobian, shape (..., m, nv).
        jump: (1 + restitution) J v, shape (..., m) [m/s, rad/s].
        damped: The damping, and when the rounds end.

    Returns:
        The jump of v as `a`, the impulses as `forces`, and how accurate they are.
    """
    return _damped_response(mass_matrix(model, q), J, np.zeros(model.nv) * q[..., :1], jump, damped)


def _damped_response(M: Array, J: Array, drive: Array, g: Array, damped: Damped) -> DampedMotion:
    """M a = drive + J^T f and J a + g = 0, for matrices of numbers, symbols or traced scalars.

    Args:
        M: Mass matrix, shape (..., nv, nv).
        J: Constraint Jacobian, shape (..., m, nv).
        drive: Torques, shape (..., nv).
        g: Constraint drift, shape (..., m).
        damped: The damping, and when the rounds end.
    """

    def solve(G: Array, b: list[Any], _product: Product) -> tuple[Any, ...]:
        return _rounds(damped_factors(G, vector(*[damped.mu] * len(b))), b, len(b), damped)

    a, forces, (count, change) = constrained_response(Factors(M), J, drive, g, solve)
    return DampedMotion(a, forces, count, change, largest_entry(apply(J, a) + g))


def damped_factors(G: Array, mu: Array) -> Factors:
    """The factors of a Delassus matrix with damping on its diagonal.

    A row without damping that depends on rows after it has a reciprocal of zero.

    Args:
        G: Delassus matrix, shape (..., m, m) [1/kg].
        mu: Damping of each row, not below zero, shape (..., m) [1/kg].

    Returns:
        The factors of G + diag(mu).
    """
    m = G.shape[-1]
    damps = [numeric.less(0.0, mu[..., i][()]) for i in range(m)]
    part = dependent_part(reduce(numeric.maximum, [G[..., i, i] for i in range(m)])) if m else 0.0
    floors = [numeric.where(damps[i], _IMMOVABLE, part * G[..., i, i] + _IMMOVABLE) for i in range(m)]
    return Factors(G + np.eye(m) * mu[..., None, :], floors)


def are_unique(factors: Factors, G: Array, S: Array) -> Any:
    """Whether the forces without damping are unique, and so have derivatives.

    In single precision also not where rounding errors of G move them by more than some thousandths: where the part of a
    row that does not depend on others, 1 / (S_ii G_ii) of its square, is small.

    Args:
        factors: Those of G without damping.
        G: Delassus matrix, shape (..., m, m) [1/kg].
        S: Its inverse, shape (..., m, m) [kg].

    Returns:
        Truth values, shape (...).
    """
    diagonals = [(S[..., i, i], G[..., i, i]) for i in range(G.shape[-1])]
    growth = reduce(numeric.maximum, [entry * inverse for inverse, entry in diagonals])
    limit = numeric.by_precision(growth, np.inf, _LARGEST_GROWTH)
    return numeric.less(0.0, reduce(numeric.minimum, factors.reciprocals)) & numeric.less(growth, limit)


def _rounds(factors: Factors, b: Sequence[Any], m: int, damped: Damped) -> tuple[Sequence[Any], Any, Any]:
    """Forces, how many rounds, and the change of the last one."""
    mu = damped.mu
    first = factors.solve(b)

    def unfinished(*state: Any) -> Any:
        change = state[-1]
        return numeric.minimum(change - damped.change, mu * change - damped.residual) > 0.0

    def one(*state: Any) -> tuple[Any, ...]:
        before = state[:m]
        forces = factors.solve([x + mu * f for x, f in zip(b, before, strict=True)])
        change = largest([f - old for f, old in zip(forces, before, strict=True)])
        return (*forces, state[m] + 1.0, change)

    begin = (*first, 1.0 + 0.0 * first[0], largest(first))
    if damped.rounds == 1:
        return first, begin[m], begin[m + 1]
    *end, count, change = numeric.loop(unfinished, one, begin, damped.rounds - 1)
    return end, count, change
