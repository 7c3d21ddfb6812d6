"""Samples of a box: Halton points, shifted by a seed."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

from ulna.compiler.procedures import Array1, Array2, broadcast, f64, greatest_of, lane_numbers, procedure
from ulna.typing import Floats

_PRIMES = np.array([2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37], float)


def samples(first: int, count: int, seed: int, low: Floats, high: Floats) -> Any:
    """Samples of a box.

    Args:
        first: The number of the first sample.
        count: How many samples.
        seed: Which of many sequences.
        low: The least coordinates, shape (n,) [any].
        high: The greatest ones, shape (n,) [any].

    Returns:
        Shape (count, n), float32, within the box, unless no float32 number is.
    """
    unit = halton(first, count, len(low)) + shift(len(low), seed)
    return _rounded(low + (unit - np.floor(unit)) * (high - low), low, high)


def _rounded(points: Floats, low: Floats, high: Floats) -> Any:
    """Points of a box (count, n) in float32; where rounding moves one out, the next number is taken if it is inside."""
    rounded = points.astype(np.float32)
    is_above = rounded > high
    is_outside = is_above | (rounded < low)
    if is_outside.any():
        next_one = np.nextafter(rounded, np.where(is_above, -np.inf, np.inf).astype(np.float32))
        np.copyto(rounded, next_one, where=is_outside & (low <= next_one) & (next_one <= high))
    return rounded


def informed_samples(
    random: np.random.Generator, count: int, a: Floats, goals: Floats, bound: float, low: Floats, high: Floats
) -> Any:
    """Samples of what paths shorter than a bound can reach: ellipsoids whose foci are the start and a goal, in a box.

    Source: Gammell, Srinivasa and Barfoot, Informed RRT* (IROS 2014), equations 3 to 5.

    Args:
        random: Draws them.
        count: How many samples.
        a: The start, shape (n,) [rad, m].
        goals: Goals, shape (k, n), at least one nearer than the bound [rad, m].
        bound: The length of the paths [rad, m].
        low: The least coordinates of the box, shape (n,) [rad, m].
        high: The greatest ones, shape (n,) [rad, m].

    Returns:
        Shape (count, n), float32, within the box, unless no float32 number is. What lies outside of it after some
        rounds is moved to its surface.
    """
    distances = np.linalg.norm(goals - a, axis=1)
    foci = goals[distances < bound]
    points = np.full((count, len(a)), np.inf)
    for _ in range(8):
        outside = np.flatnonzero(~((points >= low) & (points <= high)).all(axis=1))
        if not len(outside):
            break
        points[outside] = _in_ellipsoids(
            random, a, foci[random.integers(len(foci), size=len(outside))], bound, low < high
        )
    return _rounded(np.clip(points, low, high), low, high)


def _in_ellipsoids(random: np.random.Generator, a: Floats, b: Floats, length: float, moves: Any) -> Floats:
    """For each of b, a point of which the distances to `a` and b add up to less than a length."""
    directions = random.standard_normal(b.shape) * moves
    norms = np.linalg.norm(directions, axis=1, keepdims=True)
    ball = np.divide(directions, norms, out=np.zeros_like(directions), where=norms > 0.0)  # nothing may move
    ball *= random.random((len(b), 1)) ** (1.0 / max(int(moves.sum()), 1))
    difference = b - a
    distance = np.linalg.norm(difference, axis=1, keepdims=True)
    along = np.divide(difference, distance, out=np.zeros_like(difference), where=distance > 0.0)
    part = (ball * along).sum(axis=1, keepdims=True)
    across = 0.5 * np.sqrt(np.maximum(length**2 - distance**2, 0.0))
    return 0.5 * (a + b) + across * ball + (0.5 * length - across) * part * along


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
    points = np.empty((count, dimensions))
    even = np.empty((min(dimensions, len(_PRIMES)), -(-count // _LANES) * _LANES))
    radical_inverses(_PRIMES[: len(even)], first + 1, even)
    points[:, : len(even)] = even[:, :count].T
    if dimensions > len(even):
        random = np.random.default_rng([0, 1, first])
        points[:, len(even) :] = random.random((count, dimensions - len(even)))
    points.setflags(write=False)
    return points


@lru_cache(maxsize=256)
def shift(dimensions: int, seed: int) -> Floats:
    """What a seed adds to points of the unit cube, modulo 1 (Cranley and Patterson 1976); seed 0 adds nothing.

    Args:
        dimensions: How many numbers a point has.
        seed: The seed.

    Returns:
        Shape (dimensions,), in [0, 1).
    """
    return np.random.default_rng([seed, 0]).random(dimensions) if seed else np.zeros(dimensions)


_LANES = 8


@procedure(constants={"W": _LANES})
def radical_inverses(bases: Array1[f64], first: int, points: Array2[f64], W: int) -> None:
    """Writes the digits of consecutive integers in several bases, mirrored at the point.

    Args:
        bases: The bases, shape (n,) [-].
        first: The first integer, at least 0 [-].
        points: Receives the numbers, shape (n, count), where W divides the count [-].
        W: Lanes, a constant [-].
    """
    for k in range(len(bases)):
        for i in range(0, points.shape[1], W):
            rest = lane_numbers(W, f64) + f64(first + i)
            total = broadcast(0.0, W)
            scale = 1.0 / bases[k]
            while greatest_of(rest) > 0.0:
                shorter = np.floor((rest + 0.5) / bases[k])
                total = total + scale * (rest - shorter * bases[k])
                rest = shorter
                scale = scale / bases[k]
            points[k, i : i + W] = total
