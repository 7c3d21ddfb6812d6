"""The factors of mass matrix and constraints as one matrix, and what is solved with them.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| M, J, G | mass matrix, constraint Jacobian, Delassus matrix | | | dynamics.py |
| mu | damping of each constraint | (m) | [1/kg] ... | |
| K | what binds accelerations and forces | (m + nv, m + nv) | | K = [[-mu, J], [J^T, M]] |
| U, D | unit upper triangle; diagonal, below zero for constraints | (m + nv, m + nv), (m + nv) | | K = U diag(D) U^T |
| a, f | accelerations, constraint forces | (nv), (m) | | K [-f; a] = [-g; tau - h] |
| v+, i | velocity after an impact, impulses | (nv), (m) | | K [-i; v+ - v] = [-(1 + restitution) J v; 0] |

The elimination runs from the last joint to the first constraint, as in mass_matrix_factors.py: U is L^T of M for
joints, Y^T D^-1
between constraints and joints, and made of the factors of -(G + mu) for constraints. It is zero where neither of two
joints is an ancestor of the other, and where a joint moves no constraint. Source: Featherstone 2008, section 6.5;
Carpentier, Budhiraja & Mansard, Proximal and sparse resolution of constrained dynamic equations, RSS 2021, section III.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from typing import Any, NamedTuple

import numpy as np

from ulna import numeric
from ulna.algorithms.constraints.damped_dynamics import damped_factors
from ulna.algorithms.constraints.dynamics import delassus_of, solve_transposed_columns
from ulna.algorithms.dynamics.mass_matrix_factors import Factors
from ulna.model import Model
from ulna.numeric import apply, vector
from ulna.typing import Array


class ConstrainedFactors(NamedTuple):
    """K = U diag(D) U^T."""

    factors: Factors
    """U^T, D and 1/D, which is zero for what is not unique."""
    G: Array
    """The Delassus matrix, without damping, (..., m, m)."""
    unique: Any
    """Above 0 where M is positive definite, and no constraint without damping depends on others, (...)."""


def constrained_factors(M: Array, J: Array, mu: Array) -> ConstrainedFactors:
    """The factors of K. Entries of M and J that are the number zero cost nothing.

    Args:
        M: Mass matrix, shape (..., nv, nv) [kg, kg m, kg m^2].
        J: Constraint Jacobian, shape (..., m, nv).
        mu: Damping of each constraint, not below 0, shape (..., m) [1/kg].

    Returns:
        The factors, the Delassus matrix, and whether the solution is unique.
    """
    m, n = J.shape[-2:]
    of_joints = Factors(M, [0.0] * n)
    Y = solve_transposed_columns(of_joints, J)
    G = delassus_of(of_joints, Y) if m else np.zeros((0, 0))
    of_forces = damped_factors(G, mu)
    lower = list(of_forces.lower)
    for k, (row, reciprocal) in enumerate(zip(of_joints.lower, of_joints.reciprocals, strict=True)):
        lower.append({i: column[k] * reciprocal for i, column in enumerate(Y) if k in column})
        lower[-1] |= {m + j: entry for j, entry in row.items()}
    reciprocals = [-r for r in of_forces.reciprocals] + of_joints.reciprocals
    pivots = [-pivot for pivot in of_forces.pivots] + of_joints.pivots
    unique = reduce(numeric.minimum, of_forces.reciprocals + of_joints.reciprocals)
    return ConstrainedFactors(Factors.of(lower, reciprocals, pivots), G, unique)


def constrained_motion(factors: Factors, drive: Array, g: Array) -> tuple[Array, Array]:
    """Accelerations and forces with M a = drive + J^T f and J a + g = -mu f.

    Args:
        factors: Those of K.
        drive: Torques minus those that produce no acceleration, shape (..., nv) [N m, N].
        g: Constraint drift, shape (..., m) [m/s^2, rad/s^2].

    Returns:
        a, shape (..., nv) [rad/s^2, m/s^2], and f, shape (..., m) [N, N m].
    """
    m, n = g.shape[-1], drive.shape[-1]
    x = factors.solve([-g[..., i][()] for i in range(m)] + [drive[..., k][()] for k in range(n)])
    return vector(*x[m:]), vector(*(-f for f in x[:m]))


def constrained_impact(factors: Factors, J: Array, v: Array, restitution: Any) -> tuple[Array, Array]:
    """Velocity and impulses of an impact.

    Args:
        factors: Those of K.
        J: Constraint Jacobian, shape (..., m, nv).
        v: Velocity before, shape (..., nv) [rad/s, m/s].
        restitution: The fraction of the velocity that the constraints return, a number [-].

    Returns:
        v+, shape (..., nv) [rad/s, m/s], and the impulses, shape (..., m) [N s, N m s].
    """
    jump, impulses = constrained_motion(factors, np.zeros(v.shape), (1.0 + restitution) * apply(J, v))
    return v + jump, impulses


def joined(model: Model) -> Array:
    """Where M has entries, 1, and where it is zero by the tree, 0: (nv, nv)."""
    out = np.zeros((model.nv, model.nv))
    for k in range(len(model.joints)):
        for i in model.support(k):
            out[np.ix_(_columns(model, k), _columns(model, i))] = 1.0
    return np.maximum(out, out.T)


def moved_by(model: Model, joints: Sequence[int]) -> Array:
    """Which velocities move some of the joints.

    Args:
        model: The robot.
        joints: Indices of joints; -1 is the world.

    Returns:
        1 for velocities that move some of them, 0 for the others, shape (nv,).
    """
    out = np.zeros(model.nv)
    for joint in joints:
        for i in model.support(joint):
            out[_columns(model, i)] = 1.0
    return out


def filled(M: Array, J: Array) -> Array:
    """Where U has entries, by where M and J have.

    Args:
        M: Where the mass matrix has entries, shape (nv, nv): 1 or 0.
        J: Where the Jacobian has entries, shape (m, nv): 1 or 0.

    Returns:
        1 where U has entries, 0 elsewhere, shape (m + nv, m + nv).
    """
    m = len(J)
    out = np.block([[np.eye(m), J], [J.T, M]]) > 0.0
    for k in reversed(range(len(out))):
        above = out[k, :k].copy()
        out[:k, :k] |= np.outer(above, above)
    return np.triu(out).astype(float)


def _columns(model: Model, k: int) -> list[int]:
    """Where a joint's velocities stand, those of a mimic joint with what it follows."""
    joint = model.joints[k]
    return list(range(joint.idx_v, joint.idx_v + joint.kind.nv))
