"""Functions of traced numbers that are made of their other operations, by the methods and hooks of the values."""

from __future__ import annotations

import math
from typing import Any


def power(base: Any, exponent: Any) -> Any:
    """The power where either may be anything, as NumPy has it but for the sign of zero, (-1)**inf and (-inf)**0.5.

    Args:
        base: Number.
        exponent: Number.

    Returns:
        The power.
    """
    size = abs(base)
    result = (size.log() * exponent).exp()
    half = exponent * 0.5
    odd = half.floor() != half
    of_negative = (exponent.floor() == exponent)._where_(odd._where_(-result, result), float("nan"))
    result = (base < 0.0)._where_(of_negative, result)
    one = (exponent == 0.0) | (base == 1.0)
    return one._where_(1.0, result)


def integer_power(base: Any, exponent: int) -> Any:
    """The power with a whole exponent, by repeated squaring.

    Args:
        base: Number.
        exponent: Whole number; negative ones yield the reciprocal.

    Returns:
        The power.
    """
    if exponent < 0:
        return 1.0 / integer_power(base, -exponent)
    if exponent == 0:
        return 1.0
    result = None
    while exponent:
        if exponent & 1:
            result = base if result is None else result * base
        exponent >>= 1
        base = base * base if exponent else base
    return result


def hypot(x: Any, y: Any) -> Any:
    """The length of the vector (x, y); plain, so it can overflow beyond 1e154.

    Args:
        x: Number.
        y: Number.

    Returns:
        The length.
    """
    return (x * x + y * y).sqrt()


def cosh(x: Any) -> Any:
    """The hyperbolic cosine."""
    size = abs(x)
    return size.sinh() + (-size).exp()


def tanh(x: Any) -> Any:
    """The hyperbolic tangent."""
    # At 20 it is 1 already; beyond, exp would overflow, and derivatives be nan.
    twice = (x * 2.0)._minimum_(40.0)
    e = twice.expm1()
    return e / (e + 2.0)


def deg2rad(x: Any) -> Any:
    """An angle in degrees as one in radians."""
    return x * (math.pi / 180.0)


def rad2deg(x: Any) -> Any:
    """An angle in radians as one in degrees."""
    return x * (180.0 / math.pi)
