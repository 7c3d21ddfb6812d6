"""Samples of a box: Halton points, shifted by a seed."""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.typing import Floats

_PRIMES = (2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37)


def halton(first: int, count: int, dimensions: int, seed: int) -> Floats:
    """Points of the unit cube that fill it evenly; beyond twelve dimensions, where they would not, random numbers.

    Source: Halton, On the efficiency of certain quasi-random sequences of points (1960); the shift is that of Cranley
    and Patterson (1976).

    Args:
        first: The number of the first point.
        count: How many points.
        dimensions: How many numbers each has.
        seed: Which shift.

    Returns:
        Points, shape (count, dimensions), in [0, 1).
    """
    shift = np.random.default_rng([seed, 0]).random(dimensions)
    points = np.random.default_rng([seed, 1, first]).random((count, dimensions))
    for k, prime in enumerate(_PRIMES[:dimensions]):
        points[:, k] = (_radical_inverse(np.arange(first + 1, first + count + 1), prime) + shift[k]) % 1.0
    return points


def _radical_inverse(numbers: Any, base: int) -> Floats:
    """The digits of integers in a base, mirrored at the point."""
    result, scale, rest = np.zeros(len(numbers)), 1.0 / base, numbers.copy()
    while rest.any():
        result += scale * (rest % base)
        rest, scale = rest // base, scale / base
    return result
