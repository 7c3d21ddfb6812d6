"""Through way-points: cubic splines, minimum jerk, and B-splines near or through points.

| symbol | meaning | shape | unit |
|---|---|---|---|
| h, d | time between neighbours, and way | (k,), (k, n) | [s], [rad] |
| v, a | velocities and accelerations at the way-points, which are sought | (k + 1, n) | |
| L, D, U, r | blocks of the tridiagonal system, and its right side | (k + 1, b, b), (k + 1, b, n) | |

A cubic spline makes the acceleration continuous at the inner points; the spline of least squared jerk is quintic and
has continuous jerk and snap there. Source: Biagiotti & Melchiorri 2008, sections 4.4 and 4.5; Todorov & Jordan 1998.
"""

from __future__ import annotations

from math import factorial

import numpy as np

from ulna.checks.values import duration as checked_duration
from ulna.checks.values import flag
from ulna.errors import InputError, needed
from ulna.trajectory.inputs import filled, increasing, not_repeating, rows
from ulna.trajectory.polynomial import Polynomial, hermite
from ulna.typing import ArrayLike, Floats


def cubic_spline(
    points: ArrayLike,
    times: ArrayLike | None = None,
    duration: float | None = None,
    v0: ArrayLike | None = None,
    v1: ArrayLike | None = None,
) -> Polynomial:
    """Through way-points by cubics whose acceleration is continuous.

    Args:
        points: Way-points in rows, (k + 1, n) [rad or m].
        times: When to be there, increasing from 0, (k + 1,) [s].
        duration: Time for the whole way instead, shared out by the distances [s].
        v0: Velocity at the start, one or (n,) [rad/s or m/s]; None for rest.
        v1: Velocity at the end, one or (n,) [rad/s or m/s]; None for rest.

    Returns:
        The trajectory.

    Raises:
        InputError: Shapes do not fit, way-points repeat without `times`, or times that do not increase.

    Example:
        >>> move = ulna.trajectory.cubic_spline([[0.0], [1.0], [0.5]], times=[0.0, 1.0, 2.0])
        >>> move([0.0, 1.0, 2.0]).round(6).ravel()
        array([0. , 1. , 0.5])
    """
    q = rows("points", points)
    t = _waypoint_times(q, times, duration)
    n, h = q.shape[1], np.diff(t)[:, None, None]
    slope = np.diff(q, axis=0)[:, None] / h
    lower, diagonal, upper, right = _system(len(q), 1, n)
    lower[1:-1], upper[1:-1], diagonal[1:-1] = 1.0 / h[:-1], 1.0 / h[1:], 2.0 / h[:-1] + 2.0 / h[1:]
    right[1:-1] = 3.0 * (slope[:-1] / h[:-1] + slope[1:] / h[1:])
    right[0, 0], right[-1, 0] = filled("v0", v0, n), filled("v1", v1, n)
    return hermite(t, q, _solved(lower, diagonal, upper, right)[:, 0], kind="cubic spline")


def minimum_jerk(
    points: ArrayLike, times: ArrayLike | None = None, duration: float | None = None
) -> Polynomial:
    """Through way-points, from rest to rest, with the least integral of squared jerk.

    Args:
        points: Way-points in rows, (k + 1, n) [rad or m].
        times: When to be there, increasing from 0, (k + 1,) [s].
        duration: Time for the whole way instead, shared out by the distances [s].

    Returns:
        The trajectory.

    Raises:
        InputError: Shapes do not fit, way-points repeat without `times`, or times that do not increase.

    Source: Todorov & Jordan, Smoothness maximization along a predefined path (1998).

    Example:
        >>> move = ulna.trajectory.minimum_jerk([[0.0], [1.0], [0.0]], times=[0, 1, 2])
        >>> move([0.0, 1.0, 2.0]).round(6).ravel()
        array([0., 1., 0.])
    """
    q = rows("points", points)
    t = _waypoint_times(q, times, duration)
    n, h = q.shape[1], np.diff(t)
    lower, diagonal, upper, right = _system(len(q), 2, n)
    b, f = h[:-1], h[1:]  # before and after an inner way-point; rows: equal jerk, equal snap
    for k, (hb, hf) in enumerate(zip(b, f, strict=True), start=1):
        lower[k] = [[-24 / hb**2, -3 / hb], [-168 / hb**3, -24 / hb**2]]
        diagonal[k] = [
            [36 / hf**2 - 36 / hb**2, 9 / hf + 9 / hb],
            [-192 / hf**3 - 192 / hb**3, -36 / hf**2 + 36 / hb**2],
        ]
        upper[k] = [[24 / hf**2, -3 / hf], [-168 / hf**3, 24 / hf**2]]
        way_b, way_f = q[k] - q[k - 1], q[k + 1] - q[k]
        right[k, 0] = 60 * (way_f / hf**3 - way_b / hb**3)
        right[k, 1] = -360 * (way_f / hf**4 + way_b / hb**4)
    derivatives = _solved(lower, diagonal, upper, right)
    return hermite(t, q, derivatives[:, 0], derivatives[:, 1], kind="minimum jerk")


