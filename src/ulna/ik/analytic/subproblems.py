"""The equations in one angle that closed-form inverse kinematics is made of; generic in the scalar.

| symbol | meaning | source |
|---|---|---|
| SP1 | R(h, x) u = w: turns u to w about h | Paden 1986; Murray, Li & Sastry 1994, 3.2 |
| SP4 | A cos x + B sin x = C: two angles | Elias & Wen 2025, subproblem 4 |
| quartic | a0 + a1 cos x + b1 sin x + a2 cos 2x + b2 sin 2x = 0: up to four angles | a quartic in exp(i x) |

Equations without a solution return the nearest miss (SP4) or some angle (quartic); whoever calls certifies the result.
Where every angle is a solution, the angle given as `near` is returned.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.ik.analytic.lines import across
from ulna.numeric import arctan2, cross, dot, loop, maximum, sqrt, vector, where
from ulna.typing import Array

_ZERO = 1e-24  # below it the square of a length, or of a product of lengths, carries no direction any more

Affine = tuple[Any, Any, Any]
"""A quantity a + b cos x + c sin x, as (a, b, c); the parts are numbers or vectors."""


def angle_between(h: Array, u: Array, w: Array, near: Any) -> Any:
    """SP1: the angle that turns `u` to `w` about the unit vector `h`; both count across `h` only.

    Args:
        h: Unit vector, (3,).
        u: Vector, (3,).
        w: Vector, (3,).
        near: The angle where `u` or `w` lies along `h` [rad].

    Returns:
        Angle [rad].
    """
    s, c = dot(h, cross(u, w)), dot(across(u, h), w)
    return where(s * s + c * c > _ZERO, arctan2(s, c), near)


def two_angles(a: Any, b: Any, c: Any, sign: Any, near: Any) -> Any:
    """SP4: the angle x with a cos x + b sin x = c, the one that `sign` (1 or -1) says.

    Args:
        a: Factor of the cosine.
        b: Factor of the sine.
        c: Right side; beyond the amplitude, the nearest angle is returned.
        sign: 1 or -1.
        near: The angle where a and b vanish [rad].

    Returns:
        Angle [rad].
    """
    square = a * a + b * b
    root = sqrt(maximum(square - c * c, 0.0))
    return where(square > _ZERO, arctan2(b, a) + sign * arctan2(root, c), near)


def square(x: Affine) -> Array:
    """The square of an affine quantity as the five coefficients (1, cos, sin, cos 2x, sin 2x); of vectors, with dot."""
    a, b, c = x
    product = dot if np.ndim(a) else lambda u, v: u * v
    bb, cc = product(b, b), product(c, c)
    return vector(
        product(a, a) + 0.5 * (bb + cc),
        2.0 * product(a, b),
        2.0 * product(a, c),
        0.5 * (bb - cc),
        product(b, c),
    )


def four_angles(coefficients: Array, number: Any) -> Any:
    """The quartic's angle of that number (0 to 3).

    The roots of z^2 f(z) are found together by the iteration of Ehrlich and Aberth (Aberth 1973); those on the unit
    circle are the angles. The others lie in pairs z, 1 / conj(z), and the angle half-way between them is returned.

    Args:
        coefficients: a0, a1, b1, a2, b2 of f = a0 + a1 cos x + b1 sin x + a2 cos 2x + b2 sin 2x, (5,).
        number: Which root, 0 to 3.

    Returns:
        Angle [rad].
    """
    a0, a1, b1, a2, b2 = coefficients
    size = 1e-15 * sqrt(a0 * a0 + a1 * a1 + b1 * b1 + a2 * a2 + b2 * b2) + 1e-300
    a2 = a2 + where(a2 * a2 + b2 * b2 < size * size, size, 0.0)  # a quadratic in disguise: two roots far away
    lead = (a2, -b2)
    p3, p2 = _over((a1, -b1), lead), _over((2.0 * a0, 0.0), lead)
    p1, p0 = _over((a1, b1), lead), _over((a2, b2), lead)
    starts = [(0.9, 0.35), (-0.3, 0.95), (-1.0, -0.25), (0.2, -1.1)]
    state = (*(part for z in starts for part in z), 1.0)

    def step(*values: Any) -> tuple[Any, ...]:
        roots = [(values[2 * i], values[2 * i + 1]) for i in range(4)]
        largest: Any = 0.0
        out: list[Any] = []
        for i, z in enumerate(roots):
            value = _plus(_mul(_plus(_mul(_plus(_mul(_plus(z, p3), z), p2), z), p1), z), p0)
            slope = _plus(
                _mul(_plus(_mul(_plus((4.0 * z[0], 4.0 * z[1]), _twice(p3, 3.0)), z), _twice(p2, 2.0)), z), p1
            )
            repulsion = (0.0, 0.0)
            for j, other in enumerate(roots):
                if j != i:
                    repulsion = _plus(repulsion, _over((1.0, 0.0), (z[0] - other[0], z[1] - other[1])))
            repelled = _mul(value, repulsion)
            move = _over(value, (slope[0] - repelled[0], slope[1] - repelled[1]))
            length = move[0] * move[0] + move[1] * move[1]
            known = length < 1e12  # neither nan nor off to infinity, as where two roots fall together
            out += [z[0] - where(known, move[0], 0.0), z[1] - where(known, move[1], 0.0)]
            largest = maximum(largest, where(known, length / (z[0] * z[0] + z[1] * z[1] + 1e-30), 0.0))
        return (*out, largest)

    roots = loop(lambda *values: values[-1] > 1e-28, step, state, limit=40)
    angles = [arctan2(roots[2 * i + 1], roots[2 * i]) for i in range(4)]
    chosen = angles[3]
    for i in (2, 1, 0):
        chosen = where(number < i + 0.5, angles[i], chosen)
    return chosen


def _plus(u: Any, v: Any) -> Any:
    return u[0] + v[0], u[1] + v[1]


def _twice(u: Any, k: float) -> Any:
    return k * u[0], k * u[1]


def _mul(u: Any, v: Any) -> Any:
    return u[0] * v[0] - u[1] * v[1], u[0] * v[1] + u[1] * v[0]


def _over(u: Any, v: Any) -> Any:
    square = v[0] * v[0] + v[1] * v[1] + 1e-300
    return (u[0] * v[0] + u[1] * v[1]) / square, (u[1] * v[0] - u[0] * v[1]) / square
