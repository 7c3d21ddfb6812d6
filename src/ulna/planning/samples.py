"""Samples of a box: Halton points, shifted by a seed."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

from ulna.typing import Floats

_PRIMES = (2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37)


def samples(first: int, count: int, seed: int, low: Floats, high: Floats) -> Any:
    """Samples of a box.

    Args:
        first: The number of the first sample.
        count: How many samples.
        seed: Which of many sequences.
        low: The least coordinates, shape (n,) [any].
        high: The greatest ones, shape (n,) [any].

    Returns:
        Shape (count, n), float32.
    """
    unit = halton(first, count, len(low)) + shift(len(low), seed)
    return (low + (unit - np.floor(unit)) * (high - low)).astype(np.float32)


@lru_cache(maxsize=64)
def halton(first: int, count: int, dimensions: int) -> Floats:
    """Points of the unit cube that fill it evenly; beyond twelve dimensions, where they would not, random numbers.

    Source: Halton, On the efficiency of certain quasi-random sequences of points (1960).

    Args:
        first: The number of the first point.
        count: How many points.
        dimensions: How many numbers each has.

    Returns:
        Points, shape (count, dimensions), in [0, 1).
    """
    points = np.random.default_rng([0, 1, first]).random((count, dimensions))
    for k, prime in enumerate(_PRIMES[:dimensions]):
        points[:, k] = _radical_inverse(np.arange(first + 1, first + count + 1), prime)
    points.setflags(write=False)
    return points


@lru_cache(maxsize=256)
def shift(dimensions: int, seed: int) -> Floats:
    """What a seed adds to points of the unit cube, modulo 1 (Cranley and Patterson 1976).

    Args:
        dimensions: How many numbers a point has.
        seed: The seed.

    Returns:
        Shape (dimensions,), in [0, 1).
    """
    return np.random.default_rng([seed, 0]).random(dimensions)


def _radical_inverse(numbers: Any, base: int) -> Floats:
    """The digits of integers in a base, mirrored at the point."""
    result, scale, rest = np.zeros(len(numbers)), 1.0 / base, numbers.copy()
    while rest.any():
        result += scale * (rest % base)
        rest, scale = rest // base, scale / base
    return result