def bspline(
    points: ArrayLike, duration: float, degree: int = 5, through: bool = False, times: ArrayLike | None = None
) -> Polynomial:
    """A B-spline, from rest to rest, that is drawn by control points, or runs through way-points.

    Args:
        points: Points in rows, (k + 1, n) [rad or m]. The curve starts at the first and ends at the last; it stays in
            the convex hull of the points when it does not run through them.
        duration: Time it takes [s].
        degree: Degree of the polynomials, 3 or 5: continuous acceleration, or jerk and snap as well.
        through: Whether to run through the points instead of being drawn by them.
        times: When to be at the points with `through`, (k + 1,) [s]; None shares out the duration by the
            distances.

    Returns:
        The trajectory.

    Raises:
        InputError: Shapes do not fit, a degree that is not 3 or 5, or `times` without `through`.
        MissingExtra: SciPy is not installed.

    Source: Piegl & Tiller, The NURBS Book (1997), chapters 2, 3 and 9.
    """
    with needed("scipy", "trajectory", "A B-spline"):
        from scipy.interpolate import BSpline, make_interp_spline
    if not isinstance(degree, int) or degree not in (3, 5):
        raise InputError(f"`degree` is {degree!r}; expected 3 or 5.")
    if not flag("through", through) and times is not None:
        raise InputError("`times` are when to be at the points; expected through=True, too.")
    q = rows("points", points)
    total, n = checked_duration("duration", duration), q.shape[1]
    zero_derivatives = (degree - 1) // 2  # derivatives that are zero at the ends
    if through:
        t = _waypoint_times(q, times, None if times is not None else total)
        ends = [(d, np.zeros(n)) for d in range(1, zero_derivatives + 1)]
        spline = make_interp_spline(t, q, degree, bc_type=(ends, ends))
    else:
        control = np.concatenate(
            [np.repeat(q[:1], zero_derivatives, axis=0), q, np.repeat(q[-1:], zero_derivatives, axis=0)]
        )
        inner = np.linspace(0.0, total, len(control) - degree + 1)
        spline = BSpline(np.concatenate([[0.0] * degree, inner, [total] * degree]), control, degree)
    knots = np.unique(spline.t)
    powers = [spline(knots[:-1], nu=i) / factorial(i) for i in range(degree + 1)]
    return Polynomial.of(knots, np.stack(powers, axis=1), "b-spline")


def _waypoint_times(q: Floats, times: ArrayLike | None, duration: float | None) -> Floats:
    """The times of way-points."""
    if (times is None) == (duration is None):
        raise InputError("Expected either `times` or a `duration`; " + ("neither" if times is None else "both") +
                         " was given.")  # fmt: skip
    if times is not None:
        return increasing("times", times, len(q))
    gaps = np.linalg.norm(np.diff(q, axis=0), axis=1)
    not_repeating("points", q, gaps)
    arc_lengths = np.concatenate([[0.0], np.cumsum(gaps)])
    return checked_duration("duration", duration) * arc_lengths / arc_lengths[-1]


def _system(k: int, b: int, n: int) -> tuple[Floats, Floats, Floats, Floats]:
    """A tridiagonal system of k blocks of b unknowns whose first and last block are the identity."""
    lower, upper, right = np.zeros((k, b, b)), np.zeros((k, b, b)), np.zeros((k, b, n))
    return lower, np.tile(np.eye(b), (k, 1, 1)), upper, right


def _solved(lower: Floats, diagonal: Floats, upper: Floats, right: Floats) -> Floats:
    """The solution (k, b, n) of a block tridiagonal system: Golub & Van Loan 2013, section 4.5.1."""
    k = len(diagonal)
    factor, x = np.zeros_like(upper), np.zeros_like(right)
    factor[0], x[0] = np.linalg.solve(diagonal[0], upper[0]), np.linalg.solve(diagonal[0], right[0])
    for i in range(1, k):
        pivot = diagonal[i] - lower[i] @ factor[i - 1]
        factor[i] = np.linalg.solve(pivot, upper[i])
        x[i] = np.linalg.solve(pivot, right[i] - lower[i] @ x[i - 1])
    for i in reversed(range(k - 1)):
        x[i] -= factor[i] @ x[i + 1]
    return x
