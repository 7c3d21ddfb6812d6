"""The cone of Coulomb's friction, and what is nearest in it.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| mu | coefficient of friction | () | | |
| f = (t, n) | contact force: two tangential entries, then the normal one | (3) | [N] | |
| l | length of t | () | [N] | |
| K | the forces that friction allows | | | l <= mu n |
| K* | its dual: what has no negative product with them | | | mu l <= n |
| P f | the nearest of K | (3) | [N] | 0 where mu l <= -n; f in K; else (x.f) x, x = (mu t / l, 1) / sqrt(1 + mu^2) |
| P* f | the nearest of K* | (3) | [N] | f + P(-f) |
| P_R f | nearest in the metric of a diagonal R = (r, r, s) | (3) | [N] | R^-1/2 P' R^1/2 f, mu' = mu sqrt(r / s) |
| radial | the same normal force, t no longer than mu n | (3) | [N] | |
| shift | what makes the velocity of a sliding contact one of K* | (3) | [m/s] | (0, 0, mu l), l that of the velocity |

Source: Moreau's decomposition, f = P f - P*(-f); Parikh & Boyd, Proximal algorithms (2014), section 6.3.2; de Saxce &
Feng, The bipotential method (1998), for the shift. The coefficient is a number or a batch of numbers.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna import numeric
from ulna.numeric import vector
from ulna.typing import Array


def project(f: Array, mu: Any) -> Array:
    """The nearest force of the friction cone K.

    Args:
        f: Force, shape (..., 3) [N], the normal entry last.
        mu: Coefficient of friction, not below zero.

    Returns:
        P f, shape (..., 3) [N].
    """
    x, y, n = (f[..., i][()] for i in range(3))
    length = numeric.sqrt(x * x + y * y)
    sure = numeric.where(numeric.less(0.0, length), length, 1.0)
    normal = (mu * length + n) / (1.0 + mu * mu)
    outside = (mu * normal * x / sure, mu * normal * y / sure, normal)
    # Without friction, mu n says nothing of a force that pulls.
    leaves = numeric.less(numeric.where(numeric.less(n, 0.0), n, mu * n), length)
    pushes = numeric.less(-n, mu * length)
    return vector(
        *(
            numeric.where(leaves, numeric.where(pushes, found, 0.0), given)
            for given, found in zip((x, y, n), outside, strict=True)
        )
    )


def project_dual(f: Array, mu: Any) -> Array:
    """The nearest vector of the dual cone K*: f + P(-f).

    Args:
        f: Vector, shape (..., 3), the normal entry last.
        mu: Coefficient of friction, not below zero [-].

    Returns:
        P* f, shape (..., 3), in the unit of `f`.
    """
    return f + project(-f, mu)


def project_weighted(f: Array, mu: Any, weights: Array) -> Array:
    """The nearest force of the friction cone in the norm of weights R.

    Args:
        f: Force, shape (..., 3) [N], the normal entry last.
        mu: Coefficient of friction, not below zero.
        weights: The diagonal of R, shape (..., 3), above zero; the first two are equal.

    Returns:
        P_R f, shape (..., 3) [N].
    """
    roots = vector(*(numeric.sqrt(weights[..., i][()]) for i in range(3)))
    return project(roots * f, mu * roots[..., 0][()] / roots[..., 2][()]) / roots


def project_radially(f: Array, mu: Any) -> Array:
    """The force with the same normal entry, or none below zero, and no more friction than that allows.

    Args:
        f: Force, shape (..., 3) [N], the normal entry last.
        mu: Coefficient of friction, not below zero [-].

    Returns:
        The force, shape (..., 3) [N].
    """
    x, y, n = (f[..., i][()] for i in range(3))
    length, normal = numeric.sqrt(x * x + y * y), numeric.maximum(n, 0.0)
    slides = numeric.less(mu * normal, length)
    scale = numeric.where(slides, mu * normal / numeric.where(slides, length, 1.0), 1.0)
    return vector(scale * x, scale * y, normal)


def sliding_shift(v: Array, mu: Any) -> Array:
    """The shift that makes the velocity of a sliding contact one of K* (De Saxce).

    Args:
        v: Velocity of the contact, shape (..., 3) [m/s], the normal entry last.
        mu: Coefficient of friction, not below zero [-].

    Returns:
        (0, 0, mu times the tangential speed), shape (..., 3) [m/s].
    """
    x, y = v[..., 0][()], v[..., 1][()]
    zero = 0.0 * x
    return vector(zero, zero, mu * numeric.sqrt(x * x + y * y))


def excess(f: Array, mu: Any) -> Any:
    """How far a force is outside K.

    Args:
        f: Force, shape (..., 3) [N], the normal entry last.
        mu: Coefficient of friction, not below zero [-].

    Returns:
        The larger of |t| - mu n and -n, shape (...) [N]; not above zero inside.
    """
    tangential = numeric.sqrt(f[..., 0] ** 2 + f[..., 1] ** 2)
    return np.asarray(numeric.maximum(tangential - mu * f[..., 2], -f[..., 2]))[()]
