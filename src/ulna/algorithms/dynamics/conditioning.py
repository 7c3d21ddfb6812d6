"""How well the mass matrix of a model can be inverted, and along which motions it cannot.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| A | factor of the mass matrix | (6 nbodies + nv, nv) | [kg^1/2], [kg^1/2 m] | M = A^T A |
| d_k | length of column k of A | () | | d_k^2 = M_kk |
| D_k | length that column would have if every mass it moves lay at its distance across the axis | () | | d_k <= D_k |
| sigma, v | singular values and right singular vectors of A diag(1 / d) | | [1] | M diag(1 / d) v = 0 for sigma = 0 |
| kappa | condition number of the mass matrix in units of its diagonal | () | [1] | (sigma_max / sigma_min)^2 |

The factors of `mass_matrix_factors.py` do not change with the units of joints, so kappa measures what they lose: about
kappa times the relative precision of the numbers. A is made of the bodies' Jacobians and of square roots of their
inertias, without M, so that it distinguishes a matrix that is singular for every mass from one close to singular:
sigma is known to about 1e-15, which is 1e-30 in M.

Source: Golub & Van Loan, Matrix Computations, sections 2.6 and 3.5 (scaling, condition), 5.3 (normal equations).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ulna.algorithms.multibody.tree import poses, steps
from ulna.model import Model
from ulna.numeric import cross
from ulna.typing import Floats

LARGEST = 120
"""Coordinates of a model beyond which `conditioning` would take longer than a second."""
_ROUNDING = 16.0 * np.finfo(float).eps


class Conditioning(NamedTuple):
    """What `conditioning` finds."""

    loose: tuple[int, ...]
    """Entries of v that take part in a motion that moves no inertia; none where the mass matrix is regular."""
    kappa: float
    """The condition number; inf where the matrix is singular."""
    weak: tuple[int, ...]
    """Entries of v that take part in the motion that moves the least inertia for its size."""


def conditioning(model: Model, q: Floats) -> Conditioning:
    """How well the mass matrix can be inverted.

    Rotational inertias with negative moments count with the absolute values of these.

    Args:
        model: The robot.
        q: Configuration, shape (nq,) [rad, m].

    Returns:
        The condition number, and the velocities that move no inertia or the least.
    """
    if not model.nv:
        return Conditioning((), 1.0, ())
    A, noise, D = _factor(model, q)
    d = np.linalg.norm(A, axis=0)
    still = tuple(np.flatnonzero(d <= noise).tolist())
    if still:
        return Conditioning(still, np.inf, still)
    sigma, V = np.linalg.svd(np.linalg.qr(A / d, mode="r"))[1:]
    null = V[sigma <= _ROUNDING * len(d) + np.abs(V) @ (noise / d)]
    if len(null):
        loose = tuple(np.flatnonzero(np.abs(null).max(axis=0) > 1e-6).tolist())
        return Conditioning(loose, np.inf, loose)
    kappa, slender = float((sigma[0] / sigma[-1]) ** 2), (D / d) ** 2
    if slender.max() > kappa:
        return Conditioning((), float(slender.max()), (int(slender.argmax()),))
    least = np.abs(V[-1])
    return Conditioning((), kappa, tuple(np.flatnonzero(least >= 0.3 * least.max()).tolist()))


def _factor(model: Model, q: Floats) -> tuple[Floats, Floats, Floats]:
    """A; how long rounding alone can make each of its columns; and D."""
    tree = steps(model)
    placed = poses(tree, q)
    moves_body = np.zeros((len(tree), len(tree)), dtype=bool)  # whether a step moves the body of another
    for i, step in enumerate(tree):
        moves_body[:, i] = moves_body[:, step.parent] if step.parent >= 0 else False
        moves_body[i, i] = True
    last = [i for i, step in enumerate(tree) if step.is_last]
    R = np.stack([placed[i].rotation for i in last])
    mass = np.array([abs(body.mass) for body in model.inertias])
    com = np.stack([placed[i] @ body.com for i, body in zip(last, model.inertias, strict=True)])
    moments, axes = np.linalg.eigh(np.stack([body.inertia for body in model.inertias]))
    root = (R @ (axes * np.sqrt(np.abs(moments))[:, None, :])).swapaxes(-1, -2)
    size = np.abs(moments).max(axis=1)
    A = np.zeros((len(last), 6, model.nv))
    noise, D = np.zeros((len(last), model.nv)), np.zeros((len(last), model.nv))
    for i, step in enumerate(tree):
        R_i, p = placed[i].rotation, placed[i].translation
        bodies = moves_body[i, last]
        for s, k in zip(step.subspace(), step.indices, strict=True):
            v, w = step.multiplier * (R_i @ s.linear), step.multiplier * (R_i @ s.angular)
            arm = com - p
            A[bodies, :3, k] += (np.sqrt(mass)[:, None] * (v + cross(w, arm)))[bodies]
            A[bodies, 3:, k] += (root @ w)[bodies]
            vv, ww = v @ v, w @ w
            D[bodies, k] += (mass * (vv + ww * (arm**2).sum(axis=1)) + size * ww)[bodies]
            squared_distances = (com**2).sum(axis=1) + p @ p
            noise[bodies, k] += (mass * (vv + ww * squared_distances) + size * ww)[bodies]
    armature = np.asarray(model.armature, dtype=float)
    factor = np.concatenate([A.reshape(-1, model.nv), np.diag(np.sqrt(np.abs(armature)))])
    return factor, _ROUNDING * np.sqrt(noise.sum(axis=0)), np.sqrt(D.sum(axis=0) + np.abs(armature))
