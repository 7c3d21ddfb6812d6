"""The scalar functions of the angle inside the exponential maps, smooth and accurate through zero.

All take t2, the squared angle [rad^2], because it is smooth where the angle itself is not. With t = sqrt(t2):

| function        | value                                   | at 0  |
|-----------------|-----------------------------------------|-------|
| `half`          | sin(t/2) / (t/2) and cos(t/2)           | 1, 1  |
| `first_second`  | A = sin t / t, B = (1 - cos t) / t^2    | 1, 1/2 |
| `third`         | C = (t - sin t) / t^3                   | 1/6   |
| `fourth`        | E = (t^2 + 2 cos t - 2) / (2 t^4)       | 1/24  |
| `fifth`         | F = (2 t - 3 sin t + t cos t) / (2 t^5) | 1/120 |
| `inverse`       | D = (1 - (t/2) cot(t/2)) / t^2          | 1/12  |
| `inverse_slope` | G = (dD/dt) / t                         | 1/360 |

Below t = 0.2 they are their own power series: five terms reach full precision there, both values and
derivatives. Above, the closed forms cancel by at most 1 / t^2, those of F and G by 1 / t^4, which the factors w
and w^T they are multiplied with give back.
"""

from __future__ import annotations

from math import factorial
from typing import Any

from ulna.numeric import cos, less, sin, sqrt, where

_SMALL = 0.04  # [rad^2]
_TERMS = range(5)

_HALF_SIN = [(-1) ** k / factorial(2 * k + 1) / 4**k for k in _TERMS]
_HALF_COS = [(-1) ** k / factorial(2 * k) / 4**k for k in range(6)]
_THIRD = [(-1) ** k / factorial(2 * k + 3) for k in _TERMS]
_FOURTH = [(-1) ** k / factorial(2 * k + 4) for k in _TERMS]
_FIFTH = [(-1) ** k * (k + 1) / factorial(2 * k + 5) for k in _TERMS]
# |Bernoulli(2k)| / (2k)!
_INVERSE = [1 / 12, 1 / 720, 1 / 30240, 1 / 1209600, 1 / 47900160, 691 / 1307674368000]
_SLOPE = [2 * k * d for k, d in enumerate(_INVERSE)][1:]


def half(t2: Any) -> tuple[Any, Any]:
    """sin(t/2) / (t/2) and cos(t/2)."""
    small = less(t2, _SMALL)
    h = 0.5 * sqrt(where(small, 1.0, t2))
    s = where(small, _polynomial(_HALF_SIN, t2), sin(h) / h)
    c = where(small, _polynomial(_HALF_COS, t2), cos(h))
    return s, c


def first_second(t2: Any) -> tuple[Any, Any]:
    """A and B, from one sine and cosine of the half angle."""
    s, c = half(t2)
    return s * c, 0.5 * (s * s)


def third(t2: Any, a: Any) -> Any:
    """The coefficient C = (t - sin t) / t^3.

    Args:
        t2: The squared angle [rad^2].
        a: A of `first_second`.

    Returns:
        C, in the shape of `t2`.
    """
    return _quotient(t2, 1.0 - a, _THIRD)


def fourth(t2: Any, b: Any) -> Any:
    """The coefficient E = (t^2 + 2 cos t - 2) / (2 t^4).

    Args:
        t2: The squared angle [rad^2].
        b: B of `first_second`.

    Returns:
        E, in the shape of `t2`.
    """
    return _quotient(t2, 0.5 - b, _FOURTH)


def fifth(t2: Any, b: Any, c: Any) -> Any:
    """The coefficient F = (2 t - 3 sin t + t cos t) / (2 t^5).

    Args:
        t2: The squared angle [rad^2].
        b: B of `first_second`.
        c: C of `third`.

    Returns:
        F, in the shape of `t2`.
    """
    return _quotient(t2, 0.5 * (3.0 * c - b), _FIFTH)


def inverse(t2: Any, half_cot: Any) -> Any:
    """The coefficient D = (1 - (t/2) cot(t/2)) / t^2 of the inverse left Jacobian.

    Args:
        t2: The squared angle [rad^2].
        half_cot: (t/2) cot(t/2).

    Returns:
        D, in the shape of `t2`.
    """
    return _quotient(t2, 1.0 - half_cot, _INVERSE)


def inverse_slope(t2: Any, half_cot: Any, d: Any) -> Any:
    """The coefficient G = (dD/dt) / t.

    Args:
        t2: The squared angle [rad^2].
        half_cot: (t/2) cot(t/2).
        d: D of `inverse`.

    Returns:
        G, in the shape of `t2`.
    """
    return _quotient(t2, 0.25 - (2.0 + half_cot) * d, _SLOPE)


def _quotient(t2: Any, numerator: Any, series: list[float]) -> Any:
    """The quotient `numerator` / t2, or its series where t2 is small."""
    small = less(t2, _SMALL)
    return where(small, _polynomial(series, t2), numerator / where(small, 1.0, t2))


def _polynomial(coefficients: list[float], x: Any) -> Any:
    """c0 + c1 x + c2 x^2 + ..., by Horner's rule."""
    result = coefficients[-1]
    for c in reversed(coefficients[:-1]):
        result = result * x + c
    return result
