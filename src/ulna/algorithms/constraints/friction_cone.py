"""The cone of Coulomb's friction, and projections onto it.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| mu | coefficient of friction | () | | |
| f = (t, n) | contact force: two tangential entries, then the normal one | (3) | [N] | |
| l | length of t | () | [N] | |
| K | the forces that friction allows | | | l <= mu n |
| K* | its dual: vectors whose product with each of K is not negative | | | mu l <= n |
| P f | the nearest of K | (3) | [N] | f if f in K; 0 if mu l <= -n; else (x.f) x, x = (mu t / l, 1) / sqrt(1 + mu^2) |
| P* f | the nearest of K* | (3) | [N] | f + P(-f) |
| P_R f | nearest in the metric of a diagonal R = (r, r, s) | (3) | [N] | R^-1/2 P' R^1/2 f |
| P' | P for another coefficient mu' | (3) | | mu' = mu sqrt(r / s) |
| radial | the same normal force, t no longer than mu n | (3) | [N] | |
| shift | De Saxce correction: velocity of a sliding contact + shift is in K* | (3) | [m/s] | (0, 0, mu l), l from v |

Source: Moreau's decomposition, f = P f - P*(-f); Parikh & Boyd, Proximal algorithms (2014), section 6.3.2; de Saxce &
Feng, The bipotential method (1998), for the De Saxce correction. The coefficient is a number or a batch of numbers.
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
    divisor = numeric.where(numeric.less(0.0, length), length, 1.0)  # not zero
    normal = (mu * length + n) / (1.0 + mu * mu)
    on_boundary = (mu * normal * x / divisor, mu * normal * y / divisor, normal)
    # A force with n < 0 is outside K, which mu n < l does not show where mu and l are zero.
    is_outside = numeric.less(numeric.where(numeric.less(n, 0.0), n, mu * n), length)
    is_nonzero = numeric.less(-n, mu * length)  # of the nearest force
    return vector(
        *(
            numeric.where(is_outside, numeric.where(is_nonzero, nearest, 0.0), entry)
            for entry, nearest in zip((x, y, n), on_boundary, strict=True)
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
    """The De Saxce correction: added to the velocity of a sliding contact, the sum is in K*.

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
    """How much a force violates the friction cone K.

    Args:
        f: Force, shape (..., 3) [N], the normal entry last.
        mu: Coefficient of friction, not below zero [-].

    Returns:
        max(|t| - mu n, -n), shape (...) [N]; <= 0 inside K. It is not the distance from K.
    """
    tangential = numeric.sqrt(f[..., 0] ** 2 + f[..., 1] ** 2)
    return np.asarray(numeric.maximum(tangential - mu * f[..., 2], -f[..., 2]))[()]
